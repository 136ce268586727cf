//! Sizes, alignments and offsets, as the C compiler has them.

use super::header::Header;
use crate::c_tests::output;
use crate::run;
use anyhow::{Context, Result};
use std::fs;

/// The list's lines of numbers' other names, and of structs and their fields.
pub(super) fn measure(header: &Header) -> Result<Vec<String>> {
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
    let source = output("layout.c")?;
    fs::write(&source, program).with_context(|| format!("cannot write {}", source.display()))?;
    let binary = output("layout")?;
    run::check(run::compiler("CC", "cc").args(["-std=c11", "-Iinclude"]).arg(source).arg("-o").arg(&binary))?;
    Ok(run::read(&mut run::command(binary))?.lines().map(str::to_owned).collect())
}
