//! The targets, and what is measured of each: report/targets.toml.

use crate::chapters::plan::packages;
use anyhow::{Context, Result};
use serde::Deserialize;
use std::process::Command;
use xtask::tools::Package;
use xtask::{paths, run};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Targets {
    #[serde(deserialize_with = "packages")]
    pub(crate) packages: Vec<Package>,
    pub(crate) exports: Vec<String>,
    #[serde(rename = "platform")]
    pub(crate) platforms: Vec<Platform>,
    #[serde(rename = "service")]
    pub(crate) services: Vec<Service>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Platform {
    pub(crate) triple: String,
    /// What a reader calls it.
    pub(crate) name: String,
    pub(crate) binutils: Option<String>,
    pub(crate) emulator: String,
    pub(crate) toolchain: Option<String>,
    pub(crate) opt_level: String,
    /// Without control variates in double precision.
    #[serde(default)]
    pub(crate) float_alone: bool,
    pub(crate) board: Option<Board>,
    #[serde(deserialize_with = "packages")]
    pub(crate) packages: Vec<Package>,
}

/// An emulated board.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Board {
    pub(crate) compiler: String,
    pub(crate) source: String,
    pub(crate) linker_script: String,
    pub(crate) machine: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Service {
    pub(crate) name: String,
    pub(crate) functions: Vec<String>,
    #[serde(default)]
    pub(crate) except: Vec<String>,
}

impl Targets {
    pub(crate) fn read() -> Result<Self> {
        toml::from_str(&paths::read("report/targets.toml")?).context("report/targets.toml")
    }
}

impl Platform {
    pub(crate) fn is_wasm(&self) -> bool {
        self.triple.starts_with("wasm32")
    }

    pub(crate) fn is_windows(&self) -> bool {
        self.triple.contains("windows")
    }

    /// What runs a program here.
    pub(crate) fn emulate(&self) -> Command {
        self.emulated(&self.emulator)
    }

    /// A program that starts the emulator. Wine keeps its idea of a Windows in a folder of its own.
    pub(crate) fn emulated(&self, program: &str) -> Command {
        let mut command = run::command(program);
        command.env("WINEPREFIX", paths::output().join("wine")).env("WINEDEBUG", "-all");
        command
    }

    /// The triple, and what else tells it from others of the same.
    pub(crate) fn id(&self) -> String {
        format!("{}{}", self.triple, if self.float_alone { "-float" } else { "" })
    }
}
