/* A multilayer perceptron with two hidden layers, ReLU and softmax cross-entropy: batched forward and backward passes.
 */
#ifndef TRAIN_MLP_MLP_H
#define TRAIN_MLP_MLP_H

#include "idx.h"
#include <math.h>

#define LAYERS 3

/* Layer l maps size[l] numbers to size[l + 1]: weights [size[l]][size[l + 1]], then biases [size[l + 1]], at offset[l].
 */
typedef struct mlp {
    uint32_t size[LAYERS + 1];
    size_t offset[LAYERS];
    size_t parameters;
    float *theta; /* [parameters] */
} mlp;

/* Of one batch. activation[0] is the input, activation[LAYERS] the logits; delta[l] is the loss's derivative by the
   l-th layer's output before the ReLU, one row per item. */
typedef struct workspace {
    uint32_t rows;
    float *activation[LAYERS + 1]; /* [rows * size[l]] */
    float *delta[LAYERS + 1];      /* [rows * size[l]]; delta[0] is not used */
    float *transposed;             /* the weights of one layer */
    uint32_t *label;               /* [rows] */
} workspace;

/* ---- c[m * n] += a b, with a's element (i, p) at a[i * row + p * column] and b [k * n] ---- */

/* Four rows of c, four of b: 16 multiplications for every 4 + 4 loads. The loop over j is what the compiler vectorises,
   and it keeps the order of the sums: the results do not depend on the width of the vectors. */
static void multiply_4x4(size_t n, const float *a, size_t row, size_t column, const float *restrict b0,
                         const float *restrict b1, const float *restrict b2, const float *restrict b3,
                         float *restrict c0, float *restrict c1, float *restrict c2, float *restrict c3)
{
    const float *r0 = a, *r1 = a + row, *r2 = a + 2 * row, *r3 = a + 3 * row;
    const float a00 = r0[0], a01 = r0[column], a02 = r0[2 * column], a03 = r0[3 * column];
    const float a10 = r1[0], a11 = r1[column], a12 = r1[2 * column], a13 = r1[3 * column];
    const float a20 = r2[0], a21 = r2[column], a22 = r2[2 * column], a23 = r2[3 * column];
    const float a30 = r3[0], a31 = r3[column], a32 = r3[2 * column], a33 = r3[3 * column];
    for (size_t j = 0; j < n; ++j) {
        c0[j] += a00 * b0[j] + a01 * b1[j] + a02 * b2[j] + a03 * b3[j];
        c1[j] += a10 * b0[j] + a11 * b1[j] + a12 * b2[j] + a13 * b3[j];
        c2[j] += a20 * b0[j] + a21 * b1[j] + a22 * b2[j] + a23 * b3[j];
        c3[j] += a30 * b0[j] + a31 * b1[j] + a32 * b2[j] + a33 * b3[j];
    }
}

static void multiply_row(size_t n, float a, const float *restrict b, float *restrict c)
{
    for (size_t j = 0; j < n; ++j)
        c[j] += a * b[j];
}

static void multiply(size_t m, size_t n, size_t k, const float *a, size_t row, size_t column, const float *b, float *c)
{
    for (size_t i = 0; i < m; i += 4) {
        size_t rows = m - i < 4 ? m - i : 4, p = 0;
        if (rows == 4)
            for (; p + 4 <= k; p += 4)
                multiply_4x4(n, a + i * row + p * column, row, column, b + p * n, b + (p + 1) * n, b + (p + 2) * n,
                             b + (p + 3) * n, c + i * n, c + (i + 1) * n, c + (i + 2) * n, c + (i + 3) * n);
        for (size_t r = i; r < i + rows; ++r)
            for (size_t q = p; q < k; ++q)
                multiply_row(n, a[r * row + q * column], b + q * n, c + r * n);
    }
}

/* ---- the network ---- */

/* Weights uniform in +-sqrt(6 / inputs) (He et al. 2015), biases nought. */
static mlp mlp_create(const uint32_t size[LAYERS + 1], uint64_t seed)
{
    mlp net = {0};
    memcpy(net.size, size, sizeof net.size);
    for (int l = 0; l < LAYERS; ++l) {
        net.offset[l] = net.parameters;
        net.parameters += ((size_t)size[l] + 1) * size[l + 1];
    }
    net.theta = allocate(net.parameters, sizeof(float));
    nf_rng rng;
    nf_rng_seed(&rng, seed);
    for (int l = 0; l < LAYERS; ++l) {
        float bound = sqrtf(6.0f / (float)size[l]);
        for (size_t i = 0; i < (size_t)size[l] * size[l + 1]; ++i)
            net.theta[net.offset[l] + i] = bound * (2.0f * nf_rng_uniform(&rng) - 1.0f);
    }
    return net;
}

static workspace workspace_create(const mlp *net, uint32_t rows)
{
    workspace space = {0};
    size_t largest = 0;
    space.rows = rows;
    for (int l = 0; l <= LAYERS; ++l) {
        space.activation[l] = allocate((size_t)rows * net->size[l], sizeof(float));
        if (l > 0)
            space.delta[l] = allocate((size_t)rows * net->size[l], sizeof(float));
        if (l > 1 && (size_t)net->size[l - 1] * net->size[l] > largest)
            largest = (size_t)net->size[l - 1] * net->size[l];
    }
    space.transposed = allocate(largest, sizeof(float));
    space.label = allocate(rows, sizeof *space.label);
    return space;
}

static void workspace_free(workspace *space)
{
    for (int l = 0; l <= LAYERS; ++l) {
        free(space->activation[l]);
        free(space->delta[l]);
    }
    free(space->transposed);
    free(space->label);
}

/* Copies the items' images and labels: a batch lies scattered in memory, and is read several times. */
static void gather(workspace *space, const dataset *data, const uint32_t *index, uint32_t count)
{
    for (uint32_t r = 0; r < count; ++r) {
        const uint8_t *image = data->images + (size_t)index[r] * data->pixels;
        float *row = space->activation[0] + (size_t)r * data->pixels;
        for (uint32_t i = 0; i < data->pixels; ++i)
            row[i] = (float)image[i] * (1.0f / 255.0f);
        space->label[r] = data->labels[index[r]];
    }
}

/* From activation[0] to all others. */
static void forward(const mlp *net, workspace *space, uint32_t count)
{
    for (int l = 0; l < LAYERS; ++l) {
        size_t in = net->size[l], out = net->size[l + 1];
        const float *weights = net->theta + net->offset[l], *biases = weights + in * out;
        float *next = space->activation[l + 1];
        for (uint32_t r = 0; r < count; ++r)
            memcpy(next + r * out, biases, out * sizeof(float));
        multiply(count, out, in, space->activation[l], in, 1, weights, next);
        if (l + 1 < LAYERS)
            for (size_t i = 0; i < count * out; ++i)
                next[i] = next[i] > 0.0f ? next[i] : 0.0f;
    }
}

/* softmax - onehot into delta[LAYERS]: the loss's derivative by the logits, equation (6.10). */
static void output_gradient(const mlp *net, workspace *space, uint32_t count)
{
    check(nf_importance_cross_entropy(space->activation[LAYERS], space->label, count, net->size[LAYERS], NULL, NULL,
                                      space->delta[LAYERS]),
          "gradient of the cross-entropy");
}

/* From delta[LAYERS] to the other deltas. It is linear: a factor on a row of delta[LAYERS] is a weight on that item. */
static void backward(const mlp *net, workspace *space, uint32_t count)
{
    for (int l = LAYERS; l > 1; --l) {
        size_t in = net->size[l - 1], out = net->size[l];
        const float *weights = net->theta + net->offset[l - 1];
        for (size_t i = 0; i < in; ++i)
            for (size_t j = 0; j < out; ++j)
                space->transposed[j * in + i] = weights[i * out + j];
        float *delta = space->delta[l - 1];
        const float *activation = space->activation[l - 1];
        memset(delta, 0, count * in * sizeof(float));
        multiply(count, in, out, space->delta[l], out, 1, space->transposed, delta);
        for (size_t i = 0; i < count * in; ++i)
            delta[i] = activation[i] > 0.0f ? delta[i] : 0.0f;
    }
}

/* Adds the sum over the batch of each parameter's derivative to gradient[parameters]. */
static void add_gradient(const mlp *net, const workspace *space, uint32_t count, float *gradient)
{
    for (int l = 0; l < LAYERS; ++l) {
        size_t in = net->size[l], out = net->size[l + 1];
        float *weights = gradient + net->offset[l], *biases = weights + in * out;
        multiply(in, out, count, space->activation[l], 1, in, space->delta[l + 1], weights);
        for (uint32_t r = 0; r < count; ++r)
            multiply_row(out, 1.0f, space->delta[l + 1] + r * out, biases);
    }
}

/* ---- evaluation ---- */

typedef struct quality {
    double loss, error; /* means over the items; error is the share of wrong answers */
} quality;

/* Of the first `items` items. */
static quality evaluate(const mlp *net, workspace *space, const dataset *data, uint32_t items)
{
    quality sum = {0.0, 0.0};
    uint32_t classes = net->size[LAYERS], *index = allocate(space->rows, sizeof *index);
    for (uint32_t start = 0; start < items; start += space->rows) {
        uint32_t count = items - start < space->rows ? items - start : space->rows;
        for (uint32_t r = 0; r < count; ++r)
            index[r] = start + r;
        gather(space, data, index, count);
        forward(net, space, count);
        for (uint32_t r = 0; r < count; ++r) {
            const float *logits = space->activation[LAYERS] + (size_t)r * classes;
            float loss;
            uint32_t best = 0;
            for (uint32_t c = 1; c < classes; ++c)
                if (logits[c] > logits[best])
                    best = c;
            sum.error += best != space->label[r];
            check(nf_importance_cross_entropy(logits, &space->label[r], 1, classes, NULL, &loss, NULL), "loss");
            sum.loss += loss;
        }
    }
    free(index);
    sum.loss /= items;
    sum.error /= items;
    return sum;
}

#endif
