//! Class files, and what is said about wrong ones.

use fsot::Error;
use fsot::class::{ClassFile, ClassFunction, Step, TargetSpec};
use fsot::target::Uniform;
use std::path::Path;
use std::sync::Arc;

const TOML: &str = r#"
[[class]]
name = "red"
function = { box = { from = 0.0, to = 0.5 } }

[[class]]
name = "steps"
weight = 2.5
function = { staircase = [{ to = 0.25, value = 1.0 }, { to = 1.0, value = 0.5 }] }
target = { image = "density.png" }

[[class]]
name = "all"
function = "constant"
target = "uniform"

[[class]]
name = "rest"
function = { tabulated = [0.0, 1.0, 0.25] }
"#;

const JSON: &str = r#"{ "class": [
    { "name": "up", "function": { "ramp": { "rising": true } } },
    { "name": "hill", "weight": 0.5, "function": { "gaussian": { "center": [0.5, 0.25], "sigma": 0.1 } } },
    { "name": "part", "function": { "rectangle": { "from": [0, 0], "to": [0.5, 1] } } }
] }"#;

#[test]
fn toml() {
    let file = ClassFile::parse(Path::new("classes.toml"), TOML).unwrap();
    assert_eq!(file.class.len(), 4);
    assert_eq!(file.class[0].function, ClassFunction::Box { from: 0.0, to: 0.5 });
    assert_eq!(file.class[0].weight, 1.0);
    assert_eq!(file.class[0].target, TargetSpec::Uniform);
    let steps = vec![Step { to: 0.25, value: 1.0 }, Step { to: 1.0, value: 0.5 }];
    assert_eq!(file.class[1].function, ClassFunction::Staircase(steps));
    assert_eq!(file.class[1].target, TargetSpec::Image("density.png".into()));
    let mut opened = Vec::new();
    let classes = file.classes(2, |path| {
        opened.push(path.to_owned());
        Ok(Arc::new(Uniform::new(2)))
    });
    let classes = classes.unwrap();
    assert_eq!(opened, [Path::new("density.png")]);
    let names: Vec<&str> = classes.iter().map(|class| class.name.as_str()).collect();
    assert_eq!(names, ["red", "steps", "all", "rest"]);
    assert_eq!(classes[1].weight, 2.5);
}

#[test]
fn json() {
    let file = ClassFile::parse(Path::new("classes.JSON"), JSON).unwrap();
    let counts: Vec<usize> = file.class.iter().map(|entry| entry.function.coordinates()).collect();
    assert_eq!(counts, [1, 2, 2]);
}

#[test]
fn a_picture_that_cannot_be_opened() {
    let file = ClassFile::parse(Path::new("classes.toml"), TOML).unwrap();
    let result = file.classes(2, |path| Err(Error::Input(format!("no {}", path.display()))));
    assert_eq!(result.err().unwrap().to_string(), "no density.png");
}

#[test]
fn wrong_files() {
    let one = |function: &str| format!("[[class]]\nname = \"it\"\nfunction = {function}\n");
    for (text, says) in [
        (String::new(), "class"),
        ("class = []".into(), "no class"),
        ("[[class]]\nname = 3".into(), "string"),
        ("[[class]]\nfunction = \"constant\"".into(), "name"),
        ("[[class]]\nname = \"it\"".into(), "function"),
        (one("\"sphere\""), "sphere"),
        (one("{ box = { from = 0.5, to = 0.25 } }"), "from 0.5 to 0.25"),
        (one("{ box = { from = 0.5 } }"), "to"),
        (one("{ staircase = [] }"), "without steps"),
        (one("{ staircase = [{ to = 0.5, value = 1.0 }, { to = 0.5, value = 0.5 }] }"), "ends at 0.5"),
        (one("{ staircase = [{ to = 0.5, value = 1.5 }] }"), "value 1.5"),
        (one("{ tabulated = [] }"), "empty"),
        (one("{ tabulated = [0.5, -0.5] }"), "-0.5"),
        (one("{ tabulated = [2.0] }"), "holds 2"),
        (one("{ gaussian = { center = [], sigma = 1.0 } }"), "one or two"),
        (one("{ gaussian = { center = [0.5], sigma = 0.0 } }"), "sigma 0"),
        (one("{ gaussian = { center = [0.5], sigma = -1.0 } }"), "sigma -1"),
        (one("{ gaussian = { center = [0.5], sigma = 1e-30 } }"), "at least 1e-18"),
        (format!("{}weight = -2.0", one("\"constant\"")), "weight is -2"),
        (format!("{}colour = 1", one("\"constant\"")), "colour"),
        (format!("{}target = \"circle\"", one("\"constant\"")), "circle"),
        (one("\"constant\"").repeat(2), "c.toml: classes \"it\" and \"it\" cannot be told apart"),
        (
            one("\"constant\"").replace("it", "ink 1") + &one("\"constant\"").replace("it", "ink_1"),
            "classes \"ink 1\" and \"ink_1\" cannot be told apart: give them names that differ in more than spaces",
        ),
    ] {
        let error = ClassFile::parse(Path::new("c.toml"), &text).unwrap_err().to_string();
        assert!(error.contains(says), "{error:?} does not say {says:?}");
    }
    let error = ClassFile::parse(Path::new("c.json"), TOML).unwrap_err().to_string();
    assert!(error.starts_with("c.json: not a class file"), "{error}");
}
