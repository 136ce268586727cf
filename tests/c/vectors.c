/* The outputs pinned in tests/vectors/cv.txt, to the bit; the file's head says how they are made. */
#include "vector_file.h"

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void check_line(const char *line, int number)
{
    /* form, estimator, basis, dims, order, channels, slices, solver, precision, color, n, seed */
    unsigned in[12], samples, expected[9];
    nf_cv_config config;
    nf_estimate out;
    nf_rng rng;
    nf_status status;
    float *u, *f;
    memory work;
    size_t n, i, d, c;
    int k;
    if (sscanf(line, "%u %u %u %u %u %u %u %u %u %u %u %u : %u %x %x %x %x %x %x %x %x %x", &in[0], &in[1], &in[2],
               &in[3], &in[4], &in[5], &in[6], &in[7], &in[8], &in[9], &in[10], &in[11], &samples, &expected[0],
               &expected[1], &expected[2], &expected[3], &expected[4], &expected[5], &expected[6], &expected[7],
               &expected[8]) != 22) {
        fprintf(stderr, "tests/vectors/cv.txt:%d: cannot be read\n", number);
        CHECK(0);
        return;
    }
    if (in[0] == 0 && in[8] == NF_PRECISION_F32)
        return; /* from arrays C has the best precision alone; the Rust tests have these */
    config = make_config(in[3], in[4], in[5], in[1]);
    config.basis = in[2];
    config.slices = in[6];
    config.solver = in[7];
    config.precision = in[8];
    config.color = in[9];
    n = in[10];
    u = (float *)malloc(n * config.dims * sizeof(float));
    f = (float *)malloc(n * config.channels * sizeof(float));
    if (!u || !f)
        exit(2);
    nf_rng_seed(&rng, in[11]);
    for (i = 0; i < n; ++i)
        for (d = 0; d < config.dims; ++d)
            u[i * config.dims + d] = nf_rng_uniform(&rng);
    for (i = 0; i < n; ++i)
        for (c = 0; c < config.channels; ++c) {
            const float a = u[i * config.dims + c % config.dims], b = u[i * config.dims + config.dims - 1];
            const float quotient = (1.0f + a) / (2.0f + b);
            f[i * config.channels + c] = (float)(c + 1) * (quotient + (a > 0.5f ? 1.0f : 0.0f));
        }
    if (in[0] == 0) {
        work = memory_new(nf_cv_workspace_size(&config, n));
        status = estimate_one(&config, u, f, n, work.start, work.bytes, &out);
    } else {
        memory state = memory_new(nf_cv_accumulator_size(&config, NULL));
        nf_cv_accumulator *accumulator = NULL;
        work = memory_new(accumulator_workspace_size(&config));
        CHECK_STATUS(nf_cv_accumulator_init(state.start, state.bytes, &config, &accumulator), NF_OK);
        CHECK_STATUS(add_samples(accumulator, u, f, n), NF_OK);
        status = nf_cv_accumulator_estimate(accumulator, work.start, work.bytes, &out);
        memory_free(&state);
    }
    CHECK_STATUS(status, NF_OK);
    if (status == NF_OK) {
        int equal = out.samples == samples && bits_of(out.gain) == expected[0];
        for (k = 0; k < 4; ++k)
            equal = equal && bits_of(out.mean[k]) == expected[1 + k] && bits_of(out.std_error[k]) == expected[5 + k];
        if (!equal)
            fprintf(stderr, "tests/vectors/cv.txt:%d: gain %08x, mean %08x %08x %08x %08x\n", number, bits_of(out.gain),
                    bits_of(out.mean[0]), bits_of(out.mean[1]), bits_of(out.mean[2]), bits_of(out.mean[3]));
        CHECK(equal);
    }
    memory_free(&work);
    free(u);
    free(f);
}

int main(int argc, char **argv)
{
    CHECK(each_vector(argc > 1 ? argv[1] : "tests/vectors/cv.txt", check_line) > 100);
    set_as_hosts_do();
    CHECK(each_vector(argc > 1 ? argv[1] : "tests/vectors/cv.txt", check_line) > 100);
    return report("vectors");
}
