//! How important an item is, from the output layer.

use crate::convert;
use crate::mis::NF_MIS_MAX_TECHNIQUES;
use crate::status::*;
use crate::wrong::{Wrong, pick, rule};
use noisefloor_core::minibatch::importance::{self, Softmax, Split};

/// nf_importance_gradient split: one importance per group of nodes, the norm over it.
pub const NF_NODES_NORM: u32 = 0;
/// nf_importance_gradient split: two per group, the norms of the positive and of the negative parts, which can combine
/// linearly to the derivative itself: the choice for optimal MIS.
pub const NF_NODES_SIGN: u32 = 1;

/// Of each of `rows` items: || softmax(logits) - onehot(label) ||, the norm of the cross-entropy loss's derivative by
/// the logits (6.10), 0 to 1.4143; the loss; and that derivative, where backpropagation starts. NULL: not wanted.
///
/// logits[rows * classes]: finite, of any size. label[rows]: below classes. importance[rows], loss[rows], gradient[rows
/// * classes]: outputs; a loss beyond the range of float becomes the largest finite float.
///
/// NF_ERR_RANGE: a label, or no classes; NF_ERR_NOT_FINITE: a logit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_importance_cross_entropy(
    logits: *const f32,
    label: *const u32,
    rows: u32,
    classes: u32,
    importance: *mut f32,
    loss: *mut f32,
    gradient: *mut f32,
) -> nf_status {
    status((|| {
        let (rows, classes) = (rows as usize, classes as usize);
        let len = convert::product(rows, classes)?;
        // SAFETY: the caller passes arrays of these lengths, of which those that are written are no part of another.
        let (logits, label, importance, loss, gradient) = unsafe {
            let (logits, label) = (convert::slice(logits, len)?, convert::slice(label, rows)?);
            let (importance, loss) =
                (convert::optional_outputs(importance, rows)?, convert::optional_outputs(loss, rows)?);
            (logits, label, importance, loss, convert::optional_outputs(gradient, len)?)
        };
        if rows == 0 {
            return Ok(());
        }
        ensure(classes > 0 && label.iter().all(|&label| (label as usize) < classes), NF_ERR_RANGE)?;
        finite(logits)?;
        // Widths that are not 0 for every compiler to see: else there would be a panic.
        let (mut importance, mut loss) = (importance.into_iter().flatten(), loss.into_iter().flatten());
        let mut gradient = gradient.into_iter().flat_map(|gradient| gradient.chunks_exact_mut(classes.max(1)));
        for (logits, &label) in logits.chunks_exact(classes.max(1)).zip(label) {
            let softmax = Softmax::new(logits, label as usize)?;
            if let Some(out) = importance.next() {
                *out = softmax.norm();
            }
            if let Some(out) = loss.next() {
                *out = softmax.loss();
            }
            if let Some(out) = gradient.next() {
                out.iter_mut().zip(softmax.gradient()).for_each(|(out, g)| *out = g);
            }
        }
        Ok(())
    })())
}

/// Of each of `rows` items || 2 (output - target) ||, the norm of the derivative of the loss sum (output - target)^2.
///
/// output[rows * outputs], target[rows * outputs]: finite. importance[rows]: outputs, at most the largest finite float.
///
/// NF_ERR_RANGE: no outputs; NF_ERR_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_importance_squared_error(
    output: *const f32,
    target: *const f32,
    rows: u32,
    outputs: u32,
    importance: *mut f32,
) -> nf_status {
    status((|| {
        let (rows, outputs) = (rows as usize, outputs as usize);
        let len = convert::product(rows, outputs)?;
        // SAFETY: the caller passes arrays of these lengths, of which the written one is no part of another.
        let (output, target, importance) = unsafe {
            (convert::slice(output, len)?, convert::slice(target, len)?, convert::outputs(importance, rows)?)
        };
        ensure(rows == 0 || outputs > 0, NF_ERR_RANGE)?;
        finite(output)?;
        finite(target)?;
        let pairs = output.chunks_exact(outputs.max(1)).zip(target.chunks_exact(outputs.max(1)));
        for (out, (output, target)) in importance.iter_mut().zip(pairs) {
            *out = importance::squared_error(output, target);
        }
        Ok(())
    })())
}

/// Of each of `rows` items one importance for each of `techniques` tables, from any derivative of the loss by the
/// output nodes: || dL/dm || of section 6.1.4 for one table, after section 6.2.3 for several.
///
/// gradient[rows * outputs]: dL/dm, finite. Node k belongs to group k % groups, groups being techniques with
/// NF_NODES_NORM and half as many with NF_NODES_SIGN: importance[g] is the norm over group g, or importance[2 g],
/// importance[2 g + 1] those of max(gradient, 0) and max(-gradient, 0), a split of our own. techniques:
/// 1..NF_MIS_MAX_TECHNIQUES. importance[rows * techniques]: outputs, a row for each item, at most the largest float.
///
/// NF_ERR_RANGE: split, techniques, or fewer outputs than groups; NF_ERR_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_importance_gradient(
    gradient: *const f32,
    rows: u32,
    outputs: u32,
    split: u32,
    techniques: u32,
    importance: *mut f32,
) -> nf_status {
    status((|| {
        let split = check_importance(&nf_importance_arguments { outputs, split, techniques })?;
        let (rows, outputs, techniques) = (rows as usize, outputs as usize, techniques as usize);
        let (len, all) = (convert::product(rows, outputs)?, convert::product(rows, techniques)?);
        // SAFETY: the caller passes arrays of these lengths, of which the written one is no part of the other.
        let (gradient, importance) = unsafe { (convert::slice(gradient, len)?, convert::outputs(importance, all)?) };
        finite(gradient)?;
        // Not zipped: chunks would be counted, and the division may panic.
        let mut rows = gradient.chunks_exact(outputs.max(1));
        for out in importance.chunks_exact_mut(techniques.max(1)) {
            importance::nodes(rows.next().unwrap_or_default(), split, out)?;
        }
        Ok(())
    })())
}

/// What nf_importance_gradient takes, for nf_check().
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types)]
pub struct nf_importance_arguments {
    /// At least one for each group.
    pub outputs: u32,
    /// NF_NODES_*
    pub split: u32,
    /// 1 to NF_MIS_MAX_TECHNIQUES, with NF_NODES_SIGN an even number.
    pub techniques: u32,
}

/// What is wrong with arguments, or the split.
pub(crate) fn check_importance(of: &nf_importance_arguments) -> Result<Split, Wrong> {
    let split = pick(of.split, &[Split::Norm, Split::Sign], c"split must be one of NF_NODES_*, 0 or 1")?;
    rule((1..=NF_MIS_MAX_TECHNIQUES).contains(&of.techniques), c"techniques must be 1 to 16")?;
    let each = if split == Split::Sign { 2 } else { 1 };
    rule(of.techniques.is_multiple_of(each), c"techniques must be even with NF_NODES_SIGN")?;
    let words = c"outputs must be at least techniques, with NF_NODES_SIGN half as many";
    rule(of.outputs >= of.techniques / each, words)?;
    Ok(split)
}

/// Before anything is written.
fn finite(values: &[f32]) -> Result<(), nf_status> {
    ensure(values.iter().all(|value| value.is_finite()), NF_ERR_NOT_FINITE)
}
