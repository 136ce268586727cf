//! The folder of results: written elsewhere first, so that it only ever holds complete files.

use anyhow::{Context, Result};
use image::RgbImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Collects files beside `folder`; they move into it together. Dropped before that, it leaves nothing.
pub(crate) struct Output {
    folder: PathBuf,
    pending: TempDir,
}

impl Output {
    pub(crate) fn new(folder: &Path) -> Result<Self> {
        let create = || -> Result<TempDir> {
            // Beside the folder, because files are renamed only within one file system.
            let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
            fs::create_dir_all(parent)?;
            Ok(tempfile::Builder::new().prefix(".noisefloor-").tempdir_in(parent)?)
        };
        let pending = create().with_context(|| format!("cannot write beside {}", folder.display()))?;
        Ok(Self { folder: folder.to_owned(), pending })
    }

    pub(crate) fn write_text(&self, name: &str, text: &str) -> Result<()> {
        fs::write(self.pending.path().join(name), text).with_context(|| format!("cannot write {name}"))
    }

    /// With six bits of each channel: the eye sees no more, and noise takes little more than half of the space.
    pub(crate) fn write_picture(&self, name: &str, picture: &RgbImage) -> Result<()> {
        let (mut picture, mut bytes) = (picture.clone(), Vec::new());
        picture.iter_mut().for_each(|value| *value = value.saturating_add(2) & !3);
        // Of noise differences are larger than what they are made of: without a filter it is 461 kB, with that which
        // seems best for each line 560, and by default, which is fast, 768.
        let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::NoFilter);
        picture.write_with_encoder(encoder).with_context(|| format!("cannot encode {name}"))?;
        fs::write(self.pending.path().join(name), bytes).with_context(|| format!("cannot write {name}"))
    }

    /// The names of what was written, in order.
    pub(crate) fn names(&self) -> Result<Vec<String>> {
        let names =
            fs::read_dir(self.pending.path())?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
        let mut names = names.collect::<Result<Vec<String>>>()?;
        names.sort();
        Ok(names)
    }

    /// Moves the files to where they belong, replacing those of an earlier run; what that wrote and this did not goes.
    pub(crate) fn commit(self, former: &[String]) -> Result<()> {
        let move_all = || -> Result<()> {
            fs::create_dir_all(&self.folder)?;
            let names = self.names()?;
            for name in &names {
                fs::rename(self.pending.path().join(name), self.folder.join(name))?;
            }
            let gone = former.iter().filter(|name| !names.contains(name)).map(|name| self.folder.join(name));
            Ok(gone.filter(|path| path.exists()).try_for_each(fs::remove_file)?)
        };
        move_all().with_context(|| format!("cannot move the results to {}", self.folder.display()))
    }
}
