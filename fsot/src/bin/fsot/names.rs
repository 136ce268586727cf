//! The names of outputs: what is no picture or tile does not end like one. Pipes and devices have the names that they
//! have.

use fsot::error::{Error, Result};
use fsot::{output, read};
use std::path::Path;

/// Endings of pictures and tiles.
const KNOWN: [&str; 6] = ["png", "svg", "jpg", "jpeg", "exr", "nft"];

/// The ending of a name that is that of a picture or a tile, but of none of the `written` kinds.
fn other(path: &Path, written: &[&str]) -> Option<String> {
    let ending = read::ending(path);
    let is = |kinds: &[&str]| kinds.contains(&&ending[..]);
    (!output::is_stream(path) && is(&KNOWN) && !is(written)).then_some(ending)
}

/// Of a picture: refuses the endings of tiles, and of others than the `written` kinds.
///
/// # Errors
/// A sentence that names them.
pub(crate) fn picture(path: &Path, written: &[&str]) -> Result<()> {
    let Some(ending) = other(path, written) else { return Ok(()) };
    let kinds = written.iter().map(|kind| kind.to_ascii_uppercase()).collect::<Vec<_>>().join(" or ");
    let endings = written.iter().map(|kind| format!(".{kind}")).collect::<Vec<_>>().join(" or ");
    Err(Error::Input(format!("{} would be {kinds}, not {ending}: end its name in {endings}", path.display())))
}

/// Of a table of points.
///
/// # Errors
/// The name is that of a picture or a tile.
pub(crate) fn table(path: &Path, advice: &str) -> Result<()> {
    let Some(ending) = other(path, &[]) else { return Ok(()) };
    let (name, kind) = (path.display(), if ending == "nft" { "tile" } else { "picture" });
    Err(Error::Input(format!(
        "{name} would be a table of points, not a {kind}: end its name in .txt, .csv or .json{advice}"
    )))
}

/// Of a tile.
///
/// # Errors
/// It ends in anything but `.nft`; the sentence says how to make what it names.
pub(crate) fn tile(path: &Path) -> Result<()> {
    let ending = read::ending(path);
    if output::is_stream(path) || path.extension().is_none() || ending == "nft" {
        return Ok(());
    }
    let (name, tile) = (path.display(), path.with_extension("nft"));
    let tile = tile.display();
    let format = match &ending[..] {
        "png" | "exr" => &ending[..],
        "raw" | "bin" => "raw",
        "h" | "hpp" => "c-header",
        "rs" => "rust",
        _ => {
            return Err(Error::Input(format!(
                "{name} is no name for a tile: end it in .nft; `fsot export` makes other files of a tile"
            )));
        }
    };
    Err(Error::Input(format!(
        "{name} is no name for a tile: use --out {tile}, then `fsot export {tile} --format {format} --out {name}`"
    )))
}

/// Of a sampler's table, by whose ending `fsot measure --scenes` knows it.
///
/// # Errors
/// It does not end in `.bin`.
pub(crate) fn sampler(path: &Path) -> Result<()> {
    if output::is_stream(path) || read::ending(path) == "bin" {
        return Ok(());
    }
    Err(Error::Input(format!("{} is no name for the table of a sampler: end it in .bin", path.display())))
}

/// Of what a tile is exported as, `written`.
///
/// # Errors
/// It is that of a tile, which it would replace, or of a picture that it is not.
pub(crate) fn export(path: &Path, written: &str) -> Result<()> {
    if !output::is_stream(path) && read::ending(path) == "nft" {
        return Err(Error::Input(format!("{} is the name of a tile: give the {written} file another", path.display())));
    }
    if KNOWN.contains(&written) {
        return picture(path, &[written]);
    }
    other(path, &[]).map_or(Ok(()), |ending| {
        let name = path.display();
        Err(Error::Input(format!("{name} would be the {written} file, not {ending}: give it another ending")))
    })
}
