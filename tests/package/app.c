/* Uses the installed header and library: they must be of one version, and work. */
#include <noisefloor.h>
#include <stdio.h>

int main(void) {
    static const float u[8] = {0.1f, 0.9f, 0.4f, 0.2f, 0.7f, 0.6f, 0.3f, 0.8f};
    static double workspace[4096];
    float f[8];
    nf_cv_config config;
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
    nf_cv_config_default(&config);
    config.dims = 1;
    config.order = 1;
    config.estimator = NF_CV_LEAST_SQUARES;
    status = nf_cv_estimate(&config, u, f, 8, workspace, sizeof workspace, &estimate);
    if (status != NF_OK || estimate.mean[0] < 1.9999f || estimate.mean[0] > 2.0001f) {
        fprintf(stderr, "nf_cv_estimate: %s, mean %g instead of 2\n", nf_status_message(status),
                (double)estimate.mean[0]);
        return 1;
    }
    status = nf_tile_builtin(NF_TILE_128_16SPP_2D, &tile);
    if (status != NF_OK) {
        fprintf(stderr, "nf_tile_builtin: %s\n", nf_status_message(status));
        return 1;
    }
    return 0;
}
