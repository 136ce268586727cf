//! The generated C headers: cbindgen reads `capi/`, this file arranges what it finds by service.

use anyhow::{Context, Result, anyhow, bail, ensure};
use std::fs;
use std::path::Path;
use xtask::paths;

/// A chapter of a header and how its items' names begin, in the order in which they are printed.
struct Chapter {
    /// The header, under include/.
    file: &'static str,
    title: &'static str,
    /// Where the mathematics stands, in docs/, and when to use what.
    guides: &'static str,
    /// Between spaces; `|` separates those that share a place.
    prefixes: &'static str,
}

/// The header that the others include.
const BASE: &str = "noisefloor/base.h";
/// The width of the headers' lines.
const WIDTH: usize = 120;

/// Every item belongs to the chapter with the longest matching prefix.
const CHAPTERS: [Chapter; 8] = [
    Chapter {
        file: BASE,
        title: "Version and status",
        guides: "",
        prefixes: "NF_ABI_VERSION nf_abi_version nf_status NF_OK|NF_ERR_ nf_status_message NF_CHECK_ nf_check",
    },
    Chapter { file: BASE, title: "Random numbers", guides: "", prefixes: "nf_rng nf_rng_" },
    Chapter {
        file: "noisefloor/cv.h",
        title: "Control variates: samples of one integral, or of a pixel, made into an estimate of lower error",
        guides: "control_variates.md",
        prefixes: "NF_CV_ NF_BASIS_ NF_SOLVER_ NF_RIDGE_ NF_COLOR_ NF_NONFINITE_ NF_PRECISION_ nf_cv_config \
                   nf_cv_samples nf_cv_terms nf_estimate nf_cv_workspace_size nf_cv_estimate nf_cv_rectangle \
                   nf_cv_image nf_cv_image_ NF_OPTIMIZER_ nf_cv_descent nf_cv_gradient_descent nf_cv_accumulator \
                   nf_cv_accumulator_",
    },
    Chapter {
        file: "noisefloor/cv.h",
        title: "Guidance: which estimator and which tile to use",
        guides: "choosing.md",
        prefixes: "NF_SAMPLING_ NF_METHOD_ nf_recommendation nf_recommend",
    },
    Chapter {
        file: "noisefloor/mis.h",
        title: "Multiple importance sampling: the weight of one technique at one point",
        guides: "mis.md",
        prefixes: "NF_MIS_MAX_TECHNIQUES NF_MIS_ nf_mis_",
    },
    Chapter {
        file: "noisefloor/mis.h",
        title: "Optimal multiple importance sampling: weights of least variance, found from the samples",
        guides: "mis.md",
        prefixes: "NF_OMIS_ nf_omis nf_omis_ nf_omis_arguments",
    },
    Chapter {
        file: "noisefloor/tile.h",
        title: "Samplers and tiles: sample points whose error is spread over the image where it shows least",
        guides: "sampling.md, tiles.md, renderer.md",
        prefixes: "nf_sampler nf_sampler_pixel nf_sampler_white nf_sampler_domain nf_sampler_scramble \
                   nf_sampler_draw nf_sampler_table nf_sampler_fill nf_tile nf_tile_ nf_tile_sampler \
                   nf_tile_sampler_pixel nf_tile_sampler_domain nf_tile_sampler_scramble nf_tile_sampler_draw \
                   nf_tile_sampler_fill",
    },
    Chapter {
        file: "noisefloor/table.h",
        title: "Minibatches: items drawn in proportion to their importance, and gradients of the mean loss from them",
        guides: "minibatch.md, minibatch_gradients.md",
        prefixes: "NF_TABLE_ nf_table nf_table_ nf_shard nf_table_shard nf_shards_ nf_table_draw_shard nf_shuffle \
                   NF_NODES_ nf_importance_ nf_importance_arguments nf_omis_weights nf_gradient nf_gradient_",
    },
];

/// Rewrites `include/noisefloor.h` and its parts from the `capi` crate.
pub(crate) fn write() -> Result<()> {
    let (files, folder) = (generate()?, paths::root().join("include/noisefloor"));
    // So that no former part stays.
    _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).context("cannot create include/noisefloor")?;
    for (file, text) in files {
        let path = paths::root().join("include").join(file);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

/// Fails if the committed headers are not what the sources generate.
pub(crate) fn check() -> Result<()> {
    for (file, text) in generate()? {
        let path = paths::root().join("include").join(file);
        if fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))? != text {
            bail!("{} is not what capi/ generates: run `cargo xtask header` and commit the result", path.display());
        }
    }
    let found = paths::list("include/noisefloor")?.len();
    ensure!(found == parts().len(), "include/noisefloor has files that capi/ does not generate: `cargo xtask header`");
    Ok(())
}

/// The parts' names under include/, each once, in their order.
pub(crate) fn parts() -> Vec<String> {
    let mut parts: Vec<_> = CHAPTERS.iter().map(|chapter| chapter.file.to_owned()).collect();
    parts.dedup();
    parts
}

/// Names under include/, and texts.
fn generate() -> Result<Vec<(String, String)>> {
    let crate_dir = paths::root().join("capi");
    let mut config = cbindgen::Config::from_file(crate_dir.join("cbindgen.toml"))
        .map_err(|error| anyhow!("capi/cbindgen.toml: {error}"))?;
    let conventions = config.header.take().context("capi/cbindgen.toml has no `header`")?;
    let includes: String =
        std::mem::take(&mut config.sys_includes).iter().map(|file| format!("#include <{file}>\n")).collect();
    let trailer = config.trailer.take().context("capi/cbindgen.toml has no `trailer`")?;
    let mut items = items(&crate_dir, config)?;
    items.sort_by_key(|item| (item.chapter, item.place));

    let mut whole = format!("{}\n\n#ifndef NOISEFLOOR_H\n#define NOISEFLOOR_H\n\n", conventions.trim());
    whole.extend(parts().iter().map(|name| format!("#include \"{name}\"\n")));
    whole += &format!("\n{}\n\n#endif /* NOISEFLOOR_H */\n", trailer.trim());
    let parts = parts().into_iter().map(|name| {
        let text = part(&name, &includes, &items);
        (name, text)
    });
    Ok(parts.chain([("noisefloor.h".to_owned(), whole)]).collect())
}

/// The text of a part.
fn part(name: &str, includes: &str, items: &[Item]) -> String {
    let guard = name.to_uppercase().replace(['/', '.'], "_");
    let includes = if name == BASE { includes } else { "#include \"base.h\"\n" };
    let mut text =
        "/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */\n".to_owned();
    text += &format!("\n#ifndef {guard}\n#define {guard}\n\n{includes}\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n");
    for (index, chapter) in CHAPTERS.iter().enumerate().filter(|(_, chapter)| chapter.file == name) {
        text += &format!("\n/* {}.", chapter.title);
        if !chapter.guides.is_empty() {
            text += &format!("\n * Guides, in docs/: {}.", chapter.guides);
        }
        text += " */\n";
        let mut place = usize::MAX;
        for item in items.iter().filter(|item| item.chapter == index) {
            // Constants of one place stand together.
            if !(item.is_constant() && item.place == place) {
                text += "\n";
            }
            place = item.place;
            text += &item.text;
        }
    }
    text + &format!("\n#ifdef __cplusplus\n}}\n#endif\n\n#endif /* {guard} */\n")
}

/// One declaration with its documentation.
struct Item {
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
            let prefixes = chapter.prefixes.split(' ').enumerate();
            let prefixes = prefixes.flat_map(|(place, all)| all.split('|').map(move |prefix| (place, prefix)));
            for (place, prefix) in prefixes.filter(|(_, prefix)| name.starts_with(prefix)) {
                if best.is_none_or(|(length, ..)| prefix.len() > length) {
                    best = Some((prefix.len(), index, place));
                }
            }
        }
        let (_, chapter, place) =
            best.with_context(|| format!("release/src/header.rs has no chapter for `{name}`: add its prefix"))?;
        let is_function = code.first().is_some_and(|line| line.contains('(') && !line.starts_with("#define"));
        let mut text = String::new();
        let mut lines = block.lines().filter(|line| !is_function || line.trim_start().starts_with("//")).peekable();
        while let Some(line) = lines.next() {
            if line != "//" || !lines.peek().is_some_and(|next| names_something(next)) {
                text += &format!("{}\n", tidy(line));
            }
        }
        if is_function {
            text += &filled(&code);
        }
        Ok(Self { text: beside(&text), chapter, place })
    }

    fn is_constant(&self) -> bool {
        self.text.lines().any(|line| line.starts_with("#define ") || line.starts_with("extern const "))
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

/// Whether a line of a comment begins with an error, or with an argument: these begin a line of their own, and need no
/// empty one before.
fn names_something(line: &str) -> bool {
    let words = line.trim_start_matches("// ");
    let argument = words.split([':', '[']).next().filter(|name| name.len() < words.len());
    words.starts_with("NF_ERR_")
        || argument.is_some_and(|name| name.chars().all(|c| c.is_ascii_lowercase() || c == '_'))
}

/// Comments of one line go beside the constant, field or function that they describe, where there is room.
fn beside(text: &str) -> String {
    let comment = |line: &str| line.trim_start().starts_with("//");
    let mut result = String::new();
    let mut waiting: Vec<&str> = Vec::new();
    for line in text.lines() {
        if comment(line) {
            waiting.push(line);
            continue;
        }
        let is_short = line.starts_with("#define") || line.ends_with(';');
        match waiting[..] {
            [words] if is_short && line.len() + words.trim().len() < WIDTH => {
                result += &format!("{line} {}\n", words.trim());
            }
            _ => {
                result.extend(waiting.iter().map(|words| format!("{words}\n")));
                result += &format!("{line}\n");
            }
        }
        waiting.clear();
    }
    result
}

/// A function's declaration, as many words to a line as fit.
fn filled(code: &[&str]) -> String {
    let whole = code.iter().map(|line| tidy(line.trim())).collect::<Vec<_>>().join(" ");
    let mut text = String::new();
    let mut column = 0;
    for argument in whole.split_inclusive(", ") {
        if column > 0 && column + argument.trim_end().len() > WIDTH {
            text = format!("{}\n    ", text.trim_end());
            column = 4;
        }
        text += argument;
        column += argument.len();
    }
    text + "\n"
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
