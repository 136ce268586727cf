/* Which items a step sees and what each weighs: all that the trainer asks of noisefloor. */
#ifndef TRAIN_MLP_SAMPLER_H
#define TRAIN_MLP_SAMPLER_H

#include "mlp.h"
#include "options.h"

typedef struct sampler {
    const options *o;
    enum mode mode;
    uint32_t items;
    uint64_t seed;
    nf_rng rng;
    uint32_t tables; /* none: uniform; one: importance and adaptive; J: balance and omis */
    nf_table table[MAX_TECHNIQUES];
    void *memory[MAX_TECHNIQUES];
    /* scratch, per item of a batch */
    uint32_t *technique;
    float *pdf, *importance;
} sampler;

static sampler sampler_create(const options *o, enum mode mode, uint32_t items, uint64_t seed)
{
    sampler s = {0};
    s.o = o, s.mode = mode, s.items = items, s.seed = seed;
    s.tables = mode == UNIFORM ? 0 : mode == BALANCE || mode == OMIS ? o->techniques : 1;
    nf_rng_seed(&s.rng, ((uint64_t)1 << 32) + seed); /* not the numbers that the network begins with */
    size_t bytes = nf_table_size(items);
    for (uint32_t j = 0; j < s.tables; ++j) {
        s.memory[j] = allocate(bytes, 1);
        check(nf_table_init(&s.table[j], s.memory[j], bytes, items, NULL), "table of importances");
        s.table[j].uniform_fraction = o->delta;
    }
    s.technique = allocate(o->batch, sizeof *s.technique);
    s.pdf = allocate((size_t)o->batch * MAX_TECHNIQUES, sizeof *s.pdf);
    s.importance = allocate((size_t)o->batch * MAX_TECHNIQUES, sizeof *s.importance);
    return s;
}

static void sampler_free(sampler *s)
{
    for (uint32_t j = 0; j < s->tables; ++j)
        free(s->memory[j]);
    free(s->technique);
    free(s->pdf);
    free(s->importance);
}

/* Where no item's derivative has the sign that a table is for, as of outputs that no label names, there is nothing to
   draw by: it is uniform until a visit finds one. */
static void sampler_keep_drawable(nf_table *table)
{
    nf_shard all;
    check(nf_table_shard(table, &all), "table of importances");
    if (all.importance == 0.0)
        check(nf_table_add_epsilon(table, 1e-20f), "table of importances");
}

static void sampler_draw_table(sampler *s, uint32_t j, uint32_t count, uint32_t *index, float *weight)
{
    if (count == 0)
        return;
    check(s->o->stratified ? nf_table_draw_stratified(&s->table[j], &s->rng, count, index, weight)
                           : nf_table_draw(&s->table[j], &s->rng, count, index, weight),
          "drawing a minibatch");
}

/* `count` draws, whatever the epoch. (1 / count) sum of weight * gradient estimates the gradient of the mean loss. */
static void sampler_draw_weighted(sampler *s, uint32_t count, uint32_t *index, float *weight)
{
    if (s->mode == IMPORTANCE) {
        sampler_draw_table(s, 0, count, index, weight);
        return;
    }
    if (s->mode == ADAPTIVE) { /* the same draws; without the weights it is another loss that is minimised */
        sampler_draw_table(s, 0, count, index, NULL);
        for (uint32_t r = 0; r < count; ++r)
            weight[r] = 1.0f;
        return;
    }
    /* As many draws from each table; then each item's probability under all of them, [count * tables]. */
    uint32_t start = 0;
    for (uint32_t j = 0; j < s->tables; ++j) {
        uint32_t share = count / s->tables + (j < count % s->tables);
        sampler_draw_table(s, j, share, index + start, NULL);
        for (uint32_t r = start; r < start + share; ++r)
            s->technique[r] = j;
        start += share;
    }
    for (uint32_t j = 0; j < s->tables; ++j)
        check(nf_table_probabilities(&s->table[j], index, count, s->tables, s->pdf + j), "probabilities");
    check(nf_omis_weights(s->mode == OMIS ? NF_OMIS_RIDGE : NF_OMIS_BALANCE, 0.0f, s->tables, s->items, s->pdf,
                          s->technique, count, weight),
          "weights of the minibatch");
}

/* The `position`-th to (position + count)-th items of an epoch. The first epoch sees every item once (Algorithm 4). */
static void sampler_draw(sampler *s, uint32_t epoch, uint32_t position, uint32_t count, uint32_t *index, float *weight)
{
    if (epoch > 0 && s->mode != UNIFORM) {
        sampler_draw_weighted(s, count, index, weight);
        return;
    }
    check(nf_shuffle(s->seed * MAX_EPOCHS + epoch, s->items, position, count, index), "nf_shuffle");
    for (uint32_t r = 0; r < count; ++r)
        weight[r] = 1.0f;
}

/* Remembers how important the items were, from the forward pass that training needed anyway: the space holds their
   logits, and softmax - onehot in delta[LAYERS]. `gamma` is nought where there is nothing older (Algorithm 3, line 13;
   5, line 19). */
static void sampler_update(sampler *s, const mlp *net, const workspace *space, const uint32_t *index, uint32_t count,
                           float gamma)
{
    uint32_t classes = net->size[LAYERS];
    if (s->tables == 1) {
        check(nf_importance_cross_entropy(space->activation[LAYERS], space->label, count, classes, s->importance, NULL,
                                          NULL),
              "importances");
        check(nf_table_update(&s->table[0], index, s->importance, count, gamma), "update of the importances");
        return;
    }
    /* Each output's derivative, its positive and its negative part apart, outputs grouped so that the tables suffice.
     */
    float part[MAX_TECHNIQUES];
    for (uint32_t r = 0; r < count && s->tables > 0; ++r) {
        check(nf_importance_gradient(space->delta[LAYERS] + (size_t)r * classes, 1, classes, NF_NODES_SIGN, s->tables,
                                     part),
              "importances");
        for (uint32_t j = 0; j < s->tables; ++j)
            s->importance[(size_t)j * count + r] = part[j];
    }
    for (uint32_t j = 0; j < s->tables; ++j) {
        check(nf_table_update(&s->table[j], index, s->importance + (size_t)j * count, count, gamma),
              "update of the importances");
        sampler_keep_drawable(&s->table[j]);
    }
}

/* At the end of an epoch (Algorithm 3, line 15). */
static void sampler_end_epoch(sampler *s)
{
    for (uint32_t j = 0; j < s->tables && s->o->epsilon > 0.0f; ++j)
        check(nf_table_add_epsilon(&s->table[j], s->o->epsilon), "--epsilon");
}

#endif
