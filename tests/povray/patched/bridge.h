/* What the patched POV-Ray asks of noisefloor: numbers for a sample's decisions, and a colour for a pixel's samples.
 * MIT OR Apache-2.0. Nothing here is POV-Ray's.
 *
 * The order of calls, on any number of threads (each works on a block of its own; nothing is shared or locked):
 *   block_begin { pixel_begin { sample_begin, positions, sample_end } pixel_end } block_end
 * and, where irradiance is gathered for radiosity, inside a sample or not:
 *   gather_begin { gather_direction, positions, gather_value } gather_end
 *
 * The environment chooses; settings.hpp has the list. An error ends the program with a message.
 */
#ifndef NOISEFLOOR_POVRAY_BRIDGE_H
#define NOISEFLOOR_POVRAY_BRIDGE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* 0 if NOISEFLOOR is off or not set: then every function below that answers does so with 0. */
int nfp_enabled(void);
/* Samples of a pixel. */
unsigned nfp_samples(void);
/* 1 while a sample is traced. */
int nfp_in_sample(void);
/* 1 while a sample or a gathered ray is traced in which the point of an area light stands for the light in shading as
 * in shadow; 0 if only in shadow, as in POV-Ray itself. */
int nfp_moves_lights(void);

/* A rectangle of pixels. lens: whether rays leave from points of a lens. lights: the area lights, by address. */
void nfp_block_begin(int left, int top, unsigned width, unsigned height, int lens, const void *const *lights,
                     size_t count);
/* means[3 * width * height]: red, green, blue of its pixels, row after row. */
void nfp_block_end(float *means);

/* pixel: its number in the block, row after row. */
void nfp_pixel_begin(size_t pixel);
/* 1 if the estimator wants to know what a pixel shows. */
int nfp_wants_surfaces(void);
/* object: what the pixel shows, by address. Fits are shared only by pixels that show the same. */
void nfp_pixel_surface(const void *object);
void nfp_pixel_end(void);

/* dx, dy: where in the pixel, from its centre, in (-0.5, 0.5). */
void nfp_sample_begin(unsigned index, double *dx, double *dy);
void nfp_sample_end(const float rgb[3]);

/* A point of the unit disc: the centre while no sample is traced. 0 outside of a pixel. */
int nfp_lens_position(double *x, double *y);
/* A point of the unit square for the light as seen from `point`: the same for the same point until another is asked
 * about. 0 if no sample and no gathered ray is traced. */
int nfp_light_position(const void *light, const double point[3], double *u, double *v);

/* Irradiance at a point, from `count` directions. */
void nfp_gather_begin(const double point[3], unsigned count);
/* A point of the unit disc below the next direction: projected up it is cosine-distributed. 0 if noisefloor is off. */
int nfp_gather_direction(double disc[2]);
/* What the last direction's ray brought. */
void nfp_gather_value(const float rgb[3]);
/* The mean of the values, as estimated. 0 if their plain mean is all that can be said. */
int nfp_gather_end(float rgb[3]);

#ifdef __cplusplus
}
#endif

#endif
