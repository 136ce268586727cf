/* An image of 64 x 64 integrals, one sample in each pixel: by that sample alone, and by fits that pixels
 * share. */
#include "noisefloor.h"
#include <math.h>
#include <stdio.h>

#define SIZE 64
#define PIXELS (SIZE * SIZE)
static float u[2 * PIXELS], f[PIXELS];
static uint32_t surfaces[PIXELS];
static double exact[PIXELS];
static nf_estimate estimates[PIXELS];
static uint64_t workspace[1 << 16]; /* 512 KiB, 8-byte aligned */

/* What a renderer would trace: two surfaces, on each an integrand that changes slowly over the image. */
static void render(void)
{
    for (int pixel = 0; pixel < PIXELS; ++pixel) {
        int x = pixel % SIZE, y = pixel / SIZE;
        double a = 1.0 + x / 64.0, b = 2.0 - y / 64.0;
        surfaces[pixel] = (uint32_t)(x + y / 2 < 48);
        if (surfaces[pixel])
            b = -b;
        f[pixel] = expf((float)a * u[2 * pixel] + (float)b * u[2 * pixel + 1]);
        exact[pixel] = (exp(a) - 1.0) / a * ((exp(b) - 1.0) / b);
    }
}

static nf_status estimate(void)
{
    const uint32_t dims = 2;
    const nf_sampler sampler = nf_sampler_pixel(0, 0, 0, 0); /* column, row, frame, sample */
    nf_status status = nf_sampler_fill(&sampler, &dims, 1, SIZE, SIZE, 1, u, 2 * PIXELS);
    if (status != NF_OK)
        return status;
    render();

    /* This sampler's samples are stratified; order and stride for others: nf_recommend(). */
    nf_cv_config config = {.dims = 2, .order = 2, .channels = 1, .stratified = 1};
    nf_cv_samples samples = {.u = u, .f = f, .n = 1};
    nf_cv_image image = {0};
    image.width = SIZE;
    image.height = SIZE;
    image.surfaces = surfaces;
    if (nf_cv_image_workspace_size(&config, &image, &samples) > sizeof workspace)
        return NF_ERR_MEMORY;
    return nf_cv_image_estimate(&config, &image, &samples, workspace, sizeof workspace, estimates);
}

int main(void)
{
    nf_status status = estimate();
    if (status != NF_OK) {
        fprintf(stderr, "noisefloor: %s\n", nf_status_message(status));
        return 1;
    }
    double alone = 0.0, shared = 0.0;
    for (int pixel = 0; pixel < PIXELS; ++pixel) {
        alone += pow(f[pixel] - exact[pixel], 2.0);
        shared += pow(estimates[pixel].mean[0] - exact[pixel], 2.0);
    }
    printf("root mean squared errors of one sample in each pixel\n");
    printf("mean       %.4f\n", sqrt(alone / PIXELS));
    printf("noisefloor %.4f\n", sqrt(shared / PIXELS));
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "shared: standard output cannot be written\n");
        return 1;
    }
    return 0;
}
