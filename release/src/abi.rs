//! capi/abi.txt: every function, type, layout and constant of the C ABI, so that no change of them goes unseen.

use crate::declarations::Header;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::PathBuf;
use xtask::tools::Missing;
use xtask::{c_tests, paths, run};

/// Rewrites capi/abi.txt, unless what it promised is gone and the version is as it was; `unreleased` allows that: no
/// release has had the version yet.
pub(crate) fn write(unreleased: bool) -> Result<()> {
    let (path, now) = (path(), current()?);
    let before = fs::read_to_string(&path).unwrap_or_default();
    let broken = gone(&before, &now);
    if !broken.is_empty() && version_line(&before) == version_line(&now) && !unreleased {
        bail!(
            "programs built with the present header would break, and NF_ABI_VERSION is as before. Changed or \
             removed:\n  {}\n\
             raise NF_ABI_VERSION in capi/src/status.rs and run `cargo xtask header`; or, if no release has had it, \
             add --unreleased",
            broken.join("\n  ")
        );
    }
    fs::write(&path, now).with_context(|| format!("cannot write {}", path.display()))
}

/// Fails if the committed list is not what the header and the compiler say.
pub(crate) fn check() -> Result<()> {
    if !cfg!(target_pointer_width = "64") {
        bail!(Missing("capi/abi.txt is of targets with pointers of 64 bits".to_owned()));
    }
    let path = path();
    let committed = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let now = current()?;
    if committed == now {
        return Ok(());
    }
    let (broken, new) = (gone(&committed, &now), gone(&now, &committed));
    bail!(
        "the C ABI is not that of capi/abi.txt.\nchanged or removed, which breaks programs:\n  {}\nnew:\n  {}\n\
         if this is meant: `cargo xtask abi`, and docs/releases.md says when NF_ABI_VERSION must be raised",
        broken.join("\n  "),
        new.join("\n  ")
    )
}

fn path() -> PathBuf {
    paths::root().join("capi/abi.txt")
}

fn current() -> Result<String> {
    let header = Header::committed()?;
    header.check_asserts()?;
    let mut text = String::from(
        "# The C ABI where pointers have 64 bits: what `cargo xtask abi` read from the header and the compiler. \
         Do not edit.\n",
    );
    text += &format!("version {}\n", header.version()?);
    for line in header.lines().iter().chain(&measure(&header)?) {
        text += line;
        text.push('\n');
    }
    Ok(text)
}

/// The list's lines of numbers' other names, and of structs and their fields.
fn measure(header: &Header) -> Result<Vec<String>> {
    let mut program = String::from("#include \"noisefloor.h\"\n#include <stdio.h>\nint main(void) {\n");
    for (name, kind) in &header.typedefs {
        program += &format!(
            "printf(\"typedef {name}: size %zu, alignment %zu, %s, {kind}\\n\", sizeof({name}), \
             (size_t)_Alignof({name}), \
             ({name})-1 < 0 ? \"signed\" : \"unsigned\");\n"
        );
    }
    for one in &header.structs {
        let name = &one.name;
        program += &format!(
            "printf(\"struct {name}: size %zu, alignment %zu\\n\", sizeof({name}), (size_t)_Alignof({name}));\n"
        );
        for (kind, field) in &one.fields {
            program += &format!("printf(\"  {name}.{field}: offset %zu, {kind}\\n\", offsetof({name}, {field}));\n");
        }
    }
    program += "return 0;\n}\n";
    let source = c_tests::output("layout.c")?;
    fs::write(&source, program).with_context(|| format!("cannot write {}", source.display()))?;
    let binary = c_tests::output("layout")?;
    run::check(run::compiler("CC", "cc").args(["-std=c11", "-Iinclude"]).arg(source).arg("-o").arg(&binary))?;
    Ok(run::read(&mut run::command(binary))?.lines().map(str::to_owned).collect())
}

/// The lines of one that the other has not. The version is no promise.
fn gone<'a>(these: &'a str, those: &str) -> Vec<&'a str> {
    let kept: std::collections::HashSet<_> = those.lines().collect();
    these.lines().filter(|line| !kept.contains(line) && !line.starts_with("version ")).collect()
}

fn version_line(text: &str) -> Option<&str> {
    text.lines().find(|line| line.starts_with("version "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_removed_or_changed_line_is_gone_and_a_new_one_is_not() {
        let before = "version 1\nfunction void nf_a(void)\nstruct nf_s: size 8, alignment 4\n";
        let now = "version 2\nstruct nf_s: size 12, alignment 4\nfunction void nf_a(void)\nconstant NF_B 1\n";
        assert_eq!(gone(before, now), ["struct nf_s: size 8, alignment 4"]);
        assert_eq!(gone(now, before), ["struct nf_s: size 12, alignment 4", "constant NF_B 1"]);
    }
}
