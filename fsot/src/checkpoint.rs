//! Checkpoints: an interrupted optimisation continues with the same bits.
//!
//! A file is, little-endian: `FSOTCKP1`, the length of the header (u32), the header (JSON: version, program, problem,
//! iteration, number of coordinates), the coordinates (f32), the SHA-256 of all of that.

use crate::digest::digest;
use crate::error::{Error, Result};
use crate::output;
use crate::run::Optimization;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::sync::OnceLock;

const MAGIC: &[u8; 8] = b"FSOTCKP1";
const DIGEST: usize = 32;
/// The most bytes of a header. It names every input file of an animation, in some 70 bytes each.
const MOST_HEADER: u32 = 16 << 20;
/// Differences that an error lists.
const LISTED: usize = 4;

/// What an optimisation is made from, in canonical form: whatever changes a bit of the result belongs into it.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    description: Value,
}

#[derive(Serialize, Deserialize)]
struct Header {
    version: String,
    /// The [`program`] that wrote it.
    #[serde(default)]
    program: String,
    problem: Value,
    iteration: u64,
    coordinates: u64,
}

impl Problem {
    /// From anything serde can describe. Files belong into it by their content: see [`digest`].
    ///
    /// # Errors
    /// `description` is not representable in JSON.
    pub fn new(description: &impl Serialize) -> Result<Problem> {
        let mut description = serde_json::to_value(description)
            .map_err(|error| Error::Input(format!("the problem cannot be described: {error}")))?;
        description.sort_all_objects();
        Ok(Problem { description })
    }

    /// The SHA-256, in hexadecimal, of the canonical JSON and this program's version.
    pub fn fingerprint(&self) -> String {
        digest(format!("{}\n{}", env!("CARGO_PKG_VERSION"), self.description).as_bytes())
    }
}

/// Saves the state of an optimisation; an older checkpoint is replaced atomically.
///
/// # Errors
/// The file cannot be written; the optimisation is beyond its last step, from where [`resume`] would not continue.
pub fn save(path: &Path, problem: &Problem, optimization: &dyn Optimization) -> Result<()> {
    let [done, all] = [optimization.iteration(), optimization.iterations()];
    if done > all {
        return Err(Error::Input(format!("step {done} of {all} is beyond the last: its state is not saved")));
    }
    let coordinates = optimization.coordinates();
    let header = Header {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        program: program().to_owned(),
        problem: problem.description.clone(),
        iteration: done,
        coordinates: coordinates.len() as u64,
    };
    let header =
        serde_json::to_vec(&header).map_err(|error| Error::Write { path: path.into(), source: error.into() })?;
    let mut bytes = Vec::with_capacity(MAGIC.len() + 4 + header.len() + 4 * coordinates.len() + DIGEST);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&(header.len() as u32).to_le_bytes());
    bytes.extend_from_slice(&header);
    bytes.extend(coordinates.iter().flat_map(|value| value.to_le_bytes()));
    let digest = Sha256::digest(&bytes);
    bytes.extend_from_slice(&digest);
    output::write(path, &bytes)
}

/// Continues an optimisation from a checkpoint of the same problem. Returns false, and changes nothing, if there is
/// none.
///
/// # Errors
/// The file cannot be read, is no checkpoint, is truncated or damaged, or belongs to another problem, version or
/// build: the sentence says which, and what differs.
pub fn resume(path: &Path, problem: &Problem, optimization: &mut dyn Optimization) -> Result<bool> {
    let refuse = |why: String| Error::Input(format!("cannot continue from the checkpoint {}: {why}", path.display()));
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
        Err(error) => return Err(Error::io(path)(error)),
        Ok(metadata) if !metadata.is_file() => return Err(refuse("it is not a file".to_owned())),
        Ok(_) => {}
    }
    let file = File::open(path).map_err(Error::io(path))?;
    let length = file.metadata().map_err(Error::io(path))?.len();
    let wanted = optimization.coordinates().len();
    let (header, coordinates) = decode(file, length, wanted).map_err(|why| refuse(why.to_owned()))?;
    if header.version != env!("CARGO_PKG_VERSION") {
        let version = env!("CARGO_PKG_VERSION");
        return Err(refuse(format!("it is of version {}, this is fsot {version}", header.version)));
    }
    if header.problem != problem.description {
        return Err(refuse(format!(
            "it is of another problem ({})",
            differences(&header.problem, &problem.description)
        )));
    }
    if header.program != program() {
        return Err(refuse("another build of this version wrote it, which may compute other bits".to_owned()));
    }
    match coordinates {
        Some(coordinates) if optimization.restore(header.iteration, &coordinates) => Ok(true),
        _ => Err(refuse("its state is not one of this problem's".to_owned())),
    }
}

/// Removes a checkpoint of this problem and program, or what a link of its name leads to. Another's file stays.
pub fn remove(path: &Path, problem: &Problem) {
    let header = || {
        let file = File::open(path).ok()?;
        let length = file.metadata().ok()?.len();
        Some(decode(file, length, 0).ok()?.0)
    };
    let same = |header: Header| {
        header.version == env!("CARGO_PKG_VERSION")
            && header.program == program()
            && header.problem == problem.description
    };
    if header().is_some_and(same) {
        fs::canonicalize(path).and_then(fs::remove_file).ok();
    }
}

/// The SHA-256 of the running program's file: two builds of a version may differ in their arithmetic. Empty where the
/// file cannot be read: then the version alone counts.
fn program() -> &'static str {
    static PROGRAM: OnceLock<String> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        // On Linux the one that runs, even if another has its name by now.
        let file = fs::read("/proc/self/exe").or_else(|_| std::env::current_exe().and_then(fs::read));
        file.map_or_else(|_| String::new(), |bytes| digest(&bytes))
    })
}

/// The header of a file of `length` bytes, and its coordinates, unless there are not `wanted` of them: no more is read
/// than this problem's state has, whatever a file says.
fn decode(
    mut file: impl Read,
    length: u64,
    wanted: usize,
) -> std::result::Result<(Header, Option<Vec<f32>>), &'static str> {
    const TRUNCATED: &str = "it is truncated";
    const DAMAGED: &str = "it is damaged (its checksum does not match)";
    if length == 0 {
        return Err("it is empty");
    }
    let mut bytes = Vec::new();
    // Reads on to an offset of the file.
    let mut read_to = |bytes: &mut Vec<u8>, end: u64| {
        let more = end.saturating_sub(bytes.len() as u64);
        file.by_ref().take(more).read_to_end(bytes).is_ok_and(|read| read as u64 == more)
    };
    let start = MAGIC.len() as u64 + 4;
    let whole = read_to(&mut bytes, start);
    let size = bytes.strip_prefix(MAGIC).ok_or("it is not a checkpoint of fsot")?.first_chunk::<4>();
    let size = u32::from_le_bytes(*size.filter(|_| whole).ok_or(TRUNCATED)?);
    let body = start + u64::from(size);
    if body > length {
        return Err(TRUNCATED);
    }
    if size > MOST_HEADER {
        return Err(DAMAGED);
    }
    if !read_to(&mut bytes, body) {
        return Err(TRUNCATED);
    }
    let header: Header = serde_json::from_slice(&bytes[start as usize..]).map_err(|_| DAMAGED)?;
    let content = header.coordinates.checked_mul(4).and_then(|size| size.checked_add(body)).ok_or(DAMAGED)?;
    let end = content.checked_add(DIGEST as u64).ok_or(DAMAGED)?;
    if length != end {
        return Err(if length < end { TRUNCATED } else { DAMAGED });
    }
    if header.coordinates != wanted as u64 {
        return Ok((header, None));
    }
    if !read_to(&mut bytes, end) {
        return Err(TRUNCATED);
    }
    let (content, digest) = bytes.split_at(bytes.len() - DIGEST);
    if Sha256::digest(content).as_slice() != digest {
        return Err(DAMAGED);
    }
    let coordinates = content[body as usize..].as_chunks::<4>().0;
    Ok((header, Some(coordinates.iter().map(|value| f32::from_le_bytes(*value)).collect())))
}

/// "points: 4096 there, 1024 here; ..."
fn differences(there: &Value, here: &Value) -> String {
    let mut list = Vec::new();
    compare("", there, here, &mut list);
    let more = list.len().saturating_sub(LISTED);
    list.truncate(LISTED);
    let mut text = list.join("; ");
    if more > 0 {
        text.push_str(&format!("; and {more} more"));
    }
    text
}

fn compare(name: &str, there: &Value, here: &Value, list: &mut Vec<String>) {
    match (there, here) {
        (a, b) if a == b => {}
        (Value::Object(a), Value::Object(b)) => {
            let mut keys: Vec<_> = a.keys().chain(b.keys()).collect();
            keys.sort();
            keys.dedup();
            for key in keys {
                let inner = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                compare(&inner, a.get(key).unwrap_or(&Value::Null), b.get(key).unwrap_or(&Value::Null), list);
            }
        }
        (a, b) => {
            let name = if name.is_empty() { String::new() } else { format!("{name}: ") };
            list.push(format!("{name}{} there, {} here", short(a), short(b)));
        }
    }
}

fn short(value: &Value) -> String {
    let text = match value {
        Value::Null => "none".to_owned(),
        value => value.to_string(),
    };
    if text.chars().count() <= 40 { text } else { text.chars().take(37).chain("...".chars()).collect() }
}
