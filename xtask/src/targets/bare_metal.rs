//! examples_c/bare_metal: linked without any other library, run on an emulated board, its output compared with this machine's.

use crate::{c_tests, library, run};
use anyhow::{Context, Result, bail};
use std::path::Path;

const FOLDER: &str = "examples_c/bare_metal";
const WARNINGS: [&str; 4] = ["-std=gnu99", "-Wall", "-Wextra", "-Werror"];
/// Products and sums stay apart, as on every other target.
const ARITHMETIC: [&str; 2] = ["-O2", "-ffp-contract=off"];
const CORTEX_M4F: [&str; 4] = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"];
const ALONE: [&str; 4] = ["-ffreestanding", "-nostdlib", "-ffunction-sections", "-Wl,--gc-sections,-z,noexecstack"];
const BOARD: [&str; 6] = ["-M", "mps2-an386", "-nographic", "-monitor", "none", "-semihosting-config"];
/// Between what was computed, which is the same everywhere, and the stack that it took.
const STACK: &str = " stack ";

/// Fails unless every line is this machine's; returns the stack of each call.
pub(crate) fn run(binutils: &str, emulator: &str, archive: &Path) -> Result<Stacks> {
    let image = c_tests::output("bare_metal.elf")?;
    let mut compiler = run::command(format!("{binutils}gcc"));
    compiler.args(CORTEX_M4F).args(ALONE).arg("-T").arg(format!("{FOLDER}/mps2_an386.ld"));
    compile(&mut compiler, "board.c", archive, &image)?;
    let program = c_tests::output("bare_metal_host")?;
    compile(&mut run::compiler("CC", "cc"), "host.c", &library::build()?, &program)?;

    // A program that hangs is ended.
    let mut board = run::command("timeout");
    board.args(["60", emulator]).args(BOARD).args(["enable=on,target=native", "-kernel"]).arg(&image);
    let found = run::read(board.stdin(std::process::Stdio::null()))?;
    let expected = run::read(&mut run::command(program))?;
    let (lines, stacks) = split(&found)?;
    if lines != expected.lines().collect::<Vec<_>>() {
        bail!("the board printed\n{found}but this machine\n{expected}");
    }
    println!("   {} lines of {FOLDER} are the same bits on the board", lines.len());
    Ok(stacks)
}

fn compile(compiler: &mut std::process::Command, platform: &str, archive: &Path, program: &Path) -> Result<()> {
    let tile = crate::paths::root().join("core/tiles/64_1SPP_2D.nft");
    compiler.args(WARNINGS).args(ARITHMETIC).arg("-Iinclude").arg(format!("-DTILE_FILE=\"{}\"", tile.display()));
    compiler.arg(format!("{FOLDER}/services.c")).arg(format!("{FOLDER}/{platform}"));
    run::check(compiler.arg(archive).arg("-o").arg(program))
}

/// Bytes of stack of each call, by its name.
pub(crate) type Stacks = Vec<(String, u32)>;

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
