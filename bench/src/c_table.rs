//! `nf_table`, called as a C program calls it, from the archive that ships.

use noisefloor::rng::Rng;
use std::ffi::c_void;

/// `nf_table`.
#[repr(C)]
#[derive(Clone, Copy)]
struct Raw {
    importance: *mut f32,
    sums: *mut i64,
    scale: f64,
    items: u32,
    blocks: u32,
    uniform_fraction: f32,
    magic: u32,
}

/// `nf_rng`.
#[repr(C)]
struct RawRng {
    state: u64,
    increment: u64,
}

c_functions! {
    fn nf_table_size(items: u32) -> usize;
    fn nf_table_init(table: *mut Raw, memory: *mut c_void, bytes: usize, items: u32, importance: *const f32)
    -> i32;
    fn nf_table_draw(table: *const Raw, rng: *mut RawRng, batch: u32, index: *mut u32, weight: *mut f32) -> i32;
    fn nf_table_update(
        table: *mut Raw,
        index: *const u32,
        importance: *const f32,
        batch: u32,
        momentum: f32,
    ) -> i32;
    fn nf_table_add_epsilon(table: *mut Raw, epsilon: f32) -> i32;
}

/// A table, and the memory that its struct points into.
pub struct Table {
    raw: Raw,
    memory: Vec<u64>,
}

impl Table {
    /// A table of these importances.
    pub fn new(importance: &[f32]) -> Self {
        let items = importance.len() as u32;
        // SAFETY: no pointer is passed.
        let bytes = unsafe { nf_table_size(items) };
        let mut memory = vec![0u64; bytes.div_ceil(8)];
        let mut raw = std::mem::MaybeUninit::uninit();
        // SAFETY: memory and importances are of the lengths passed; on success the struct is written.
        let raw = unsafe {
            let start = memory.as_mut_ptr().cast();
            assert_eq!(nf_table_init(raw.as_mut_ptr(), start, bytes, items, importance.as_ptr()), 0);
            raw.assume_init()
        };
        Table { raw, memory }
    }

    /// The bytes of its memory.
    pub fn bytes(&self) -> usize {
        8 * self.memory.len()
    }

    /// Draws a batch with its weights.
    #[inline]
    pub fn draw(&self, rng: &mut Rng, index: &mut [u32], weight: &mut [f32]) {
        let mut raw = RawRng { state: rng.state, increment: rng.increment };
        // SAFETY: the table is alive, and both outputs have the length passed.
        let status =
            unsafe { nf_table_draw(&self.raw, &mut raw, index.len() as u32, index.as_mut_ptr(), weight.as_mut_ptr()) };
        assert_eq!(status, 0);
        (rng.state, rng.increment) = (raw.state, raw.increment);
    }

    /// Updates items.
    #[inline]
    pub fn update(&mut self, index: &[u32], importance: &[f32], momentum: f32) {
        // SAFETY: the table is alive, and both inputs have the length passed.
        let status = unsafe {
            nf_table_update(&mut self.raw, index.as_ptr(), importance.as_ptr(), index.len() as u32, momentum)
        };
        assert_eq!(status, 0);
    }

    /// Adds to every importance.
    pub fn add_epsilon(&mut self, epsilon: f32) {
        // SAFETY: the table is alive.
        assert_eq!(unsafe { nf_table_add_epsilon(&mut self.raw, epsilon) }, 0);
    }
}
