/* Integrates f(x, y) = exp(-x - y) over the unit square from 64 random samples: by their mean, and by noisefloor. */
#include "noisefloor.h"
#include <math.h>
#include <stdio.h>

#define SAMPLES 64
static uint64_t workspace[4096]; /* 32 KiB, 8-byte aligned */

int main(void)
{
    float u[2 * SAMPLES], f[SAMPLES], mean = 0.0f;
    nf_rng rng;
    nf_rng_seed(&rng, 1);
    for (int i = 0; i < SAMPLES; ++i) {
        u[2 * i] = nf_rng_uniform(&rng);
        u[2 * i + 1] = nf_rng_uniform(&rng);
        f[i] = expf(-u[2 * i] - u[2 * i + 1]);
        mean += f[i] / SAMPLES;
    }

    nf_cv_config config = {.dims = 2, .order = 2, .channels = 1}; /* the robust estimator */
    nf_cv_samples samples = {.u = u, .f = f, .n = SAMPLES};
    nf_estimate estimate;
    nf_status status = NF_ERR_MEMORY;
    if (nf_cv_workspace_size(&config, SAMPLES) <= sizeof workspace)
        status = nf_cv_estimate(&config, &samples, 1, workspace, sizeof workspace, &estimate);
    if (status != NF_OK) {
        fprintf(stderr, "noisefloor: %s\n", nf_status_message(status));
        return 1;
    }

    double exact = (1.0 - exp(-1.0)) * (1.0 - exp(-1.0));
    printf("exact      %.6f\n", exact);
    printf("mean       %.6f  error %+.6f\n", mean, mean - exact);
    printf("noisefloor %.6f  error %+.6f\n", estimate.mean[0], estimate.mean[0] - exact);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "integrate: standard output cannot be written\n");
        return 1;
    }
    return 0;
}
