/* A polynomial of order 6, its loss and derivatives, and Adam. */
#ifndef FIT_POLYNOMIAL_REGRESSION_H
#define FIT_POLYNOMIAL_REGRESSION_H

#include "options.h"

#define TERMS 7

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

#endif
