//! The C functions, called as a C program calls them, from the archive that ships.
//!
//! A renderer links `libnoisefloor.a`, so its figures are the ones that count. Where the archive had not been built,
//! nothing here can be called and [`STATE`] says "missing".

use noisefloor::basis::Family;
use noisefloor::control_variate::Estimator;
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
    pub controls: u32,
    pub stride: u32,
    pub solver: u32,
    pub precision: u32,
    pub nonfinite: u32,
    pub color: u32,
    pub folds: u32,
    pub iterations: u32,
    pub optimizer: u32,
    pub ridge: f32,
    pub learning_rate: f32,
    pub momentum: f32,
}

/// The `NF_CV_*` value of an estimator.
pub fn estimator(estimator: Estimator) -> u32 {
    match estimator {
        Estimator::Robust => 0,
        Estimator::LeastSquares => 1,
        Estimator::LeaveOneOut => 2,
        Estimator::KFold => 3,
        Estimator::GradientDescent => 4,
        Estimator::Incremental => 5,
    }
}

/// The `NF_BASIS_*` value of a basis.
pub fn basis(family: Family) -> u32 {
    match family {
        Family::Legendre => 0,
        Family::Step => 1,
        Family::Sine => 2,
        Family::Gaussian => 3,
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
    surfaces: *const u32,
    factors: *const f32,
    known: *const f32,
    known_integrals: *const f32,
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
        u: *const f32,
        f: *const f32,
        n: usize,
        workspace: *mut c_void,
        bytes: usize,
        out: *mut Estimate,
    ) -> i32;
    fn nf_cv_image_workspace_size(config: *const Config, image: *const Image, n: usize) -> usize;
    fn nf_cv_image_estimate(
        config: *const Config,
        image: *const Image,
        u: *const f32,
        f: *const f32,
        n: usize,
        workspace: *mut c_void,
        bytes: usize,
        out: *mut Estimate,
    ) -> i32;
    fn nf_cv_accumulator_size(config: *const Config) -> usize;
    fn nf_cv_accumulator_init(
        memory: *mut c_void,
        bytes: usize,
        config: *const Config,
        out: *mut *mut c_void,
    ) -> i32;
    fn nf_cv_accumulator_add(accumulator: *mut c_void, u: *const f32, f: *const f32, n: usize) -> i32;
    fn nf_cv_accumulator_merge(accumulator: *mut c_void, other: *const c_void) -> i32;
    fn nf_cv_accumulator_workspace_size(config: *const Config) -> usize;
    fn nf_cv_accumulator_estimate(
        accumulator: *const c_void,
        workspace: *mut c_void,
        bytes: usize,
        out: *mut Estimate,
    ) -> i32;
    fn nf_cv_accumulator_reset(accumulator: *mut c_void) -> i32;
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
            nf_cv_estimate(
                &self.config,
                u.as_ptr(),
                f.as_ptr(),
                self.n,
                self.workspace.as_mut_ptr().cast(),
                bytes,
                &mut out,
            )
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
            surfaces: std::ptr::null(),
            factors: std::ptr::null(),
            known: std::ptr::null(),
            known_integrals: std::ptr::null(),
            parts: [[0; 4]; 2],
        };
        // SAFETY: a valid configuration and image are all that is read.
        let bytes = unsafe { nf_cv_image_workspace_size(&config, &image, n) };
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
            let (u, f, out) = (u.as_ptr(), f.as_ptr(), out.as_mut_ptr());
            // SAFETY: the arrays are as long as was just checked, the workspace as long as said.
            check(unsafe { nf_cv_image_estimate(&self.config, &self.image, u, f, self.n, workspace, bytes, out) });
        }
        self.out[0].mean[0]
    }
}

/// `nf_cv_accumulator` in memory of its own.
pub struct Accumulator {
    dims: usize,
    memory: Vec<u64>,
    workspace: Vec<u64>,
}

impl Accumulator {
    /// An empty accumulator.
    pub fn new(config: Config) -> Self {
        // SAFETY: a valid configuration is all that is read.
        let (size, work) = unsafe { (nf_cv_accumulator_size(&config), nf_cv_accumulator_workspace_size(&config)) };
        let mut this = Self { dims: config.dims as usize, memory: memory(size), workspace: memory(work) };
        let mut out = std::ptr::null_mut();
        let bytes = this.memory.len() * 8;
        // SAFETY: the memory is as long as said.
        check(unsafe { nf_cv_accumulator_init(this.memory.as_mut_ptr().cast(), bytes, &config, &mut out) });
        assert_eq!(out.cast_const().cast(), this.memory.as_ptr(), "the object starts its memory");
        this
    }

    /// Adds one sample for each value.
    pub fn add(&mut self, u: &[f32], f: &[f32]) {
        assert!(u.len() >= f.len() * self.dims);
        // SAFETY: the arrays are as long as was just checked; `new` made the object.
        check(unsafe { nf_cv_accumulator_add(self.memory.as_mut_ptr().cast(), u.as_ptr(), f.as_ptr(), f.len()) });
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
        // SAFETY: `new` made the object.
        check(unsafe { nf_cv_accumulator_reset(self.memory.as_mut_ptr().cast()) });
    }
}
