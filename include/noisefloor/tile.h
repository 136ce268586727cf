/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_TILE_H
#define NOISEFLOOR_TILE_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Samplers and tiles: sample points whose error is spread over the image where it shows least.
 * Guides, in docs/: sampling.md, tiles.md, renderer.md. */

// One sample of one pixel, of the default sampler: a small struct, passed and copied by value. Drawing does not change
// it, and there is nothing to set up.
//
// A sampler stands for a point of a cube with as many dimensions as are asked for. There are no dimension counters:
// each decision of a path (lens, light, bounce, ...) has a domain, a child of the sampler by a key of its own. A
// domain's numbers depend on nothing but pixel, frame, index and the keys that led to it, so that any sample can be
// drawn in any order, on any thread, and at any time. Made by nf_sampler_pixel; the fields are not to be written.
typedef struct nf_sampler {
    // The domain: 0 is the root.
    uint32_t domain;
    // The sample of the pixel.
    uint32_t index;
    // The pixel's column, its last 16 bits.
    uint16_t x;
    // The pixel's row, likewise.
    uint16_t y;
    // Whether it is scrambled, or white.
    uint32_t flags;
} nf_sampler;

// Sample `index` of pixel (x, y) in `frame`, any values of each.
//
// The samples of a pixel are one sequence, best at powers of two: take any number, and stop where you like. Each frame
// is unrelated to the others. Where frames are averaged, by a viewer or by TAA, leave the frame 0 and let the index
// count on.
nf_sampler nf_sampler_pixel(uint32_t x, uint32_t y, uint32_t frame, uint32_t index);

// As nf_sampler_pixel(), but neighbours know nothing of each other: the error is that of each pixel, white over the
// image. For denoisers that were made for white noise.
nf_sampler nf_sampler_white(uint32_t x, uint32_t y, uint32_t frame, uint32_t index);

// The child domain of a key, any value. Children of different keys are unrelated to each other and to their parent.
// Keys mean something only among the children of one parent: a bounce's light may have the same key as the next
// bounce's.
nf_sampler nf_sampler_domain(nf_sampler sampler, uint32_t key);

// An independent version of the sampler for each seed but 0; seed 0 changes nothing.
//
// All values of a dimension are shifted, modulo 1, by a hash of seed and domain. Over random seeds every value is
// uniform, so that estimates are unbiased, as far as a hash of 32 bits is random. The shift costs quality: where good
// images are wanted, and not exact unbiasedness, take another frame instead. Children of a scrambled sampler are
// scrambled.
nf_sampler nf_sampler_scramble(nf_sampler sampler, uint32_t seed);

// Writes `dims` numbers, 1..4, to u[dims]: each in [0, 1), a multiple of 2^-24.
//
// The first two are optimised together, across pixels too; all four are stratified together. Fewer are the first of
// those. More come from a domain of their own. Writes nothing if dims is out of range or u is NULL.
void nf_sampler_draw(nf_sampler sampler, uint32_t dims, float *u);

// The table that all draws look into, 65,536 numbers, for copies on other devices: see noisefloor_sampler.h.
const uint32_t *nf_sampler_table(void);

// How many numbers nf_sampler_fill, or nf_tile_sampler_fill, writes: width * height * samples * (the sum of dims). 0
// if one of dims is outside 1..4, or memory has not that many.
size_t nf_sampler_fill_len(const uint32_t *dims, size_t domains, uint32_t width, uint32_t height, uint32_t samples);

// Draws for many pixels and samples at once, for renderers that work on whole images. The same bits as single draws.
//
// samplers[domains]: one for each domain, all at the first pixel and the first sample. dims[domains]: how many numbers
// to draw from each, 1..4. width, height: how many pixels, to the right and down. samples: how many samples of each,
// by ascending index. u[height][width][samples][sum of dims]: what the samplers draw there, one after the other; len
// numbers are there, at least nf_sampler_fill_len.
//
// NF_ERR_NULL; NF_ERR_ALIGNMENT; NF_ERR_RANGE: dims, or sizes that memory cannot have; NF_ERR_MEMORY: len.
nf_status nf_sampler_fill(const nf_sampler *samplers, const uint32_t *dims, size_t domains, uint32_t width,
    uint32_t height, uint32_t samples, float *u, size_t len);

// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims.
#define NF_TILE_128_1SPP_2D 1
// nf_tile_builtin: 128 x 128 pixels, 4 samples, 2 dims.
#define NF_TILE_128_4SPP_2D 2
// nf_tile_builtin: 128 x 128 pixels, 16 samples, 2 dims.
#define NF_TILE_128_16SPP_2D 3
// nf_tile_builtin: 128 x 128 pixels, 16 samples, 2 dims; the first 1, 2, 4 and 8 samples are well distributed too.
#define NF_TILE_128_16SPP_2D_PROGRESSIVE 4
// nf_tile_builtin: 128 x 128 pixels, 1 sample, 4 dims.
#define NF_TILE_128_1SPP_4D 5
// nf_tile_builtin: 128 x 128 pixels, 4 samples, 4 dims.
#define NF_TILE_128_4SPP_4D 6
// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims, for images reconstructed with a Gaussian filter (figures 5.21,
// 5.22).
#define NF_TILE_128_1SPP_2D_GAUSSIAN 7
// nf_tile_builtin: 128 x 128 pixels, 4 samples, 2 dims, for images reconstructed with a Gaussian filter.
#define NF_TILE_128_4SPP_2D_GAUSSIAN 8
// nf_tile_builtin: 128 x 128 pixels, 1 sample, 2 dims, 16 frames.
#define NF_TILE_128_1SPP_2D_TEMPORAL 9
// nf_tile_builtin: 64 x 64 pixels, 1 sample, 2 dims.
#define NF_TILE_64_1SPP_2D 10
// nf_tile_builtin: 64 x 64 pixels, 4 samples, 2 dims.
#define NF_TILE_64_4SPP_2D 11
// nf_tile_builtin: 64 x 64 pixels, 4 samples, 2 dims, 16 frames.
#define NF_TILE_64_4SPP_2D_TEMPORAL 12

// A view of a tile: sample points for a square of pixels that repeats over the image (chapter 5; docs/tiles.md).
//
// A complete struct, to be copied freely; it owns nothing. `nf_tile_128_1spp_2d` and its like come with the library,
// and a program linked with `--gc-sections` carries those that it names; nf_tile_from_bytes makes others. The fields
// are to be read, never written; all zero is a valid tile, whose samples are all 0.
typedef struct nf_tile {
    // The stored values, in the memory that the tile was made from.
    const void *values;
    // How many bytes they are.
    size_t bytes;
    // Pixels on a side: a power of two, 1..1024.
    uint32_t size;
    // Samples of each pixel: a power of two, 1..256.
    uint32_t spp;
    // Dimensions of each sample that were optimised together: 1..8.
    uint32_t dims;
    // Frames that follow each other in time: 1..256.
    uint32_t frames;
    // Bits of each stored coordinate: 8 or 16.
    uint32_t bits;
    // 1 if the first 1, 2, 4, ... samples of a pixel are well distributed too, otherwise 0.
    uint32_t progressive;
} nf_tile;

// The tile NF_TILE_128_1SPP_2D.
extern const nf_tile nf_tile_128_1spp_2d;
// The tile NF_TILE_128_4SPP_2D.
extern const nf_tile nf_tile_128_4spp_2d;
// The tile NF_TILE_128_16SPP_2D.
extern const nf_tile nf_tile_128_16spp_2d;
// The tile NF_TILE_128_16SPP_2D_PROGRESSIVE.
extern const nf_tile nf_tile_128_16spp_2d_progressive;
// The tile NF_TILE_128_1SPP_4D.
extern const nf_tile nf_tile_128_1spp_4d;
// The tile NF_TILE_128_4SPP_4D.
extern const nf_tile nf_tile_128_4spp_4d;
// The tile NF_TILE_128_1SPP_2D_GAUSSIAN.
extern const nf_tile nf_tile_128_1spp_2d_gaussian;
// The tile NF_TILE_128_4SPP_2D_GAUSSIAN.
extern const nf_tile nf_tile_128_4spp_2d_gaussian;
// The tile NF_TILE_128_1SPP_2D_TEMPORAL.
extern const nf_tile nf_tile_128_1spp_2d_temporal;
// The tile NF_TILE_64_1SPP_2D.
extern const nf_tile nf_tile_64_1spp_2d;
// The tile NF_TILE_64_4SPP_2D.
extern const nf_tile nf_tile_64_4spp_2d;
// The tile NF_TILE_64_4SPP_2D_TEMPORAL.
extern const nf_tile nf_tile_64_4spp_2d_temporal;

// One of the tiles that come with the library, by number: id is NF_TILE_*. A program that calls it carries all of
// them.
//
// NF_ERR_NULL; NF_ERR_RANGE: id; NF_ERR_UNSUPPORTED: this library was built without that tile.
nf_status nf_tile_builtin(uint32_t id, nf_tile *out);

// The tile of an .nft file's bytes, all of them checked: about 3 ms for a megabyte. The bytes must outlive the tile,
// unchanged; any alignment will do.
//
// NF_ERR_NULL; NF_ERR_RANGE: len; NF_ERR_FOREIGN: the bytes are no tile; NF_ERR_VERSION: one of a newer format;
// NF_ERR_LENGTH: truncated, or followed by other bytes; NF_ERR_CORRUPT: damaged.
nf_status nf_tile_from_bytes(const void *bytes, size_t len, nf_tile *out);

// One sample of one pixel: a small struct, passed and copied by value. Drawing does not change it.
//
// A sampler stands for a point of a cube with as many dimensions as are asked for. There are no dimension counters:
// each decision of a path (lens, light, bounce, ...) has a domain, a child of the sampler by a key of its own. A
// domain's numbers depend on nothing but tile, pixel, frame, index and the keys that led to it, so that any sample can
// be drawn in any order, on any thread, and at any time. Made by nf_tile_sampler_pixel; the fields are not to be
// written.
typedef struct nf_tile_sampler {
    // The tile; it must outlive the sampler and stay where it is.
    const nf_tile *tile;
    // The domain: 0 is the root.
    uint32_t domain;
    // The sample of the pixel.
    uint32_t index;
    // The pixel's column, modulo the tile's size.
    uint16_t x;
    // The pixel's row, modulo the tile's size.
    uint16_t y;
    // The frame, modulo the tile's frames.
    uint16_t frame;
    // 1 after nf_tile_sampler_scramble, otherwise 0.
    uint16_t scrambled;
} nf_tile_sampler;

// Sample `index` of pixel (x, y) in `frame`, any values of each: pixels repeat with the tile's size.
//
// The first tile->spp samples are the tile's. Those that follow continue with a scrambled Sobol sequence in their
// place; none is repeated. Frames 0 to tile->frames - 1 are the tile's; each later run of them is the tile at another
// place, unrelated to it. For an image that is refined over time leave the frame and count the index.
//
// tile: it must outlive the sampler and stay where it is. All draws of a sampler without a tile, NULL, are 0.
nf_tile_sampler nf_tile_sampler_pixel(const nf_tile *tile, uint32_t x, uint32_t y, uint32_t frame, uint32_t index);

// The child domain of a key, any value. Children of different keys are unrelated to each other and to their parent.
// Keys mean something only among the children of one parent: a bounce's light may have the same key as the next
// bounce's.
nf_tile_sampler nf_tile_sampler_domain(nf_tile_sampler sampler, uint32_t key);

// An independent version of the sampler for each seed but 0; seed 0 changes nothing.
//
// It is the tile at another place, with all values of a dimension shifted, modulo 1, by a hash of seed and domain.
// Over random seeds every value is uniform, so an estimate is unbiased, as far as a hash of 32 bits is random (the
// tile's own values are fixed, and an estimate from them is what it is). The shift costs quality: where good images
// are wanted, and not exact unbiasedness, take another frame instead. Children of a scrambled sampler are scrambled.
nf_tile_sampler nf_tile_sampler_scramble(nf_tile_sampler sampler, uint32_t seed);

// Writes the first `dims` coordinates, 1..4, of the sampler's point to u[dims]: each in [0, 1), a multiple of 2^-24.
//
// Up to tile->dims they are optimised together, and more come from other places of the tile; fewer are the first of
// those. If the tile has at least two dims and spp, and is not progressive, each further number of its samples is
// stratified, and the third of a tile of two dims with those two: draw a choice, or a time, after the two numbers that
// it goes with. Two further numbers that belong together are better drawn from a domain of their own. Writes nothing
// if dims is out of range or u is NULL.
void nf_tile_sampler_draw(nf_tile_sampler sampler, uint32_t dims, float *u);

// As nf_sampler_fill(), of tiles' samplers. Those without a tile draw zeros.
nf_status nf_tile_sampler_fill(const nf_tile_sampler *samplers, const uint32_t *dims, size_t domains, uint32_t width,
    uint32_t height, uint32_t samples, float *u, size_t len);

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_TILE_H */
