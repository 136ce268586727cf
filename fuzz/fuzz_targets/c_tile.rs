//! The C library's tiles, samplers, generator, recommendations and messages: any bytes, numbers and addresses.
#![no_main]

mod support;

use arbitrary::{Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use noisefloor::tile::{Header, Shape};
use noisefloor_c::*;
use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use support::Source;

fn shipped() -> [&'static nf_tile; 12] {
    [
        &nf_tile_128_1spp_2d,
        &nf_tile_128_4spp_2d,
        &nf_tile_128_16spp_2d,
        &nf_tile_128_16spp_2d_progressive,
        &nf_tile_128_1spp_4d,
        &nf_tile_128_4spp_4d,
        &nf_tile_128_1spp_2d_gaussian,
        &nf_tile_128_4spp_2d_gaussian,
        &nf_tile_128_1spp_2d_temporal,
        &nf_tile_64_1spp_2d,
        &nf_tile_64_4spp_2d,
        &nf_tile_64_4spp_2d_temporal,
    ]
}

/// How many numbers a fill writes; 0 for what it refuses.
fn fill_len(dims: &[u32], sizes: [u32; 3]) -> usize {
    if dims.iter().any(|dims| !(1..=4).contains(dims)) {
        return 0;
    }
    sizes.iter().fold(dims.iter().sum::<u32>() as usize, |len, &size| len.saturating_mul(size as usize))
}

/// A built-in tile, the bytes as they are, or under a header that fits them.
fn tile(source: &mut Source<'_>, bytes: &mut Vec<u8>) -> Result<Option<nf_tile>> {
    let mut tile = MaybeUninit::uninit();
    // SAFETY: `bytes` has `len` bytes and outlives the tile; wrong addresses are NULL.
    let status = unsafe {
        if source.any()? {
            let shipped = shipped();
            tile.write(*shipped[source.small(20)? as usize % shipped.len()]);
            NF_OK
        } else {
            let shape = Shape {
                size: 1 << (source.any::<u8>()? % 4),
                spp: 1 << (source.any::<u8>()? % 3),
                dims: 1 + u32::from(source.any::<u8>()? % 4),
                frames: 1 + u32::from(source.any::<u8>()? % 2),
                bits: if source.any()? { 16 } else { 8 },
                progressive: source.any()?,
            };
            *bytes = source.0.peek_bytes(source.0.len()).unwrap_or_default().to_vec();
            if let Some(payload) = bytes.get(..shape.payload_bytes() as usize)
                && let Ok(head) = Header::new(shape, 1, "fuzz").and_then(|header| header.encode(payload))
            {
                *bytes = [&head[..], payload].concat();
            }
            nf_tile_from_bytes(bytes.as_ptr().cast(), bytes.len(), tile.as_mut_ptr())
        }
    };
    // SAFETY: written on success.
    Ok((status == NF_OK).then(|| unsafe { tile.assume_init() }))
}

fn draw(source: &mut Source<'_>, tile: Option<&nf_tile>) -> Result<()> {
    let view = tile.map_or(null(), |tile| &raw const *tile);
    let [x, y, frame, index, key, seed] = [0; 6].map(|_| source.any::<u32>().unwrap_or(1));
    // SAFETY: the tile lives on; arrays have the lengths that the header asks for.
    unsafe {
        let root = nf_tile_sampler_pixel(view, x, y, frame, index);
        let child = nf_tile_sampler_domain(nf_tile_sampler_scramble(root, seed), key);
        for sampler in [root, child] {
            let mut all = [-1.0; 4];
            nf_tile_sampler_draw(sampler, 4, all.as_mut_ptr());
            assert!(all.iter().all(|u| (0.0..1.0).contains(u)), "{all:?}");
            for dims in [0, 1, 2, 3, 5, seed] {
                let mut u = [-1.0; 4];
                nf_tile_sampler_draw(sampler, if dims == 4 { 0 } else { dims }, u.as_mut_ptr());
                let drawn = if dims <= 4 && dims != 4 { dims as usize } else { 0 };
                assert!(u[..drawn] == all[..drawn] && u[drawn..].iter().all(|&u| u == -1.0), "{dims}: {u:?}");
            }
            nf_tile_sampler_draw(sampler, 2, null_mut());
        }
        let dims = source.array(2, |source| source.small(5))?;
        let (width, height, samples) = (source.small(5)?, source.small(5)?, source.small(3)?);
        let samplers = [root, child];
        let len = fill_len(&dims.values, [width, height, samples]);
        if len < 1 << 12 {
            let room = if source.rarely(16)? { len / 2 } else { len };
            let mut u = source.array(room, |_| Ok(-1.0_f32))?;
            let count = u.values.len();
            let to = u.pointer_mut();
            let status = nf_tile_sampler_fill(samplers.as_ptr(), dims.pointer(), 2, width, height, samples, to, count);
            let is_written = |u: &f32| (0.0..1.0).contains(u) == (status == NF_OK);
            assert!(count > len || u.values.iter().all(is_written), "{status}");
        }
    }
    Ok(())
}

/// The default sampler, from any bytes.
fn draw_default(source: &mut Source<'_>) -> Result<()> {
    let [domain, index, flags, key, seed] = [source.any()?, source.any()?, source.any()?, source.any()?, source.any()?];
    let sampler = nf_sampler { domain, index, x: source.any()?, y: source.any()?, flags };
    let dims = [source.small(5)?, source.small(5)?];
    // SAFETY: arrays have the lengths that the header asks for.
    unsafe {
        for made in [nf_sampler_pixel(key, seed, domain, index), nf_sampler_white(key, seed, domain, index)] {
            let mut all = [-1.0_f32; 4];
            nf_sampler_draw(made, 4, all.as_mut_ptr());
            assert!(all.iter().all(|u| (0.0..1.0).contains(u)), "{all:?}");
        }
        let samplers = [sampler, nf_sampler_scramble(nf_sampler_domain(sampler, key), seed)];
        let mut all = [-1.0_f32; 4];
        nf_sampler_draw(samplers[1], dims[1], all.as_mut_ptr());
        let drawn = if dims[1] <= 4 { dims[1] as usize } else { 0 };
        assert!(all.iter().enumerate().all(|(k, u)| (0.0..1.0).contains(u) == (k < drawn)));
        let (width, height, samples) = (source.small(5)?, source.small(5)?, source.small(3)?);
        let len = fill_len(&dims, [width, height, samples]);
        if len >= 1 << 12 {
            return Ok(());
        }
        let mut u = vec![-1.0_f32; if source.rarely(16)? { len / 2 } else { len }];
        let (to, count) = (u.as_mut_ptr(), u.len());
        let status = nf_sampler_fill(samplers.as_ptr(), dims.as_ptr(), 2, width, height, samples, to, count);
        assert!(u.iter().all(|u| (0.0..1.0).contains(u) == (status == NF_OK)), "{status}");
    }
    Ok(())
}

fn run(bytes: &[u8]) -> Result<()> {
    let mut source = Source(Unstructured::new(bytes));
    let mut memory = Vec::new();
    let tile = tile(&mut source, &mut memory)?;
    draw(&mut source, tile.as_ref())?;
    draw_default(&mut source)?;
    let mut rng = nf_rng { state: source.any()?, increment: source.any()? };
    // SAFETY: references are valid pointers, and messages are static strings.
    unsafe {
        assert!((0.0..1.0).contains(&nf_rng_uniform(&mut rng)));
        let seed = u64::from(nf_rng_next(&mut rng));
        nf_rng_seed(&mut rng, seed);
        assert_eq!(nf_rng_next(null_mut()), 0);
        let mut advice = MaybeUninit::uninit();
        let [dims, spp, sampling, can_share] =
            [source.small(20)?, source.small(64)?, source.small(2)?, source.small(2)?];
        let sample_cost = source.number()?;
        if nf_recommend(dims, spp, sampling, can_share, sample_cost, advice.as_mut_ptr()) == NF_OK {
            let advice = advice.assume_init();
            assert!(advice.error > 0.0 && advice.filtered_error > 0.0);
            assert!(nf_cv_terms(&advice.config) > 0, "a configuration that the library refuses");
        }
        let message = CStr::from_ptr(nf_status_message(source.any()?));
        assert!(!message.is_empty() && nf_abi_version() == 1);
    }
    Ok(())
}

/// What is to be fuzzed is there: a library without tiles would refuse half of all inputs, and none would fail.
fn defaults_work() {
    for (id, tile) in shipped().into_iter().enumerate() {
        let mut u = [-1.0; 2];
        // SAFETY: the tile outlives its samplers; arrays have the lengths that the header asks for.
        unsafe {
            let sampler = nf_tile_sampler_pixel(tile, 1, 2, 0, 0);
            nf_tile_sampler_draw(sampler, 2, u.as_mut_ptr());
            assert!(u.iter().all(|u| (0.0..1.0).contains(u)), "tile {id}: {u:?}");
            assert_eq!(nf_tile_sampler_fill(&sampler, &2, 1, 1, 1, 1, u.as_mut_ptr(), 2), NF_OK);
        }
    }
    // SAFETY: the header says how long it is.
    let table = unsafe { std::slice::from_raw_parts(nf_sampler_table(), 1 << 16) };
    assert!(table.iter().any(|&number| number != table[0]));
    let mut advice = MaybeUninit::uninit();
    // SAFETY: room for the answer.
    assert_eq!(unsafe { nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 1, f32::INFINITY, advice.as_mut_ptr()) }, NF_OK);
}

fuzz_target!(init: defaults_work(), |bytes: &[u8]| {
    // Bytes that ran out are no input.
    run(bytes).ok();
});
