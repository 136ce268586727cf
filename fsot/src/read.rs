//! Reading what other commands and programs wrote.

mod bounded;
mod ending;
mod jpeg;

pub use ending::ending;

use crate::counted::counted;
use crate::digest::digest;
use crate::error::{Error, Result};
use crate::export::points::{Json, Labels, Table};
use crate::picture::{Photo, is_linear};
use crate::place::Object;
use crate::points::Points;
use crate::target::image::ImageTarget;
use image::error::ImageError;
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use noisefloor::tile::MAGIC;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::io::Cursor;
use std::path::Path;

/// The most bytes of a picture's pixels.
const MOST_DECODED: u64 = 512 << 20;
/// The most bytes of a first line that says how many numbers follow.
const LINE: usize = 100;
/// Some editors begin a text with it.
const BYTE_ORDER_MARK: char = '\u{feff}';
/// The columns of `fsot place`'s tables: an object's colour is its class, and its size is no coordinate.
const OBJECT: [&str; 4] = ["x", "y", "color", "size"];
const SIZE: usize = 3;
const NO_PICTURE: &str = "not a picture that can be read: use PNG, JPEG or OpenEXR";

/// The content of a tile's file, which begins as such files do; nothing else is known of it.
///
/// # Errors
/// The file is missing, a folder, unreadable, empty, too large (1 GiB; 128 MiB from a pipe or a device) or no such
/// file.
pub fn tile(path: &Path) -> Result<Vec<u8>> {
    begun(path, &MAGIC, "not a tile file (.nft)")
}

/// Of a file that begins with `magic` and numbers, separated by spaces, in one line: these numbers, and the floats
/// after them, little-endian. Any other file is `otherwise`.
///
/// # Errors
/// As [`tile`].
pub fn floats(path: &Path, magic: &str, otherwise: &'static str) -> Result<(Vec<usize>, Vec<f32>)> {
    let bytes = begun(path, magic.as_bytes(), otherwise)?;
    let parsed = || {
        let end = bytes.iter().take(LINE).position(|byte| *byte == b'\n')?;
        let line = std::str::from_utf8(bytes.get(magic.len()..end)?).ok()?;
        let numbers = line.trim_end().split(' ').map(|number| number.parse().ok()).collect::<Option<_>>()?;
        let (floats, []) = bytes[end + 1..].as_chunks::<4>() else { return None };
        Some((numbers, floats.iter().map(|float| f32::from_le_bytes(*float)).collect()))
    };
    parsed().ok_or_else(|| Error::Input(format!("{} is {otherwise}", path.display())))
}

/// The content of a file of any kind.
///
/// # Errors
/// As [`tile`].
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>> {
    bounded::read(path, |_| Ok(()))
}

fn begun(path: &Path, magic: &[u8], otherwise: &'static str) -> Result<Vec<u8>> {
    bounded::read(path, |beginning| {
        let same = beginning.iter().zip(magic).all(|(byte, magic)| byte == magic);
        if same { Ok(()) } else { Err(otherwise) }
    })
}

/// The content of a file of text, which is to be `what`.
///
/// # Errors
/// As [`tile`]; the file is not text in UTF-8.
pub fn text(path: &Path, what: &str) -> Result<String> {
    let none = || Error::Input(format!("{} is not {what}: it is not text", path.display()));
    let mut binary = false;
    let bytes = bounded::read(path, |beginning| {
        // The last letter may be cut in two.
        let broken = std::str::from_utf8(beginning).is_err_and(|error| error.error_len().is_some());
        binary = broken || beginning.contains(&0);
        if binary { Err("binary") } else { Ok(()) }
    });
    if binary {
        return Err(none());
    }
    let mut text = String::from_utf8(bytes?).map_err(|_| none())?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.remove(0);
    }
    Ok(text)
}

/// A picture to be drawn with dots, and the SHA-256 of its file: PNG, JPEG or OpenEXR by its content, whatever its name
/// says, upright as its Exif data says.
///
/// # Errors
/// As [`tile`]; the picture is damaged, of more pixels than 512 MiB hold, or of a value that is not finite.
pub fn photo(path: &Path) -> Result<(Photo, String)> {
    let (image, digest) = picture(path)?;
    let photo = Photo::new(&image).map_err(|why| Error::Input(format!("{}: {why}", path.display())))?;
    Ok((photo, digest))
}

/// A decoded picture, and the SHA-256 of its file.
fn picture(path: &Path) -> Result<(DynamicImage, String)> {
    let bytes = bounded::read(path, |beginning| format(beginning).map(drop).ok_or(NO_PICTURE))?;
    Ok((decode(&bytes, path)?, digest(&bytes)))
}

fn decode(bytes: &[u8], path: &Path) -> Result<DynamicImage> {
    let Some((format, name)) = format(bytes) else {
        return Err(Error::Input(format!("{} is {NO_PICTURE}", path.display())));
    };
    let path = path.display();
    let failed = |error: ImageError| {
        Error::Input(match error {
            ImageError::Limits(_) => too_large(&path.to_string(), png_size(bytes), None),
            // As the decoder says it; the exr library tells no more.
            error if format == ImageFormat::OpenExr && error.to_string().contains("rgb channels") => {
                format!("{path} is {name} without red, green and blue, or deep: save it with flat channels R, G and B")
            }
            error => format!("{path} is a damaged {name} file: {error}"),
        })
    };
    let mut decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder().map_err(failed)?;
    if decoder.total_bytes() > MOST_DECODED {
        let bytes = decoder.color_type().bytes_per_pixel();
        return Err(Error::Input(too_large(&path.to_string(), Some(decoder.dimensions()), Some(bytes))));
    }
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut image = if format == ImageFormat::Jpeg {
        jpeg::decode(bytes, decoder.dimensions(), decoder.color_type())
            .map_err(|why| Error::Input(format!("{path} is a damaged {name} file: {why}")))?
    } else {
        DynamicImage::from_decoder(decoder).map_err(failed)?
    };
    image.apply_orientation(orientation);
    Ok(image)
}

/// Which of the formats that can be read these bytes begin as, and its name.
fn format(bytes: &[u8]) -> Option<(ImageFormat, &'static str)> {
    let format = image::guess_format(bytes).ok()?;
    let name = match format {
        ImageFormat::Png => "PNG",
        ImageFormat::Jpeg => "JPEG",
        ImageFormat::OpenExr => "OpenEXR",
        _ => return None,
    };
    Some((format, name))
}

/// That a picture has too many pixels: how many, as far as known, and how many there may be.
fn too_large(path: &str, size: Option<(u32, u32)>, bytes: Option<u8>) -> String {
    let size = size.map_or("its pixels".to_owned(), |(width, height)| format!("{width} x {height} pixels"));
    let most = match bytes {
        Some(bytes) => format!("{} of them, {} each,", MOST_DECODED / u64::from(bytes), counted(bytes, "byte")),
        None => format!("{MOST_DECODED} bytes of them"),
    };
    format!("{path} is too large: it has {size}, and at most {most} are read; scale it down")
}

/// What the header of a PNG file, which comes first, says of its size.
fn png_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let number = |at: usize| bytes.get(at..)?.first_chunk().map(|bytes| u32::from_be_bytes(*bytes));
    (bytes.get(12..16)? == b"IHDR").then_some((number(16)?, number(20)?))
}

/// Of the whole density: values below 0 that make no more are 0. Lossy codecs and resampling filters leave such.
const UNDERSHOOT: f64 = 1e-3;

/// A picture as a density for `points` points, and the SHA-256 of its file: its luma as it is stored (not linear
/// light), or what is missing to white; transparent parts have none. Values beyond 1 (OpenEXR) are densities too, but
/// not if inverted.
///
/// # Errors
/// As [`photo`]; values below 0 that are more than what codecs leave; a density of 0 everywhere.
pub fn density(path: &Path, points: usize, invert: bool) -> Result<(ImageTarget, String)> {
    let (decoded, digest) = picture(path)?;
    let (premultiplied, picture) = (is_linear(&decoded), decoded.to_luma_alpha32f());
    drop(decoded);
    let (width, height) = picture.dimensions();
    let sum = |sign: f32| picture.pixels().map(|pixel| f64::from((sign * pixel.0[0]).max(0.0))).sum::<f64>();
    let is_undershoot = sum(-1.0) <= UNDERSHOOT * sum(1.0);
    let weights: Vec<f32> = picture
        .pixels()
        .map(|pixel| {
            let [luma, alpha]: [f32; 2] = pixel.0;
            let luma = if is_undershoot && luma < 0.0 { 0.0 } else { luma };
            // A value that is refused is refused as it is.
            let inverted = invert && luma.is_finite() && luma >= 0.0;
            let (white, part) = if premultiplied { (alpha, 1.0) } else { (1.0, alpha) };
            part * if inverted { (white - luma).max(0.0) } else { luma }
        })
        .collect();
    if weights.iter().all(|weight| *weight == 0.0) {
        let colour = match invert {
            _ if picture.pixels().all(|pixel| pixel.0[1] <= 0.0) => "transparent",
            true => "white",
            false => "black",
        };
        return Err(Error::Input(format!(
            "{} is {colour} everywhere: a density of 0 has no place for a point",
            path.display()
        )));
    }
    let target = ImageTarget::new(width as usize, height as usize, &weights, points)
        .map_err(|error| Error::Input(format!("{}: {error}", path.display())))?;
    Ok((target, digest))
}

/// A point set by its content: JSON, CSV (rows with commas) or text (columns separated by spaces), as
/// [`Format`](crate::export::points::Format) describes them. A first row that holds no number names the columns; one
/// named `class` holds each point's class. Of the objects of `fsot place` several colours are classes, and sizes are
/// left out. What follows a `#` is a comment; in CSV, a line that begins with it.
///
/// # Errors
/// As [`text`]; a value that is no finite number; rows of different lengths; no points; more than 8 coordinates.
pub fn points(path: &Path) -> Result<Table> {
    let text = &text(path, "a point set")?;
    // The first may be a header, of names with a `#` in them.
    let first: Vec<&str> = text.lines().map(uncommented).filter(|line| !line.is_empty()).take(2).collect();
    let table = if first.first().is_some_and(|line| line.starts_with('{')) {
        json(text)
    } else if first.iter().any(|line| line.contains(',')) {
        csv(text)
    } else {
        lines(text)
    };
    let table = table.map_err(|why| Error::Input(format!("{}: {why}", path.display())))?;
    match table.points.dims() {
        _ if table.points.is_empty() => Err(Error::Input(format!(
            "{} holds no points: give rows of numbers with spaces or commas between them, or JSON such as \
             {{\"dims\": 2, \"points\": [[0.1, 0.2]]}}",
            path.display()
        ))),
        1..=8 => Ok(table),
        dims => Err(Error::Input(format!("{} has {dims} coordinates per point: 1 to 8 are possible", path.display()))),
    }
}

fn json(text: &str) -> std::result::Result<Table, String> {
    #[derive(Deserialize)]
    struct Keys {
        objects: Option<IgnoredAny>,
    }
    let has_objects = || serde_json::from_str::<Keys>(text).is_ok_and(|keys| keys.objects.is_some());
    let json = serde_json::from_str(text).or_else(|error| if has_objects() { objects(text) } else { Err(error) });
    let json: Json = json.map_err(|error| error.to_string())?;
    if let Some(index) = json.points.iter().position(|point| point.len() != json.dims) {
        return Err(format!(
            "point {} has {}, not {}",
            index + 1,
            counted(json.points[index].len(), "coordinate"),
            json.dims
        ));
    }
    if json.classes.as_ref().is_some_and(|classes| classes.len() != json.points.len()) {
        return Err("there are not as many classes as points".to_owned());
    }
    let coordinates = json.points.concat();
    if !coordinates.iter().all(|value| value.is_finite()) {
        return Err("a coordinate is not finite".to_owned());
    }
    Ok(Table { points: Points::new(json.dims, coordinates), classes: json.classes.map(Labels::from_names) })
}

/// What `fsot place` writes.
fn objects(text: &str) -> serde_json::Result<Json> {
    #[derive(Deserialize)]
    struct Objects {
        objects: Vec<Object>,
    }
    let Objects { objects } = serde_json::from_str(text)?;
    let points = objects.iter().map(|object| vec![object.x, object.y]).collect();
    let several = objects.iter().any(|object| object.color != objects[0].color);
    let classes = several.then(|| objects.iter().map(|object| object.color.to_string()).collect());
    Ok(Json { dims: 2, points, classes })
}

fn csv(text: &str) -> std::result::Result<Table, String> {
    let mut builder = csv::ReaderBuilder::new();
    // Rows of other lengths get the sentence of `rows`.
    builder.has_headers(false).flexible(true).comment(Some(b'#')).trim(csv::Trim::All);
    let mut wrong = None;
    let records = builder.from_reader(text.as_bytes()).into_records().map_while(|record| {
        let record: csv::StringRecord = record.map_err(|error| wrong = Some(error.to_string())).ok()?;
        let line = record.position().map_or(0, csv::Position::line);
        Some((line, record.iter().map(str::to_owned).collect()))
    });
    let table = rows(records);
    wrong.map_or(table, Err)
}

/// What a line says before a comment.
fn uncommented(line: &str) -> &str {
    line.split('#').next().unwrap_or_default().trim()
}

fn lines(text: &str) -> std::result::Result<Table, String> {
    let content = |line: &str| uncommented(line).split_whitespace().map(str::to_owned).collect();
    let lines = text.lines().zip(1..).map(|(line, number)| (number, content(line)));
    let lines = lines.filter(|(_, words): &(u64, Vec<String>)| !words.is_empty());
    let names = text.lines().find_map(|line| line.strip_prefix("# classes:"));
    let Some(names) = names else { return rows(lines) };
    let names: Vec<String> = names.split_whitespace().map(str::to_owned).collect();
    let mut index = Vec::new();
    let mut wrong = None;
    let coordinates = lines.map_while(|(number, mut words)| {
        let class = words.pop().unwrap_or_default();
        match class.parse::<usize>() {
            Ok(known) if known < names.len() => index.push(known),
            _ => wrong = Some(format!("line {number}: `{class}` is not the index of a class")),
        }
        wrong.is_none().then_some((number, words))
    });
    let table = rows(coordinates);
    match wrong {
        Some(wrong) => Err(wrong),
        None => Ok(Table { classes: Some(Labels { names, index }), ..table? }),
    }
}

/// From numbered rows of words.
fn rows(rows: impl Iterator<Item = (u64, Vec<String>)>) -> std::result::Result<Table, String> {
    let mut rows = rows.peekable();
    let header = rows.next_if(|(_, words)| words.iter().all(|word| word.parse::<f32>().is_err()));
    let names = header.map_or(Vec::new(), |(_, words)| words);
    let columns = rows.peek().map_or(1, |(_, words)| words.len());
    let objects = names == OBJECT;
    let class_column = names.iter().position(|name| name == if objects { "color" } else { "class" });
    if objects && columns != OBJECT.len() {
        return Err(format!("rows have {}, and the first names {}", counted(columns, "column"), OBJECT.join(",")));
    }
    let mut coordinates = Vec::new();
    let mut classes = Vec::new();
    for (number, words) in rows {
        if words.len() != columns {
            return Err(format!("line {number} has {}, the lines before {columns}", counted(words.len(), "column")));
        }
        for (column, word) in words.into_iter().enumerate() {
            if class_column == Some(column) {
                classes.push(word);
                continue;
            }
            match word.parse::<f32>() {
                Ok(value) if value.is_finite() && objects && column == SIZE => {}
                Ok(value) if value.is_finite() => coordinates.push(value),
                _ => return Err(format!("line {number}: `{word}` is not a finite number")),
            }
        }
    }
    let has_classes = class_column.is_some_and(|column| column < columns);
    let dims = columns.saturating_sub(usize::from(has_classes) + usize::from(objects));
    if dims == 0 {
        return Err("there are no coordinates".to_owned());
    }
    let classes = has_classes.then(|| Labels::from_names(classes)).filter(|labels| !objects || labels.names.len() > 1);
    Ok(Table { points: Points::new(dims, coordinates), classes })
}
