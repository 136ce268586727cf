//! The folder of results: written elsewhere first, so that it only ever holds complete files.

use super::image::{exposure, tone_map};
use super::metric::Reference;
use anyhow::{Context, Result};
use image::{Rgb32FImage, RgbImage};
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
        self.write_bytes(name, text.as_bytes())
    }

    pub(crate) fn write_bytes(&self, name: &str, bytes: &[u8]) -> Result<()> {
        fs::write(self.pending.path().join(name), bytes).with_context(|| format!("cannot write {name}"))
    }

    pub(crate) fn write_picture(&self, name: &str, picture: &RgbImage) -> Result<()> {
        picture.save(self.pending.path().join(name)).with_context(|| format!("cannot write {name}"))
    }

    /// NAME.exr with linear values, NAME.png as they are shown beside the reference.
    pub(crate) fn write_image(&self, name: &str, image: &Rgb32FImage, reference: &Reference) -> Result<()> {
        let path = self.pending.path().join(format!("{name}.exr"));
        image.save(path).with_context(|| format!("cannot write {name}.exr"))?;
        self.write_picture(&format!("{name}.png"), &tone_map(image, exposure(&reference.image)))
    }

    /// Moves the files to where they belong, replacing those of an earlier run.
    pub(crate) fn commit(self) -> Result<()> {
        let move_all = || -> Result<()> {
            fs::create_dir_all(&self.folder)?;
            for entry in fs::read_dir(self.pending.path())? {
                let entry = entry?;
                fs::rename(entry.path(), self.folder.join(entry.file_name()))?;
            }
            Ok(())
        };
        move_all().with_context(|| format!("cannot move the results to {}", self.folder.display()))
    }
}
