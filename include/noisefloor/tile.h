/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_TILE_H
#define NOISEFLOOR_TILE_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Samplers and tiles: sample points whose error is spread over the image where it shows least.
 * Guides, in docs/: sampling.md, tiles.md, renderer.md. */

// One sample of one pixel, of the default sampler: passed and copied by value, unchanged by drawing, made by
// nf_sampler_pixel.
//
// It stands for a point of a cube of any dimensions. Each decision of a path (lens, light, bounce, ...) has a domain,
// a child of the sampler by a key of its own, whose numbers depend on nothing but pixel, frame, index and the keys
// that led to it: any sample can be drawn in any order, on any thread.
typedef struct nf_sampler {
    uint32_t domain; // The domain: 0 is the root.
    uint32_t index; // The sample of the pixel.
    uint16_t x; // The pixel's column, its last 16 bits.
    uint16_t y; // The pixel's row, likewise.
    uint32_t flags; // Whether it is scrambled, or white.
} nf_sampler;

// Sample `index` of pixel (x, y) in `frame`, any values of each. The samples of a pixel are one sequence, best at
// powers of two. Where frames are averaged, count it on in frame 0; of what moves sample k is k % 16 of frame k / 16.
//
// At indices 0 and 1 the numbers of all domains repeat every 32 pixels: an image has 1,024 different vectors. Seeds of
// further numbers need the pixel, too.
nf_sampler nf_sampler_pixel(uint32_t x, uint32_t y, uint32_t frame, uint32_t index);

// As nf_sampler_pixel(), but the error is white over the image: for denoisers that were made for white noise. At
// indices 0 and 1 a pixel has one of 1,024 vectors at random.
nf_sampler nf_sampler_white(uint32_t x, uint32_t y, uint32_t frame, uint32_t index);

// The child domain of a key, any value. Children of different keys are unrelated to each other and to their parent, at
// indices 0 and 1 as far as nf_sampler_pixel() says; keys mean something only among the children of one parent.
nf_sampler nf_sampler_domain(nf_sampler sampler, uint32_t key);

// An independent version of the sampler, and of its children, for each seed but 0, which changes nothing. All values
// of a dimension are exclusive-or a hash of seed and domain: uniform over random seeds, for unbiased estimates. Nets
// stay nets; neighbours' errors vanish less through a filter. For good images take another frame instead.
nf_sampler nf_sampler_scramble(nf_sampler sampler, uint32_t seed);

// Writes `dims` numbers, 1..4, to u[dims]: each in [0, 1), a multiple of 2^-24; nothing if dims is out of range or u
// NULL. The first two are optimised together, across pixels too; all four are stratified together.
void nf_sampler_draw(nf_sampler sampler, uint32_t dims, float *u);

// The table that all draws look into, 65,536 numbers, for copies on other devices: see noisefloor_sampler.h.
const uint32_t *nf_sampler_table(void);

// Draws for many pixels and samples at once, with the bits of single draws.
// samplers[domains]: all at the first pixel and sample. dims[domains]: how many numbers of each, 1..4. width, height:
// pixels to the right and down. samples: of each pixel, by ascending index. u[height][width][samples][sum of dims], of
// which `len` numbers, or more than needed, are there.
// NF_ERR_RANGE: dims, or sizes that memory cannot have; NF_ERR_MEMORY: len.
nf_status nf_sampler_fill(const nf_sampler *samplers, const uint32_t *dims, size_t domains, uint32_t width,
    uint32_t height, uint32_t samples, float *u, size_t len);

// A view of a tile: sample points for a square of pixels that repeats over the image (chapter 5; docs/tiles.md). To be
// copied freely, never written; it owns nothing. All zero is a valid tile, whose samples are all 0.
typedef struct nf_tile {
    const void *values; // The stored values, in the memory that the tile was made from.
    size_t bytes; // How many bytes they are.
    uint32_t size; // Pixels on a side: a power of two, 1..1024.
    uint32_t spp; // Samples of each pixel: a power of two, 1..256.
    uint32_t dims; // Dimensions of each sample that were optimised together: 1..8.
    uint32_t frames; // Frames that follow each other in time: 1..256.
    uint32_t bits; // Bits of each stored coordinate: 8 or 16.
    uint32_t progressive; // 1 if the first 1, 2, 4, ... samples of a pixel are well distributed too, otherwise 0.
} nf_tile;

extern const nf_tile nf_tile_128_1spp_2d; // 128 x 128 pixels, 1 sample, 2 dims.
extern const nf_tile nf_tile_128_4spp_2d; // The same, 4 samples.
extern const nf_tile nf_tile_128_16spp_2d; // The same, 16 samples.
// The same, 16 samples, of which the first 1, 2, 4 and 8 are well distributed too.
extern const nf_tile nf_tile_128_16spp_2d_progressive;
extern const nf_tile nf_tile_128_1spp_4d; // 128 x 128 pixels, 1 sample, 4 dims.
extern const nf_tile nf_tile_128_4spp_4d; // The same, 4 samples.
// 128 x 128 pixels, 1 sample, 2 dims, for films that splat samples by a Gaussian filter (figures 5.21, 5.22).
extern const nf_tile nf_tile_128_1spp_2d_gaussian;
extern const nf_tile nf_tile_128_4spp_2d_gaussian; // The same, 4 samples.
extern const nf_tile nf_tile_128_1spp_2d_temporal; // 128 x 128 pixels, 1 sample, 2 dims, 16 frames.
extern const nf_tile nf_tile_64_1spp_2d; // 64 x 64 pixels, 1 sample, 2 dims.
extern const nf_tile nf_tile_64_4spp_2d; // The same, 4 samples.
extern const nf_tile nf_tile_64_4spp_2d_temporal; // The same, 4 samples, 16 frames.

// The tile of an .nft file's bytes, all of them checked: about 3 ms for a megabyte. They must outlive it unchanged.
// NF_ERR_RANGE: a len that no memory has; NF_ERR_FOREIGN; NF_ERR_VERSION; NF_ERR_LENGTH; NF_ERR_CORRUPT.
nf_status nf_tile_from_bytes(const void *bytes, size_t len, nf_tile *out);

// One sample of one pixel, as nf_sampler is, drawn from a tile. Made by nf_tile_sampler_pixel.
typedef struct nf_tile_sampler {
    const nf_tile *tile; // The tile; it must outlive the sampler and stay where it is.
    uint32_t domain; // The domain: 0 is the root.
    uint32_t index; // The sample of the pixel.
    uint16_t x; // The pixel's column, modulo the tile's size.
    uint16_t y; // The pixel's row, modulo the tile's size.
    uint16_t frame; // The frame, modulo the tile's frames.
    uint16_t scrambled; // 1 after nf_tile_sampler_scramble, otherwise 0.
} nf_tile_sampler;

// Sample `index` of pixel (x, y) in `frame`, any values of each. Samples beyond tile->spp continue with a scrambled
// Sobol sequence; frames beyond tile->frames are the tile at other places. For an image that is refined over time
// leave the frame and count the index. The tile must outlive the sampler and stay where it is; of NULL draws are 0.
nf_tile_sampler nf_tile_sampler_pixel(const nf_tile *tile, uint32_t x, uint32_t y, uint32_t frame, uint32_t index);

nf_tile_sampler nf_tile_sampler_domain(nf_tile_sampler sampler, uint32_t key); // As nf_sampler_domain().

// As nf_sampler_scramble(), but the values are shifted, modulo 1.
nf_tile_sampler nf_tile_sampler_scramble(nf_tile_sampler sampler, uint32_t seed);

// Writes the first `dims` coordinates, 1..4, as nf_sampler_draw() does. Up to tile->dims are optimised together, more
// come from other places of the tile. Of a tile that is not progressive, with at least two dims and spp, each further
// number is stratified, the third with the first two: draw a choice, or a time, after the two numbers beside it.
void nf_tile_sampler_draw(nf_tile_sampler sampler, uint32_t dims, float *u);

// As nf_sampler_fill(), of tiles' samplers, which nf_check() must not refuse. Those without a tile draw zeros.
nf_status nf_tile_sampler_fill(const nf_tile_sampler *samplers, const uint32_t *dims, size_t domains, uint32_t width,
    uint32_t height, uint32_t samples, float *u, size_t len);

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_TILE_H */
