//! The C functions, called as a C program calls them, from the archive that ships.
//!
//! A renderer links `libnoisefloor.a`, so its figures are the ones that count. Where the archive had not been built,
//! nothing here can be called and [`STATE`] says "missing".

use std::ffi::c_void;

/// "up to date", "older than the sources" or "missing".
pub const STATE: &str = env!("ARCHIVE_STATE");

/// Whether the archive is linked.
pub const LINKED: bool = cfg!(archive);

/// `nf_cv_config`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
#[allow(missing_docs, reason = "include/noisefloor.h documents the fields")]
pub struct Config {
    pub dims: u32,
    pub order: u32,
    pub channels: u32,
    pub estimator: u32,
    pub basis: u32,
    pub stratified: u32,
    pub slices: u32,
    pub edges: u32,
    pub controls: u32,
    pub stride: u32,
    pub solver: u32,
    pub precision: u32,
    pub nonfinite: u32,
    pub color: u32,
    pub folds: u32,
    pub ridge: f32,
}

/// `nf_cv_samples`.
#[repr(C)]
struct Samples {
    u: *const f32,
    f: *const f32,
    n: usize,
    /// Controls, their integrals, and what is known: nothing.
    others: [*const f32; 4],
}

impl Samples {
    fn new(u: *const f32, f: *const f32, n: usize) -> Self {
        Self { u, f, n, others: [std::ptr::null(); 4] }
    }
}

/// `nf_cv_image`.
#[repr(C)]
#[derive(Clone, Copy)]
struct Image {
    width: u32,
    height: u32,
    frames: u32,
    window: u32,
    stride: u32,
    unordered: u32,
    samples: usize,
    surfaces: *const u32,
    factors: *const f32,
    /// Column, row, width and height of what is given, then of what is wanted.
    parts: [[u32; 4]; 2],
}

/// `nf_estimate`.
#[repr(C)]
#[derive(Clone, Copy, Default)]
struct Estimate {
    mean: [f32; 4],
    std_error: [f32; 4],
    samples: u32,
    gain: f32,
}

c_functions! {
    fn nf_cv_workspace_size(config: *const Config, n: usize) -> usize;
    fn nf_cv_estimate(
        config: *const Config,
        samples: *const Samples,
        integrals: usize,
        workspace: *mut c_void,
        bytes: usize,
        out: *mut Estimate,
    ) -> i32;
    fn nf_cv_image_workspace_size(config: *const Config, image: *const Image, samples: *const Samples) -> usize;
    fn nf_cv_image_estimate(
        config: *const Config,
        image: *const Image,
        samples: *const Samples,
        workspace: *mut c_void,
        bytes: usize,
        out: *mut Estimate,
    ) -> i32;
    fn nf_cv_accumulator_size(config: *const Config, workspace: *mut usize) -> usize;
    fn nf_cv_accumulator_init(
        memory: *mut c_void,
        bytes: usize,
        config: *const Config,
        out: *mut *mut c_void,
    ) -> i32;
    fn nf_cv_accumulator_add(accumulator: *mut c_void, samples: *const Samples) -> i32;
    fn nf_cv_accumulator_merge(accumulator: *mut c_void, other: *const c_void) -> i32;
    fn nf_cv_accumulator_estimate(
        accumulator: *const c_void,
        workspace: *mut c_void,
        bytes: usize,
        out: *mut Estimate,
    ) -> i32;
}

/// 8-byte aligned memory of at least `bytes` bytes.
fn memory(bytes: usize) -> Vec<u64> {
    assert_ne!(bytes, 0, "the configuration is not supported");
    vec![0; bytes.div_ceil(8)]
}

fn check(status: i32) {
    assert_eq!(status, 0, "the C function failed");
}

/// `nf_cv_estimate` for a fixed number of samples.
pub struct Batch {
    config: Config,
    n: usize,
    workspace: Vec<u64>,
}

impl Batch {
    /// Allocates the workspace, as a renderer does once per thread.
    pub fn new(config: Config, n: usize) -> Self {
        // SAFETY: a valid configuration is all that is read.
        let bytes = unsafe { nf_cv_workspace_size(&config, n) };
        Self { config, n, workspace: memory(bytes) }
    }

    /// One estimate.
    pub fn estimate(&mut self, u: &[f32], f: &[f32]) -> f32 {
        assert!(u.len() >= self.n * self.config.dims as usize && f.len() >= self.n);
        let mut out = Estimate::default();
        let bytes = self.workspace.len() * 8;
        // SAFETY: the arrays are as long as was just checked, the workspace as long as said.
        check(unsafe {
            let samples = Samples::new(u.as_ptr(), f.as_ptr(), self.n);
            nf_cv_estimate(&self.config, &samples, 1, self.workspace.as_mut_ptr().cast(), bytes, &mut out)
        });
        out.mean[0]
    }
}

/// `nf_cv_image_estimate` of square images, or of blocks of pixels in no order.
pub struct Shared {
    config: Config,
    image: Image,
    n: usize,
    workspace: Vec<u64>,
    out: Vec<Estimate>,
}

impl Shared {
    /// `side` x `side` pixels of `n` samples. With `stride` 0 blocks of 64 pixels in no order, else windows.
    pub fn new(config: Config, side: usize, n: usize, stride: usize) -> Self {
        let (pixels, block) = (side * side, 64);
        assert_eq!(pixels % block, 0);
        let (width, height) = if stride == 0 { (block, 1) } else { (side, side) };
        let image = Image {
            width: width as u32,
            height: height as u32,
            frames: 1,
            window: 8,
            stride: stride as u32,
            unordered: u32::from(stride == 0),
            samples: 0,
            surfaces: std::ptr::null(),
            factors: std::ptr::null(),
            parts: [[0; 4]; 2],
        };
        let samples = Samples::new(std::ptr::null(), std::ptr::null(), n);
        // SAFETY: a valid configuration and image, and the number of samples, are all that is read.
        let bytes = unsafe { nf_cv_image_workspace_size(&config, &image, &samples) };
        Self { config, image, n, workspace: memory(bytes), out: vec![Estimate::default(); pixels] }
    }

    /// All pixels' estimates; returns the first. `u` and `f` hold the samples of pixel after pixel, or block after
    /// block.
    pub fn estimate(&mut self, u: &[f32], f: &[f32]) -> f32 {
        let (dims, channels) = (self.config.dims as usize, self.config.channels as usize);
        let (workspace, bytes) = (self.workspace.as_mut_ptr().cast(), self.workspace.len() * 8);
        let pixels = (self.image.width * self.image.height) as usize;
        let rows = pixels * self.n;
        assert!(u.len() >= self.out.len() * self.n * dims && f.len() >= self.out.len() * self.n * channels);
        for ((u, f), out) in u.chunks(rows * dims).zip(f.chunks(rows * channels)).zip(self.out.chunks_mut(pixels)) {
            let (samples, out) = (Samples::new(u.as_ptr(), f.as_ptr(), self.n), out.as_mut_ptr());
            // SAFETY: the arrays are as long as was just checked, the workspace as long as said.
            check(unsafe { nf_cv_image_estimate(&self.config, &self.image, &samples, workspace, bytes, out) });
        }
        self.out[0].mean[0]
    }
}

/// `nf_cv_accumulator` in memory of its own.
pub struct Accumulator {
    config: Config,
    memory: Vec<u64>,
    workspace: Vec<u64>,
}

impl Accumulator {
    /// An empty accumulator.
    pub fn new(config: Config) -> Self {
        let mut work = 0;
        // SAFETY: a valid configuration is all that is read, a size all that is written.
        let size = unsafe { nf_cv_accumulator_size(&config, &mut work) };
        let mut this = Self { config, memory: memory(size), workspace: memory(work) };
        this.reset();
        this
    }

    /// Adds one sample for each value.
    pub fn add(&mut self, u: &[f32], f: &[f32]) {
        assert!(u.len() >= f.len() * self.config.dims as usize);
        let samples = Samples::new(u.as_ptr(), f.as_ptr(), f.len());
        // SAFETY: the arrays are as long as was just checked; `new` made the object.
        check(unsafe { nf_cv_accumulator_add(self.memory.as_mut_ptr().cast(), &samples) });
    }

    /// Adds another accumulator's samples.
    pub fn merge(&mut self, other: &Self) {
        // SAFETY: `new` made both objects.
        check(unsafe { nf_cv_accumulator_merge(self.memory.as_mut_ptr().cast(), other.memory.as_ptr().cast()) });
    }

    /// The estimate so far.
    pub fn estimate(&mut self) -> f32 {
        let mut out = Estimate::default();
        let bytes = self.workspace.len() * 8;
        // SAFETY: the workspace is as long as said; `new` made the object.
        check(unsafe {
            nf_cv_accumulator_estimate(self.memory.as_ptr().cast(), self.workspace.as_mut_ptr().cast(), bytes, &mut out)
        });
        out.mean[0]
    }

    /// Forgets all samples.
    pub fn reset(&mut self) {
        let mut out = std::ptr::null_mut();
        let bytes = self.memory.len() * 8;
        // SAFETY: the memory is as long as said.
        check(unsafe { nf_cv_accumulator_init(self.memory.as_mut_ptr().cast(), bytes, &self.config, &mut out) });
        assert_eq!(out.cast_const().cast(), self.memory.as_ptr(), "the object starts its memory");
    }
}
