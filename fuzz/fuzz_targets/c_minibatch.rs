//! The C library's tables, shards, importances and permutations: any operations, values and addresses.
#![no_main]

mod support;

use arbitrary::{Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use noisefloor_c::*;
use std::mem::MaybeUninit;
use std::ptr::null_mut;
use support::Source;

/// The probabilities of all items sum to 1.
fn check(table: &nf_table) {
    let probability = |item: u32| {
        let mut p = 0.0;
        // SAFETY: references are valid pointers. Where nothing can be drawn it stays 0.
        unsafe { nf_table_probabilities(table, &item, 1, 1, &mut p) };
        f64::from(p)
    };
    let sum: f64 = (0..table.items).map(probability).sum();
    assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-4, "probabilities sum to {sum}");
}

fn operation(source: &mut Source<'_>, table: &mut nf_table, rng: &mut nf_rng) -> Result<()> {
    let count = source.any::<u8>()? % 40;
    let batch = u32::from(count);
    let count = usize::from(count);
    let items = table.items;
    let mut index = source.array(count, |source| source.small(items.saturating_sub(1)))?;
    let mut weight = source.array(count, |_| Ok(-7.0_f32))?;
    let importance = source.array(count, |source| source.number().map(f32::abs))?;
    // SAFETY: arrays have the lengths that the header asks for; wrong addresses are NULL or misaligned, which are
    // refused.
    unsafe {
        let draws = source.any::<u8>()? % 12;
        match draws {
            0..4 => {
                let (index_to, weight_to) = (index.pointer_mut(), weight.pointer_mut());
                let mut shard = MaybeUninit::uninit();
                assert_eq!(nf_table_shard(table, shard.as_mut_ptr()), NF_OK);
                let other = nf_shard { importance: source.number()?.into(), items: source.any::<u16>()?.into() };
                let shards = [shard.assume_init(), other];
                let status = match draws {
                    0 => nf_table_draw(table, rng, batch, index_to, weight_to),
                    1 => nf_table_draw_stratified(table, rng, batch, index_to, weight_to),
                    2 => nf_table_draw_distinct(table, rng, batch, index_to, weight_to),
                    _ => nf_table_draw_shard(table, shards.as_ptr(), 2, rng, batch, index_to, weight_to),
                };
                if status == NF_OK {
                    assert!(index.values.iter().all(|&item| item < items), "{:?}", index.values);
                    // No weights are asked for with NULL.
                    assert!(weight_to.is_null() || weight.values.iter().all(|&w| w > 0.0), "{:?}", weight.values);
                } else {
                    assert!(weight.values.iter().all(|&weight| weight == -7.0));
                }
                let mut counts = [u32::MAX; 2];
                let fraction = source.unit()?;
                if nf_shards_allocate(shards.as_ptr(), 2, fraction, rng, batch, counts.as_mut_ptr()) == NF_OK {
                    assert_eq!(counts[0] + counts[1], batch);
                }
            }
            4..7 => _ = nf_table_update(table, index.pointer(), importance.pointer(), batch, source.unit()?),
            7 => _ = nf_table_append(table, importance.pointer(), batch),
            8 => _ = nf_table_add_epsilon(table, source.number()?),
            9 => {
                // Numbers outside 0..=1 are refused by every call.
                let fraction = source.unit()?;
                if (0.0..=1.0).contains(&fraction) {
                    table.uniform_fraction = fraction;
                }
            }
            10 => {
                let stride = source.small(2)?;
                let mut p = vec![-7.0; if stride > 2 { 0 } else { count * stride as usize }];
                if stride <= 2 {
                    nf_table_probabilities(table, index.pointer(), batch, stride, p.as_mut_ptr());
                }
                assert!(total(table) >= 0.0);
            }
            _ => save(source, table)?,
        }
    }
    check(table);
    Ok(())
}

fn total(table: &nf_table) -> f64 {
    let mut shard = nf_shard { importance: -1.0, items: 0 };
    // SAFETY: references are valid pointers.
    assert_eq!(unsafe { nf_table_shard(table, &mut shard) }, NF_OK);
    shard.importance
}

/// What was saved is loaded; with a byte changed it is refused.
unsafe fn save(source: &mut Source<'_>, table: &nf_table) -> Result<()> {
    // SAFETY: as in `operation`.
    unsafe {
        let mut saved = vec![0_u8; NF_TABLE_SAVED_HEADER as usize + 4 * table.items as usize];
        assert_eq!(nf_table_save(table, saved.as_mut_ptr().cast(), saved.len()), NF_OK);
        assert!(nf_table_save(table, saved.as_mut_ptr().cast(), saved.len() - 1) < 0);
        let at = source.any::<u16>()? as usize % saved.len();
        let change = source.any::<u8>()?;
        saved[at] ^= change;
        let mut memory = vec![0_u64; nf_table_size(table.items).div_ceil(8)];
        let mut loaded = MaybeUninit::uninit();
        let (to, bytes) = (memory.as_mut_ptr().cast(), 8 * memory.len());
        let status = nf_table_load(loaded.as_mut_ptr(), to, bytes, saved.as_ptr().cast(), saved.len());
        assert_eq!(status == NF_OK, change == 0, "{status}: byte {at} changed by {change:#x}");
        if status == NF_OK {
            let loaded = loaded.assume_init();
            assert_eq!(total(&loaded).to_bits(), total(table).to_bits());
        }
    }
    Ok(())
}

fn importances(source: &mut Source<'_>) -> Result<()> {
    let outputs = source.any::<u8>()? % 20;
    let len = usize::from(outputs);
    let (outputs, label) = (u32::from(outputs), source.small(20)?);
    let logits = source.array(len, Source::number)?;
    let target = source.array(len, Source::number)?;
    let (a, b) = (logits.pointer(), target.pointer());
    // SAFETY: as in `operation`.
    unsafe {
        let [mut norm, mut loss] = [-7.0_f32; 2];
        let mut gradient = source.array(len, |_| Ok(-7.0_f32))?;
        let to = gradient.pointer_mut();
        let status = nf_importance_cross_entropy(a, &label, 1, outputs, &mut norm, &mut loss, to);
        assert!(if status == NF_OK { (0.0..=1.415).contains(&norm) } else { norm == -7.0 }, "{norm}");
        assert!(if status == NF_OK { loss >= 0.0 && loss.is_finite() } else { loss == -7.0 }, "{loss}");
        let [mut error, mut nodes] = [-7.0_f32; 2];
        for (status, out) in [
            (nf_importance_squared_error(a, b, 1, outputs, &mut error), error),
            (nf_importance_gradient(a, 1, outputs, NF_NODES_NORM, 1, &mut nodes), nodes),
        ] {
            assert!(if status == NF_OK { out >= 0.0 && out.is_finite() } else { out == -7.0 }, "{status}: {out}");
        }
        let good =
            gradient.values.iter().all(|&g| if status == NF_OK { to.is_null() || g.abs() <= 1.0 } else { g == -7.0 });
        assert!(good, "{status}: {:?}", gradient.values);
    }
    let (seed, items, position) = (source.any()?, source.any::<u32>()?, source.any()?);
    let mut index = source.array(len, |_| Ok(u32::MAX))?;
    let to = index.pointer_mut();
    // SAFETY: as in `operation`.
    let status = unsafe { nf_shuffle(seed, items, position, len as u32, to) };
    assert!(index.values.iter().all(|&i| if status == NF_OK { i < items } else { i == u32::MAX }));
    Ok(())
}

fn run(bytes: &[u8]) -> Result<()> {
    let mut source = Source(Unstructured::new(bytes));
    let [items, room] = [source.any::<u8>()?, source.any::<u8>()?].map(u32::from);
    let importance = source.array(items as usize, |source| source.number().map(f32::abs))?;
    let mut table = MaybeUninit::uninit();
    // SAFETY: the memory outlives the table, and a table is used only if it was made.
    unsafe {
        // Room for some more than the items.
        let mut memory = source.memory(nf_table_size(items + room))?;
        let (to, size) = (memory.pointer_mut().cast(), memory.bytes());
        if nf_table_init(table.as_mut_ptr(), to, size, items, importance.pointer()) == NF_OK {
            let table = table.assume_init_mut();
            let mut rng = MaybeUninit::uninit();
            nf_rng_seed(rng.as_mut_ptr(), source.any()?);
            let rng = rng.assume_init_mut();
            check(table);
            for _ in 0..source.any::<u8>()? % 16 {
                operation(&mut source, table, rng)?;
            }
        }
        let (saved, size) = (bytes.as_ptr().cast(), bytes.len());
        assert!(nf_table_load(null_mut(), to, memory.bytes(), saved, size) < 0);
    }
    importances(&mut source)
}

/// Valid arguments are not refused: a library that refused all would fail no input.
fn defaults_work() {
    let (mut table, mut rng) = (MaybeUninit::uninit(), MaybeUninit::uninit());
    let mut memory = vec![0_u64; nf_table_size(3).div_ceil(8)];
    let (mut index, mut weight) = ([u32::MAX; 2], [0.0_f32; 2]);
    // SAFETY: arrays have the lengths that the header asks for.
    unsafe {
        let (to, bytes) = (memory.as_mut_ptr().cast(), 8 * memory.len());
        assert_eq!(nf_table_init(table.as_mut_ptr(), to, bytes, 3, [1.0, 2.0, 3.0].as_ptr()), NF_OK);
        nf_rng_seed(rng.as_mut_ptr(), 1);
        let (table, rng) = (table.as_mut_ptr(), rng.as_mut_ptr());
        for draw in [nf_table_draw, nf_table_draw_stratified] {
            assert_eq!(draw(table, rng, 2, index.as_mut_ptr(), weight.as_mut_ptr()), NF_OK);
        }
        assert_eq!(nf_table_draw_distinct(table, rng, 2, index.as_mut_ptr(), weight.as_mut_ptr()), NF_OK);
        assert!(index.iter().all(|&item| item < 3) && weight.iter().all(|&w| w > 0.0), "{index:?} {weight:?}");
        assert_eq!(nf_table_update(table, index.as_ptr(), weight.as_ptr(), 2, 0.3), NF_OK);
        check(&*table);
        let (logits, mut norm) = ([0.0, 1.0], 0.0);
        let status = nf_importance_cross_entropy(logits.as_ptr(), &1, 1, 2, &mut norm, null_mut(), null_mut());
        assert!(status == NF_OK && norm > 0.0);
    }
}

fuzz_target!(init: defaults_work(), |bytes: &[u8]| {
    // Bytes that ran out are no input.
    run(bytes).ok();
});
