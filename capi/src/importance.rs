//! How important an item is, from the output layer.

use crate::convert;
use crate::status::*;
use noisefloor_core::minibatch::importance::{self, Split};

/// nf_importance_nodes split: one importance per group of nodes, the norm over it.
pub const NF_NODES_NORM: u32 = 0;
/// nf_importance_nodes split: two per group, the norm of the positive parts and that of the negative parts. Importances
/// of one sign can combine linearly to the derivative itself, which norms cannot: the choice for optimal MIS.
pub const NF_NODES_SIGN: u32 = 1;

/// || softmax(logits) - onehot(label) ||, the norm of the cross-entropy loss's derivative by the logits (6.10):
/// 0..1.4143.
///
/// logits[classes]: finite, of any size. label: below classes. No backward pass is needed; a norm near 0 keeps its
/// relative accuracy.
///
/// NaN, which nf_table_update refuses, for NULL, misaligned, a label out of range, or a logit that is NaN or infinite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_importance_cross_entropy(logits: *const f32, classes: u32, label: u32) -> f32 {
    // SAFETY: the caller passes an array of the length it says.
    unsafe { convert::slice(logits, classes as usize) }
        .map_or(f32::NAN, |logits| importance::cross_entropy(logits, label as usize))
}

/// The cross-entropy loss -ln softmax(logits)[label] itself, at least 0; one beyond the range of float becomes the
/// largest finite float.
///
/// Arguments, and NaN, as for nf_importance_cross_entropy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_importance_cross_entropy_loss(logits: *const f32, classes: u32, label: u32) -> f32 {
    // SAFETY: the caller passes an array of the length it says.
    unsafe { convert::slice(logits, classes as usize) }
        .map_or(f32::NAN, |logits| importance::cross_entropy_loss(logits, label as usize))
}

/// || 2 (output - target) ||, the norm of the derivative of the loss sum (output - target)^2 by the outputs.
///
/// output[outputs], target[outputs]: finite. One beyond the range of float becomes the largest finite float.
///
/// NaN for NULL, misaligned, no outputs, or a value that is NaN or infinite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_importance_squared_error(output: *const f32, target: *const f32, outputs: u32) -> f32 {
    // SAFETY: the caller passes arrays of the length it says.
    match unsafe { (convert::slice(output, outputs as usize), convert::slice(target, outputs as usize)) } {
        (Ok(output), Ok(target)) => importance::squared_error(output, target),
        _ => f32::NAN,
    }
}

/// The L2 norm of any derivative of the loss by the outputs: || dL/dm || of (6.1.4).
///
/// gradient[outputs]: finite. A norm beyond the range of float becomes the largest finite float.
///
/// NaN for NULL, misaligned, no outputs, or a value that is NaN or infinite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_importance_gradient(gradient: *const f32, outputs: u32) -> f32 {
    // SAFETY: the caller passes an array of the length it says.
    unsafe { convert::slice(gradient, outputs as usize) }.map_or(f32::NAN, importance::gradient)
}

/// The derivative of the cross-entropy loss by the logits, softmax(logits) - onehot(label) (6.10), where
/// backpropagation starts.
///
/// logits[classes]: finite, of any size. label: below classes. gradient[classes]: the output.
///
/// NF_ERR_NULL; NF_ERR_RANGE: label; NF_ERR_NOT_FINITE: a logit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cross_entropy_gradient(
    logits: *const f32,
    classes: u32,
    label: u32,
    gradient: *mut f32,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes arrays of the length it says, one of them to be written and no part of the other.
        let (logits, gradient) =
            unsafe { (convert::slice(logits, classes as usize)?, convert::outputs(gradient, classes as usize)?) };
        importance::cross_entropy_gradient(logits, label as usize, gradient).map_err(status_of)
    })())
}

/// Importances of one item for several tables, from the derivative of the loss by each output node (6.2.3).
///
/// gradient[outputs]: dL/dm, finite; at least one node per group. Node k belongs to group k % groups, so that every
/// node has its table: a subset of the nodes, as section 6.2.3 proposes, leaves the gradients of the others uncovered.
/// split: NF_NODES_NORM: groups = techniques, importance[g] = the norm over group g. NF_NODES_SIGN: techniques is even,
/// groups = techniques / 2, importance[2 g] = the norm of max(gradient, 0) over group g, importance[2 g + 1] that of
/// max(-gradient, 0).
/// techniques: 1..NF_MIS_MAX_TECHNIQUES. importance[techniques]: the output, at least 0. An importance may be 0: the
/// tables' uniform fraction is what still draws the item.
///
/// NF_ERR_NULL; NF_ERR_RANGE: split, techniques, or fewer outputs than groups; NF_ERR_NOT_FINITE: a gradient.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_importance_nodes(
    gradient: *const f32,
    outputs: u32,
    split: u32,
    techniques: u32,
    importance: *mut f32,
) -> nf_status {
    status((|| {
        let split = match split {
            NF_NODES_NORM => Split::Norm,
            NF_NODES_SIGN => Split::Sign,
            _ => return Err(NF_ERR_RANGE),
        };
        if techniques > crate::NF_MIS_MAX_TECHNIQUES {
            return Err(NF_ERR_RANGE);
        }
        // SAFETY: the caller passes arrays of the lengths it says, one of them to be written and no part of the other.
        let (gradient, importance) = unsafe {
            (convert::slice(gradient, outputs as usize)?, convert::outputs(importance, techniques as usize)?)
        };
        importance::nodes(gradient, split, importance).map_err(status_of)
    })())
}
