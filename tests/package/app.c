/* Uses the installed header and library: they must be of one version, and work. */
#include <noisefloor.h>
#include <stdio.h>
#include <string.h>

int main(void) {
    static const float u[8] = {0.1f, 0.9f, 0.4f, 0.2f, 0.7f, 0.6f, 0.3f, 0.8f};
    static double workspace[4096];
    float f[8];
    nf_cv_config config;
    nf_cv_samples samples;
    nf_estimate estimate;
    nf_tile tile;
    nf_status status;
    int i;
    if (nf_abi_version() != NF_ABI_VERSION) {
        fprintf(stderr, "the header is of ABI version %d, the library of %u\n", NF_ABI_VERSION,
                (unsigned)nf_abi_version());
        return 1;
    }
    /* Least squares of order 1 are exact for a linear integrand. */
    for (i = 0; i < 8; i++) {
        f[i] = 1.0f + 2.0f * u[i];
    }
    memset(&config, 0, sizeof config);
    memset(&samples, 0, sizeof samples);
    samples.u = u, samples.f = f, samples.n = 8;
    config.channels = 1;
    config.dims = 1;
    config.order = 1;
    config.estimator = NF_CV_LEAST_SQUARES;
    status = nf_cv_estimate(&config, &samples, 1, workspace, sizeof workspace, &estimate);
    if (status != NF_OK || estimate.mean[0] < 1.9999f || estimate.mean[0] > 2.0001f) {
        fprintf(stderr, "nf_cv_estimate: %s, mean %g instead of 2\n", nf_status_message(status),
                (double)estimate.mean[0]);
        return 1;
    }
    tile = nf_tile_128_16spp_2d;
    if (tile.size != 128 || tile.spp != 16) {
        fprintf(stderr, "nf_tile_128_16spp_2d: size %u, spp %u\n", (unsigned)tile.size, (unsigned)tile.spp);
        return 1;
    }
    return 0;
}
