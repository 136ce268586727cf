//! What each family of estimators takes of a program that calls nf_cv_estimate: the sizes of its functions, by the
//! modules that their names tell.

use super::platform::Platform;
use super::sizes;
use anyhow::{Context, Result, bail};
use object::{Object, ObjectSymbol, SymbolKind};
use std::fs;
use std::path::Path;
use xtask::c_tests;

/// A family, and parts of its functions' mangled names: modules, with their lengths. The first that fits counts.
struct Family {
    name: &'static str,
    modules: &'static [&'static str],
}

const FAMILIES: [Family; 5] = [
    Family { name: "k-fold", modules: &["6k_fold", "9cross_fit"] },
    Family { name: "gradient descent", modules: &["16gradient_descent"] },
    Family { name: "least squares by rotations", modules: &["11square_root", "6givens"] },
    Family { name: "incremental", modules: &["7readout", "5state", "11incremental", "7moments"] },
    Family { name: "Gaussian basis", modules: &["8gaussian"] },
];
const OURS: &str = "10noisefloor";
const SHARED: &str = "robust, leave-one-out, least squares, and what all share";
const ARITHMETIC: &str = "elementary functions, and arithmetic that the processor has not";

/// Bytes of instructions, by family.
pub(crate) type Parts = Vec<(&'static str, u64)>;

/// Of a WebAssembly module nothing: its functions have no names.
pub(crate) fn measure(platform: &Platform, archive: &Path) -> Result<Parts> {
    if platform.is_wasm() {
        return Ok(Parts::new());
    }
    let program = c_tests::output("families")?;
    sizes::link(platform, archive, &["nf_cv_estimate"], &program)?;
    let bytes = fs::read(&program).with_context(|| format!("cannot read {}", program.display()))?;
    let file = object::File::parse(&*bytes).context("the linker wrote no program")?;
    let names = FAMILIES.iter().map(|family| family.name).chain([SHARED, ARITHMETIC]);
    let mut parts: Parts = names.map(|name| (name, 0)).collect();
    // Several names of one function are counted once.
    let mut seen = std::collections::BTreeSet::new();
    for symbol in file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0) {
        if !seen.insert(symbol.address()) {
            continue;
        }
        let family = family(symbol.name().unwrap_or_default());
        if let Some((_, sum)) = parts.iter_mut().find(|(name, _)| *name == family) {
            *sum += symbol.size();
        }
    }
    if let Some((name, _)) = parts.iter().find(|(name, size)| *size == 0 && *name != ARITHMETIC) {
        bail!("no function of \"{name}\" is in a program that calls nf_cv_estimate: were modules renamed?");
    }
    Ok(parts)
}

fn family(function: &str) -> &'static str {
    if !function.contains(OURS) && !function.starts_with("nf_") {
        return ARITHMETIC;
    }
    let fits = |family: &&Family| family.modules.iter().any(|module| function.contains(module));
    FAMILIES.iter().find(fits).map_or(SHARED, |family| family.name)
}

#[cfg(test)]
mod tests {
    use super::{ARITHMETIC, SHARED, family};

    #[test]
    fn modules_tell_the_family() {
        let module = "_RINvNtNtCsaKbik3kX1F9_10noisefloor15control_variate";
        assert_eq!(family(&format!("{module}6k_fold8estimatefE")), "k-fold");
        assert_eq!(family(&format!("{module}7readoutINtNtB4_5state5StatefE8estimate")), "incremental");
        assert_eq!(family(&format!("{module}6fitterE")), SHARED);
        assert_eq!(family("nf_cv_estimate"), SHARED);
        assert_eq!(family("__aeabi_dmul"), ARITHMETIC);
        assert_eq!(family("_RNvNtNtCs6KAedJjSfK6_4libm4math3erf3erf"), ARITHMETIC);
    }
}
