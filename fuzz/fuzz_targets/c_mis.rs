//! Every function of multiple importance sampling and of gradients in the C library, the heuristics against their
//! formulas.
#![no_main]

mod support;

use arbitrary::{Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use noisefloor_c::*;
use std::ptr::null_mut;
use support::Source;

/// Bytes beyond which no object is allocated.
const MOST: usize = 1 << 16;

fn weights(source: &mut Source<'_>) -> Result<()> {
    let techniques = 1 + source.any::<u8>()? % 16;
    let len = usize::from(techniques);
    let techniques = u32::from(techniques);
    let pdf = source.array(len, |source| source.number().map(f32::abs))?;
    let counts = source.array(len, |source| source.small(4))?;
    let alpha = source.array(len, Source::number)?;
    let (option, value) = (source.number()?, source.number()?);
    let which = source.any::<u8>()? % 5;
    let (p, n) = (pdf.pointer(), counts.pointer());
    let call = |technique: u32, out: *mut f32| {
        // SAFETY: arrays have the lengths that the header asks for; wrong addresses are NULL or misaligned, which are
        // refused.
        unsafe {
            match which {
                0 => nf_mis_weight(NF_MIS_BALANCE, 0.0, p, n, techniques, technique, out),
                1 => nf_mis_weight(NF_MIS_POWER, option, p, n, techniques, technique, out),
                2 => nf_mis_weight(NF_MIS_CUTOFF, option, p, n, techniques, technique, out),
                3 => nf_mis_weight(NF_MIS_MAXIMUM, 0.0, p, n, techniques, technique, out),
                _ => nf_mis_optimal_contribution(p, n, techniques, technique, alpha.pointer(), value, out),
            }
        }
    };
    let mut sum = Some(0.0);
    for technique in 0..techniques {
        let mut weight = -7.0;
        if call(technique, &mut weight) == NF_OK {
            assert!(weight.is_finite() && (which >= 4 || (0.0..=1.0).contains(&weight)), "{weight}");
            sum = sum.map(|sum| sum + f64::from(weight));
        } else {
            assert_eq!(weight, -7.0);
            sum = None;
        }
        if which == 0 && sum.is_some() {
            let products: Vec<f64> =
                pdf.values.iter().zip(&counts.values).map(|(&p, &n)| f64::from(p) * f64::from(n)).collect();
            let total: f64 = products.iter().sum();
            if total > 0.0 && total.is_finite() {
                let expected = products[technique as usize] / total;
                assert!((f64::from(weight) - expected).abs() < 1e-6, "{weight}, by the formula {expected}");
            }
        }
    }
    if let Some(sum) = sum
        && which < 4
    {
        assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-5, "weights sum to {sum}");
    }
    assert!(call(techniques, &mut 0.0) < 0 && call(0, null_mut()) < 0);
    Ok(())
}

fn accumulator(source: &mut Source<'_>) -> Result<()> {
    let (techniques, integrals) = (source.small(6)?, source.small(5)?);
    // SAFETY: as in `weights`; objects live in memory that outlives them.
    unsafe {
        let bytes = nf_omis_size(techniques, integrals);
        if bytes > MOST {
            return Ok(());
        }
        let (j, p) = if bytes == 0 { (0, 0) } else { (techniques as usize, integrals as usize) };
        let mut memory = [source.memory(bytes)?, source.memory(bytes)?];
        let mut objects = [null_mut(); 2];
        for (memory, object) in memory.iter_mut().zip(&mut objects) {
            let counts = source.array(j, |source| source.small(4))?;
            nf_omis_init(memory.pointer_mut().cast(), memory.bytes(), techniques, integrals, counts.pointer(), object);
        }
        let [first, second] = objects;
        for _ in 0..source.any::<u8>()? % 16 {
            let object = if source.any()? { first } else { second };
            let (solver, ridge) = (source.small(4)?, source.number()?);
            match source.any::<u8>()? % 8 {
                0..4 => {
                    let n = usize::from(source.any::<u8>()? % 4);
                    let pdf = source.array(n * j, |source| source.number().map(f32::abs))?;
                    let technique = source.array(n, |source| source.small(6))?;
                    let value = source.array(n * p, Source::number)?;
                    nf_omis_add(object, pdf.pointer(), technique.pointer(), value.pointer(), n);
                }
                4 | 5 => _ = nf_omis_next_batch(object, solver, ridge, source.unit()?),
                _ => _ = nf_omis_merge(first, second),
            }
            let (mut estimate, mut alpha) = (vec![f32::NAN; p], vec![f32::NAN; p * j]);
            let solved = nf_omis_solve(object, solver, ridge, estimate.as_mut_ptr(), null_mut());
            assert!(estimate.iter().all(|value| value.is_finite() == (solved == NF_OK)), "{solved}: {estimate:?}");
            let solved = nf_omis_solve(object, solver, ridge, null_mut(), alpha.as_mut_ptr());
            assert!(alpha.iter().all(|value| value.is_finite() == (solved == NF_OK)), "{solved}: {alpha:?}");
        }
    }
    Ok(())
}

fn gradients(source: &mut Source<'_>) -> Result<()> {
    let (techniques, parameters) = (source.small(5)?, source.small(6)?);
    // SAFETY: as in `accumulator`.
    unsafe {
        let bytes = nf_gradient_size(techniques, parameters);
        if bytes > MOST {
            return Ok(());
        }
        let mut memory = source.memory(bytes)?;
        let mut state = null_mut();
        nf_gradient_init(memory.pointer_mut().cast(), memory.bytes(), techniques, parameters, &mut state);
        let (j, p) = if bytes == 0 { (0, 0) } else { (techniques as usize, parameters as usize) };
        for _ in 0..source.any::<u8>()? % 4 {
            let batch = u32::from(source.any::<u8>()? % 8);
            let samples = batch as usize;
            let pdf = source.array(samples * j, |source| source.unit())?;
            let technique = source.array(samples, |source| source.small(techniques.min(15)))?;
            let gradient = source.array(samples * p, Source::number)?;
            let (solver, ridge, items) = (source.small(3)?, source.number()?, source.small(1000)?);
            let mut out = vec![f32::NAN; p];
            let (pdf, technique) = (pdf.pointer(), technique.pointer());
            let (beta, to) = (source.unit()?, out.as_mut_ptr());
            let gradient = gradient.pointer();
            let status = nf_gradient_estimate(state, solver, ridge, beta, items, pdf, technique, gradient, batch, to);
            assert!(out.iter().all(|value| value.is_finite() == (status == NF_OK)), "{status}: {out:?}");
            if j > 0 {
                let mut weight = vec![f32::NAN; samples];
                let to = weight.as_mut_ptr();
                let status = nf_omis_weights(solver, ridge, techniques, items, pdf, technique, batch, to);
                assert!(weight.iter().all(|value| value.is_finite() == (status == NF_OK)), "{status}: {weight:?}");
            }
            if source.rarely(4)? && !state.is_null() {
                nf_gradient_init(state.cast(), bytes, techniques, parameters, &mut state);
            }
        }
        let outputs = usize::from(source.any::<u8>()? % 24);
        let nodes = source.array(outputs, Source::number)?;
        let split = source.small(1)?;
        let mut importance = vec![-7.0; if techniques > 16 { 0 } else { techniques as usize }];
        let before = importance.clone();
        let (outputs, to) = (nodes.values.len() as u32, importance.as_mut_ptr());
        let status = nf_importance_gradient(nodes.pointer(), 1, outputs, split, techniques, to);
        assert!(status == NF_OK || before == importance);
        assert!(status != NF_OK || importance.iter().all(|&q| q >= 0.0 && q.is_finite()), "{importance:?}");
    }
    Ok(())
}

fn run(bytes: &[u8]) -> Result<()> {
    let mut source = Source(Unstructured::new(bytes));
    match source.any::<u8>()? % 3 {
        0 => weights(&mut source),
        1 => accumulator(&mut source),
        _ => gradients(&mut source),
    }
}

/// Valid arguments are not refused: a library that refused all would fail no input.
fn defaults_work() {
    let (pdf, counts, technique) = ([0.25, 0.75, 0.5, 0.5], [1, 1], [0, 1]);
    // SAFETY: arrays have the lengths that the header asks for.
    unsafe {
        let mut weight = [f32::NAN; 2];
        assert_eq!(nf_mis_weight(NF_MIS_BALANCE, 0.0, pdf.as_ptr(), counts.as_ptr(), 2, 1, weight.as_mut_ptr()), NF_OK);
        assert_eq!(weight[0], 0.75);
        let mut memory = vec![0_u64; nf_omis_size(2, 1).div_ceil(8)];
        let (to, bytes, mut omis) = (memory.as_mut_ptr().cast(), 8 * memory.len(), null_mut());
        assert_eq!(nf_omis_init(to, bytes, 2, 1, counts.as_ptr(), &mut omis), NF_OK);
        assert_eq!(nf_omis_add(omis, pdf.as_ptr(), &0, &1.0, 1), NF_OK);
        assert_eq!(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0, weight.as_mut_ptr(), null_mut()), NF_OK);
        let (p, j, to) = (pdf.as_ptr(), technique.as_ptr(), weight.as_mut_ptr());
        assert_eq!(nf_omis_weights(NF_OMIS_RIDGE, 0.0, 2, 2, p, j, 2, to), NF_OK);
        let mut memory = vec![0_u64; nf_gradient_size(2, 1).div_ceil(8)];
        let (place, bytes, mut state) = (memory.as_mut_ptr().cast(), 8 * memory.len(), null_mut());
        assert_eq!(nf_gradient_init(place, bytes, 2, 1, &mut state), NF_OK);
        let gradient = [1.0, 2.0];
        assert_eq!(nf_gradient_estimate(state, NF_OMIS_RIDGE, 0.0, 0.5, 2, p, j, gradient.as_ptr(), 2, to), NF_OK);
        assert!(weight.iter().all(|value| value.is_finite()), "{weight:?}");
    }
}

fuzz_target!(init: defaults_work(), |bytes: &[u8]| {
    // Bytes that ran out are no input.
    run(bytes).ok();
});
