/* Figure 6.2: how much the gradient estimate varies with each way to draw, at the same states of one network that is
   trained uniformly. What one importance gives is exact: with B draws from p, and g_i the gradient of item i's loss,
       variance = (1/B) ((1/N^2) sum ||g_i||^2 / p_i - ||mean g||^2).
   Several distributions at once are measured by drawing: the mean squared distance to the exact gradient, bias
   included. */
#ifndef TRAIN_MLP_VARIANCE_H
#define TRAIN_MLP_VARIANCE_H

#define EXACT_BATCH 16
#define DRAWN_BATCH 64
#define DRAWN_BATCHES 200
#define SCAN_ROWS 256

/* Ways to rate an item. */
enum rating { RATE_LOSS, RATE_OURS, RATE_LAST_LAYER, RATE_GRADIENT, RATINGS };
static const char *const rating_name[RATINGS] = {"loss", "importance", "last_layer", "gradient_norm"};

/* What every item says at one state of the network. */
typedef struct scan {
    uint32_t items;
    float *rating[RATINGS];     /* [items] */
    float *part[MAX_TECHNIQUES]; /* [items]: what balance and omis keep */
    double *square;             /* [items]: ||g_i||^2 */
    double *mean;               /* [parameters]: the exact gradient */
    double mean_square;         /* ||mean||^2 */
} scan;

static double row_square(const float *row, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < n; ++i)
        sum += (double)row[i] * row[i];
    return sum;
}

static scan scan_create(const mlp *net, uint32_t items, uint32_t techniques)
{
    scan all = {0};
    all.items = items;
    for (int k = 0; k < RATINGS; ++k)
        all.rating[k] = allocate(items, sizeof(float));
    for (uint32_t j = 0; j < techniques; ++j)
        all.part[j] = allocate(items, sizeof(float));
    all.square = allocate(items, sizeof(double));
    all.mean = allocate(net->parameters, sizeof(double));
    return all;
}

static void scan_free(scan *all)
{
    for (int k = 0; k < RATINGS; ++k)
        free(all->rating[k]);
    for (uint32_t j = 0; j < MAX_TECHNIQUES; ++j)
        free(all->part[j]);
    free(all->square);
    free(all->mean);
}

static void scan_items(scan *all, const mlp *net, const dataset *data, workspace *space, uint32_t techniques)
{
    uint32_t index[SCAN_ROWS], classes = net->size[LAYERS];
    float part[MAX_TECHNIQUES], *sum = allocate(net->parameters, sizeof *sum);
    memset(all->mean, 0, net->parameters * sizeof *all->mean);
    for (uint32_t start = 0; start < all->items; start += SCAN_ROWS) {
        uint32_t count = all->items - start < SCAN_ROWS ? all->items - start : SCAN_ROWS;
        for (uint32_t r = 0; r < count; ++r)
            index[r] = start + r;
        gather(space, data, index, count);
        forward(net, space, count);
        output_gradient(net, space, count);
        backward(net, space, count);
        memset(sum, 0, net->parameters * sizeof *sum);
        add_gradient(net, space, count, sum);
        for (size_t i = 0; i < net->parameters; ++i)
            all->mean[i] += sum[i];
        for (uint32_t r = 0; r < count; ++r) {
            const float *logits = space->activation[LAYERS] + (size_t)r * classes;
            /* A fully connected layer's gradient is an outer product: its norm is the product of the norms. */
            double square = 0.0, last = 0.0;
            for (int l = 0; l < LAYERS; ++l) {
                uint32_t in = net->size[l], out = net->size[l + 1];
                last = row_square(space->delta[l + 1] + (size_t)r * out, out) *
                       (row_square(space->activation[l] + (size_t)r * in, in) + 1.0);
                square += last;
            }
            all->square[start + r] = square;
            check(nf_importance_cross_entropy(logits, &space->label[r], 1, classes, &all->rating[RATE_OURS][start + r],
                                              &all->rating[RATE_LOSS][start + r], NULL),
                  "importances");
            all->rating[RATE_LAST_LAYER][start + r] = (float)sqrt(last);
            all->rating[RATE_GRADIENT][start + r] = (float)sqrt(square);
            check(nf_importance_gradient(space->delta[LAYERS] + (size_t)r * classes, 1, classes, NF_NODES_SIGN,
                                         techniques, part),
                  "importances");
            for (uint32_t j = 0; j < techniques; ++j)
                all->part[j][start + r] = part[j];
        }
    }
    /* A table of no importance at all is refused; see sampler_keep_drawable(). */
    for (uint32_t j = 0; j < techniques; ++j) {
        float largest = 0.0f;
        for (uint32_t i = 0; i < all->items; ++i)
            largest = fmaxf(largest, all->part[j][i]);
        for (uint32_t i = 0; largest == 0.0f && i < all->items; ++i)
            all->part[j][i] = 1e-20f;
    }
    all->mean_square = 0.0;
    for (size_t i = 0; i < net->parameters; ++i) {
        all->mean[i] /= all->items;
        all->mean_square += all->mean[i] * all->mean[i];
    }
    free(sum);
}

/* The variance of one draw, a batch of one. Infinite if an item that matters is never drawn. */
static double exact_variance(const scan *all, const float *probability)
{
    double n = all->items, sum = 0.0;
    for (uint32_t i = 0; i < all->items; ++i)
        if (all->square[i] > 0.0)
            sum += all->square[i] / (probability == NULL ? 1.0 / n : probability[i]);
    return sum / (n * n) - all->mean_square;
}

/* The same with a table filled with that importance. */
static double fresh_variance(const scan *all, const float *importance, float delta, float *probability)
{
    double n = all->items, total = 0.0;
    for (uint32_t i = 0; i < all->items; ++i)
        total += importance[i];
    for (uint32_t i = 0; i < all->items; ++i)
        probability[i] = (float)((1.0 - delta) * importance[i] / total + delta / n);
    return exact_variance(all, probability);
}

static double table_variance(const scan *all, const nf_table *table, const uint32_t *every, float *probability)
{
    check(nf_table_probabilities(table, every, all->items, 1, probability), "probabilities");
    return exact_variance(all, probability);
}

/* Mean squared distance of `DRAWN_BATCHES` estimates to the exact gradient, and its standard error. `s` is a copy. */
static double drawn_error(sampler s, const scan *all, const mlp *net, const dataset *data, workspace *space,
                          double *error)
{
    uint32_t index[DRAWN_BATCH], classes = net->size[LAYERS];
    float weight[DRAWN_BATCH], *gradient = allocate(net->parameters, sizeof *gradient);
    double sum = 0.0, squares = 0.0;
    nf_rng_seed(&s.rng, s.seed + 1000003); /* not the numbers that training goes on with */
    for (uint32_t batch = 0; batch < DRAWN_BATCHES; ++batch) {
        sampler_draw_weighted(&s, DRAWN_BATCH, index, weight);
        gather(space, data, index, DRAWN_BATCH);
        forward(net, space, DRAWN_BATCH);
        output_gradient(net, space, DRAWN_BATCH);
        for (uint32_t r = 0; r < DRAWN_BATCH; ++r)
            for (uint32_t c = 0; c < classes; ++c)
                space->delta[LAYERS][(size_t)r * classes + c] *= weight[r] / DRAWN_BATCH;
        backward(net, space, DRAWN_BATCH);
        memset(gradient, 0, net->parameters * sizeof *gradient);
        add_gradient(net, space, DRAWN_BATCH, gradient);
        double distance = 0.0;
        for (size_t i = 0; i < net->parameters; ++i)
            distance += (gradient[i] - all->mean[i]) * (gradient[i] - all->mean[i]);
        sum += distance;
        squares += distance * distance;
    }
    free(gradient);
    double mean = sum / DRAWN_BATCHES;
    *error = sqrt((squares / DRAWN_BATCHES - mean * mean) / (DRAWN_BATCHES - 1));
    return mean;
}

/* Tables filled with what every item says now. */
static void sampler_refresh(sampler *s, const scan *all)
{
    size_t bytes = nf_table_size(s->items);
    for (uint32_t j = 0; j < s->tables; ++j) {
        const float *importance = s->tables == 1 ? all->rating[RATE_OURS] : all->part[j];
        check(nf_table_init(&s->table[j], s->memory[j], bytes, s->items, importance), "fresh table");
        s->table[j].uniform_fraction = s->o->delta;
    }
}

/* Tables kept as training would keep them: with draws of their own, on the network as it is. */
enum { STALE_MIXED, STALE_PURE, STALE_PARTS, STALE };

static void measure_variance(const options *given, const dataset *train, const dataset *test)
{
    options mixed = *given, pure = *given, *o = &mixed;
    FILE *file = fopen(given->variance, "w");
    if (file == NULL)
        fail("cannot write %s", given->variance);
    mixed.batch = pure.batch = DRAWN_BATCH;
    pure.delta = 0.0f;
    run r = run_create(o, train, UNIFORM, o->seed);
    sampler stale[STALE] = {sampler_create(&mixed, IMPORTANCE, train->items, o->seed),
                            sampler_create(&pure, IMPORTANCE, train->items, o->seed),
                            sampler_create(&mixed, OMIS, train->items, o->seed)};
    sampler fresh = sampler_create(&mixed, IMPORTANCE, train->items, o->seed);
    sampler parts = sampler_create(&mixed, OMIS, train->items, o->seed);
    workspace space = workspace_create(&r.net, DRAWN_BATCH), large = workspace_create(&r.net, SCAN_ROWS);
    scan all = scan_create(&r.net, train->items, o->techniques);
    float *probability = allocate(train->items, sizeof *probability), weight[DRAWN_BATCH];
    uint32_t *every = allocate(train->items, sizeof *every), index[DRAWN_BATCH];
    for (uint32_t i = 0; i < train->items; ++i)
        every[i] = i;

    /* batches: drawn; 0 where the ratio is exact. */
    fprintf(file, "epoch,method,uniform_fraction,batch,ratio,std_error,batches\n");
    printf("epoch,test_loss,test_error\n");
    for (uint32_t epoch = 0; epoch <= o->epochs; ++epoch) {
        for (uint32_t position = 0; epoch > 0 && position < train->items; position += o->batch) {
            step(&r, o, train, &space, epoch - 1, position);
            uint32_t count = train->items - position < o->batch ? train->items - position : o->batch;
            for (int k = 0; k < STALE; ++k) {
                sampler_draw(&stale[k], epoch - 1, position, count, index, weight);
                gather(&space, train, index, count);
                forward(&r.net, &space, count);
                output_gradient(&r.net, &space, count);
                sampler_update(&stale[k], &r.net, &space, index, count, epoch == 1 ? 0.0f : o->gamma);
            }
        }
        quality quality_now = evaluate(&r.net, &large, test, test->items);
        printf("%u,%.6g,%.6g\n", epoch, quality_now.loss, quality_now.error);
        fflush(stdout);

        scan_items(&all, &r.net, train, &large, o->techniques);
        double uniform = exact_variance(&all, NULL), error;
        fprintf(file, "%u,uniform,1,%d,1,0,0\n", epoch, EXACT_BATCH);
        for (int k = 0; k < RATINGS; ++k)
            for (int m = 0; m < 2; ++m) {
                float delta = m == 0 ? 0.0f : given->delta;
                double ratio = fresh_variance(&all, all.rating[k], delta, probability) / uniform;
                fprintf(file, "%u,%s,%g,%d,%.5g,0,0\n", epoch, rating_name[k], delta, EXACT_BATCH, ratio);
            }
        fprintf(file, "%u,importance_stale,0,%d,%.5g,0,0\n", epoch, EXACT_BATCH,
                table_variance(&all, &stale[STALE_PURE].table[0], every, probability) / uniform);
        fprintf(file, "%u,importance_stale,%g,%d,%.5g,0,0\n", epoch, given->delta, EXACT_BATCH,
                table_variance(&all, &stale[STALE_MIXED].table[0], every, probability) / uniform);

        sampler_refresh(&fresh, &all);
        sampler_refresh(&parts, &all);
        sampler balance = parts, stale_balance = stale[STALE_PARTS];
        balance.mode = stale_balance.mode = BALANCE;
        const sampler *drawn[] = {&fresh, &balance, &parts, &stale_balance, &stale[STALE_PARTS]};
        static const char *const name[] = {"importance_drawn", "balance", "omis", "balance_stale", "omis_stale"};
        for (size_t k = 0; k < sizeof name / sizeof *name; ++k) {
            double ratio = drawn_error(*drawn[k], &all, &r.net, train, &space, &error) * DRAWN_BATCH / uniform;
            fprintf(file, "%u,%s,%g,%d,%.5g,%.3g,%d\n", epoch, name[k], given->delta, DRAWN_BATCH, ratio,
                    error * DRAWN_BATCH / uniform, DRAWN_BATCHES);
        }
        fflush(file);
    }
    if (ferror(file) || fclose(file) != 0)
        fail("cannot write %s", given->variance);
    free(probability);
    free(every);
    scan_free(&all);
    workspace_free(&space);
    workspace_free(&large);
    for (int k = 0; k < STALE; ++k)
        sampler_free(&stale[k]);
    sampler_free(&fresh);
    sampler_free(&parts);
    run_free(&r);
}

#endif
