/* Minibatches: what noisefloor does. */
#ifndef FIT_POLYNOMIAL_SAMPLER_H
#define FIT_POLYNOMIAL_SAMPLER_H

#include "regression.h"

enum importance { NO_IMPORTANCE, ABSOLUTE_RESIDUAL, SIGNED_RESIDUAL, SIGNED_DERIVATIVES };

typedef struct method {
    const char *name;
    uint32_t tables; /* 0: none */
    enum importance importance;
    uint32_t solver;
    int explicit_gradients; /* nf_gradient_estimate, which has the momentum --beta */
} method;

/* balance2 and balance4 draw from the tables of omis2 and omis4. */
static const method METHODS[] = {
    {"exact", 0, NO_IMPORTANCE, 0, 0}, /* Not a minibatch, but the mean over all items. */
    {"uniform", 0, NO_IMPORTANCE, 0, 0},
    {"is", 1, ABSOLUTE_RESIDUAL, 0, 0},
    {"balance2", 2, SIGNED_RESIDUAL, NF_OMIS_BALANCE, 0},
    {"balance4", 4, SIGNED_DERIVATIVES, NF_OMIS_BALANCE, 0},
    {"omis2", 2, SIGNED_RESIDUAL, NF_OMIS_RIDGE, 0},
    {"omis4", 4, SIGNED_DERIVATIVES, NF_OMIS_RIDGE, 0},
    {"omis4-beta", 4, SIGNED_DERIVATIVES, NF_OMIS_RIDGE, 1},
};
enum { EXACT, UNIFORM, METHOD_COUNT = sizeof METHODS / sizeof METHODS[0] };

static int is_run(const method *m, const options *o)
{
    return !m->explicit_gradients || o->beta > 0.0;
}

typedef struct sampler {
    const method *method;
    const options *options;
    nf_rng rng;
    uint64_t shuffle;  /* seed of the permutations */
    uint64_t position; /* in them, one after the other */
    int started;       /* The tables are in use: the initial epoch is over. */
    nf_table tables[MAX_TABLES];
    void *memory[MAX_TABLES];
    size_t bytes;
    float *initial[MAX_TABLES]; /* importances that the initial epoch saw, [items] each */
    nf_gradient *gradient;      /* of explicit_gradients */
    void *gradient_memory;
    uint32_t index[MAX_BATCH], technique[MAX_BATCH];
    float weight[MAX_BATCH], pdf[MAX_BATCH * MAX_TABLES], gradients[MAX_BATCH * TERMS];
    int weighted; /* `weight` holds weights; otherwise `pdf` holds what nf_gradient_estimate makes them from. */
} sampler;

static void sampler_start(sampler *s, const method *m, const options *o, uint32_t seed)
{
    memset(s, 0, sizeof *s);
    s->method = m;
    s->options = o;
    nf_rng_seed(&s->rng, 0x100000u + (uint64_t)seed);
    s->shuffle = (uint64_t)seed << 32;
    s->bytes = nf_table_size(o->items);
    for (uint32_t j = 0; j < m->tables; ++j) {
        s->memory[j] = allocate(s->bytes);
        s->initial[j] = allocate(o->items * sizeof(float));
    }
    if (m->explicit_gradients) {
        size_t bytes = nf_gradient_size(m->tables, TERMS);
        s->gradient_memory = allocate(bytes);
        check(nf_gradient_init(s->gradient_memory, bytes, m->tables, TERMS, &s->gradient), "nf_gradient_init");
    }
}

static void sampler_end(sampler *s)
{
    for (uint32_t j = 0; j < MAX_TABLES; ++j) {
        free(s->memory[j]);
        free(s->initial[j]);
    }
    free(s->gradient_memory);
}

/* q of one item for each table, from the derivatives of its loss.
 *
 * SIGNED_RESIDUAL splits the derivative by the output in two. SIGNED_DERIVATIVES does so with the derivatives by the
 * coefficients, those of even powers (group 0) apart from those of odd powers (group 1): differences of the four
 * densities are then r(x) e(x) and r(x) o(x), an even and an odd profile, and every derivative r(x) x^k is nearly a
 * multiple of one of them. What optimal MIS can write with the densities, it integrates without noise. */
static void importances(const method *m, const float *gradient, float *q)
{
    const float output = gradient[0], zero = 0.0f; /* The derivative by the constant is that by the output. */
    nf_status status = NF_OK;
    switch (m->importance) {
    case NO_IMPORTANCE:
        break;
    case ABSOLUTE_RESIDUAL: {
        const float error = 0.5f * output;
        status = nf_importance_squared_error(&error, &zero, 1, 1, q);
        break;
    }
    case SIGNED_RESIDUAL:
        status = nf_importance_gradient(&output, 1, 1, NF_NODES_SIGN, m->tables, q);
        break;
    case SIGNED_DERIVATIVES:
        status = nf_importance_gradient(gradient, 1, TERMS, NF_NODES_SIGN, m->tables, q);
        break;
    }
    check(status, "importances");
}

static void draw_batch(sampler *s)
{
    const uint32_t batch = s->options->batch, items = s->options->items, tables = s->method->tables;
    s->weighted = 1;
    if (!s->started) { /* The initial epoch, and uniform sampling: without replacement, all weights 1. */
        for (uint32_t k = 0; k < batch; ++k, ++s->position) {
            uint64_t epoch = s->position / items;
            check(nf_shuffle(s->shuffle + epoch, items, s->position, 1, &s->index[k]), "nf_shuffle");
            s->weight[k] = 1.0f;
        }
        return;
    }
    if (tables == 1) {
        check(nf_table_draw(&s->tables[0], &s->rng, batch, s->index, s->weight), "nf_table_draw");
        return;
    }
    /* The same number from each table. */
    const uint32_t each = batch / tables;
    for (uint32_t j = 0; j < tables; ++j) {
        check(nf_table_draw(&s->tables[j], &s->rng, each, s->index + j * each, NULL), "nf_table_draw");
        for (uint32_t k = j * each; k < (j + 1) * each; ++k)
            s->technique[k] = j;
    }
    for (uint32_t j = 0; j < tables; ++j)
        check(nf_table_probabilities(&s->tables[j], s->index, batch, tables, s->pdf + j), "nf_table_probabilities");
    s->weighted = !s->method->explicit_gradients;
    if (s->weighted)
        check(nf_omis_weights(s->method->solver, 0.0f, tables, items, s->pdf, s->technique, batch, s->weight),
              "nf_omis_weights");
}

/* The gradient's estimate from the batch. */
static void estimate_gradient(sampler *s, const problem *p, const double *coefficients, double *estimate)
{
    const uint32_t batch = s->options->batch;
    memset(estimate, 0, TERMS * sizeof *estimate);
    for (uint32_t k = 0; k < batch; ++k) {
        float *gradient = s->gradients + k * TERMS;
        item_gradient(p, coefficients, s->index[k], gradient);
        if (s->weighted)
            for (int j = 0; j < TERMS; ++j)
                estimate[j] += (double)s->weight[k] * gradient[j] / batch;
    }
    if (!s->weighted) {
        float sums[TERMS];
        check(nf_gradient_estimate(s->gradient, s->method->solver, 0.0f, (float)s->options->beta, p->items, s->pdf,
                                   s->technique, s->gradients, batch, sums),
              "nf_gradient_estimate");
        for (int j = 0; j < TERMS; ++j)
            estimate[j] = sums[j];
    }
}

static void start_tables(sampler *s)
{
    for (uint32_t j = 0; j < s->method->tables; ++j) {
        /* Where no residual has the table's sign, it has nothing to draw by: it is uniform until a visit finds one. */
        float largest = 0.0f;
        for (uint32_t i = 0; i < s->options->items; ++i)
            largest = fmaxf(largest, s->initial[j][i]);
        for (uint32_t i = 0; largest == 0.0f && i < s->options->items; ++i)
            s->initial[j][i] = 1e-20f;
        check(nf_table_init(&s->tables[j], s->memory[j], s->bytes, s->options->items, s->initial[j]), "nf_table_init");
        s->tables[j].uniform_fraction = (float)s->options->uniform_fraction;
    }
    s->started = 1;
}

/* The importance of the batch's items is known now, at no cost; that of all others stays what it was. */
static void update_tables(sampler *s)
{
    const uint32_t batch = s->options->batch, tables = s->method->tables;
    float q[MAX_BATCH * MAX_TABLES]; /* table by table */
    for (uint32_t k = 0; k < batch; ++k) {
        float of_item[MAX_TABLES] = {0};
        importances(s->method, s->gradients + k * TERMS, of_item);
        for (uint32_t j = 0; j < tables; ++j) {
            q[j * batch + k] = of_item[j];
            if (!s->started)
                s->initial[j][s->index[k]] = of_item[j];
        }
    }
    for (uint32_t j = 0; s->started && j < tables; ++j)
        check(nf_table_update(&s->tables[j], s->index, q + j * batch, batch, (float)s->options->momentum),
              "nf_table_update");
    if (!s->started && tables > 0 && s->position >= s->options->items) /* All items have been seen. */
        start_tables(s);
}

#endif
