//! The C functions of MIS and of the generator: their checks, and that they are the core's. The door's own sources are
//! compiled into this test, as the library itself is linked by C programs only.
#![allow(clippy::missing_safety_doc, clippy::undocumented_unsafe_blocks, dead_code)]

extern crate noisefloor as noisefloor_core;

#[path = "../../capi/src/convert.rs"]
mod convert;
#[path = "../../capi/src/magic.rs"]
mod magic;
#[path = "../../capi/src/mis.rs"]
mod mis;
#[path = "../../capi/src/omis.rs"]
mod omis;
#[path = "../../capi/src/rng.rs"]
mod rng;
#[path = "../../capi/src/status.rs"]
mod status;
#[path = "../../capi/src/wrong.rs"]
mod wrong;

use mis::*;
use noisefloor::mis::{self as core_mis, OptimalMis, Solver};
use omis::*;
use rng::*;
use std::ptr::{null, null_mut};

const PDF: [f32; 3] = [0.5, 2.0, 1.0];
const COUNTS: [u32; 3] = [2, 1, 4];
const ALPHA: [f32; 3] = [0.3, -0.2, 1.0];
use status::*;

/// The status, and the output if it was written.
type Answer = (nf_status, Option<f32>);

fn call(f: impl FnOnce(*mut f32) -> nf_status) -> Answer {
    let mut out = f32::NAN;
    let status = f(&mut out);
    (status, (!out.is_nan()).then_some(out))
}

/// The heuristics and the optimal weights' terms, with every argument but those for the densities, counts,
/// number and technique fixed.
type Weight = fn(*const f32, *const u32, u32, u32, *mut f32) -> nf_status;

const WEIGHTS: [Weight; 5] = [
    |p, n, t, j, out| unsafe { nf_mis_weight(NF_MIS_BALANCE, 0.0, p, n, t, j, out) },
    |p, n, t, j, out| unsafe { nf_mis_weight(NF_MIS_POWER, 2.0, p, n, t, j, out) },
    |p, n, t, j, out| unsafe { nf_mis_weight(NF_MIS_CUTOFF, 0.1, p, n, t, j, out) },
    |p, n, t, j, out| unsafe { nf_mis_weight(NF_MIS_MAXIMUM, 0.0, p, n, t, j, out) },
    |p, n, t, j, out| unsafe { nf_mis_optimal_contribution(p, n, t, j, ALPHA.as_ptr(), 2.0, out) },
];

#[test]
fn weights_are_those_of_the_core() {
    for j in 0..3 {
        let expected = [
            core_mis::balance(&PDF, &COUNTS, j),
            core_mis::power(&PDF, &COUNTS, j, 2.0),
            core_mis::cutoff(&PDF, &COUNTS, j, 0.1),
            core_mis::maximum(&PDF, &COUNTS, j),
            core_mis::optimal_contribution(&PDF, &COUNTS, j, &ALPHA, 2.0),
        ];
        for (weight, expected) in WEIGHTS.iter().zip(expected) {
            let answer = call(|out| weight(PDF.as_ptr(), COUNTS.as_ptr(), 3, j as u32, out));
            assert_eq!(answer, (NF_OK, Some(expected.unwrap())));
        }
    }
    // A beta of 0 is the default.
    let power =
        |beta| call(|out| unsafe { nf_mis_weight(NF_MIS_POWER, beta, PDF.as_ptr(), COUNTS.as_ptr(), 3, 1, out) });
    assert_eq!(power(0.0), power(2.0));
    assert_ne!(power(0.0), power(1.0));
}

#[test]
fn errors_of_weights() {
    let (pdf, counts) = (PDF.as_ptr(), COUNTS.as_ptr());
    for weight in WEIGHTS {
        assert_eq!(call(|out| weight(null(), counts, 3, 0, out)), (NF_ERR_NULL, None));
        assert_eq!(call(|out| weight(pdf, null(), 3, 0, out)), (NF_ERR_NULL, None));
        assert_eq!(weight(pdf, counts, 3, 0, null_mut()), NF_ERR_NULL);
        assert_eq!(
            call(|out| weight(pdf.cast::<u8>().wrapping_add(1).cast(), counts, 2, 0, out)),
            (NF_ERR_ALIGNMENT, None)
        );
        // A wild number is refused before the arrays are looked at.
        for techniques in [0, 17, u32::MAX] {
            assert_eq!(call(|out| weight(pdf, counts, techniques, 0, out)), (NF_ERR_RANGE, None));
        }
        assert_eq!(call(|out| weight(pdf, counts, 3, 3, out)), (NF_ERR_RANGE, None));
        assert_eq!(call(|out| weight([1.0, -1.0].as_ptr(), counts, 2, 0, out)), (NF_ERR_RANGE, None));
        assert_eq!(call(|out| weight([1.0, f32::NAN].as_ptr(), counts, 2, 0, out)), (NF_ERR_NOT_FINITE, None));
    }
    let power = |beta| call(|out| unsafe { nf_mis_weight(NF_MIS_POWER, beta, pdf, counts, 3, 0, out) });
    assert_eq!(call(|out| unsafe { nf_mis_weight(4, 0.0, pdf, counts, 3, 0, out) }), (NF_ERR_RANGE, None));
    assert_eq!(power(-1.0), (NF_ERR_RANGE, None));
    assert_eq!(power(f32::NAN), (NF_ERR_NOT_FINITE, None));
    let cutoff = |epsilon| call(|out| unsafe { nf_mis_weight(NF_MIS_CUTOFF, epsilon, pdf, counts, 3, 0, out) });
    assert_eq!(cutoff(2.0), (NF_ERR_RANGE, None));
    assert_eq!(cutoff(f32::INFINITY), (NF_ERR_NOT_FINITE, None));
    let optimal =
        |alpha, value| call(|out| unsafe { nf_mis_optimal_contribution(pdf, counts, 3, 0, alpha, value, out) });
    assert_eq!(optimal(null(), 1.0), (NF_ERR_NULL, None));
    assert_eq!(optimal(ALPHA.as_ptr(), f32::NAN), (NF_ERR_NOT_FINITE, None));
}

/// Caller memory for three techniques and two integrals.
struct Memory(Vec<u64>);

impl Memory {
    fn new() -> Memory {
        Memory(vec![u64::MAX; nf_omis_size(3, 2) / 8])
    }

    fn init(&mut self) -> *mut nf_omis {
        let mut omis = null_mut();
        let status =
            unsafe { nf_omis_init(self.0.as_mut_ptr().cast(), self.0.len() * 8, 3, 2, COUNTS.as_ptr(), &mut omis) };
        assert_eq!(status, NF_OK);
        assert_eq!(omis.cast(), self.0.as_mut_ptr());
        omis
    }
}

fn sample(i: u32) -> ([f32; 3], [f32; 2]) {
    let x = (i as f32 * 0.618).fract();
    ([1.0, 0.5 + x, 1.5 - x], [x * x, 1.0 - x])
}

#[test]
fn the_accumulator_is_the_core_s() {
    let (mut memory, mut other_memory) = (Memory::new(), Memory::new());
    let (omis, other) = (memory.init(), other_memory.init());
    let make = || OptimalMis::new(vec![0.0; core_mis::len(3, 2)], &COUNTS, 2).unwrap();
    let (mut expected, mut expected_other) = (make(), make());
    for i in 0..30 {
        let (pdf, value) = sample(i);
        let to = if i % 5 == 0 { other } else { omis };
        assert_eq!(unsafe { nf_omis_add(to, i % 3, pdf.as_ptr(), value.as_ptr()) }, NF_OK);
        let to = if i % 5 == 0 { &mut expected_other } else { &mut expected };
        to.add(i as usize % 3, &pdf, &value).unwrap();
        if i == 14 {
            assert_eq!(unsafe { nf_omis_next_batch(omis, NF_OMIS_PLAIN, 0.0, 0.5) }, NF_OK);
            expected.next_batch(Solver::Plain).unwrap();
            expected.decay(0.5).unwrap();
        }
    }
    assert_eq!(unsafe { nf_omis_merge(omis, other) }, NF_OK);
    expected.merge(&expected_other).unwrap();
    for (code, ridge, solver) in [
        (NF_OMIS_RIDGE, 0.0, Solver::default()),
        (NF_OMIS_RIDGE, 0.5, Solver::Ridge(0.5)),
        (NF_OMIS_PLAIN, f32::NAN, Solver::Plain),
        (NF_OMIS_PROGRESSIVE, -1.0, Solver::Progressive),
        (NF_OMIS_BALANCE, 0.0, Solver::Balance),
    ] {
        let (mut out, mut reference) = ([0.0; 2], [0.0; 2]);
        for _ in 0..2 {
            assert_eq!(unsafe { nf_omis_solve(omis, code, ridge, out.as_mut_ptr(), null_mut()) }, NF_OK);
            expected.solve(solver, &mut reference).unwrap();
            assert_eq!(out, reference);
        }
        let (mut out, mut reference) = ([0.0; 6], [0.0; 6]);
        assert_eq!(unsafe { nf_omis_solve(omis, code, ridge, null_mut(), out.as_mut_ptr()) }, NF_OK);
        expected.alpha(solver, &mut reference).unwrap();
        assert_eq!(out, reference);
    }
    let omis = memory.init();
    let solve = unsafe { nf_omis_solve(omis, NF_OMIS_PLAIN, 0.0, [0.0; 2].as_mut_ptr(), null_mut()) };
    assert_eq!(solve, NF_ERR_NO_SAMPLES);
}

#[test]
fn sizes() {
    assert_eq!(nf_omis_size(2, 1) % 8, 0);
    assert!(nf_omis_size(2, 1) > 8 * core_mis::len(2, 1));
    assert_eq!([nf_omis_size(0, 1), nf_omis_size(17, 1), nf_omis_size(1, 0), nf_omis_size(u32::MAX, u32::MAX)], [0; 4]);
    assert_eq!(
        nf_omis_size(16, u32::MAX),
        if usize::BITS == 64 { 80 + 8 * core_mis::len(16, u32::MAX as usize) } else { 0 }
    );
}

#[test]
fn errors_of_init_leave_memory_and_handle() {
    let mut memory = Memory::new();
    let before = memory.0.clone();
    let (place, bytes) = (memory.0.as_mut_ptr(), memory.0.len() * 8);
    let mut handle = std::ptr::dangling_mut();
    let untouched = handle;
    let mut init = |place: *mut u64, bytes, techniques, integrals, counts: *const u32| unsafe {
        nf_omis_init(place.cast(), bytes, techniques, integrals, counts, &mut handle)
    };
    let counts = COUNTS.as_ptr();
    assert_eq!(init(null_mut(), bytes, 3, 2, counts), NF_ERR_NULL);
    assert_eq!(init(place, bytes, 3, 2, null()), NF_ERR_NULL);
    assert_eq!(init(place.cast::<u8>().wrapping_add(4).cast(), bytes, 3, 2, counts), NF_ERR_ALIGNMENT);
    assert_eq!(init(place, bytes - 1, 3, 2, counts), NF_ERR_MEMORY);
    assert_eq!(init(place, bytes, 0, 2, counts), NF_ERR_RANGE);
    assert_eq!(init(place, bytes, 17, 2, counts), NF_ERR_RANGE);
    assert_eq!(init(place, bytes, 3, 0, counts), NF_ERR_RANGE);
    assert_eq!(init(place, bytes, 3, 2, [1, 0, 1].as_ptr()), NF_ERR_RANGE);
    assert_eq!(handle, untouched);
    assert_eq!(unsafe { nf_omis_init(place.cast(), bytes, 3, 2, counts, null_mut()) }, NF_ERR_NULL);
    assert_eq!(memory.0, before);
}

#[test]
fn errors_of_every_method() {
    type Method = fn(*mut nf_omis) -> nf_status;
    const METHODS: [Method; 6] = [
        |omis| unsafe { nf_omis_add(omis, 0, PDF.as_ptr(), [1.0; 2].as_ptr()) },
        |omis| unsafe { nf_omis_solve(omis, 0, 0.0, [0.0; 2].as_mut_ptr(), null_mut()) },
        |omis| unsafe { nf_omis_solve(omis, 0, 0.0, null_mut(), [0.0; 6].as_mut_ptr()) },
        |omis| unsafe { nf_omis_next_batch(omis, 0, 0.0, 1.0) },
        |omis| unsafe { nf_omis_merge(omis, Memory::new().init()) },
        |omis| unsafe { nf_omis_merge(Memory::new().init(), omis) },
    ];
    for (i, method) in METHODS.iter().enumerate() {
        assert_eq!(method(null_mut()), NF_ERR_NULL);
        let mut never = Memory::new();
        assert_eq!(method(never.0.as_mut_ptr().cast()), NF_ERR_STATE);
        let mut memory = Memory::new();
        let omis = memory.init();
        assert_eq!(method(omis.cast::<u8>().wrapping_add(1).cast()), NF_ERR_ALIGNMENT);
        if i < 4 {
            // Only adding needs no sample.
            let expected = if i == 0 { NF_OK } else { NF_ERR_NO_SAMPLES };
            assert_eq!(method(omis), expected);
        }
    }
}

#[test]
fn errors_of_arguments_change_nothing() {
    let mut memory = Memory::new();
    let omis = memory.init();
    let (pdf, value) = sample(1);
    assert_eq!(unsafe { nf_omis_add(omis, 0, pdf.as_ptr(), value.as_ptr()) }, NF_OK);
    let before = memory.0.clone();
    let omis: *mut nf_omis = memory.0.as_mut_ptr().cast();
    let add = |technique, pdf: *const f32, value: *const f32| unsafe { nf_omis_add(omis, technique, pdf, value) };
    assert_eq!(add(0, null(), value.as_ptr()), NF_ERR_NULL);
    assert_eq!(add(0, pdf.as_ptr(), null()), NF_ERR_NULL);
    assert_eq!(add(3, pdf.as_ptr(), value.as_ptr()), NF_ERR_RANGE);
    assert_eq!(add(0, [0.0, 1.0, 1.0].as_ptr(), value.as_ptr()), NF_ERR_RANGE);
    assert_eq!(add(0, [1.0, -1.0, 1.0].as_ptr(), value.as_ptr()), NF_ERR_RANGE);
    assert_eq!(add(0, [1.0, f32::INFINITY, 1.0].as_ptr(), value.as_ptr()), NF_ERR_NOT_FINITE);
    assert_eq!(add(0, pdf.as_ptr(), [1.0, f32::NAN].as_ptr()), NF_ERR_NOT_FINITE);

    let mut out = [7.0; 6];
    for (solver, ridge, expected) in [
        (4, 0.0, NF_ERR_RANGE),
        (u32::MAX, 0.0, NF_ERR_RANGE),
        (NF_OMIS_RIDGE, -1.0, NF_ERR_RANGE),
        (NF_OMIS_RIDGE, 1e9, NF_ERR_RANGE),
        (NF_OMIS_RIDGE, f32::NAN, NF_ERR_NOT_FINITE),
    ] {
        assert_eq!(unsafe { nf_omis_solve(omis, solver, ridge, out.as_mut_ptr(), null_mut()) }, expected);
        assert_eq!(unsafe { nf_omis_solve(omis, solver, ridge, null_mut(), out.as_mut_ptr()) }, expected);
        assert_eq!(unsafe { nf_omis_next_batch(omis, solver, ridge, 1.0) }, expected);
    }
    assert_eq!(unsafe { nf_omis_solve(omis, 0, 0.0, null_mut(), null_mut()) }, NF_ERR_NULL);
    assert_eq!(out, [7.0; 6]);
    assert_eq!(unsafe { nf_omis_next_batch(omis, NF_OMIS_PROGRESSIVE, 0.0, 1.0) }, NF_ERR_UNSUPPORTED);
    assert_eq!(unsafe { nf_omis_next_batch(omis, 0, 0.0, 1.5) }, NF_ERR_RANGE);
    assert_eq!(unsafe { nf_omis_next_batch(omis, 0, 0.0, f32::NAN) }, NF_ERR_NOT_FINITE);
    assert_eq!(unsafe { nf_omis_merge(omis, omis) }, NF_ERR_RANGE);
    let mut small = vec![0_u64; nf_omis_size(2, 2) / 8];
    let mut other = null_mut();
    let status = unsafe { nf_omis_init(small.as_mut_ptr().cast(), small.len() * 8, 2, 2, COUNTS.as_ptr(), &mut other) };
    assert_eq!(status, NF_OK);
    assert_eq!(unsafe { nf_omis_merge(omis, other) }, NF_ERR_MISMATCH);
    assert_eq!(memory.0, before);
}

#[test]
fn the_generator_is_the_core_s() {
    let mut rng = nf_rng { state: 0, increment: 0 };
    let mut expected = noisefloor::rng::Rng::seed(99);
    unsafe { nf_rng_seed(&mut rng, 99) };
    for _ in 0..10 {
        assert_eq!(unsafe { nf_rng_next(&mut rng) }, expected.next_u32());
        assert_eq!(unsafe { nf_rng_uniform(&mut rng) }, expected.uniform_f32());
    }
    unsafe { nf_rng_seed(null_mut(), 1) };
    assert_eq!(unsafe { (nf_rng_next(null_mut()), nf_rng_uniform(null_mut())) }, (0, 0.0));
}
