/* Trains a multilayer perceptron with minibatches that noisefloor draws, and prints test error against steps and time.
 *
 *     cc -std=c99 -O3 -march=native -fno-math-errno -Iinclude examples_c/train_mlp.c libnoisefloor.a -lm -o train_mlp
 *     ./train_mlp --data examples_c/data/digits --modes uniform,importance,adaptive,omis --seeds 5
 *
 * What a trainer needs of noisefloor is in train_mlp/sampler.h; step() below shows where it is called. */
#include "train_mlp/mlp.h"
#include "train_mlp/options.h"
#include "train_mlp/sampler.h"
#include "train_mlp/summary.h"
#include <time.h>

/* ---- the optimisers ---- */

typedef struct optimizer {
    float *gradient, *first, *second; /* [parameters]: the step's, its running mean, the running mean of its square */
    uint32_t steps;
} optimizer;

static optimizer optimizer_create(size_t parameters)
{
    optimizer opt = {0};
    opt.gradient = allocate(parameters, sizeof(float));
    opt.first = allocate(parameters, sizeof(float));
    opt.second = allocate(parameters, sizeof(float));
    return opt;
}

static void optimizer_free(optimizer *opt)
{
    free(opt->gradient);
    free(opt->first);
    free(opt->second);
}

/* Adam (Kingma and Ba 2014) with its usual constants. */
static void adam(size_t n, float rate, uint32_t steps, const float *restrict gradient, float *restrict first,
                 float *restrict second, float *restrict theta)
{
    const float beta1 = 0.9f, beta2 = 0.999f, tiny = 1e-8f;
    const float scale1 = (float)(rate / (1.0 - pow(beta1, steps)));
    const float scale2 = (float)(1.0 / (1.0 - pow(beta2, steps)));
    for (size_t i = 0; i < n; ++i) {
        first[i] = beta1 * first[i] + (1.0f - beta1) * gradient[i];
        second[i] = beta2 * second[i] + (1.0f - beta2) * gradient[i] * gradient[i];
        theta[i] -= scale1 * first[i] / (sqrtf(scale2 * second[i]) + tiny);
    }
}

static void sgd(size_t n, float rate, float momentum, const float *restrict gradient, float *restrict velocity,
                float *restrict theta)
{
    for (size_t i = 0; i < n; ++i) {
        velocity[i] = momentum * velocity[i] + gradient[i];
        theta[i] -= rate * velocity[i];
    }
}

/* `part`: how much of the training is done. */
static void optimizer_step(optimizer *opt, const options *o, double part, mlp *net)
{
    float rate = (float)(o->rate * (1.0 + (o->final_rate - 1.0) * part));
    ++opt->steps;
    if (o->adam)
        adam(net->parameters, rate, opt->steps, opt->gradient, opt->first, opt->second, net->theta);
    else
        sgd(net->parameters, rate, o->sgd_momentum, opt->gradient, opt->first, net->theta);
}

/* ---- training ---- */

/* One network in training. */
typedef struct run {
    mlp net;
    sampler draw;
    optimizer opt;
    uint32_t *index; /* [batch] */
    float *weight;   /* [batch] */
    double seconds;
} run;

static run run_create(const options *o, const dataset *data, enum mode mode, uint32_t seed)
{
    uint32_t size[LAYERS + 1] = {data->pixels, o->hidden[0], o->hidden[1], data->classes};
    run r = {0};
    r.net = mlp_create(size, seed);
    r.draw = sampler_create(o, mode, data->items, seed);
    r.opt = optimizer_create(r.net.parameters);
    r.index = allocate(o->batch, sizeof *r.index);
    r.weight = allocate(o->batch, sizeof *r.weight);
    return r;
}

static void run_free(run *r)
{
    free(r->net.theta);
    sampler_free(&r->draw);
    optimizer_free(&r->opt);
    free(r->index);
    free(r->weight);
}

/* One step: draw, forward, remember, backward, move. */
static void step(run *r, const options *o, const dataset *data, workspace *space, uint32_t epoch, uint32_t position)
{
    uint32_t count = data->items - position < o->batch ? data->items - position : o->batch;
    uint32_t classes = r->net.size[LAYERS];
    sampler_draw(&r->draw, epoch, position, count, r->index, r->weight);
    gather(space, data, r->index, count);
    forward(&r->net, space, count);
    output_gradient(&r->net, space, count);
    sampler_update(&r->draw, &r->net, space, r->index, count, epoch == 0 ? 0.0f : o->gamma);
    for (uint32_t i = 0; i < count; ++i)
        for (uint32_t c = 0; c < classes; ++c)
            space->delta[LAYERS][(size_t)i * classes + c] *= r->weight[i] / (float)count;
    backward(&r->net, space, count);
    memset(r->opt.gradient, 0, r->net.parameters * sizeof(float));
    add_gradient(&r->net, space, count, r->opt.gradient);
    optimizer_step(&r->opt, o, (epoch + (double)position / data->items) / o->epochs, &r->net);
}

/* Items of the training set that the training loss is the mean over: enough for a curve, and soon evaluated. */
#define TRAIN_LOSS_ITEMS 10000

#include "train_mlp/variance.h" /* here, because it trains a network with step() */

static void print_row(const options *o, enum mode mode, uint32_t seed, uint32_t point, run *r, const quality *train,
                      const quality *test)
{
    printf("%s,%u,%.4g,%u,%.4f,%.6g,%.6g,%.6g\n", mode_name[mode], seed, (double)point / o->rows, r->opt.steps,
           r->seconds, train->loss, test->loss, test->error);
    fflush(stdout);
}

/* Every mode with every seed. They take turns, a row at a time: what else the machine does meets all of them alike. */
static void compare(const options *o, const dataset *train, const dataset *test)
{
    static curve curves[MODES][MAX_SEEDS];
    uint32_t points = o->epochs * o->rows, steps = (train->items + o->batch - 1) / o->batch;
    uint32_t train_items = train->items < TRAIN_LOSS_ITEMS ? train->items : TRAIN_LOSS_ITEMS;
    printf("mode,seed,epoch,step,seconds,train_loss,test_loss,test_error\n");
    for (uint32_t s = 0; s < o->seeds; ++s) {
        run runs[MODES];
        for (uint32_t m = 0; m < o->mode_count; ++m) {
            runs[m] = run_create(o, train, o->modes[m], o->seed + s);
            curves[m][s].seconds = allocate((size_t)points + 1, sizeof(double));
            curves[m][s].error = allocate((size_t)points + 1, sizeof(double));
        }
        workspace space = workspace_create(&runs[0].net, o->batch), large = workspace_create(&runs[0].net, 256);
        for (uint32_t point = 0; point <= points; ++point) {
            for (uint32_t m = 0; m < o->mode_count; ++m) {
                run *r = &runs[m];
                if (point > 0) { /* from one row to the next */
                    uint32_t epoch = (point - 1) / o->rows, part = (point - 1) % o->rows;
                    uint32_t first = (uint32_t)((uint64_t)steps * part / o->rows);
                    uint32_t last = (uint32_t)((uint64_t)steps * (part + 1) / o->rows);
                    clock_t start = clock();
                    for (uint32_t i = first; i < last; ++i)
                        step(r, o, train, &space, epoch, i * o->batch);
                    if (part + 1 == o->rows)
                        sampler_end_epoch(&r->draw);
                    r->seconds += (double)(clock() - start) / CLOCKS_PER_SEC;
                }
                quality on_train = evaluate(&r->net, &large, train, train_items);
                quality on_test = evaluate(&r->net, &large, test, test->items);
                curves[m][s].seconds[point] = r->seconds;
                curves[m][s].error[point] = on_test.error;
                print_row(o, o->modes[m], o->seed + s, point, r, &on_train, &on_test);
            }
        }
        workspace_free(&space);
        workspace_free(&large);
        for (uint32_t m = 0; m < o->mode_count; ++m)
            run_free(&runs[m]);
    }
    print_summary(o, curves);
    for (uint32_t m = 0; m < o->mode_count; ++m)
        for (uint32_t s = 0; s < o->seeds; ++s) {
            free(curves[m][s].seconds);
            free(curves[m][s].error);
        }
}

int main(int count, char **words)
{
    options o = options_parse(count, words);
    dataset train = dataset_read(o.data, "train"), test = dataset_read(o.data, "t10k");
    if (test.pixels != train.pixels || test.classes > train.classes)
        fail("%s: the test images are unlike the training images", o.data);
    if (train.classes < 2)
        fail("%s: one class alone is nothing to learn", o.data);
    if (options_use_techniques(&o) && o.techniques > 2 * train.classes)
        fail("--techniques: %u needs %u classes, the data have %u", o.techniques, o.techniques / 2, train.classes);
    if (o.variance != NULL)
        measure_variance(&o, &train, &test);
    else
        compare(&o, &train, &test);
    dataset_free(&train);
    dataset_free(&test);
    if (fflush(stdout) != 0 || ferror(stdout))
        fail("cannot write the output");
    return EXIT_SUCCESS;
}
