//! Each rule: what keeps it passes, what breaks it is told.

use super::source::Sources;
use super::text;
use std::fs;
use tempfile::TempDir;

/// A report of two chapters, and a tile.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let embree = r#"{"settings": {"spp": 64}, "quoted": {"worst": {"text": "1.234", "value": 1.234}}, "tables": [
        {"name": "direct", "columns": ["scene", "spp", "ratio"], "rows": [
            ["dining", "16", {"text": "0.434 [0.400, 0.460]", "value": 0.4343, "interval": [0.40, 0.46], "seeds": 77}],
            ["dragon", "64", {"text": "-0.712 [-0.800, -0.600]", "value": -0.712, "interval": [-0.8, -0.6]}]]},
        {"name": "indirect", "columns": ["scene", "bound", "ratio"], "rows": [["duck", "at most 0.8", "0.921"],
            ["lens", "at most 0.8", "+0.315 +- 0.04"]]},
        {"name": "rays", "columns": ["a ray for each", "frame, ns per sample", "default, %"], "rows": [
            ["sample", {"value": 512.3}, {"value": 35.7}], ["pixel", {"value": 434.2}, {"value": 16.3}]]},
        {"name": "orders", "columns": ["samples", "order 3", "order 4"], "rows": [["4", 0.512, 0.443], ["16", 0.212, 0.125]]}]}"#;
    let many: Vec<String> =
        (0..200).map(|i| format!(r#"["row {i}", {{"value": {}}}]"#, 0.3 + 0.001 * f64::from(i))).collect();
    let many = format!(r#"{{"tables": [{{"name": "all", "columns": ["", "x"], "rows": [{}]}}]}}"#, many.join(","));
    for (name, text) in
        [("embree.json", embree), ("many.json", &many), ("A.toml", "spp = 4\nfiltered = [0.04299, 0.002204]\n")]
    {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

fn wrong(document: &str) -> Vec<String> {
    let folder = folder();
    let sources = Sources::new(folder.path(), folder.path());
    let found = text::check(document, &sources);
    assert!(found.without_source.is_empty(), "{document}");
    found.wrong.into_iter().map(|(line, message)| format!("{line}: {message}")).collect()
}

/// The only message about a figure below a source.
#[track_caller]
fn error(source: &str, text: &str) -> String {
    let all = wrong(&format!("<!-- figures: {source} -->\n{text}\n"));
    all.first().unwrap_or_else(|| panic!("`{text}` is accepted of {source}")).clone()
}

#[track_caller]
fn accepted(source: &str, text: &str) {
    assert_eq!(wrong(&format!("<!-- figures: {source} -->\n{text}\n")), [""; 0]);
}

#[test]
fn a_figure_is_a_value_rounded() {
    accepted("embree/direct", "The ratio is .43, or 43 of a hundred.");
    accepted("embree/direct", "0.434 and -.71");
    accepted("embree/indirect", "0.92");
    accepted("embree/quoted", "1.23");
    accepted("embree/settings", "64 ms");
    accepted("tiles/A", ".043 / .0022");
    let told = error("embree/direct", "The ratio is .44 in dining.");
    assert_eq!(told, "2: .44 is not in embree/direct; nearest: 0.4343 (dining, 16 | ratio)");
    error("embree/direct", ".433");
    error("tiles/A", ".044");
    error("embree/settings", "63 ms");
}

#[test]
fn signs_count() {
    error("embree/direct", "-.43");
    error("embree/direct", "−.43");
    error("embree/direct", ".71");
    accepted("embree/direct", "−.71");
}

#[test]
fn a_figure_of_another_table_is_wrong() {
    error("embree/direct", "0.921");
    error("embree/direct", "1.23");
    error("embree/quoted", ".43");
    error("many/all", "0.921");
}

#[test]
fn only_values_count() {
    for (of, text) in
        [("an end of the interval", ".46"), ("half of its width", ".03"), ("seeds", "77 ms"), ("a label", "64 ms")]
    {
        assert!(error("embree/direct", text).contains("is not in"), "{of}");
    }
    error("embree/indirect", ".8");
}

#[test]
fn intervals_are_of_the_figure_before_them() {
    accepted("embree/direct", ".43 ± .03 and -.71 ± .1");
    accepted("embree/direct", ".43 [.40, .46]");
    assert!(error("embree/direct", ".43 ± .1").contains("not both sides of an interval of the figure before it"));
    assert!(error("embree/direct", ".43 [.40, .47]").contains("no end of an interval of the figure before it"));
    error("embree/direct", ".43 [-.8, .46]");
    error("embree/direct", "± .03");
    accepted("embree/indirect", "+.315 ± .04");
    error("embree/indirect", ".04");
}

/// 0.4343 [0.400, 0.460]: .0343 below, .0257 above, .030 on average.
#[test]
fn sides_that_differ_are_quoted_as_ends() {
    for of in [".434 ± .030", ".434 ± .034", ".434 ± .026"] {
        assert!(error("embree/direct", of).contains("write [low, high]"), "{of}");
    }
    accepted("embree/direct", ".434 [.400, .460]");
}

#[test]
fn what_says_little_must_be_narrowed() {
    let told = error("many/all", "It is .35.");
    assert!(told.contains("says little") && told.contains("TABLE @ WORDS"), "{told}");
    accepted("many/all @ row 50", "It is .35.");
    error("many/all @ row 51", "It is .38.");
    assert!(error("many/all @ row 500", ".35").contains("no row and column of many/all have these words"));
}

#[test]
fn a_word_of_rows_names_no_column() {
    accepted("embree/rays @ sample", "512.3 ns, 35.7 %");
    accepted("embree/rays @ pixel frame", "434.2 ns");
    error("embree/rays @ sample", "434.2 ns");
    error("embree/rays @ sample", "16.3 %");
    error("embree/rays @ sample frame", "35.7 %");
    assert!(error("embree/rays @ sample pixel", "512.3 ns").contains("no row and column"));
    accepted("embree/orders @ order 4", ".443 and .125");
    error("embree/orders @ order 4", ".512");
    accepted("embree/orders @ 4 order", ".512 and .443");
}

#[test]
fn rows_are_of_the_same_name() {
    accepted("embree/direct", "| dining (2) | .43 |\n| dragon | -.71 |\n| | -.71 |\n| other | .43 |");
    error("embree/direct", "| dragon | .43 |");
    error("embree/direct", "| dining | .43 |\n| | -.71 |");
    accepted("many/all", "| 50, row | .35 |");
}

#[test]
fn sources_are_tables_that_are_there_and_needed() {
    assert!(error("embree/nothing", ".43").contains(
        "there are embree/direct; embree/indirect; embree/orders; embree/quoted; embree/rays; embree/settings"
    ));
    assert!(error("embree", ".43").contains("there is no source `embree`"), "a chapter alone");
    error("tiles", ".043");
    accepted("tiles", "| `NF_TILE_A` | .043 |");
    error("tiles", "| `NF_TILE_B` | .043 |");
    error("test rng", ".43");
    error("embree/direct", "Nothing.");
    assert!(error("embree/direct; embree/quoted", ".43").contains("no figure is from embree/quoted"));
    accepted("embree/direct; embree/quoted", ".43 and 1.23");
    accepted("none (settings)", ".044");
    assert!(error("none", ".044").contains("must say why"));
    assert!(error("none (settings)", "Nothing.").contains("no figure needs"));
    error("embree/direct --", ".43");
}

#[test]
fn a_heading_ends_what_a_line_says() {
    let folder = folder();
    let sources = Sources::new(folder.path(), folder.path());
    let found = text::check("<!-- figures: embree/direct -->\n.43\n\n## Next\n\n.43\n", &sources);
    assert_eq!((found.wrong.len(), found.without_source.len()), (0, 1));
}
