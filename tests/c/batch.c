/* Estimates from arrays: nf_cv_estimate(), nf_cv_gradient_descent(). */
#include "check.h"

#define N 64
static float u[N * 4], f[N * 4];
static const uint32_t estimators = 6;
static nf_cv_descent steps; /* by default */

/* The pointers, the workspace and the samples, for one function. */
typedef nf_status (*estimate_function)(const nf_cv_config *, const float *, const float *, size_t, void *, size_t,
                                       nf_estimate *);
static float start[64];
static nf_status descent(const nf_cv_config *c, const float *pu, const float *pf, size_t n, void *w, size_t b,
                         nf_estimate *out)
{
    nf_status status;
    float before[64];
    memcpy(before, start, sizeof start);
    status = descend(c, pu, pf, n, &steps, start, w, b, out);
    if (status != NF_OK)
        CHECK(memcmp(before, start, sizeof start) == 0);
    return status;
}

static void errors(estimate_function call, uint32_t estimator)
{
    static const size_t huge[] = {SIZE_MAX,     SIZE_MAX - 1, SIZE_MAX / 2,  SIZE_MAX / 2 + 1, SIZE_MAX / 3,
                                  SIZE_MAX / 4, SIZE_MAX / 8, SIZE_MAX / 16, SIZE_MAX / 256,   SIZE_MAX / 65536};
    nf_cv_config config = make_config(2, 2, 1, estimator);
    memory work;
    nf_estimate out;
    float saved;
    size_t i, bytes;
    fill_linear(f, u, N, 2, 1);
    bytes = nf_cv_workspace_size(&config, N);
    work = memory_new(bytes);

    CHECK_STATUS(call(&config, u, f, N, work.start, bytes, &out), NF_OK);
    CHECK(memory_is_intact(&work));
    CHECK_REFUSED(call(NULL, u, f, N, work.start, bytes, &out), NF_ERR_NULL, out);
    CHECK_REFUSED(call(&config, NULL, f, N, work.start, bytes, &out), NF_ERR_NULL, out);
    CHECK_REFUSED(call(&config, u, NULL, N, work.start, bytes, &out), NF_ERR_NULL, out);
    CHECK_REFUSED(call(&config, u, f, N, NULL, bytes, &out), NF_ERR_NULL, out);
    CHECK_STATUS(call(&config, u, f, N, work.start, bytes, NULL), NF_ERR_NULL);
    CHECK_REFUSED(call(&config, u, f, 0, work.start, bytes, &out), NF_ERR_NO_SAMPLES, out);
    CHECK_REFUSED(call(&config, u, f, N, work.start, bytes - 1, &out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(call(&config, u, f, N, work.start, 0, &out), NF_ERR_MEMORY, out);
    for (i = 1; i < 8; ++i)
        CHECK_REFUSED(call(&config, u, f, N, (char *)work.start + i, bytes - i, &out), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(call(&config, (const float *)misaligned(u), f, N, work.start, bytes, &out), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(call(&config, u, (const float *)misaligned(f), N, work.start, bytes, &out), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(call((const nf_cv_config *)misaligned(&config), u, f, N, work.start, bytes, &out), NF_ERR_ALIGNMENT,
                  out);

    /* Counts that no array can have, or that the workspace is much too small for: nothing is read. */
    for (i = 0; i < sizeof huge / sizeof *huge; ++i) {
        nf_status status;
        poison(&out, sizeof out);
        status = call(&config, u, f, huge[i], work.start, bytes, &out);
        CHECK(status == NF_ERR_RANGE || status == NF_ERR_MEMORY);
        CHECK(is_poisoned(&out, sizeof out));
    }
    if (estimator != NF_CV_INCREMENTAL)
        CHECK(nf_cv_workspace_size(&config, SIZE_MAX / 2) == 0);

    for (i = 0; i < 2 * N; i += 2 * N - 1) {
        saved = u[i];
        u[i] = not_a_number();
        CHECK_REFUSED(call(&config, u, f, N, work.start, bytes, &out), NF_ERR_NOT_FINITE, out);
        u[i] = infinity_f();
        CHECK_REFUSED(call(&config, u, f, N, work.start, bytes, &out), NF_ERR_NOT_FINITE, out);
        u[i] = -1e-6f;
        CHECK_REFUSED(call(&config, u, f, N, work.start, bytes, &out), NF_ERR_RANGE, out);
        u[i] = 1.00001f;
        CHECK_REFUSED(call(&config, u, f, N, work.start, bytes, &out), NF_ERR_RANGE, out);
        u[i] = saved;
    }
    for (i = 0; i < N; i += N - 1) {
        saved = f[i];
        f[i] = not_a_number();
        CHECK_NAN_REFUSED(call(&config, u, f, N, work.start, bytes, &out), out);
        f[i] = -infinity_f();
        CHECK_REFUSED(call(&config, u, f, N, work.start, bytes, &out), NF_ERR_NOT_FINITE, out);
        config.nonfinite = NF_NONFINITE_SKIP;
        CHECK_STATUS(call(&config, u, f, N, work.start, bytes, &out), NF_OK);
        CHECK(out.samples == N - 1 && isfinite(out.mean[0]));
        config.nonfinite = NF_NONFINITE_ERROR;
        f[i] = saved;
    }
    /* All skipped: nothing is left. */
    config.nonfinite = NF_NONFINITE_SKIP;
    for (i = 0; i < N; ++i)
        f[i] = not_a_number();
    CHECK_REFUSED(call(&config, u, f, N, work.start, bytes, &out), NF_ERR_NO_SAMPLES, out);
    memory_free(&work);
}

static void combinations(void)
{
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    memory work = memory_new(1 << 20);
    nf_estimate out;
    fill_linear(f, u, N, 2, 1);
    config.solver = NF_SOLVER_SQUARE_ROOT;
    CHECK(nf_cv_workspace_size(&config, N) == 0);
    CHECK_REFUSED(estimate_one(&config, u, f, N, work.start, work.bytes, &out), NF_ERR_UNSUPPORTED, out);
    config.estimator = NF_CV_LEAST_SQUARES;
    config.ridge = NF_RIDGE_AUTO;
    CHECK_REFUSED(estimate_one(&config, u, f, N, work.start, work.bytes, &out), NF_ERR_UNSUPPORTED, out);
    config = make_config(2, 2, 1, NF_CV_ROBUST);
    config.solver = NF_SOLVER_DUAL;
    config.controls = 1;
    CHECK(nf_cv_workspace_size(&config, N) == 0);
    CHECK_REFUSED(estimate_controlled(&config, u, f, f, u, N, work.start, work.bytes, &out),
                  NF_ERR_UNSUPPORTED, out);
    config.controls = 0;
    CHECK(nf_cv_workspace_size(&config, 4096) > 0);
    CHECK(nf_cv_workspace_size(&config, 4097) == 0);
    config.estimator = NF_CV_GRADIENT_DESCENT; /* which solves nothing */
    CHECK(nf_cv_workspace_size(&config, 4097) > 0);
#if SIZE_MAX > UINT32_MAX
    CHECK(nf_cv_workspace_size(&config, (size_t)UINT32_MAX + 1) == 0);
    CHECK_REFUSED(estimate_one(&config, u, f, (size_t)UINT32_MAX + 1, work.start, work.bytes, &out), NF_ERR_RANGE,
                  out);
#endif
    config = make_config(2, 2, 2, NF_CV_ROBUST);
    config.color = NF_COLOR_LUMINANCE_RATIO;
    CHECK_REFUSED(estimate_one(&config, u, f, N / 2, work.start, work.bytes, &out), NF_ERR_UNSUPPORTED, out);
    memory_free(&work);
}

/* Ridges that have the bits of others. */
static void ridges(void)
{
    static const struct {
        uint32_t estimator;
        float ridge, same;
    } of[] = {{NF_CV_LEAVE_ONE_OUT, 1e-20f, 1e-13f}, {NF_CV_INCREMENTAL, NF_RIDGE_AUTO, 0.0f}};
    memory work = memory_new(1 << 20);
    nf_estimate out, expected;
    size_t i;
    fill_linear(f, u, N, 2, 1);
    for (i = 0; i < sizeof of / sizeof *of; ++i) {
        nf_cv_config config = make_config(2, 2, 1, of[i].estimator);
        config.ridge = of[i].ridge;
        CHECK_STATUS(estimate_one(&config, u, f, N, work.start, work.bytes, &out), NF_OK);
        config.ridge = of[i].same;
        CHECK_STATUS(estimate_one(&config, u, f, N, work.start, work.bytes, &expected), NF_OK);
        CHECK(memcmp(&out, &expected, sizeof out) == 0);
    }
    memory_free(&work);
}

static void controls(void)
{
    nf_cv_config config = make_config(2, 1, 1, NF_CV_LEAST_SQUARES);
    float h[N], integral = 0.25f, bad = not_a_number(), saved;
    nf_estimate out;
    memory work;
    size_t i;
    /* f = 5 h, h = u0 u1, whose integral is 1/4: order 1 does not contain it, h does. */
    for (i = 0; i < N; ++i) {
        h[i] = u[2 * i] * u[2 * i + 1];
        f[i] = 5.0f * h[i];
    }
    config.controls = 1;
    work = memory_new(nf_cv_workspace_size(&config, N));
    CHECK_STATUS(estimate_controlled(&config, u, f, h, &integral, N, work.start, work.bytes, &out), NF_OK);
    CHECK(fabsf(out.mean[0] - 1.25f) < 1e-4f);
    CHECK_REFUSED(estimate_controlled(&config, u, f, NULL, &integral, N, work.start, work.bytes, &out),
                  NF_ERR_NULL, out);
    CHECK_REFUSED(estimate_controlled(&config, u, f, h, NULL, N, work.start, work.bytes, &out), NF_ERR_NULL,
                  out);
    CHECK_REFUSED(estimate_controlled(&config, u, f, (const float *)misaligned(h), &integral, N, work.start,
                  work.bytes, &out),
                  NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(estimate_controlled(&config, u, f, h, &bad, N, work.start, work.bytes, &out),
                  NF_ERR_NOT_FINITE, out);
    CHECK_REFUSED(estimate_one(&config, u, f, N, work.start, work.bytes, &out), NF_ERR_NULL, out);
    saved = h[3];
    h[3] = infinity_f();
    CHECK_REFUSED(estimate_controlled(&config, u, f, h, &integral, N, work.start, work.bytes, &out),
                  NF_ERR_NOT_FINITE, out);
    h[3] = saved;
    memory_free(&work);
}

/* Many integrals have the bits of single calls; where one is refused, none is written. */
static void many_integrals(void)
{
    enum { INTEGRALS = 8, EACH = N / INTEGRALS };
    uint32_t estimator, stride;
    nf_estimate out[INTEGRALS + 1], one;
    for (estimator = 0; estimator < estimators; ++estimator)
        for (stride = 2; stride < 5; ++stride) {
            nf_cv_config config = make_config(2, 1, 1, estimator);
            memory work;
            float saved;
            size_t i;
            config.stride = stride;
            fill_linear(f, u, N, stride, 1);
            work = memory_new(nf_cv_workspace_size(&config, EACH));
            poison(out, sizeof out);
            CHECK_STATUS(estimate_many(&config, u, f, EACH, INTEGRALS, work.start, work.bytes, out), NF_OK);
            CHECK(is_poisoned(&out[INTEGRALS], sizeof *out) && memory_is_intact(&work));
            for (i = 0; i < INTEGRALS; ++i) {
                CHECK_STATUS(estimate_one(&config, u + i * EACH * stride, f + i * EACH, EACH, work.start, work.bytes,
                             &one), NF_OK);
                CHECK(memcmp(&one, &out[i], sizeof one) == 0);
            }
            poison(out, sizeof out);
            saved = u[(N - 1) * stride + 1];
            u[(N - 1) * stride + 1] = 1.5f;
            CHECK_STATUS(estimate_many(&config, u, f, EACH, INTEGRALS, work.start, work.bytes, out),
                         NF_ERR_RANGE);
            u[(N - 1) * stride + 1] = saved;
            f[N - 1] = infinity_f();
            CHECK_STATUS(estimate_many(&config, u, f, EACH, INTEGRALS, work.start, work.bytes, out),
                         NF_ERR_NOT_FINITE);
            config.nonfinite = NF_NONFINITE_SKIP;
            CHECK_STATUS(estimate_many(&config, u, f, EACH, INTEGRALS, work.start, work.bytes, out),
                         NF_ERR_UNSUPPORTED);
            config.nonfinite = NF_NONFINITE_ERROR;
            config.controls = 1;
            CHECK_STATUS(estimate_many(&config, u, f, EACH, INTEGRALS, work.start, work.bytes, out),
                         NF_ERR_UNSUPPORTED);
            config.controls = 0;
            CHECK_STATUS(estimate_many(&config, u, f, EACH, SIZE_MAX / 2, work.start, work.bytes, out),
                         NF_ERR_RANGE);
            CHECK_STATUS(estimate_many(&config, u, f, EACH, 0, work.start, work.bytes, out), NF_OK);
            config.dims = 99;
            CHECK_STATUS(estimate_many(&config, u, f, EACH, 0, work.start, work.bytes, out), NF_ERR_RANGE);
            CHECK(is_poisoned(out, sizeof out));
            memory_free(&work);
        }
}

/* Samples that are not there, and what is known of an image's. */
static void sample_errors(void)
{
    static const nf_cv_descent odd[] = {{3, 0, 0.0f, 0.0f},     {0, (1u << 20) + 1, 0.0f, 0.0f}, {0, 0, -1.0f, 0.0f},
                                        {0, 0, 0.0f, -0.1f}, {0, 0, 0.0f, 1.0f}};
    nf_cv_config config = make_config(2, 2, 1, NF_CV_GRADIENT_DESCENT);
    nf_cv_samples samples = samples_of(u, f, N);
    memory work = memory_new(nf_cv_workspace_size(&config, N));
    float coefficients[5] = {0};
    nf_estimate out;
    size_t i;
    fill_linear(f, u, N, 2, 1);
    CHECK_REFUSED(nf_cv_estimate(&config, NULL, 1, work.start, work.bytes, &out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_cv_estimate(&config, (const nf_cv_samples *)misaligned(&samples), 1, work.start, work.bytes, &out),
                  NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_cv_gradient_descent(&config, NULL, &steps, coefficients, work.start, work.bytes, &out),
                  NF_ERR_NULL, out);
    CHECK_REFUSED(descend(&config, u, f, N, NULL, coefficients, work.start, work.bytes, &out), NF_ERR_NULL, out);
    for (i = 0; i < sizeof odd / sizeof *odd; ++i) {
        CHECK_REFUSED(descend(&config, u, f, N, &odd[i], coefficients, work.start, work.bytes, &out), NF_ERR_RANGE,
                      out);
        CHECK(nf_check(NF_CHECK_CV_DESCENT, &odd[i]) != NULL);
    }
    CHECK_NAMED(NF_CHECK_CV_DESCENT, &steps, NULL);
    CHECK_NAMED(NF_CHECK_CV_DESCENT, &odd[0], "optimizer must be");
    samples.known = f;
    CHECK_REFUSED(nf_cv_estimate(&config, &samples, 1, work.start, work.bytes, &out), NF_ERR_UNSUPPORTED, out);
    samples.known = NULL;
    samples.known_integrals = f;
    CHECK_REFUSED(nf_cv_estimate(&config, &samples, 1, work.start, work.bytes, &out), NF_ERR_UNSUPPORTED, out);
    memory_free(&work);
}

static void warm_starts(void)
{
    nf_cv_config config = make_config(2, 2, 2, NF_CV_GRADIENT_DESCENT);
    float coefficients[2 * 5], before[2 * 5];
    nf_estimate cold, warm, out;
    memory work = memory_new(nf_cv_workspace_size(&config, N));
    uint32_t optimizer;
    fill_linear(f, u, N, 2, 2);
    for (optimizer = 0; optimizer < 3; ++optimizer) {
        steps.optimizer = optimizer;
        steps.iterations = 0;
        memset(coefficients, 0, sizeof coefficients);
        CHECK_STATUS(descend(&config, u, f, N, &steps, coefficients, work.start, work.bytes, &cold), NF_OK);
        CHECK_STATUS(estimate_one(&config, u, f, N, work.start, work.bytes, &out), NF_OK);
        CHECK((memcmp(&cold, &out, sizeof out) == 0) == (optimizer == NF_OPTIMIZER_MOMENTUM));
        steps.iterations = 400;
        CHECK_STATUS(descend(&config, u, f, N, &steps, coefficients, work.start, work.bytes, &warm), NF_OK);
        /* u = 1/2 + phi_1 / sqrt(12), with the orthonormal phi_1. */
        if (optimizer != NF_OPTIMIZER_ADAM) {
            CHECK(fabsf(warm.mean[0] - 2.0f) < 1e-3f && fabsf(warm.mean[1] - 4.0f) < 2e-3f);
            CHECK(fabsf(coefficients[0] - 0.288675f) < 1e-2f && fabsf(coefficients[5] - 2 * 0.288675f) < 2e-2f);
        }
    }
    CHECK_REFUSED(descend(&config, u, f, N, &steps, NULL, work.start, work.bytes, &out), NF_ERR_NULL, out);
    CHECK_REFUSED(
        descend(&config, u, f, N, &steps, (float *)misaligned(coefficients), work.start, work.bytes, &out),
        NF_ERR_ALIGNMENT, out);
    coefficients[9] = not_a_number();
    memcpy(before, coefficients, sizeof before);
    CHECK_REFUSED(descend(&config, u, f, N, &steps, coefficients, work.start, work.bytes, &out),
                  NF_ERR_NOT_FINITE, out);
    CHECK(memcmp(before, coefficients, sizeof before) == 0);
    coefficients[9] = 0.0f;
    config.estimator = NF_CV_ROBUST;
    CHECK_REFUSED(descend(&config, u, f, N, &steps, coefficients, work.start, work.bytes, &out),
                  NF_ERR_UNSUPPORTED, out);
    config.estimator = NF_CV_GRADIENT_DESCENT;
    config.controls = 1;
    CHECK_REFUSED(descend(&config, u, f, N, &steps, coefficients, work.start, work.bytes, &out),
                  NF_ERR_UNSUPPORTED, out);
    memory_free(&work);
}

int main(void)
{
    uint32_t estimator;
    fill_uniform(u, N * 4, 3);
    for (estimator = 0; estimator < estimators; ++estimator)
        errors(estimate_one, estimator);
    errors(descent, NF_CV_GRADIENT_DESCENT);
    combinations();
    ridges();
    controls();
    many_integrals();
    sample_errors();
    warm_starts();
    CHECK(nf_cv_workspace_size(NULL, N) == 0);
    return report("batch");
}
