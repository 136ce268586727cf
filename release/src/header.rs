//! The generated C header: cbindgen reads `capi/`, this file arranges what it finds by service.

use crate::banner;
use anyhow::{Context, Result, anyhow, bail};
use std::fs;
use std::path::Path;
use xtask::paths;

/// A chapter of the header and how its items' names begin, in the order in which they are printed.
struct Chapter {
    title: &'static str,
    /// Where the mathematics stands, in docs/, and when to use what.
    guides: &'static str,
    /// `|` separates those that share a place.
    prefixes: &'static [&'static str],
}

/// Every item belongs to the chapter with the longest matching prefix.
const CHAPTERS: [Chapter; 8] = [
    Chapter {
        title: "Version and status",
        guides: "",
        prefixes: &["NF_ABI_VERSION", "nf_abi_version", "nf_status", "NF_OK|NF_ERR_", "nf_status_message"],
    },
    Chapter {
        title: "Control variates: samples of one integral, or of a pixel, made into an estimate of lower error",
        guides: "control_variates.md",
        prefixes: &[
            "NF_CV_",
            "NF_BASIS_",
            "NF_SOLVER_",
            "NF_RIDGE_",
            "NF_OPTIMIZER_",
            "NF_COLOR_",
            "NF_NONFINITE_",
            "NF_PRECISION_",
            "nf_cv_config",
            "nf_cv_terms",
            "nf_estimate",
            "nf_cv_workspace_size",
            "nf_cv_",
            "nf_cv_block_",
            "nf_cv_accumulator",
            "nf_cv_accumulator_",
        ],
    },
    Chapter {
        title: "Guidance: which estimator and which tile to use",
        guides: "choosing.md",
        prefixes: &["NF_SAMPLING_", "NF_METHOD_", "nf_recommendation", "nf_recommend"],
    },
    Chapter {
        title: "Multiple importance sampling: the weight of one technique at one point",
        guides: "mis.md",
        prefixes: &["NF_MIS_", "nf_mis_"],
    },
    Chapter {
        title: "Optimal multiple importance sampling: weights of least variance, found from the samples",
        guides: "mis.md",
        prefixes: &["NF_OMIS_", "nf_omis", "nf_omis_"],
    },
    Chapter {
        title: "Samplers and tiles: sample points whose error is spread over the image where it shows least",
        guides: "tiles.md, renderer.md",
        prefixes: &[
            "NF_TILE_",
            "nf_tile",
            "nf_tile_",
            "nf_sampler",
            "nf_sampler_pixel",
            "nf_sampler_white",
            "nf_sampler_domain",
            "nf_sampler_scramble",
            "nf_sampler_draw",
            "nf_sampler_table",
            "nf_sampler_fill",
            "nf_tile_sampler",
            "nf_tile_sampler_pixel",
            "nf_tile_sampler_domain",
            "nf_tile_sampler_scramble",
            "nf_tile_sampler_draw",
            "nf_tile_sampler_fill",
        ],
    },
    Chapter { title: "Random numbers", guides: "", prefixes: &["nf_rng", "nf_rng_"] },
    Chapter {
        title: "Minibatches: items drawn in proportion to their importance, and gradients of the mean loss from them",
        guides: "minibatch.md, minibatch_gradients.md",
        prefixes: &[
            "nf_table",
            "nf_table_",
            "nf_shard",
            "nf_table_shard",
            "nf_shards_",
            "nf_table_draw_shard",
            "nf_shuffle",
            "NF_NODES_",
            "nf_importance_",
            "nf_cross_entropy_gradient",
            "nf_importance_nodes",
            "nf_omis_weights",
            "nf_gradient",
            "nf_gradient_",
        ],
    },
];

/// Rewrites `include/noisefloor.h` from the `capi` crate.
pub(crate) fn write() -> Result<()> {
    let path = paths::header();
    fs::write(&path, generate()?).with_context(|| format!("cannot write {}", path.display()))
}

/// Fails if the committed header is not what the sources generate.
pub(crate) fn check() -> Result<()> {
    let path = paths::header();
    let committed = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    if committed != generate()? {
        bail!("{} is not what capi/ generates: run `cargo xtask header` and commit the result", path.display());
    }
    Ok(())
}

fn generate() -> Result<String> {
    let crate_dir = paths::root().join("capi");
    let mut config = cbindgen::Config::from_file(crate_dir.join("cbindgen.toml"))
        .map_err(|error| anyhow!("capi/cbindgen.toml: {error}"))?;
    let conventions = config.header.take().context("capi/cbindgen.toml has no `header`")?;
    let includes: String =
        std::mem::take(&mut config.sys_includes).iter().map(|file| format!("#include <{file}>\n")).collect();
    let trailer = config.trailer.take().context("capi/cbindgen.toml has no `trailer`")?;
    let items = items(&crate_dir, config)?;

    let mut text = format!("{}\n\n#ifndef NOISEFLOOR_H\n#define NOISEFLOOR_H\n\n{includes}\n", conventions.trim());
    text += "#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
    for (index, chapter) in CHAPTERS.iter().enumerate() {
        let mut sorted: Vec<_> = items.iter().filter(|item| item.chapter == index).collect();
        sorted.sort_by_key(|item| item.place);
        let functions = sorted.iter().filter_map(|item| item.summary.as_ref());
        text += &banner::banner(chapter.title, chapter.guides, functions);
        let mut place = usize::MAX;
        for item in sorted {
            // Constants of one place stand together.
            if !(item.is_constant() && item.place == place) {
                text += "\n";
            }
            place = item.place;
            text += &item.text;
        }
    }
    text += &format!("\n{}\n\n#ifdef __cplusplus\n}}\n#endif\n\n#endif /* NOISEFLOOR_H */\n", trailer.trim());
    Ok(text)
}

/// One declaration with its documentation.
struct Item {
    /// A function's name and the first sentence of its description.
    summary: Option<(String, String)>,
    text: String,
    chapter: usize,
    place: usize,
}

impl Item {
    fn new(block: &str) -> Result<Self> {
        let code: Vec<_> = block.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        let name = name(&code).with_context(|| format!("cbindgen wrote a declaration without a name: {block}"))?;
        let mut best: Option<(usize, usize, usize)> = None;
        for (index, chapter) in CHAPTERS.iter().enumerate() {
            let prefixes = chapter.prefixes.iter().enumerate();
            let prefixes = prefixes.flat_map(|(place, all)| all.split('|').map(move |prefix| (place, prefix)));
            for (place, prefix) in prefixes.filter(|(_, prefix)| name.starts_with(prefix)) {
                if best.is_none_or(|(length, ..)| prefix.len() > length) {
                    best = Some((prefix.len(), index, place));
                }
            }
        }
        let (_, chapter, place) =
            best.with_context(|| format!("release/src/header.rs has no chapter for `{name}`: add its prefix"))?;
        let mut text = String::new();
        // Arguments on lines of their own stand below the first, whose line a `struct` left out makes shorter.
        let mut shorter = 0;
        for line in block.lines() {
            let tidied = tidy(line);
            let indent = line.len() - line.trim_start().len();
            text += tidied.get(shorter.min(indent)..).unwrap_or_default();
            text.push('\n');
            if let (Some(before), Some(after)) = (line.find('('), tidied.find('(')) {
                shorter = before.saturating_sub(after);
            }
        }
        let is_function = code.first().is_some_and(|line| line.contains('(') && !line.starts_with("#define"));
        let comments: Vec<_> = block.lines().filter(|line| line.trim_start().starts_with("//")).collect();
        let summary = is_function.then(|| (name.to_owned(), banner::first_sentence(&comments)));
        Ok(Self { summary, text, chapter, place })
    }

    fn is_constant(&self) -> bool {
        self.text.contains("#define ") || self.text.contains("\nextern const ")
    }
}

/// What cbindgen writes, item by item: it separates them by empty lines.
fn items(crate_dir: &Path, config: cbindgen::Config) -> Result<Vec<Item>> {
    let bindings = cbindgen::Builder::new()
        .with_crate(crate_dir)
        .with_config(config)
        .generate()
        .context("cbindgen could not read capi/")?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    let text = String::from_utf8(text).context("cbindgen wrote a header that is not UTF-8")?;
    text.split("\n\n").map(|block| block.trim_matches('\n')).filter(|block| !block.is_empty()).map(Item::new).collect()
}

/// The first word of ours that is declared: the macro, the type or the function.
fn name<'a>(code: &[&'a str]) -> Option<&'a str> {
    let word = |c: char| !(c.is_ascii_alphanumeric() || c == '_');
    let ours = |name: &&str| name.starts_with("nf_") || name.starts_with("NF_");
    let first = code.first()?;
    // A function's name is what stands before the parenthesis, after the type it returns.
    match first.split_once('(') {
        Some((before, _)) => before.split(word).rfind(ours),
        None => first.split(word).rfind(ours),
    }
}

/// Parentheses around negative constants, `f` behind floats, and no `struct` where a typedef does.
fn tidy(line: &str) -> String {
    if let Some((macro_name, value)) = line.strip_prefix("#define ").and_then(|rest| rest.split_once(' ')) {
        let suffix = if value.contains('.') { "f" } else { "" };
        return if value.starts_with('-') {
            format!("#define {macro_name} ({value}{suffix})")
        } else {
            format!("#define {macro_name} {value}{suffix}")
        };
    }
    if line.starts_with("typedef") || line.trim_start().starts_with("//") {
        return line.to_owned();
    }
    line.replace("struct nf_", "nf_")
}
