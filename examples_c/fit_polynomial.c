/* Figure 6.10 of the thesis: the seven coefficients of a polynomial of order 6, fitted to points of another one by Adam
 * from minibatches of 32, drawn and weighted in several ways. C99.
 *
 *   cc -std=c99 -O3 -Iinclude examples_c/fit_polynomial.c target/noisefloor/libnoisefloor.a -lm -o fit_polynomial
 *   ./fit_polynomial > losses.csv            # method,seed,step,loss; a table on standard error
 *   ./fit_polynomial --variance > errors.csv # state,method,coefficient,error: of the gradient, over uniform sampling's
 *
 * How the library is used: start_tables, draw_batch, update_tables. */
#include "noisefloor.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TERMS 7
#define MAX_TABLES 4
#define MAX_BATCH 1024
#define STATES 4 /* of the network, here the polynomial, at which --variance looks */

static void fail(const char *what, const char *why)
{
    fprintf(stderr, "fit_polynomial: %s: %s\n", what, why);
    exit(1);
}

static void check(nf_status status, const char *what)
{
    if (status != NF_OK)
        fail(what, nf_status_message(status));
}

/* malloc's memory is aligned for anything, and a table asks for 8 bytes. */
static void *allocate(size_t bytes)
{
    void *memory = malloc(bytes > 0 ? bytes : 1);
    if (!memory)
        fail("no memory", "malloc failed");
    return memory;
}

/* ---- command line ---- */

typedef struct options {
    uint32_t items, batch, steps, seeds, batches;
    double rate, noise, uniform_fraction, momentum, beta;
    int variance;
} options;

static void usage(void)
{
    fputs("usage: fit_polynomial [options]\n"
          "  --variance            errors of the gradient estimates at the same states, instead of training\n"
          "  --items N             data points [1000]\n"
          "  --batch N             items of a minibatch, a multiple of 4 [32]\n"
          "  --steps N             steps of Adam [3000]\n"
          "  --seeds N             problems and runs to average [10]\n"
          "  --batches N           minibatches per state of --variance [2000]\n"
          "  --rate R              Adam's learning rate [.003]\n"
          "  --noise S             standard deviation of noise added to the points [0]\n"
          "  --uniform-fraction D  part of every distribution that is uniform [.2]\n"
          "  --momentum M          how much of an importance is kept when its item is visited [0]\n"
          "  --beta B              add omis4-beta: optimal MIS with momentum B over the steps [0: leave it out]\n",
          stderr);
}

static double number(const char *name, const char *text, double low, double high)
{
    char *end = NULL;
    double value = text ? strtod(text, &end) : 0.0;
    if (!text || end == text || *end || !(value >= low && value <= high)) {
        fprintf(stderr, "fit_polynomial: %s needs a number in %g..%g\n", name, low, high);
        exit(1);
    }
    return value;
}

static uint32_t whole(const char *name, const char *text, double low, double high)
{
    double value = number(name, text, low, high);
    if (value != floor(value))
        fail(name, "not a whole number");
    return (uint32_t)value;
}

static options parse(int argc, char **argv)
{
    options o = {1000, 32, 3000, 10, 2000, 0.003, 0.0, 0.2, 0.0, 0.0, 0};
    for (int i = 1; i < argc; ++i) {
        const char *name = argv[i], *text = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(name, "--help") == 0) {
            usage();
            exit(0);
        }
        if (strcmp(name, "--variance") == 0) {
            o.variance = 1;
            continue;
        }
        ++i;
        if (strcmp(name, "--items") == 0)
            o.items = whole(name, text, 32, 1e7);
        else if (strcmp(name, "--batch") == 0)
            o.batch = whole(name, text, MAX_TABLES, MAX_BATCH);
        else if (strcmp(name, "--steps") == 0)
            o.steps = whole(name, text, 1, 1e7);
        else if (strcmp(name, "--seeds") == 0)
            o.seeds = whole(name, text, 1, 1e4);
        else if (strcmp(name, "--batches") == 0)
            o.batches = whole(name, text, 2, 1e6);
        else if (strcmp(name, "--rate") == 0)
            o.rate = number(name, text, 1e-9, 10.0);
        else if (strcmp(name, "--noise") == 0)
            o.noise = number(name, text, 0.0, 1e3);
        else if (strcmp(name, "--uniform-fraction") == 0)
            o.uniform_fraction = number(name, text, 1e-3, 1.0);
        else if (strcmp(name, "--momentum") == 0)
            o.momentum = number(name, text, 0.0, 0.99);
        else if (strcmp(name, "--beta") == 0)
            o.beta = number(name, text, 0.0, 0.99);
        else {
            usage();
            fail(name, "unknown option");
        }
    }
    if (o.batch % MAX_TABLES != 0)
        fail("--batch", "not a multiple of 4");
    if (o.batch > o.items)
        fail("--batch", "more than --items");
    return o;
}

/* ---- the regression ---- */

/* Powers of x / 2: on [-2, 2] those of x itself reach 64, and no single learning rate suits them. */
typedef struct problem {
    uint32_t items;
    float *basis;  /* [items * TERMS] */
    float *target; /* [items] */
    double start[TERMS];
} problem;

static double gaussian(nf_rng *rng)
{
    double u = 1.0 - nf_rng_uniform(rng), v = nf_rng_uniform(rng);
    return sqrt(-2.0 * log(u)) * cos(6.283185307179586 * v);
}

/* Points of a random polynomial at random x, and another random polynomial to start from. */
static void make_problem(problem *p, const options *o, uint32_t seed)
{
    nf_rng rng;
    nf_rng_seed(&rng, seed);
    double reference[TERMS];
    for (int k = 0; k < TERMS; ++k)
        reference[k] = gaussian(&rng);
    for (int k = 0; k < TERMS; ++k)
        p->start[k] = gaussian(&rng);
    p->items = o->items;
    for (uint32_t i = 0; i < p->items; ++i) {
        double x = 4.0 * nf_rng_uniform(&rng) - 2.0, power = 1.0, y = 0.0;
        for (int k = 0; k < TERMS; ++k, power *= x / 2.0) {
            p->basis[(size_t)i * TERMS + (size_t)k] = (float)power;
            y += reference[k] * power;
        }
        p->target[i] = (float)(y + o->noise * gaussian(&rng));
    }
}

static double residual(const problem *p, const double *coefficients, uint32_t item)
{
    const float *basis = p->basis + (size_t)item * TERMS;
    double output = 0.0;
    for (int k = 0; k < TERMS; ++k)
        output += coefficients[k] * basis[k];
    return output - p->target[item];
}

/* The derivatives of one item's loss, the squared residual. */
static void item_gradient(const problem *p, const double *coefficients, uint32_t item, float *gradient)
{
    double error = 2.0 * residual(p, coefficients, item);
    for (int k = 0; k < TERMS; ++k)
        gradient[k] = (float)(error * p->basis[(size_t)item * TERMS + (size_t)k]);
}

static double mean_loss(const problem *p, const double *coefficients)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < p->items; ++i)
        sum += pow(residual(p, coefficients, i), 2.0);
    return sum / p->items;
}

static void exact_gradient(const problem *p, const double *coefficients, double *gradient)
{
    memset(gradient, 0, TERMS * sizeof *gradient);
    for (uint32_t i = 0; i < p->items; ++i) {
        double error = 2.0 * residual(p, coefficients, i) / p->items;
        for (int k = 0; k < TERMS; ++k)
            gradient[k] += error * p->basis[(size_t)i * TERMS + (size_t)k];
    }
}

typedef struct adam {
    double mean[TERMS], square[TERMS];
    uint32_t steps;
} adam;

static void adam_step(adam *a, double rate, const double *gradient, double *coefficients)
{
    a->steps += 1;
    double mean_scale = 1.0 - pow(0.9, a->steps), square_scale = 1.0 - pow(0.999, a->steps);
    for (int k = 0; k < TERMS; ++k) {
        a->mean[k] = 0.9 * a->mean[k] + 0.1 * gradient[k];
        a->square[k] = 0.999 * a->square[k] + 0.001 * gradient[k] * gradient[k];
        coefficients[k] -= rate * (a->mean[k] / mean_scale) / (sqrt(a->square[k] / square_scale) + 1e-8);
    }
}

/* ---- minibatches: what noisefloor does ---- */

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
 * coefficients, those of even powers (group 0) apart from those of odd powers (group 1): differences of the four densities
 * are then r(x) e(x) and r(x) o(x), an even and an odd profile, and every derivative r(x) x^k is nearly a multiple of one
 * of them. What optimal MIS can write with the densities, it integrates without noise. */
static void importances(const method *m, const float *gradient, float *q)
{
    const float output = gradient[0], zero = 0.0f; /* The derivative by the constant is that by the output. */
    nf_status status = NF_OK;
    switch (m->importance) {
    case NO_IMPORTANCE:
        break;
    case ABSOLUTE_RESIDUAL: {
        const float error = 0.5f * output;
        q[0] = nf_importance_squared_error(&error, &zero, 1);
        break;
    }
    case SIGNED_RESIDUAL:
        status = nf_importance_nodes(&output, 1, NF_NODES_SIGN, m->tables, q);
        break;
    case SIGNED_DERIVATIVES:
        status = nf_importance_nodes(gradient, TERMS, NF_NODES_SIGN, m->tables, q);
        break;
    }
    check(status, "nf_importance_nodes");
}

static void draw_batch(sampler *s)
{
    const uint32_t batch = s->options->batch, items = s->options->items, tables = s->method->tables;
    s->weighted = 1;
    if (!s->started) { /* The initial epoch, and uniform sampling: without replacement, all weights 1. */
        for (uint32_t k = 0; k < batch; ++k, ++s->position) {
            uint64_t epoch = s->position / items;
            s->index[k] = nf_shuffle(s->shuffle + epoch, items, (uint32_t)(s->position % items));
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
        check(nf_table_set_uniform_fraction(&s->tables[j], (float)s->options->uniform_fraction),
              "nf_table_set_uniform_fraction");
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

/* ---- training ---- */

static uint32_t records(const options *o)
{
    return o->steps < 100 ? o->steps : 100;
}

static uint32_t record_step(const options *o, uint32_t record)
{
    return (uint32_t)((uint64_t)o->steps * (record + 1) / records(o));
}

static void train(const problem *p, const method *m, const options *o, uint32_t seed, double *losses)
{
    sampler *s = allocate(sizeof *s);
    sampler_start(s, m, o, seed);
    adam optimiser;
    memset(&optimiser, 0, sizeof optimiser);
    double coefficients[TERMS], gradient[TERMS];
    memcpy(coefficients, p->start, sizeof coefficients);
    uint32_t record = 0;
    for (uint32_t step = 1; step <= o->steps; ++step) {
        if (m == &METHODS[EXACT]) {
            exact_gradient(p, coefficients, gradient);
        } else {
            draw_batch(s);
            estimate_gradient(s, p, coefficients, gradient);
            update_tables(s);
        }
        adam_step(&optimiser, o->rate, gradient, coefficients);
        if (step == record_step(o, record))
            losses[record++] = mean_loss(p, coefficients);
    }
    sampler_end(s);
    free(s);
}

static void compare_training(problem *p, const options *o)
{
    const uint32_t count = records(o);
    double *losses = allocate(count * sizeof *losses);
    double *means = allocate((size_t)METHOD_COUNT * count * sizeof *means);
    double final_mean[METHOD_COUNT] = {0}, final_square[METHOD_COUNT] = {0};
    for (size_t i = 0; i < (size_t)METHOD_COUNT * count; ++i)
        means[i] = 0.0;
    printf("method,seed,step,loss\n");
    for (uint32_t seed = 1; seed <= o->seeds; ++seed) {
        make_problem(p, o, seed);
        for (int m = 0; m < METHOD_COUNT; ++m) {
            if (!is_run(&METHODS[m], o))
                continue;
            train(p, &METHODS[m], o, seed, losses);
            for (uint32_t r = 0; r < count; ++r) {
                printf("%s,%u,%u,%.6e\n", METHODS[m].name, (unsigned)seed, (unsigned)record_step(o, r), losses[r]);
                means[(size_t)m * count + r] += losses[r] / o->seeds;
            }
            final_mean[m] += losses[count - 1] / o->seeds;
            final_square[m] += losses[count - 1] * losses[count - 1] / o->seeds;
        }
    }
    fprintf(stderr, "| method     | loss at the end | standard error | over exact |\n");
    fprintf(stderr, "| ---------- | --------------: | -------------: | ---------: |\n");
    for (int m = 0; m < METHOD_COUNT; ++m) {
        if (!is_run(&METHODS[m], o))
            continue;
        for (uint32_t r = 0; r < count; ++r)
            printf("%s,mean,%u,%.6e\n", METHODS[m].name, (unsigned)record_step(o, r), means[(size_t)m * count + r]);
        double variance = final_square[m] - final_mean[m] * final_mean[m];
        double error = o->seeds > 1 ? sqrt((variance > 0.0 ? variance : 0.0) / (o->seeds - 1)) : 0.0;
        fprintf(stderr, "| %-10s | %15.3e | %14.1e | %10.3f |\n", METHODS[m].name, final_mean[m], error,
                final_mean[m] / final_mean[EXACT]);
    }
    free(losses);
    free(means);
}

/* ---- errors of the estimates at the same states ---- */

/* Mean squared errors of a method's estimates at STATES states on the way that the exact gradient takes. The method's
 * tables are what its own batches on that way have made them. */
static void measure(const problem *p, const method *m, const options *o, uint32_t seed, double (*errors)[TERMS])
{
    sampler *s = allocate(sizeof *s);
    sampler_start(s, m, o, seed);
    adam optimiser;
    memset(&optimiser, 0, sizeof optimiser);
    double coefficients[TERMS], exact[TERMS], estimate[TERMS];
    memcpy(coefficients, p->start, sizeof coefficients);
    uint32_t state = 0;
    for (uint32_t step = 1; step <= o->steps; ++step) {
        exact_gradient(p, coefficients, exact);
        if (step == (uint32_t)((uint64_t)o->steps * (state + 1) / STATES)) {
            for (uint32_t b = 0; b < o->batches; ++b) {
                draw_batch(s);
                estimate_gradient(s, p, coefficients, estimate);
                for (int k = 0; k < TERMS; ++k)
                    errors[state][k] += pow(estimate[k] - exact[k], 2.0) / o->batches;
            }
            ++state;
        }
        draw_batch(s);
        estimate_gradient(s, p, coefficients, estimate);
        update_tables(s);
        adam_step(&optimiser, o->rate, exact, coefficients);
    }
    sampler_end(s);
    free(s);
}

static void compare_errors(problem *p, const options *o)
{
    if (o->steps / STATES <= o->items / o->batch + 1)
        fail("--variance", "needs more --steps: the tables start after an epoch");
    double relative[METHOD_COUNT][STATES][TERMS];
    memset(relative, 0, sizeof relative);
    for (uint32_t seed = 1; seed <= o->seeds; ++seed) {
        make_problem(p, o, seed);
        double uniform[STATES][TERMS] = {{0.0}};
        for (int m = UNIFORM; m < METHOD_COUNT; ++m) {
            if (METHODS[m].explicit_gradients) /* Its momentum would join states that are not the same. */
                continue;
            double errors[STATES][TERMS];
            memset(errors, 0, sizeof errors);
            measure(p, &METHODS[m], o, seed, errors);
            if (m == UNIFORM)
                memcpy(uniform, errors, sizeof uniform);
            for (int state = 0; state < STATES; ++state)
                for (int k = 0; k < TERMS; ++k)
                    relative[m][state][k] += errors[state][k] / uniform[state][k] / o->seeds;
        }
    }
    printf("step,method,coefficient,error\n");
    fprintf(stderr, "| step | method   |   mean |  worst | by coefficient, of power 0 to 6\n");
    fprintf(stderr, "| ---: | -------- | -----: | -----: | -----: | -----: | -----: | -----: | -----: | -----: | -----: |\n");
    for (int state = 0; state < STATES; ++state)
        for (int m = UNIFORM; m < METHOD_COUNT; ++m) {
            if (METHODS[m].explicit_gradients)
                continue;
            unsigned step = (unsigned)((uint64_t)o->steps * ((uint32_t)state + 1) / STATES);
            double mean = 0.0, worst = 0.0;
            for (int k = 0; k < TERMS; ++k) {
                double value = relative[m][state][k];
                printf("%u,%s,%d,%.6e\n", step, METHODS[m].name, k, value);
                mean += value / TERMS;
                worst = value > worst ? value : worst;
            }
            fprintf(stderr, "| %4u | %-8s | %6.3f | %6.3f |", step, METHODS[m].name, mean, worst);
            for (int k = 0; k < TERMS; ++k)
                fprintf(stderr, " %6.3f |", relative[m][state][k]);
            fputc('\n', stderr);
        }
}

int main(int argc, char **argv)
{
    const options o = parse(argc, argv);
    problem p;
    p.basis = allocate((size_t)o.items * TERMS * sizeof(float));
    p.target = allocate((size_t)o.items * sizeof(float));
    if (o.variance)
        compare_errors(&p, &o);
    else
        compare_training(&p, &o);
    free(p.basis);
    free(p.target);
    if (fflush(stdout) != 0 || ferror(stdout))
        fail("standard output", "cannot be written");
    return 0;
}
