//! Running POV-Ray, stock or patched, and reading its pictures.

use anyhow::{Context, Result, bail};
use image::Rgb32FImage;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use tempfile::TempDir;
use xtask::run;

pub(crate) struct Programs {
    /// Debian's.
    pub(crate) stock: PathBuf,
    pub(crate) patched: PathBuf,
}

/// Environment of a patched run: NOISEFLOOR settings by the rest of their names.
pub(crate) type Settings<'a> = Vec<(&'a str, String)>;

/// What POV-Ray is run with. `options` come last and override.
struct Call<'a> {
    program: &'a Path,
    scene: &'a str,
    size: [u32; 2],
    options: &'a [&'a str],
    settings: &'a [(&'a str, String)],
}

/// Renders in a folder of its own: POV-Ray's default rules let it read and write there.
pub(crate) struct Renderer<'a> {
    programs: &'a Programs,
    scratch: TempDir,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// A linear picture and what it took.
pub(crate) struct Picture {
    pub(crate) image: Rgb32FImage,
    /// Of all threads, in tracing.
    pub(crate) cpu_seconds: f64,
}

impl<'a> Renderer<'a> {
    pub(crate) fn new(programs: &'a Programs, folder: &Path, width: u32, height: u32) -> Result<Self> {
        let scratch = tempfile::tempdir_in(folder).context("cannot create a temporary folder")?;
        Ok(Self { programs, scratch, width, height })
    }

    /// A file for scenes to be rendered or included.
    pub(crate) fn provide(&self, name: &str, text: &[u8]) -> Result<()> {
        fs::write(self.scratch.path().join(name), text).with_context(|| format!("cannot write {name}"))
    }

    /// POV-Ray as Debian built it.
    pub(crate) fn stock(&self, scene: &str, options: &[&str]) -> Result<Picture> {
        self.stock_sized(scene, [self.width, self.height], options)
    }

    pub(crate) fn stock_sized(&self, scene: &str, size: [u32; 2], options: &[&str]) -> Result<Picture> {
        self.run(&Call { program: &self.programs.stock, scene, size, options, settings: &[] })
    }

    pub(crate) fn patched(&self, scene: &str, settings: &Settings) -> Result<Picture> {
        self.patched_sized(scene, [self.width, self.height], &[], settings)
    }

    pub(crate) fn patched_sized(
        &self,
        scene: &str,
        size: [u32; 2],
        options: &[&str],
        settings: &Settings,
    ) -> Result<Picture> {
        self.run(&Call { program: &self.programs.patched, scene, size, options, settings })
    }

    fn run(&self, call: &Call) -> Result<Picture> {
        let text = self.call(call)?;
        let image = self.read("picture.png")?;
        let [width, height] = call.size;
        if image.dimensions() != (width, height) {
            bail!("{} became a picture of {:?} pixels instead of {width} x {height}", call.scene, image.dimensions());
        }
        Ok(Picture { image, cpu_seconds: cpu_seconds(&text).unwrap_or(f64::NAN) })
    }

    /// The mean of `frames` frames, which differ by frame_number, from 0.
    pub(crate) fn stock_mean(&self, scene: &str, size: [u32; 2], frames: u32) -> Result<Rgb32FImage> {
        let last = (frames - 1).to_string();
        let options = ["+KFI0", &format!("+KFF{last}")];
        self.call(&Call { program: &self.programs.stock, scene, size, options: &options, settings: &[] })?;
        let mut sum = vec![0.0_f64; (size[0] * size[1] * 3) as usize];
        for frame in 0..frames {
            let image = self.read(&format!("picture{frame:0>width$}.png", width = last.len()))?;
            sum.iter_mut().zip(image.iter()).for_each(|(sum, value)| *sum += f64::from(*value));
        }
        let mean = sum.into_iter().map(|sum| (sum / f64::from(frames)) as f32).collect();
        Rgb32FImage::from_raw(size[0], size[1], mean).context("the frames are of another size")
    }

    fn read(&self, name: &str) -> Result<Rgb32FImage> {
        let path = self.scratch.path().join(name);
        Ok(image::open(&path).with_context(|| format!("POV-Ray wrote no {name}"))?.to_rgb32f())
    }

    fn call(&self, &Call { program, scene, size: [width, height], options, settings }: &Call) -> Result<String> {
        let mut command = run::command(program);
        command.current_dir(self.scratch.path()).stdin(Stdio::null());
        // 16 bits, linear, no window, no antialiasing of its own.
        command.args([&format!("+I{scene}"), "+Opicture.png", "+FN16", "File_Gamma=1.0", "-D", "-A"]);
        command.args([format!("+W{width}"), format!("+H{height}")]).args(options);
        for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("NOISEFLOOR")) {
            command.env_remove(name);
        }
        for (name, value) in settings {
            let name = if name.is_empty() { "NOISEFLOOR".to_owned() } else { format!("NOISEFLOOR_{name}") };
            command.env(name, value);
        }
        let mut run = || -> Result<_> {
            let output = command.output();
            let output = output.with_context(|| format!("cannot start {}", program.display()))?;
            Ok((output.status, String::from_utf8_lossy(&output.stderr).into_owned()))
        };
        let (mut status, mut text) = run()?;
        // A busy machine may start POV-Ray's threads so late that it gives up before it begins.
        for _ in 0..3 {
            if text.contains("Timed out waiting for worker thread startup") {
                (status, text) = run()?;
            }
        }
        if !status.success() {
            let tail: Vec<&str> = text.lines().rev().take(12).collect();
            let tail: Vec<&str> = tail.into_iter().rev().collect();
            bail!("{} failed on {scene} ({status}):\n{}", program.display(), tail.join("\n"));
        }
        Ok(text)
    }
}

/// POV-Ray ends by saying so: `Trace Time: ... using 2 thread(s) with 1.234 CPU-seconds total`.
fn cpu_seconds(text: &str) -> Option<f64> {
    let start = text.rfind("Trace Time:")?;
    let (before, _) = text[start..].split_once(" CPU-seconds total")?;
    before.split_whitespace().last()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_found() {
        let text = "Parse Time: 0 seconds\n with 9.0 CPU-seconds total\nTrace Time:  0 hours  0 minutes  5 seconds \
                    (5.125 seconds)\n   using 2 thread(s) with 10.181 CPU-seconds total\n";
        assert_eq!(cpu_seconds(text), Some(10.181));
        assert_eq!(cpu_seconds("Parse Time: 3"), None);
    }
}
