//! examples_c/bare_metal: linked without an operating system, run on an emulated board or in node, its output compared
//! with this machine's. On targets with an operating system it tells the stack.

use super::platform::{Board, Platform};
use super::sizes;
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use xtask::{c_tests, library, paths, run};

const FOLDER: &str = "examples_c/bare_metal";
const WARNINGS: [&str; 4] = ["-std=gnu99", "-Wall", "-Wextra", "-Werror"];
/// Products and sums stay apart, as on every other target.
const ARITHMETIC: [&str; 2] = ["-O2", "-ffp-contract=off"];
const ALONE: [&str; 4] = ["-ffreestanding", "-nostdlib", "-ffunction-sections", "-Wl,--gc-sections,-z,noexecstack"];
const HOST: [&str; 3] = ["services.c", "stack.c", "host.c"];
/// Between what was computed, which is the same everywhere, and the stack that it took.
const STACK: &str = " stack ";

/// What the program prints is QEMU's standard output; without a device for it, it would be the standard error.
const DEVICES: &str = "-display none -serial none -monitor none -chardev stdio,id=out -semihosting-config \
                       enable=on,target=native,chardev=out";

/// Bytes of stack of each call, by its name.
type Stacks = Vec<(String, u32)>;

/// What the program told of a target.
#[derive(Default)]
pub(crate) struct Told {
    pub(crate) stacks: Stacks,
    /// Bytes of the whole program, where it stands alone.
    pub(crate) image: Option<u64>,
}

/// Without an operating system. Fails unless every line is this machine's.
pub(crate) fn alone(platform: &Platform, board: &Board, binutils: &str, archive: &Path) -> Result<Told> {
    let image = c_tests::output("bare_metal.elf")?;
    let mut compiler = run::command(format!("{binutils}gcc"));
    compiler.args(board.compiler.split(' ')).args(ALONE).arg("-T").arg(format!("{FOLDER}/{}", board.linker_script));
    let sources = ["services.c", "stack.c", "board.c", &board.source];
    // What the program's own floating-point numbers need where there is no unit for them.
    compile(platform, &mut compiler, &sources, archive, &["-lgcc"], &image)?;
    // A program that hangs is ended.
    let mut machine = run::command("timeout");
    machine.args(["60", &platform.emulator]).args(board.machine.split(' ')).args(DEVICES.split(' '));
    let told = compare(platform, machine.arg("-kernel").arg(&image))?;
    Ok(Told { image: Some(sizes::program(&image)?), ..told })
}

/// On another processor's operating system.
pub(crate) fn hosted(platform: &Platform, binutils: &str, archive: &Path) -> Result<Told> {
    let program = c_tests::output("bare_metal_hosted")?;
    let mut compiler = run::command(format!("{binutils}gcc"));
    compile(platform, compiler.arg("-static"), &HOST, archive, &["-pthread"], &program)?;
    compare(platform, run::command(&platform.emulator).arg(program))
}

/// The WebAssembly module `module`, which exports what services.mjs calls.
pub(crate) fn wasm(platform: &Platform, module: &Path) -> Result<Told> {
    let mut script = run::command(&platform.emulator);
    compare(platform, script.arg(format!("{FOLDER}/services.mjs")).arg(module).arg(tile()))
}

fn tile() -> PathBuf {
    paths::root().join("core/tiles/64_1SPP_2D.nft")
}

fn compile(
    platform: &Platform,
    compiler: &mut Command,
    sources: &[&str],
    archive: &Path,
    libraries: &[&str],
    program: &Path,
) -> Result<()> {
    compiler.args(WARNINGS).args(ARITHMETIC).arg("-Iinclude").arg(format!("-DTILE_FILE=\"{}\"", tile().display()));
    if platform.float_alone {
        compiler.arg("-DFLOAT_ALONE");
    }
    compiler.args(sources.iter().map(|source| format!("{FOLDER}/{source}")));
    run::check(compiler.arg(archive).args(libraries).arg("-o").arg(program))
}

/// Runs it, and the same on this machine.
fn compare(platform: &Platform, other: &mut Command) -> Result<Told> {
    let program = c_tests::output("bare_metal_host")?;
    compile(platform, &mut run::compiler("CC", "cc"), &HOST, &library::build()?, &["-pthread"], &program)?;
    let found = run::read(other.stdin(Stdio::null()))?;
    let expected = run::read(&mut run::command(program))?;
    let ((lines, stacks), (wanted, _)) = (split(&found)?, split(&expected)?);
    if lines != wanted {
        bail!("{} printed\n{found}but this machine\n{expected}", platform.name);
    }
    println!("   {} lines of {FOLDER} are the same bits there", lines.len());
    Ok(Told { stacks, image: None })
}

/// The lines without the stack; and the stack of each.
fn split(text: &str) -> Result<(Vec<&str>, Stacks)> {
    let (mut lines, mut stacks) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let (result, stack) = line.split_once(STACK).map_or((line, None), |(result, stack)| (result, Some(stack)));
        lines.push(result);
        if let Some(stack) = stack {
            let name = result.split(' ').next().unwrap_or(result).to_owned();
            stacks.push((name, stack.parse().with_context(|| format!("no number of bytes: `{line}`"))?));
        }
    }
    Ok((lines, stacks))
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_line_without_a_stack_stays_whole() {
        let (lines, stacks) = super::split("nf_a 01 02 stack 96\ndone\n").unwrap();
        assert_eq!(lines, ["nf_a 01 02", "done"]);
        assert_eq!(stacks, [("nf_a".to_owned(), 96)]);
        assert!(super::split("nf_a 01 02 stack deep").is_err());
    }
}
