/* Optimal MIS gradients with momentum: nf_gradient_*(). */
#include "check.h"

#define TECHNIQUES 3
#define BATCH 9
#define PARAMETERS 601
#define ITEMS 1000

static float pdf[BATCH * TECHNIQUES], gradient[BATCH * PARAMETERS], estimate[PARAMETERS], again[PARAMETERS];
static uint32_t technique[BATCH];

static void fill(uint64_t seed)
{
    uint32_t i;
    fill_uniform(pdf, BATCH * TECHNIQUES, seed);
    for (i = 0; i < BATCH * TECHNIQUES; ++i)
        pdf[i] = (pdf[i] + 0.1f) / ITEMS;
    fill_uniform(gradient, BATCH * PARAMETERS, seed + 1);
    for (i = 0; i < BATCH; ++i)
        technique[i] = i % TECHNIQUES;
}

static nf_gradient *make(memory *memory_out)
{
    nf_gradient *state = NULL;
    *memory_out = memory_new(nf_gradient_size(TECHNIQUES, PARAMETERS));
    CHECK_STATUS(nf_gradient_init(memory_out->start, memory_out->bytes, TECHNIQUES, PARAMETERS, &state), NF_OK);
    CHECK((void *)state == memory_out->start);
    return state;
}

static nf_status step(nf_gradient *state, uint32_t solver, float beta, float *out)
{
    return nf_gradient_estimate(state, solver, 0.0f, beta, ITEMS, pdf, technique, gradient, BATCH, out);
}

static void normal_use(void)
{
    static const uint32_t solvers[3] = {NF_OMIS_RIDGE, NF_OMIS_PLAIN, NF_OMIS_BALANCE};
    memory m, copy;
    nf_gradient *state = make(&m), *moved;
    float weight[BATCH];
    uint32_t k, s;
    fill(1);
    for (k = 0; k < 3; ++k) {
        double sum = 0.0, size = 0.0;
        CHECK_STATUS(nf_omis_weights(solvers[k], 0.0f, TECHNIQUES, ITEMS, pdf, technique, BATCH, weight), NF_OK);
        CHECK_STATUS(step(state, solvers[k], 0.0f, estimate), NF_OK);
        for (s = 0; s < BATCH; ++s) {
            sum += (double)weight[s] * (double)gradient[s * PARAMETERS] / BATCH;
            size += fabs((double)weight[s]) / BATCH;
        }
        CHECK(fabs((double)estimate[0] - sum) < 1e-5 * size);
    }
    /* Made anew, the first estimate is that without momentum, and a ridge of 0 the usual 2. */
    CHECK_STATUS(step(state, NF_OMIS_RIDGE, 0.0f, again), NF_OK);
    CHECK_STATUS(nf_gradient_init(m.start, m.bytes, TECHNIQUES, PARAMETERS, &state), NF_OK);
    CHECK_STATUS(nf_gradient_estimate(state, NF_OMIS_RIDGE, 2.0f, 0.7f, ITEMS, pdf, technique, gradient, BATCH,
                                      estimate), NF_OK);
    CHECK(memcmp(estimate, again, sizeof estimate) == 0);

    /* A copy of the bytes goes on as the original does, which the batch before still counts for. */
    copy = memory_new(m.bytes);
    memcpy(copy.start, m.start, m.bytes);
    moved = (nf_gradient *)copy.start;
    fill(99);
    CHECK_STATUS(step(state, NF_OMIS_PLAIN, 0.5f, estimate), NF_OK);
    CHECK_STATUS(step(moved, NF_OMIS_PLAIN, 0.5f, again), NF_OK);
    CHECK(memcmp(estimate, again, sizeof estimate) == 0);
    CHECK(memcmp(copy.start, m.start, m.bytes) == 0);
    CHECK_STATUS(step(state, NF_OMIS_PLAIN, 0.0f, again), NF_OK);
    CHECK(memcmp(estimate, again, sizeof estimate) != 0);
    memory_free(&m);
    memory_free(&copy);
}

static void sizes_and_init(void)
{
    const size_t bytes = nf_gradient_size(2, 5);
    memory m = memory_new(bytes);
    nf_gradient *out;
    uint32_t j;
    CHECK(nf_gradient_size(0, 1) == 0 && nf_gradient_size(17, 1) == 0 && nf_gradient_size(1, 0) == 0);
    for (j = 1; j <= 16; ++j)
        CHECK(nf_gradient_size(j, 1001) - nf_gradient_size(j, 1) == 4000 * ((size_t)j + 1));
    if (sizeof(size_t) == 4)
        CHECK(nf_gradient_size(16, UINT32_MAX) == 0);
    CHECK_REFUSED(nf_gradient_init(NULL, bytes, 2, 5, &out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_gradient_init(m.start, bytes, 2, 5, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_gradient_init(m.start, bytes - 1, 2, 5, &out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_gradient_init(m.start, bytes, 2, UINT32_MAX, &out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_gradient_init((char *)m.start + 4, bytes, 2, 5, &out), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_gradient_init(m.start, bytes, 0, 5, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_gradient_init(m.start, bytes, 17, 5, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_gradient_init(m.start, bytes, 2, 0, &out), NF_ERR_RANGE, out);
    CHECK(is_poisoned(m.start, bytes));
    memory_free(&m);
}

static nf_status any(void *object) { return step((nf_gradient *)object, NF_OMIS_RIDGE, 0.0f, estimate); }

/* Bytes of another build of the library, which may mean something else by them. */
static void another_build(void)
{
    memory m;
    check_other_builds(make(&m), "nf_grad\x01", any);
    memory_free(&m);
}

/* Whatever is refused leaves every byte as it was. */
static void errors(void)
{
    memory m, before;
    nf_gradient *state = make(&m), *odd = (nf_gradient *)misaligned(m.start);
    const float bad[3] = {not_a_number(), infinity_f(), -0.5f};
    uint32_t k;
    float kept;
    fill(7);
    CHECK_STATUS(step(state, NF_OMIS_RIDGE, 0.7f, estimate), NF_OK);
    before = memory_new(m.bytes);
    memcpy(before.start, m.start, m.bytes);
#define ESTIMATE(state, solver, ridge, beta, items, pdf, technique, gradient, batch) \
    nf_gradient_estimate(state, solver, ridge, beta, items, pdf, technique, gradient, batch, estimate)
#define REFUSED(call, status) CHECK_REFUSED(call, status, estimate)
    REFUSED(ESTIMATE(NULL, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_NULL);
    REFUSED(ESTIMATE(odd, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_ALIGNMENT);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, NULL, technique, gradient, BATCH), NF_ERR_NULL);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, pdf, NULL, gradient, BATCH), NF_ERR_NULL);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, pdf, technique, NULL, BATCH), NF_ERR_NULL);
    CHECK_STATUS(step(state, NF_OMIS_RIDGE, 0.7f, NULL), NF_ERR_NULL);
    CHECK_STATUS(step(state, NF_OMIS_RIDGE, 0.7f, (float *)misaligned(estimate)), NF_ERR_ALIGNMENT);
    REFUSED(ESTIMATE(state, 4, 0.0f, 0.7f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_RANGE);
    REFUSED(ESTIMATE(state, NF_OMIS_PROGRESSIVE, 0.0f, 0.7f, ITEMS, pdf, technique, gradient, BATCH),
            NF_ERR_UNSUPPORTED);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 1e9f, 0.7f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_RANGE);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, bad[0], 0.7f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_NOT_FINITE);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, -0.1f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_RANGE);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 1.1f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_RANGE);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, bad[0], ITEMS, pdf, technique, gradient, BATCH), NF_ERR_NOT_FINITE);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, 0, pdf, technique, gradient, BATCH), NF_ERR_RANGE);
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, pdf, technique, gradient, 0), NF_ERR_NO_SAMPLES);
    technique[4] = TECHNIQUES;
    REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_RANGE);
    technique[4] = 1;
    for (k = 0; k < 3; ++k) {
        const nf_status expected = k < 2 ? NF_ERR_NOT_FINITE : NF_ERR_RANGE;
        kept = pdf[5];
        pdf[5] = bad[k];
        REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, pdf, technique, gradient, BATCH), expected);
        pdf[5] = kept;
        /* The very last gradient: all others have been seen by then. */
        kept = gradient[BATCH * PARAMETERS - 1];
        gradient[BATCH * PARAMETERS - 1] = k < 2 ? bad[k] : 1e38f;
        REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, 1, pdf, technique, gradient, BATCH), expected);
        gradient[BATCH * PARAMETERS - 1] = kept;
    }
    CHECK(memcmp(before.start, m.start, m.bytes) == 0);
    for (k = 0; k < 2; ++k) {
        memset(m.start, k == 0 ? 0 : POISON, m.bytes);
        REFUSED(ESTIMATE(state, NF_OMIS_RIDGE, 0.0f, 0.7f, ITEMS, pdf, technique, gradient, BATCH), NF_ERR_STATE);
    }
    memory_free(&m);
    memory_free(&before);
}

int main(void)
{
    normal_use();
    sizes_and_init();
    errors();
    another_build();
    return report("gradient");
}
