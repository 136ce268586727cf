/* Figure 6.10 of the thesis: the seven coefficients of a polynomial of order 6, fitted to points of another one by Adam
 * from minibatches of 32, drawn and weighted in several ways. C99.
 *
 *   cc -std=c99 -O3 -Iinclude examples_c/fit_polynomial.c target/noisefloor/libnoisefloor.a -lm -o fit_polynomial
 *   ./fit_polynomial > losses.csv             # method,seed,step,loss; a table on standard error
 *   ./fit_polynomial --variance > errors.csv  # step,method,coefficient,error,bias: the gradient's, over uniform's
 *
 * To see how the library is used, read fit_polynomial/sampler.h. */
#include "fit_polynomial/sampler.h"

#define STATES 4 /* of the polynomial, at which --variance looks */

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
    double final_mean[METHOD_COUNT] = {0}, ratio_mean[METHOD_COUNT] = {0}, ratio_square[METHOD_COUNT] = {0};
    for (size_t i = 0; i < (size_t)METHOD_COUNT * count; ++i)
        means[i] = 0.0;
    printf("method,seed,step,loss\n");
    for (uint32_t seed = 1; seed <= o->seeds; ++seed) {
        double exact = 0.0;
        make_problem(p, o, seed);
        for (int m = 0; m < METHOD_COUNT; ++m) {
            if (!is_run(&METHODS[m], o))
                continue;
            train(p, &METHODS[m], o, seed, losses);
            for (uint32_t r = 0; r < count; ++r) {
                printf("%s,%u,%u,%.6e\n", METHODS[m].name, (unsigned)seed, (unsigned)record_step(o, r), losses[r]);
                means[(size_t)m * count + r] += losses[r] / o->seeds;
            }
            if (m == EXACT)
                exact = losses[count - 1];
            double ratio = log(losses[count - 1] / exact);
            final_mean[m] += losses[count - 1] / o->seeds;
            ratio_mean[m] += ratio / o->seeds;
            ratio_square[m] += ratio * ratio / o->seeds;
        }
    }
    /* Problems differ a hundredfold, so ratios are taken problem by problem. */
    fprintf(stderr, "| method     | mean loss at the end | over exact | problem by problem | standard error |\n");
    fprintf(stderr, "| ---------- | -------------------: | ---------: | -----------------: | -------------: |\n");
    for (int m = 0; m < METHOD_COUNT; ++m) {
        if (!is_run(&METHODS[m], o))
            continue;
        for (uint32_t r = 0; r < count; ++r)
            printf("%s,mean,%u,%.6e\n", METHODS[m].name, (unsigned)record_step(o, r), means[(size_t)m * count + r]);
        double variance = ratio_square[m] - ratio_mean[m] * ratio_mean[m], mean = exp(ratio_mean[m]);
        fprintf(stderr, "| %-10s | %20.3e | %10.3f | %18.3f | ", METHODS[m].name, final_mean[m],
                final_mean[m] / final_mean[EXACT], mean);
        if (o->seeds > 1)
            fprintf(stderr, "%14.3f |\n", mean * sqrt((variance > 0.0 ? variance : 0.0) / (o->seeds - 1)));
        else
            fprintf(stderr, "%14s |\n", "-");
    }
    free(losses);
    free(means);
}

/* ---- errors of the estimates at the same states ---- */

/* Mean squared errors of a method's estimates, and means of their errors, at STATES states on the way that the exact
 * gradient takes. The method's tables are what its own batches on that way have made them. */
static void measure(const problem *p, const method *m, const options *o, uint32_t seed, double (*errors)[TERMS],
                    double (*biases)[TERMS])
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
                for (int k = 0; k < TERMS; ++k) {
                    errors[state][k] += pow(estimate[k] - exact[k], 2.0) / o->batches;
                    biases[state][k] += (estimate[k] - exact[k]) / o->batches;
                }
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
    const uint32_t least = STATES * (o->items / o->batch + 2);
    if (o->steps < least)
        fail("--variance: the tables start after an epoch, so --steps must be at least %u, not %u", (unsigned)least,
             (unsigned)o->steps);
    double relative[METHOD_COUNT][STATES][TERMS], bias[METHOD_COUNT][STATES][TERMS];
    memset(relative, 0, sizeof relative);
    memset(bias, 0, sizeof bias);
    for (uint32_t seed = 1; seed <= o->seeds; ++seed) {
        make_problem(p, o, seed);
        double uniform[STATES][TERMS] = {{0.0}};
        for (int m = UNIFORM; m < METHOD_COUNT; ++m) {
            if (METHODS[m].explicit_gradients) /* Its momentum would join states that are not the same. */
                continue;
            double errors[STATES][TERMS], biases[STATES][TERMS];
            memset(errors, 0, sizeof errors);
            memset(biases, 0, sizeof biases);
            measure(p, &METHODS[m], o, seed, errors, biases);
            if (m == UNIFORM)
                memcpy(uniform, errors, sizeof uniform);
            for (int state = 0; state < STATES; ++state)
                for (int k = 0; k < TERMS; ++k) {
                    /* The mean of so many batches is not exact: what that adds to the square is taken off. */
                    double square = pow(biases[state][k], 2.0);
                    square = (square - (errors[state][k] - square) / (o->batches - 1));
                    relative[m][state][k] += errors[state][k] / uniform[state][k] / o->seeds;
                    bias[m][state][k] += square / uniform[state][k] / o->seeds;
                }
        }
    }
    printf("step,method,coefficient,error,bias\n");
    fprintf(stderr, "| step | method   |   mean |  worst | squared bias | x^0    | x^1    | x^2    | x^3    | x^4    | "
                    "x^5    | x^6    |\n");
    fprintf(stderr, "| ---: | -------- | -----: | -----: | -----------: | -----: | -----: | -----: | -----: | -----: | "
                    "-----: | -----: |\n");
    for (int state = 0; state < STATES; ++state)
        for (int m = UNIFORM; m < METHOD_COUNT; ++m) {
            if (METHODS[m].explicit_gradients)
                continue;
            unsigned step = (unsigned)((uint64_t)o->steps * ((uint32_t)state + 1) / STATES);
            double mean = 0.0, worst = 0.0, squared_bias = 0.0;
            for (int k = 0; k < TERMS; ++k) {
                double value = relative[m][state][k];
                printf("%u,%s,%d,%.6e,%.6e\n", step, METHODS[m].name, k, value, bias[m][state][k]);
                mean += value / TERMS;
                squared_bias += bias[m][state][k] / TERMS;
                worst = value > worst ? value : worst;
            }
            fprintf(stderr, "| %4u | %-8s | %6.3f | %6.3f | %12.4f |", step, METHODS[m].name, mean, worst,
                    squared_bias);
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
        fail("standard output cannot be written");
    return 0;
}
