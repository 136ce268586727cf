//! `nf_gradient`, called as a C program calls it, from the archive that ships.

use std::ffi::c_void;

/// A minibatch with its items' gradients.
pub struct Inputs {
    /// J.
    pub techniques: usize,
    /// P.
    pub parameters: usize,
    /// Probabilities, `[batch][J]`.
    pub pdf: Vec<f32>,
    /// The technique of each sample.
    pub technique: Vec<u32>,
    /// `[batch][P]`.
    pub gradient: Vec<f32>,
}

c_functions! {
    fn nf_gradient_size(techniques: u32, parameters: u32) -> usize;
    fn nf_gradient_init(
        memory: *mut c_void,
        bytes: usize,
        techniques: u32,
        parameters: u32,
        out: *mut *mut c_void,
    ) -> i32;
    fn nf_gradient_estimate(
        state: *mut c_void,
        solver: u32,
        ridge: f32,
        beta: f32,
        items: u32,
        pdf: *const f32,
        technique: *const u32,
        gradient: *const f32,
        batch: u32,
        estimate: *mut f32,
    ) -> i32;
}

/// `nf_gradient` with its memory.
pub struct Gradient {
    memory: Vec<u64>,
    estimate: Vec<f32>,
}

impl Gradient {
    /// One that has seen no batch.
    pub fn new(techniques: usize, parameters: usize) -> Self {
        // SAFETY: the memory has the size asked for.
        unsafe {
            let bytes = nf_gradient_size(techniques as u32, parameters as u32);
            let mut memory = vec![0_u64; bytes.div_ceil(8)];
            let mut out = std::ptr::null_mut();
            let place = memory.as_mut_ptr().cast();
            assert_eq!(nf_gradient_init(place, bytes, techniques as u32, parameters as u32, &mut out), 0);
            Gradient { memory, estimate: vec![0.0; parameters] }
        }
    }

    /// `nf_gradient_estimate` with the default solver.
    pub fn estimate(&mut self, inputs: &Inputs, items: u32, beta: f32) -> &[f32] {
        assert_eq!(inputs.gradient.len(), inputs.technique.len() * self.estimate.len());
        assert_eq!(inputs.pdf.len(), inputs.technique.len() * inputs.techniques);
        // SAFETY: the lengths are those of the object, as just checked.
        let status = unsafe {
            nf_gradient_estimate(
                self.memory.as_mut_ptr().cast(),
                0,
                0.0,
                beta,
                items,
                inputs.pdf.as_ptr(),
                inputs.technique.as_ptr(),
                inputs.gradient.as_ptr(),
                inputs.technique.len() as u32,
                self.estimate.as_mut_ptr(),
            )
        };
        assert_eq!(status, 0);
        &self.estimate
    }
}
