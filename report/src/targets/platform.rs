//! The targets: what each needs to be built, and to be run here.

use xtask::tools::Package;

pub(crate) struct Platform {
    pub(crate) triple: &'static str,
    /// What a reader calls it.
    pub(crate) name: &'static str,
    /// How the names of its gcc and binutils begin, where they are needed.
    pub(crate) binutils: Option<&'static str>,
    /// Runs its programs here.
    pub(crate) emulator: &'static str,
    pub(crate) is_bare_metal: bool,
    /// Cargo's: where memory is scarce, for size.
    pub(crate) opt_level: &'static str,
    /// Whether control variates in double precision are part of the library.
    pub(crate) has_double: bool,
    pub(crate) packages: &'static [Package],
}

impl Platform {
    pub(crate) fn is_wasm(&self) -> bool {
        self.triple.starts_with("wasm32")
    }

    /// The triple, and what else tells it from others of the same.
    pub(crate) fn id(&self) -> String {
        format!("{}{}", self.triple, if self.has_double { "" } else { "-float" })
    }
}

/// A compiler with the source of Rust's core, which every target is built from.
pub(crate) const COMPILER: [Package; 3] = [
    // Not their programs: those of rustup, in another folder, would stand for them.
    Package { name: "rustc-web", file: "/usr/share/doc/rustc-web" },
    Package { name: "cargo-web", file: "/usr/share/doc/cargo-web" },
    Package { name: "rust-web-src", file: "/usr/share/doc/rust-web-src" },
];

const QEMU_USER: Package = Package { name: "qemu-user", file: "/usr/bin/qemu-s390x" };

const CORTEX: &[Package] = &[
    Package { name: "gcc-arm-none-eabi", file: "/usr/bin/arm-none-eabi-gcc" },
    Package { name: "qemu-system-arm", file: "/usr/bin/qemu-system-arm" },
];

pub(crate) const PLATFORMS: [Platform; 6] = [
    Platform {
        triple: "thumbv7em-none-eabihf",
        name: "Cortex-M4F",
        binutils: Some("arm-none-eabi-"),
        emulator: "qemu-system-arm",
        is_bare_metal: true,
        opt_level: "s",
        has_double: true,
        packages: CORTEX,
    },
    Platform {
        triple: "thumbv7em-none-eabihf",
        name: "Cortex-M4F, float alone",
        binutils: Some("arm-none-eabi-"),
        emulator: "qemu-system-arm",
        is_bare_metal: true,
        opt_level: "s",
        has_double: false,
        packages: CORTEX,
    },
    Platform {
        triple: "riscv32imac-unknown-none-elf",
        name: "RISC-V, 32 bits",
        binutils: Some("riscv64-unknown-elf-"),
        emulator: "qemu-system-riscv32",
        is_bare_metal: true,
        opt_level: "s",
        has_double: true,
        packages: &[
            Package { name: "gcc-riscv64-unknown-elf", file: "/usr/bin/riscv64-unknown-elf-gcc" },
            Package { name: "qemu-system-misc", file: "/usr/bin/qemu-system-riscv32" },
        ],
    },
    Platform {
        triple: "aarch64-unknown-linux-gnu",
        name: "AArch64",
        binutils: Some("aarch64-linux-gnu-"),
        emulator: "qemu-aarch64",
        is_bare_metal: false,
        opt_level: "3",
        has_double: true,
        packages: &[
            QEMU_USER,
            Package { name: "cmake", file: "/usr/bin/cmake" },
            Package { name: "gcc-aarch64-linux-gnu", file: "/usr/bin/aarch64-linux-gnu-gcc" },
            Package { name: "libc6-dev-arm64-cross", file: "/usr/aarch64-linux-gnu/lib/libc.a" },
        ],
    },
    Platform {
        triple: "s390x-unknown-linux-gnu",
        name: "s390x, big-endian",
        binutils: Some("s390x-linux-gnu-"),
        emulator: "qemu-s390x",
        is_bare_metal: false,
        opt_level: "3",
        has_double: true,
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
        emulator: "node",
        is_bare_metal: true,
        opt_level: "s",
        has_double: true,
        packages: &[Package { name: "nodejs", file: "/usr/bin/node" }],
    },
];
