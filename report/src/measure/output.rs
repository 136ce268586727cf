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

    /// The names of what was written, in order.
    pub(crate) fn names(&self) -> Result<Vec<String>> {
        let names =
            fs::read_dir(self.pending.path())?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
        let mut names = names.collect::<Result<Vec<String>>>()?;
        names.sort();
        Ok(names)
    }

    /// Moves the files to where they belong, replacing those of an earlier run.
    pub(crate) fn commit(self) -> Result<()> {
        commit_together([self])
    }

    /// Does what `commit` says, and notes how to undo it.
    fn move_files(&self, moves: &mut Moves) -> Result<()> {
        let mut move_all = || -> Result<()> {
            fs::create_dir_all(&self.folder)?;
            // Within the pending folder, so that what is replaced goes with it.
            let replaced = self.pending.path().join(REPLACED);
            fs::create_dir(&replaced)?;
            for entry in fs::read_dir(self.pending.path())? {
                let entry = entry?;
                if entry.file_name() == REPLACED {
                    continue;
                }
                let target = self.folder.join(entry.file_name());
                if target.exists() {
                    moves.rename(&target, &replaced.join(entry.file_name()))?;
                }
                moves.rename(&entry.path(), &target)?;
            }
            Ok(())
        };
        move_all().with_context(|| format!("cannot move the results to {}", self.folder.display()))
    }
}

/// Where files that are replaced wait until all moved.
const REPLACED: &str = ".replaced";

/// Commits several folders: if one file cannot be moved, all that moved before move back.
pub(crate) fn commit_together<const N: usize>(outputs: [Output; N]) -> Result<()> {
    let mut moves = Moves(Vec::new());
    outputs.iter().try_for_each(|output| output.move_files(&mut moves))?;
    moves.0.clear();
    Ok(())
}

/// Files that were renamed, from and to; undone in reverse when dropped with any left.
struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
    fn rename(&mut self, from: &Path, to: &Path) -> std::io::Result<()> {
        fs::rename(from, to)?;
        self.0.push((from.to_owned(), to.to_owned()));
        Ok(())
    }
}

impl Drop for Moves {
    fn drop(&mut self) {
        for (from, to) in self.0.drain(..).rev() {
            // Nothing can be done about a second failure; the first is being told.
            let _ = fs::rename(to, from);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_committed_together_or_not_at_all() {
        let root = tempfile::tempdir().expect("a folder");
        let (small, large) = (root.path().join("small"), root.path().join("large"));
        let outputs = |text: &str| {
            let outputs = [&small, &large].map(|folder| Output::new(folder).expect("writable"));
            outputs.iter().for_each(|output| output.write_text("a", text).expect("writable"));
            outputs
        };
        let read = |folder: &Path| fs::read_to_string(folder.join("a")).expect("a file");
        commit_together(outputs("first")).expect("nothing is in the way");
        assert_eq!((read(&small), read(&large)), ("first".to_owned(), "first".to_owned()));
        // Where the second folder should be there is now a file.
        fs::remove_dir_all(&large).expect("removable");
        let second = outputs("second");
        fs::write(&large, "in the way").expect("writable");
        assert!(commit_together(second).is_err());
        assert_eq!(read(&small), "first");
        fs::remove_file(&large).expect("removable");
        commit_together(outputs("third")).expect("nothing is in the way");
        assert_eq!((read(&small), read(&large)), ("third".to_owned(), "third".to_owned()));
        assert_eq!(fs::read_dir(root.path()).expect("readable").count(), 2, "nothing else is left");
    }
}
