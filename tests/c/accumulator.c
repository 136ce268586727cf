/* Streaming: nf_cv_accumulator_*(). */
#include "check.h"

#define N 96
static float u[N * 2], f[N * 2], h[N];
/* All estimators but leave-one-out, which needs all samples at once. */
static const uint32_t streaming[] = {NF_CV_ROBUST, NF_CV_LEAST_SQUARES, NF_CV_K_FOLD, NF_CV_GRADIENT_DESCENT,
                                     NF_CV_INCREMENTAL};
#define STREAMING (sizeof streaming / sizeof *streaming)

static nf_status add_controlled(nf_cv_accumulator *accumulator, const float *pu, const float *pf, const float *h,
                                const float *integral, size_t n)
{
    nf_cv_samples samples = samples_of(pu, pf, n);
    samples.controls = h;
    samples.control_integrals = integral;
    return nf_cv_accumulator_add(accumulator, &samples);
}

typedef struct stream {
    memory state, work;
    nf_cv_accumulator *accumulator;
} stream;

static stream stream_new(const nf_cv_config *config)
{
    stream s;
    s.state = memory_new(nf_cv_accumulator_size(config, NULL));
    s.work = memory_new(accumulator_workspace_size(config));
    s.accumulator = NULL;
    CHECK(s.state.bytes > 0 && s.work.bytes > 0);
    CHECK_STATUS(nf_cv_accumulator_init(s.state.start, s.state.bytes, config, &s.accumulator), NF_OK);
    CHECK((void *)s.accumulator == s.state.start);
    return s;
}

static void stream_free(stream *s)
{
    memory_free(&s->state);
    memory_free(&s->work);
}

static nf_estimate estimate(const stream *s)
{
    nf_estimate out;
    poison(&out, sizeof out);
    CHECK_STATUS(nf_cv_accumulator_estimate(s->accumulator, s->work.start, s->work.bytes, &out), NF_OK);
    return out;
}

static void normal_use(uint32_t precision)
{
    nf_cv_config config = make_config(2, 2, 2, NF_CV_ROBUST);
    stream all, moved, half;
    nf_estimate a, whole;
    config.precision = precision;
    all = stream_new(&config);
    moved = stream_new(&config);
    half = stream_new(&config);
    CHECK_STATUS(add_samples(all.accumulator, u, f, N), NF_OK);
    whole = estimate(&all);
    CHECK(whole.samples == N && whole.mean[2] == 0.0f && whole.std_error[3] == 0.0f);

    /* Moved as bytes between calls. */
    memcpy(moved.state.start, all.state.start, moved.state.bytes);
    a = estimate(&moved);
    CHECK(memcmp(&a, &whole, sizeof a) == 0);

    /* Merged into another, it stays as it is. */
    CHECK_STATUS(add_samples(half.accumulator, u, f, N / 2), NF_OK);
    CHECK_STATUS(nf_cv_accumulator_merge(half.accumulator, all.accumulator), NF_OK);
    a = estimate(&all);
    CHECK(memcmp(&a, &whole, sizeof a) == 0);
    a = estimate(&half);
    CHECK(a.samples == N + N / 2);

    /* Made anew in the same memory: empty. */
    CHECK_STATUS(nf_cv_accumulator_init(all.state.start, all.state.bytes, &config, &all.accumulator), NF_OK);
    CHECK_REFUSED(nf_cv_accumulator_estimate(all.accumulator, all.work.start, all.work.bytes, &a), NF_ERR_NO_SAMPLES,
                  a);
    CHECK_STATUS(add_samples(all.accumulator, u, f, N), NF_OK);
    a = estimate(&all);
    CHECK(memcmp(&a, &whole, sizeof a) == 0);
    stream_free(&all);
    stream_free(&moved);
    stream_free(&half);
}

static void init_errors(void)
{
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    const size_t bytes = nf_cv_accumulator_size(&config, NULL);
    memory state = memory_new(bytes);
    nf_cv_accumulator *out;
    size_t scratch[2];
    CHECK(nf_cv_accumulator_size(&config, (size_t *)misaligned(scratch)) == 0);
    CHECK_REFUSED(nf_cv_accumulator_init(NULL, bytes, &config, &out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_cv_accumulator_init(state.start, bytes, NULL, &out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_cv_accumulator_init(state.start, bytes, &config, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_cv_accumulator_init(state.start, bytes - 1, &config, &out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_cv_accumulator_init(state.start, 0, &config, &out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_cv_accumulator_init((char *)state.start + 4, bytes, &config, &out), NF_ERR_ALIGNMENT, out);
    config.estimator = NF_CV_LEAVE_ONE_OUT;
    CHECK(nf_cv_accumulator_size(&config, NULL) == 0 && accumulator_workspace_size(&config) == 0);
    CHECK_REFUSED(nf_cv_accumulator_init(state.start, bytes, &config, &out), NF_ERR_UNSUPPORTED, out);
    config.estimator = NF_CV_ROBUST;
    config.solver = NF_SOLVER_DUAL;
    CHECK(nf_cv_accumulator_size(&config, NULL) == 0);
    CHECK_REFUSED(nf_cv_accumulator_init(state.start, bytes, &config, &out), NF_ERR_UNSUPPORTED, out);
    config.solver = NF_SOLVER_SQUARE_ROOT;
    CHECK_REFUSED(nf_cv_accumulator_init(state.start, bytes, &config, &out), NF_ERR_UNSUPPORTED, out);
    /* A refusal leaves even the memory as it was. */
    CHECK(is_poisoned(state.start, bytes));
    CHECK(nf_cv_accumulator_size(NULL, NULL) == 0 && accumulator_workspace_size(NULL) == 0);
    memory_free(&state);
}

/* Memory that holds no accumulator, or none any more. */
static void no_object(void)
{
    nf_cv_config config = make_config(2, 2, 2, NF_CV_ROBUST);
    stream good = stream_new(&config);
    memory bad = memory_new(good.state.bytes);
    nf_cv_accumulator *wrong = (nf_cv_accumulator *)bad.start, *odd = (nf_cv_accumulator *)misaligned(good.state.start);
    nf_estimate out;
    int pass;
    for (pass = 0; pass < 2; ++pass) {
        CHECK_STATUS(add_samples(wrong, u, f, N), NF_ERR_STATE);
        CHECK_STATUS(nf_cv_accumulator_merge(wrong, good.accumulator), NF_ERR_STATE);
        CHECK_STATUS(nf_cv_accumulator_merge(good.accumulator, wrong), NF_ERR_STATE);
        CHECK_REFUSED(nf_cv_accumulator_estimate(wrong, good.work.start, good.work.bytes, &out), NF_ERR_STATE, out);
        memset(bad.start, 0, bad.bytes);
    }
    CHECK_STATUS(add_samples(NULL, u, f, N), NF_ERR_NULL);
    CHECK_STATUS(nf_cv_accumulator_merge(NULL, good.accumulator), NF_ERR_NULL);
    CHECK_STATUS(nf_cv_accumulator_merge(good.accumulator, NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_cv_accumulator_merge(NULL, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_cv_accumulator_estimate(NULL, good.work.start, good.work.bytes, &out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_cv_accumulator_add(good.accumulator, NULL), NF_ERR_NULL);
    CHECK_STATUS(add_samples(odd, u, f, N), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_cv_accumulator_merge(odd, good.accumulator), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_cv_accumulator_merge(good.accumulator, odd), NF_ERR_ALIGNMENT);
    CHECK_REFUSED(nf_cv_accumulator_estimate(odd, good.work.start, good.work.bytes, &out), NF_ERR_ALIGNMENT, out);
    memory_free(&bad);
    stream_free(&good);
}

static nf_status add_one(void *object) { return add_samples((nf_cv_accumulator *)object, u, f, 1); }

/* Bytes of another build of the library, which may mean something else by them. */
static void another_build(void)
{
    uint32_t precision;
    for (precision = 0; precision < 2; ++precision) {
        nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
        stream s;
        config.precision = precision;
        s = stream_new(&config);
        check_other_builds(s.accumulator, "nf_cvac1", add_one);
        stream_free(&s);
    }
}

/* Whatever is refused leaves every byte of the accumulator as it was, and the accumulator usable. */
static void refused_calls_change_nothing(uint32_t estimator)
{
    nf_cv_config config = make_config(2, 2, 2, estimator), others[6];
    /* The twin is never given a refused call. */
    stream s = stream_new(&config), twin = stream_new(&config);
    nf_estimate first, out;
    float saved;
    size_t i, n;
    CHECK_REFUSED(nf_cv_accumulator_estimate(s.accumulator, s.work.start, s.work.bytes, &out), NF_ERR_NO_SAMPLES, out);
    CHECK_STATUS(add_samples(s.accumulator, u, f, 50), NF_OK);
    CHECK_STATUS(add_samples(twin.accumulator, u, f, 50), NF_OK);
    first = estimate(&s);

    CHECK_STATUS(add_samples(s.accumulator, NULL, f, N), NF_ERR_NULL);
    CHECK_STATUS(add_samples(s.accumulator, u, NULL, N), NF_ERR_NULL);
    CHECK_STATUS(add_samples(s.accumulator, (const float *)misaligned(u), f, 1), NF_ERR_ALIGNMENT);
    CHECK_STATUS(add_samples(s.accumulator, u, f, 0), NF_ERR_NO_SAMPLES);
    for (n = SIZE_MAX; n > SIZE_MAX / 65536; n /= 4)
        CHECK_STATUS(add_samples(s.accumulator, u, f, n), NF_ERR_RANGE);
    saved = f[2 * N - 1];
    f[2 * N - 1] = not_a_number();
    CHECK_STATUS(add_samples(s.accumulator, u, f, N), NF_ERR_NOT_FINITE);
    f[2 * N - 1] = saved;
    saved = u[2 * N - 1];
    u[2 * N - 1] = -1.0f;
    CHECK_STATUS(add_samples(s.accumulator, u, f, N), NF_ERR_RANGE);
    u[2 * N - 1] = infinity_f();
    CHECK_STATUS(add_samples(s.accumulator, u, f, N), NF_ERR_NOT_FINITE);
    u[2 * N - 1] = saved;

    CHECK_STATUS(nf_cv_accumulator_merge(s.accumulator, s.accumulator), NF_ERR_RANGE);
    for (i = 0; i < 6; ++i)
        others[i] = config;
    others[0].order = 3;
    others[1].precision = NF_PRECISION_F32;
    others[2].channels = 1;
    others[3].ridge = 0.5f;
    others[4].estimator = estimator == NF_CV_ROBUST ? NF_CV_K_FOLD : NF_CV_ROBUST;
    others[5].basis = NF_BASIS_SINE;
    for (i = 0; i < 6; ++i) {
        stream other = stream_new(&others[i]);
        CHECK_STATUS(add_samples(other.accumulator, u, f, 20), NF_OK);
        CHECK_STATUS(nf_cv_accumulator_merge(s.accumulator, other.accumulator), NF_ERR_MISMATCH);
        stream_free(&other);
    }

    CHECK_REFUSED(nf_cv_accumulator_estimate(s.accumulator, NULL, s.work.bytes, &out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_cv_accumulator_estimate(s.accumulator, s.work.start, s.work.bytes - 1, &out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_cv_accumulator_estimate(s.accumulator, (char *)s.work.start + 4, s.work.bytes, &out),
                  NF_ERR_ALIGNMENT, out);
    CHECK_STATUS(nf_cv_accumulator_estimate(s.accumulator, s.work.start, s.work.bytes, NULL), NF_ERR_NULL);

    out = estimate(&s);
    CHECK(memcmp(&first, &out, sizeof out) == 0);
    CHECK_STATUS(add_samples(s.accumulator, u + 100, f + 100, N - 50), NF_OK);
    CHECK_STATUS(add_samples(twin.accumulator, u + 100, f + 100, N - 50), NF_OK);
    out = estimate(&s);
    first = estimate(&twin);
    CHECK(out.samples == N && memcmp(&first, &out, sizeof out) == 0);
    stream_free(&s);
    stream_free(&twin);
}

static void controls(void)
{
    nf_cv_config config = make_config(2, 1, 1, NF_CV_LEAST_SQUARES);
    float integral = 0.25f, bad = infinity_f(), g[N];
    nf_estimate out;
    stream s;
    size_t i;
    for (i = 0; i < N; ++i) {
        h[i] = u[2 * i] * u[2 * i + 1];
        g[i] = 5.0f * h[i];
    }
    config.controls = 1;
    s = stream_new(&config);
    CHECK_STATUS(add_samples(s.accumulator, u, g, N), NF_ERR_NULL);
    CHECK_STATUS(add_controlled(s.accumulator, u, g, NULL, &integral, N), NF_ERR_NULL);
    CHECK_STATUS(add_controlled(s.accumulator, u, g, h, NULL, N), NF_ERR_NULL);
    CHECK_STATUS(add_controlled(s.accumulator, u, g, h, &bad, N), NF_ERR_NOT_FINITE);
    CHECK_STATUS(nf_cv_accumulator_estimate(s.accumulator, s.work.start, s.work.bytes, &out), NF_ERR_NO_SAMPLES);
    CHECK_STATUS(add_controlled(s.accumulator, u, g, h, &integral, N), NF_OK);
    out = estimate(&s);
    CHECK(fabsf(out.mean[0] - 1.25f) < 1e-3f);
    stream_free(&s);
}

static void skipping(void)
{
    nf_cv_config config = make_config(2, 2, 2, NF_CV_ROBUST);
    const float saved = f[7];
    stream s;
    config.nonfinite = NF_NONFINITE_SKIP;
    s = stream_new(&config);
    f[7] = not_a_number();
    CHECK_STATUS(add_samples(s.accumulator, u, f, N), NF_OK);
    f[7] = saved;
    CHECK(estimate(&s).samples == N - 1);
    stream_free(&s);
}

int main(void)
{
    size_t i;
    fill_uniform(u, N * 2, 17);
    fill_linear(f, u, N, 2, 2);
    for (i = 0; i < STREAMING; ++i)
        refused_calls_change_nothing(streaming[i]);
    normal_use(NF_PRECISION_F64);
    normal_use(NF_PRECISION_F32);
    init_errors();
    no_object();
    another_build();
    controls();
    skipping();
    return report("accumulator");
}
