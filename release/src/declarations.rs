//! What the generated header declares. Its form is cbindgen's, so a few splits read it.

use crate::header;
use anyhow::{Context, Result, bail};
use std::fs;
use xtask::paths;

/// The end of the declarations: what follows only asserts.
const ASSERTS: &str = "/* Layouts:";

#[derive(Default)]
pub(crate) struct Header {
    /// Result, name and parameters, whose names tell two of one type apart.
    functions: Vec<String>,
    /// Type and name of what is data.
    objects: Vec<String>,
    pub(crate) structs: Vec<Struct>,
    /// Name, and the number that it is.
    pub(crate) typedefs: Vec<(String, String)>,
    opaque: Vec<String>,
    constants: Vec<(String, String)>,
    /// Everything from [`ASSERTS`] on.
    asserts: String,
}

pub(crate) struct Struct {
    pub(crate) name: String,
    /// Type with the array's length, and name.
    pub(crate) fields: Vec<(String, String)>,
}

impl Header {
    /// Reads include/noisefloor.h and its parts.
    pub(crate) fn committed() -> Result<Self> {
        let mut all = String::new();
        for file in header::parts().iter().map(String::as_str).chain(["noisefloor.h"]) {
            let path = paths::root().join("include").join(file);
            all += &fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        }
        Self::parse(&all)
    }

    fn parse(text: &str) -> Result<Self> {
        let (text, asserts) = text.split_once(ASSERTS).with_context(|| format!("the header has no `{ASSERTS}`"))?;
        let mut header = Self { asserts: asserts.to_owned(), ..Self::default() };
        let mut statement = String::new();
        // Comments' lines begin with an asterisk, which no declaration's does; others stand beside the code.
        let code = |line: &'_ str| line.find(" // ").unwrap_or(line.len());
        for line in text.lines().map(|line| line[..code(line)].trim()) {
            if let Some((name, value)) = line.strip_prefix("#define NF_").and_then(|rest| rest.split_once(' ')) {
                header.constants.push((format!("NF_{name}"), number(value)?));
            } else if !line.is_empty() && !["//", "/*", "*", "#"].iter().any(|start| line.starts_with(start)) {
                statement = format!("{statement} {line}").trim().to_owned();
                let open = statement.matches('{').count() > statement.matches('}').count();
                // Of extern "C" the beginning and the end.
                if statement == "}" || statement.ends_with('{') && statement.starts_with("extern") {
                    statement.clear();
                } else if statement.ends_with(';') && !open {
                    header.declare(&statement)?;
                    statement.clear();
                }
            }
        }
        Ok(header)
    }

    /// NF_ABI_VERSION.
    pub(crate) fn version(&self) -> Result<&str> {
        let version = self.constants.iter().find(|(name, _)| name == "NF_ABI_VERSION");
        version.map(|(_, value)| value.as_str()).context("the header has no NF_ABI_VERSION")
    }

    /// Keeps one declaration, up to its semicolon.
    fn declare(&mut self, text: &str) -> Result<()> {
        let text = text.trim_end_matches(';');
        if let Some(rest) = text.strip_prefix("typedef ") {
            return self.declare_type(rest);
        }
        if let Some(object) = text.strip_prefix("extern ").filter(|object| !object.contains('(')) {
            self.objects.push(object.to_owned());
            return Ok(());
        }
        let (before, parameters) =
            text.split_once('(').with_context(|| format!("neither a type nor a function: {text}"))?;
        let name = before.rsplit([' ', '*']).next().unwrap_or_default();
        if !name.starts_with("nf_") {
            bail!("the header declares `{name}`, which does not begin with nf_");
        }
        let parameters: Vec<_> = parameters.trim_end_matches(')').split(',').map(str::trim).collect();
        self.functions.push(format!("{before}({})", parameters.join(", ")));
        Ok(())
    }

    /// Keeps a struct with its fields, an opaque one, or a number's other name.
    fn declare_type(&mut self, text: &str) -> Result<()> {
        if text.starts_with("enum ") {
            bail!("the header has an enum, whose width the compiler chooses: make it a number and constants: {text}");
        }
        if let Some((_, rest)) = text.split_once('{') {
            let (fields, name) = rest.rsplit_once('}').with_context(|| format!("a struct without end: {text}"))?;
            let fields = fields.split(';').map(str::trim).filter(|field| !field.is_empty());
            let fields = fields.map(field).collect::<Result<_>>()?;
            self.structs.push(Struct { name: name.trim().to_owned(), fields });
        } else if let Some(rest) = text.strip_prefix("struct ") {
            self.opaque.push(rest.split(' ').next_back().unwrap_or_default().to_owned());
        } else {
            let (kind, name) = text.rsplit_once(' ').with_context(|| format!("a type without a name: {text}"))?;
            self.typedefs.push((name.to_owned(), kind.to_owned()));
        }
        Ok(())
    }

    /// The list's lines of functions, constants and opaque types, in the header's order.
    pub(crate) fn lines(&self) -> Vec<String> {
        let functions = self.functions.iter().map(|prototype| format!("function {prototype}"));
        let constants = self.constants.iter().filter(|(name, _)| name != "NF_ABI_VERSION");
        let constants = constants.map(|(name, value)| format!("constant {name} {value}"));
        let objects = self.objects.iter().map(|object| format!("object {object}"));
        functions
            .chain(objects)
            .chain(constants)
            .chain(self.opaque.iter().map(|name| format!("opaque {name}")))
            .collect()
    }

    /// Fails unless the header asserts the size of every struct and of every other name of a number.
    pub(crate) fn check_asserts(&self) -> Result<()> {
        let structs = self.structs.iter().map(|one| &one.name);
        for name in structs.chain(self.typedefs.iter().map(|(name, _)| name)) {
            let asserted = [format!("sizeof({name}) == "), format!("NF_ASSERT_STRUCT({name}, ")];
            if !asserted.iter().any(|text| self.asserts.contains(text)) {
                bail!("the header asserts nothing of sizeof({name}): add a line to capi/cbindgen.toml");
            }
        }
        Ok(())
    }
}

/// A constant's value: a number, perhaps in parentheses.
fn number(text: &str) -> Result<String> {
    let value = text.trim_start_matches('(').trim_end_matches(')').to_owned();
    if value.trim_end_matches('f').parse::<f64>().is_err() {
        bail!("the header has a constant whose value is no number: {text}");
    }
    Ok(value)
}

/// `float mean[4]` is of type `float[4]`.
fn field(text: &str) -> Result<(String, String)> {
    let (text, array) = text.split_at(text.find('[').unwrap_or(text.len()));
    let place = text.rfind([' ', '*']).with_context(|| format!("a field without a type: {text}"))? + 1;
    let (kind, name) = text.split_at(place);
    Ok((format!("{}{array}", kind.trim()), name.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "/* Top.\n */\n#ifndef H\nextern \"C\" {\n// Of nf_x(int).\n#define NF_ABI_VERSION 3\n\
        #define NF_E (-2)\n\
        typedef int32_t nf_status;\ntypedef struct nf_o nf_o;\ntypedef struct nf_s {\n    // A.\n    \
        float mean[4];\n    \
        const void *p;\n} nf_s;\nconst char *nf_m(nf_status status);\nnf_s nf_f(const float *u,\n          size_t n);\n\
        uint32_t nf_v(void);\n/* Layouts: */\nA(sizeof(nf_s) == 24)\nA(sizeof(nf_status) == 4)\n";

    #[test]
    fn functions_constants_and_structs_are_read() {
        let header = Header::parse(TEXT).unwrap();
        assert_eq!(header.version().unwrap(), "3");
        let lines = [
            "function const char *nf_m(nf_status status)",
            "function nf_s nf_f(const float *u, size_t n)",
            "function uint32_t nf_v(void)",
            "constant NF_E -2",
            "opaque nf_o",
        ];
        assert_eq!(header.lines(), lines);
        assert_eq!(header.typedefs, [("nf_status".to_owned(), "int32_t".to_owned())]);
        assert_eq!(header.structs.len(), 1);
        let fields = [("float[4]", "mean"), ("const void *", "p")].map(|(a, b)| (a.to_owned(), b.to_owned()));
        assert_eq!(header.structs[0].fields, fields);
        header.check_asserts().unwrap();
        for name in ["nf_s", "nf_status"] {
            let text = TEXT.replace(&format!("A(sizeof({name})"), "A(alignof(x)");
            assert!(Header::parse(&text).unwrap().check_asserts().is_err());
        }
        assert!(Header::parse(&TEXT.replace("struct nf_o nf_o", "enum nf_o { A } nf_o")).is_err());
    }
}
