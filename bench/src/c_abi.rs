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
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs, reason = "include/noisefloor.h documents the fields")]
pub struct Image {
    pub width: u32,
    pub height: u32,
    pub frames: u32,
    pub window: u32,
    pub stride: u32,
    pub unordered: u32,
    pub surfaces: *const u32,
    pub factors: *const f32,
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
    fn nf_cv_block_workspace_size(config: *const Config, pixels: usize, n: usize) -> usize;
    fn nf_cv_block_estimate(
        config: *const Config,
        u: *const f32,
        f: *const f32,
        pixels: usize,
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

/// Estimates of the pixels of a square image that share fits: `nf_cv_image_estimate`, or `nf_cv_block_estimate` for
/// square blocks.
pub struct Shared {
    config: Config,
    image: Option<Image>,
    block: usize,
    n: usize,
    workspace: Vec<u64>,
    out: Vec<Estimate>,
}

impl Shared {
    /// `side` x `side` pixels of `n` samples. With `stride` 0 blocks of 8 x 8 pixels in no order, else windows.
    pub fn new(config: Config, side: usize, n: usize, stride: usize) -> Self {
        let (block, pixels) = (64, side * side);
        assert_eq!(pixels % block, 0);
        let [width, stride] = [side, stride].map(|value| value as u32);
        let image = (stride > 0).then_some(Image {
            width,
            height: width,
            frames: 1,
            window: 8,
            stride,
            unordered: 0,
            surfaces: std::ptr::null(),
            factors: std::ptr::null(),
        });
        // SAFETY: a valid configuration and image are all that is read.
        let bytes = unsafe {
            match &image {
                Some(image) => nf_cv_image_workspace_size(&config, image, n),
                None => nf_cv_block_workspace_size(&config, block, n),
            }
        };
        Self { config, image, block, n, workspace: memory(bytes), out: vec![Estimate::default(); pixels] }
    }

    /// All pixels' estimates; returns the first. `u` and `f` hold the samples of pixel after pixel, or block after
    /// block.
    pub fn estimate(&mut self, u: &[f32], f: &[f32]) -> f32 {
        let (dims, channels) = (self.config.dims as usize, self.config.channels as usize);
        let samples = self.out.len() * self.n;
        assert!(u.len() >= samples * dims && f.len() >= samples * channels);
        let (workspace, bytes) = (self.workspace.as_mut_ptr().cast(), self.workspace.len() * 8);
        if let Some(image) = &self.image {
            let (u, f, out) = (u.as_ptr(), f.as_ptr(), self.out.as_mut_ptr());
            // SAFETY: the arrays are as long as was just checked, the workspace as long as said.
            check(unsafe { nf_cv_image_estimate(&self.config, image, u, f, self.n, workspace, bytes, out) });
        } else {
            let rows = self.block * self.n;
            let blocks = u.chunks(rows * dims).zip(f.chunks(rows * channels)).zip(self.out.chunks_mut(self.block));
            for ((u, f), out) in blocks {
                let (u, f, out) = (u.as_ptr(), f.as_ptr(), out.as_mut_ptr());
                // SAFETY: as above, of whole blocks.
                check(unsafe { nf_cv_block_estimate(&self.config, u, f, self.block, self.n, workspace, bytes, out) });
            }
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
