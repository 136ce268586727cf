//! Reading what other commands and programs wrote.

use crate::error::{Error, Result};
use crate::export::points::{Json, Labels, Table};
use crate::points::Points;
use crate::target::image::ImageTarget;
use image::{DynamicImage, ImageFormat, ImageReader};
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// The content of a file.
///
/// # Errors
/// The file is missing, a folder, unreadable or empty.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    if path.is_dir() {
        return Err(Error::Input(format!("{} is a folder: give the name of a file", path.display())));
    }
    let bytes = fs::read(path).map_err(Error::io(path))?;
    if bytes.is_empty() {
        return Err(Error::Input(format!("{} is empty", path.display())));
    }
    Ok(bytes)
}

/// The ending of a file's name, in lower case; empty if it has none.
pub fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// A picture, PNG, JPEG or OpenEXR by its content, whatever its name says.
///
/// # Errors
/// As [`bytes`]; the content is of no such format, or damaged.
pub fn image(path: &Path) -> Result<DynamicImage> {
    decode_image(&bytes(path)?, path)
}

/// As [`image`](fn@image), from the content of the file `path`.
///
/// # Errors
/// The content is of no known format, or damaged.
pub fn decode_image(bytes: &[u8], path: &Path) -> Result<DynamicImage> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(Error::io(path))?;
    let format = reader.format();
    let name = match format {
        Some(ImageFormat::Png) => "PNG",
        Some(ImageFormat::Jpeg) => "JPEG",
        Some(ImageFormat::OpenExr) => "OpenEXR",
        _ => {
            return Err(Error::Input(format!(
                "{} is not a picture that can be read: use PNG, JPEG or OpenEXR",
                path.display()
            )));
        }
    };
    reader.decode().map_err(|error| Error::Input(format!("{} is a damaged {name} file: {error}", path.display())))
}

/// A picture as a density for `points` points: its luma as it is stored (not linear light), or what is missing to white; transparent
/// parts have none. Values beyond 1 (OpenEXR) are densities too, but not if inverted.
///
/// # Errors
/// As [`decode_image`]; a value that is negative or not finite; a density of 0 everywhere.
pub fn density(bytes: &[u8], path: &Path, points: usize, invert: bool) -> Result<ImageTarget> {
    let picture = decode_image(bytes, path)?.to_luma_alpha32f();
    let (width, height) = picture.dimensions();
    let weights: Vec<f32> = picture
        .pixels()
        .map(|pixel| {
            let [luma, alpha]: [f32; 2] = pixel.0;
            // A value that is refused is refused as it is.
            let inverted = invert && luma.is_finite() && luma >= 0.0;
            alpha * if inverted { (1.0 - luma).max(0.0) } else { luma }
        })
        .collect();
    if weights.iter().all(|weight| *weight == 0.0) {
        let colour = if invert { "white" } else { "black" };
        return Err(Error::Input(format!(
            "{} is {colour} everywhere: a density of 0 has no place for a point",
            path.display()
        )));
    }
    ImageTarget::new(width as usize, height as usize, &weights, points)
        .map_err(|error| Error::Input(format!("{}: {error}", path.display())))
}

/// A point set by its content: JSON, CSV (rows with commas) or text (columns separated by spaces), as
/// [`Format`](crate::export::points::Format) describes them. A first row that holds no number names the columns; one named
/// `class` holds each point's class. What follows a `#` is a comment.
///
/// # Errors
/// As [`bytes`]; not text; a value that is no finite number; rows of different lengths; no points; more than 8 coordinates.
pub fn points(path: &Path) -> Result<Table> {
    let bytes = bytes(path)?;
    let text = std::str::from_utf8(&bytes)
        .map_err(|_| Error::Input(format!("{} is not a point set: it is not text", path.display())))?;
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#')).unwrap_or_default();
    let table = if first.starts_with('{') {
        json(text)
    } else if first.contains(',') {
        csv(text)
    } else {
        lines(text)
    };
    let table = table.map_err(|why| Error::Input(format!("{}: {why}", path.display())))?;
    match table.points.dims() {
        _ if table.points.is_empty() => Err(Error::Input(format!("{} holds no points", path.display()))),
        1..=8 => Ok(table),
        dims => Err(Error::Input(format!("{} has {dims} coordinates per point: 1 to 8 are possible", path.display()))),
    }
}

fn json(text: &str) -> std::result::Result<Table, String> {
    let json: Json = serde_json::from_str(text).map_err(|error| error.to_string())?;
    if let Some(index) = json.points.iter().position(|point| point.len() != json.dims) {
        return Err(format!("point {index} has {} coordinates, not {}", json.points[index].len(), json.dims));
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

fn csv(text: &str) -> std::result::Result<Table, String> {
    let mut builder = csv::ReaderBuilder::new();
    builder.has_headers(false).comment(Some(b'#')).trim(csv::Trim::All);
    let records: Vec<csv::StringRecord> =
        builder.from_reader(text.as_bytes()).into_records().collect::<csv::Result<_>>().map_err(|e| e.to_string())?;
    rows(records.iter().map(|record| {
        (record.position().map_or(0, csv::Position::line), record.iter().map(str::to_owned).collect::<Vec<_>>())
    }))
}

fn lines(text: &str) -> std::result::Result<Table, String> {
    let content =
        |line: &str| line.split('#').next().unwrap_or_default().split_whitespace().map(str::to_owned).collect();
    let lines = text.lines().zip(1..).map(|(line, number)| (number, content(line)));
    let names = text.lines().find_map(|line| line.strip_prefix("# classes:"));
    let Some(names) = names else { return rows(lines.filter(|(_, words): &(u64, Vec<String>)| !words.is_empty())) };
    let names: Vec<String> = names.split_whitespace().map(str::to_owned).collect();
    let mut labels = Vec::new();
    let mut coordinates = Vec::new();
    for (number, mut words) in lines.filter(|(_, words)| !words.is_empty()) {
        let class = words.pop().unwrap_or_default();
        let known = class.parse::<usize>().ok().filter(|index| *index < names.len());
        labels.push(known.ok_or_else(|| format!("line {number}: `{class}` is not the index of a class"))?);
        coordinates.push((number, words));
    }
    let table = rows(coordinates.into_iter())?;
    Ok(Table { classes: Some(Labels { names, index: labels }), ..table })
}

/// From numbered rows of words.
fn rows(rows: impl Iterator<Item = (u64, Vec<String>)>) -> std::result::Result<Table, String> {
    let mut rows = rows.peekable();
    let header = rows.next_if(|(_, words)| words.iter().all(|word| word.parse::<f32>().is_err()));
    let class_column = header.and_then(|(_, words)| words.iter().position(|word| word == "class"));
    let columns = rows.peek().map_or(1, |(_, words)| words.len());
    let mut coordinates = Vec::new();
    let mut classes = Vec::new();
    for (number, words) in rows {
        if words.len() != columns {
            return Err(format!("line {number} has {} columns, the lines before {columns}", words.len()));
        }
        for (column, word) in words.into_iter().enumerate() {
            if class_column == Some(column) {
                classes.push(word);
                continue;
            }
            match word.parse::<f32>() {
                Ok(value) if value.is_finite() => coordinates.push(value),
                _ => return Err(format!("line {number}: `{word}` is not a finite number")),
            }
        }
    }
    let has_classes = class_column.is_some_and(|column| column < columns);
    let dims = columns.saturating_sub(usize::from(has_classes));
    if dims == 0 {
        return Err("there are no coordinates".to_owned());
    }
    Ok(Table { points: Points::new(dims, coordinates), classes: has_classes.then(|| Labels::from_names(classes)) })
}
