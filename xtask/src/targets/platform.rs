//! The targets: what each needs to be built, and to be run here.

use crate::tools::Package;

pub(crate) struct Platform {
    pub(crate) triple: &'static str,
    /// What a reader calls it.
    pub(crate) name: &'static str,
    /// How the names of its gcc and binutils begin, where they are needed.
    pub(crate) binutils: Option<&'static str>,
    /// Runs its programs here.
    pub(crate) emulator: Option<&'static str>,
    pub(crate) is_bare_metal: bool,
    pub(crate) packages: &'static [Package],
}

/// A compiler with the source of Rust's core, which every target is built from.
pub(crate) const COMPILER: [Package; 3] = [
    Package { name: "rustc-web", file: "/usr/bin/rustc" },
    Package { name: "cargo-web", file: "/usr/bin/cargo" },
    Package { name: "rust-web-src", file: "/usr/share/doc/rust-web-src" },
];

const QEMU_USER: Package = Package { name: "qemu-user", file: "/usr/bin/qemu-s390x" };

pub(crate) const PLATFORMS: [Platform; 5] = [
    Platform {
        triple: "thumbv7em-none-eabihf",
        name: "Cortex-M4F",
        binutils: Some("arm-none-eabi-"),
        emulator: Some("qemu-system-arm"),
        is_bare_metal: true,
        packages: &[
            Package { name: "gcc-arm-none-eabi", file: "/usr/bin/arm-none-eabi-gcc" },
            Package { name: "qemu-system-arm", file: "/usr/bin/qemu-system-arm" },
        ],
    },
    Platform {
        triple: "riscv32imac-unknown-none-elf",
        name: "RISC-V, 32 bits",
        binutils: None,
        emulator: None,
        is_bare_metal: true,
        packages: &[],
    },
    Platform {
        triple: "aarch64-unknown-linux-gnu",
        name: "AArch64",
        binutils: Some("aarch64-linux-gnu-"),
        emulator: Some("qemu-aarch64"),
        is_bare_metal: false,
        packages: &[
            QEMU_USER,
            Package { name: "gcc-aarch64-linux-gnu", file: "/usr/bin/aarch64-linux-gnu-gcc" },
            Package { name: "libc6-dev-arm64-cross", file: "/usr/aarch64-linux-gnu/lib/libc.a" },
        ],
    },
    Platform {
        triple: "s390x-unknown-linux-gnu",
        name: "s390x, big-endian",
        binutils: Some("s390x-linux-gnu-"),
        emulator: Some("qemu-s390x"),
        is_bare_metal: false,
        packages: &[
            QEMU_USER,
            Package { name: "gcc-s390x-linux-gnu", file: "/usr/bin/s390x-linux-gnu-gcc" },
            Package { name: "libc6-dev-s390x-cross", file: "/usr/s390x-linux-gnu/lib/libc.a" },
        ],
    },
    Platform {
        triple: "wasm32-unknown-unknown",
        name: "WebAssembly",
        binutils: None,
        emulator: None,
        is_bare_metal: true,
        packages: &[],
    },
];
