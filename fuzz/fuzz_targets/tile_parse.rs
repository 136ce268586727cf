//! Any bytes as a tile, and draws from what is accepted: an error or numbers in [0, 1), never a panic.
//!
//! Few random bytes have the right checksum, so the input is also read with its header's checksum and lengths put
//! right.
#![no_main]

use libfuzzer_sys::fuzz_target;
use noisefloor::tile::{HEADER_BYTES, Header, Sampler, Shape, Tile, fill};

fn draw(tile: &Tile<'_>, numbers: &[u8]) {
    let number = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| numbers.get(at + i).copied().unwrap_or(0)));
    let root = Sampler::pixel(tile, number(0), number(4), number(8), number(12));
    for sampler in [root, root.domain(number(2)), root.scramble(number(5)).domain(number(9))] {
        let all = sampler.draw::<4>();
        assert!(all.iter().all(|u| (0.0..1.0).contains(u)), "{all:?}");
        // Only what `Tile::new` accepts has to make sense.
        if Tile::new(tile.shape(), tile.payload()).is_err() {
            continue;
        }
        assert_eq!(sampler.draw::<1>(), all[..1]);
        assert_eq!(sampler.draw::<2>(), all[..2]);
        assert_eq!(sampler.draw::<3>(), all[..3]);
        let mut u = [0.0; 3 * 2 * 2 * 4];
        fill([(sampler, 4)], 3, 2, 2, &mut u).unwrap();
        assert_eq!(u[..4], all);
    }
}

fuzz_target!(|bytes: &[u8]| {
    if let Ok(tile) = Tile::from_bytes(bytes) {
        let (header, payload) = Header::decode(bytes).unwrap();
        assert_eq!(header.encode(payload).unwrap()[..], bytes[..HEADER_BYTES]);
        assert_eq!(payload.len() as u64, tile.shape().payload_bytes());
        draw(&tile, bytes);
    }
    let Some((&[size, spp, dims, frames, flags, ref numbers @ ..], payload)) = bytes.split_first_chunk::<21>() else {
        return;
    };
    let (wide, progressive) = (flags & 1 == 1, flags & 2 == 2);
    let shape = Shape {
        size: 1 << (size % 11),
        spp: 1 << (spp % 9),
        dims: u32::from(dims % 9),
        frames: u32::from(frames),
        bits: if wide { 16 } else { 8 },
        progressive,
    };
    // As a file of that shape, if there is enough of it; and as one that no one should make.
    let wanted = usize::try_from(shape.payload_bytes()).unwrap_or(usize::MAX);
    if let (Ok(header), Some(payload)) = (Header::new(shape, 1, "fuzz"), payload.get(..wanted))
        && let Ok(head) = header.encode(payload)
    {
        let file = [&head[..], payload].concat();
        draw(&Tile::from_bytes(&file).unwrap(), numbers);
    }
    draw(
        &Tile::resume(Shape { size: u32::from(size), spp: u32::from(spp), bits: u32::from(flags), ..shape }, payload),
        numbers,
    );
});
