//! Debian's source package and what building it needs, from wherever this machine's packages come from.

use anyhow::{Context, Result, bail};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask::{run, tools};

const KEYRING: &str = "/usr/share/keyrings/debian-archive-keyring.gpg";

/// apt-get with package lists of its own: the system's sources and lists stay as they are.
pub(crate) struct Apt {
    options: Vec<String>,
}

impl Apt {
    /// `folder`: where the lists go.
    pub(crate) fn new(folder: &Path) -> Result<Self> {
        if !Path::new("/etc/debian_version").exists() {
            bail!("POV-Ray is built from Debian's source package, and this is no Debian: run it in a Debian container");
        }
        let lists = folder.join("lists");
        fs::create_dir_all(&lists).with_context(|| format!("cannot create {}", lists.display()))?;
        let sources = folder.join("sources.list");
        fs::write(&sources, sources_list()?).with_context(|| format!("cannot write {}", sources.display()))?;
        let option = |name: &str, value: &Path| format!("{name}={}", value.display());
        let options = vec![
            option("Dir::Etc::sourcelist", &sources),
            option("Dir::Etc::sourceparts", Path::new("/dev/null")),
            option("Dir::State::lists", &lists),
            // Else apt warns that its own user cannot write into the folder.
            "APT::Sandbox::User=root".to_owned(),
        ];
        let apt = Self { options };
        run::check(apt.get().arg("update")).context("the package lists could not be fetched: is the network there?")?;
        Ok(apt)
    }

    fn get(&self) -> Command {
        let mut command = run::command("apt-get");
        command.env("DEBIAN_FRONTEND", "noninteractive").arg("-qq");
        command.args(self.options.iter().flat_map(|option| ["-o", option]));
        command
    }

    /// Installs what the package's build needs where that is allowed, or says what to install.
    pub(crate) fn build_dependencies(&self, package: &str) -> Result<()> {
        let missing = run::read(self.get().args(["--simulate", "build-dep", package]))?;
        if !missing.lines().any(|line| line.starts_with("Inst ")) {
            return Ok(());
        }
        if !tools::can_install() {
            bail!(
                "packages that POV-Ray's build needs are missing. As root: apt-get build-dep {package} (with deb-src)"
            );
        }
        println!("   installing what {package} is built with");
        run::check(self.get().args(["-y", "--no-install-recommends", "build-dep", package]))
    }

    /// Unpacks the package's source, with Debian's patches, below `folder`, and returns where.
    pub(crate) fn source(&self, package: &str, folder: &Path) -> Result<PathBuf> {
        run::check(self.get().args(["source", package]).current_dir(folder))?;
        let entries = fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
        let mut folders = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| path.is_dir());
        folders.next().with_context(|| format!("`apt-get source {package}` unpacked nothing"))
    }
}

/// Binary and source packages of those archives of Debian that the machine uses already.
fn sources_list() -> Result<String> {
    let format = "$(ORIGIN)|$(CREATED_BY)|$(REPO_URI)|$(RELEASE)|$(COMPONENT)";
    let text = run::read(run::command("apt-get").args(["indextargets", "--format", format]))?;
    let signed = if Path::new(KEYRING).exists() { format!("[signed-by={KEYRING}] ") } else { String::new() };
    let mut lines = BTreeSet::new();
    for line in text.lines() {
        if let ["Debian", "Packages", uri, release, component] = line.split('|').collect::<Vec<_>>()[..] {
            for kind in ["deb", "deb-src"] {
                lines.insert(format!("{kind} {signed}{uri} {release} {component}\n"));
            }
        }
    }
    if lines.is_empty() {
        bail!("`apt-get indextargets` names no archive of Debian: run `apt-get update` once, then try again");
    }
    Ok(lines.into_iter().collect())
}
