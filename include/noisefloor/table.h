/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_TABLE_H
#define NOISEFLOOR_TABLE_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Minibatches: items drawn in proportion to their importance, and gradients of the mean loss from them.
 * Guides, in docs/: minibatch.md, minibatch_gradients.md. */

#define NF_TABLE_SAVED_HEADER 32 // nf_table_save: the bytes before those of the items, of which each takes 4.

// The importances of the items of a data set, from which minibatches are drawn (Algorithm 3).
//
// Item i is drawn with probability p_i = (1 - d) q_i / sum q + d / N: q_i is its importance, d the uniform fraction,
// .2 unless set. No weight 1 / (N p_i) is then above 1 / d. Draws and weights round alike; where d is 0, an item
// beside one 2^53 times as important is lost. Where all importances are 0 draws are uniform, or NF_ERR_NO_SAMPLES if d
// is 0. The struct refers to the memory its items live in: keep one copy.
typedef struct nf_table {
    float *importance; // q_i, of each item, to be read. In the memory given to nf_table_init.
    int64_t *sums; // The sums over them, behind.
    double scale; // A power of two: importances times this are what is summed.
    uint32_t items; // How many items there are: N.
    uint32_t blocks; // How many blocks of 16 items there is room for.
    // d, the part of draws that are uniform; to be written at will, 0 to 1, else all calls are NF_ERR_RANGE. At 0 an
    // item of importance 0 is never drawn, and one whose importance is out of date can get a weight of thousands.
    float uniform_fraction;
    uint32_t magic; // Says that this is a table.
} nf_table;

// Bytes of memory of a table, at most 4.6 for each item and a few hundred; 0 for 0 items, or if no memory has them.
size_t nf_table_size(uint32_t items);

// Makes a table of `items` items in `memory`, of which more than nf_table_size(items) bytes are room for
// nf_table_append; all are written. importance[items]: at least 0, finite, not all 0; or NULL, which makes all 1, for
// an initial epoch (Algorithm 4). uniform_fraction becomes .2.
// NF_ERR_RANGE: no items, bytes beyond any memory, a negative importance; NF_ERR_NOT_FINITE; NF_ERR_NO_SAMPLES: all
// are 0; NF_ERR_MEMORY.
nf_status nf_table_init(nf_table *table, void *memory, size_t bytes, uint32_t items, const float *importance);

// Draws `batch` items with replacement, independently, in proportion to importance.
// index[batch]: the items. weight[batch]: 1 / (N p) of each: gradients times weights, averaged over the batch,
// estimate the gradient of the mean loss without bias (6.3). NULL where they are not wanted: adaptive sampling (w = p
// in Algorithm 3), which favours important items, a bias by design.
// NF_ERR_RANGE: uniform_fraction; NF_ERR_NO_SAMPLES: nothing can be drawn. A batch of 0 is no error.
nf_status nf_table_draw(const nf_table *table, nf_rng *rng, uint32_t batch, uint32_t *index, float *weight);

// As nf_table_draw, from `batch` equal parts of the line of probabilities: less variance where neighbouring items are
// alike. In the order of the data set but within blocks of 16, uniform draws first: use the batch as a whole.
nf_status nf_table_draw_stratified(const nf_table *table, nf_rng *rng, uint32_t batch, uint32_t *index, float *weight);

// Draws `batch` different items, the k-th being item i with probability c_i = ((1 - d) q_i / sum q + d / N) / (1 - d
// (k - 1) / N), the sum being that of the items not yet drawn, d 1 where it is 0. weight: (1 / c_k + batch - k) / N,
// at most 1 / d + (batch - 1) / N, for the same unbiased estimate (Raj 1956).
//
// The table is written meanwhile, and the same afterwards. A draw takes the time of some ten updates, or, where a few
// items have nearly all of the sum, time for every item.
// NF_ERR_RANGE: more than there are items; NF_ERR_NO_SAMPLES also where d is 0 and fewer items have an importance
// above 0; else as for nf_table_draw.
nf_status nf_table_draw_distinct(nf_table *table, nf_rng *rng, uint32_t batch, uint32_t *index, float *weight);

// Sets the importance of visited items, one after the other: q = momentum q + (1 - momentum) importance (line 13 of
// Algorithm 3, (6.11)). An item that comes twice is changed twice.
// index[batch]; importance[batch]: at least 0, finite. momentum: 0..1; 0 forgets the old value, .3 is a good choice.
// NF_ERR_RANGE: an item, an importance, momentum; NF_ERR_NOT_FINITE.
nf_status nf_table_update(nf_table *table, const uint32_t *index, const float *importance, uint32_t batch,
    float momentum);

// Adds epsilon, at least 0, to every importance: line 15 of Algorithm 3. The uniform fraction does so at no cost.
// NF_ERR_RANGE; NF_ERR_NOT_FINITE.
nf_status nf_table_add_epsilon(nf_table *table, float epsilon);

// Adds `count` items behind the last.
// NF_ERR_MEMORY: nf_table_init got no room; NF_ERR_RANGE, NF_ERR_NOT_FINITE: an importance.
nf_status nf_table_append(nf_table *table, const float *importance, uint32_t count);

// The probabilities of `count` items: p[k * stride] of index[k]. With J tables, stride J and p + j for the j-th table
// make the rows that nf_omis_weights takes.
// NF_ERR_RANGE: an item, or stride 0; NF_ERR_NO_SAMPLES as for nf_table_draw.
nf_status nf_table_probabilities(const nf_table *table, const uint32_t *index, uint32_t count, uint32_t stride,
    float *p);

// Writes the table, the same bytes on every target: exactly NF_TABLE_SAVED_HEADER + 4 * items, of any alignment.
// NF_ERR_LENGTH.
nf_status nf_table_save(const nf_table *table, void *saved, size_t len);

// A table as nf_table_save wrote it, in memory as for nf_table_init: it draws the same items from the same generator.
// NF_ERR_FOREIGN, NF_ERR_VERSION, NF_ERR_LENGTH, NF_ERR_CORRUPT: `saved`; NF_ERR_MEMORY; NF_ERR_RANGE: bytes, len.
nf_status nf_table_load(nf_table *table, void *memory, size_t bytes, const void *saved, size_t len);

// What the processes of a data-parallel trainer, each with the table of its part of the data, must know of each
// other's: before a draw all gather these 16 bytes (MPI_Allgather, for example).
typedef struct nf_shard {
    double importance; // The sum of the importances.
    uint64_t items; // The number of items.
} nf_shard;

nf_status nf_table_shard(const nf_table *table, nf_shard *out); // What the other processes must know of this table.

// How many of a batch's items each process draws: counts[shards], in proportion to the shards' probabilities, each
// right on average. They sum to batch. Every process calls it with the same shards and a generator of the same seed.
// uniform_fraction: that of all tables.
// NF_ERR_RANGE: a negative sum, one of no items, 2^53 items or more together, uniform_fraction; NF_ERR_NOT_FINITE;
// NF_ERR_NO_SAMPLES: no shards, no items, or nothing that can be drawn.
nf_status nf_shards_allocate(const nf_shard *shard, uint32_t shards, float uniform_fraction, nf_rng *rng,
    uint32_t batch, uint32_t *counts);

// As nf_table_draw, for this process's part of a batch over all shards, of which this table is one, unchanged since
// its nf_shard was made: gradients times weights, summed over all processes and divided by the whole batch's size,
// estimate the gradient of the mean loss over all items. batch: from nf_shards_allocate. Where the others dwarf it a
// weight may be infinite.
// NF_ERR_RANGE also if the shards have less than this table; else as for nf_table_draw and nf_shards_allocate.
nf_status nf_table_draw_shard(const nf_table *table, const nf_shard *shard, uint32_t shards, nf_rng *rng,
    uint32_t batch, uint32_t *index, float *weight);

// The elements from `position` on of a random permutation of 0..items-1, which seed chooses: an epoch's order
// (Algorithm 4) with no array of all. Positions beyond the last start again. index[count]: the output.
// NF_ERR_RANGE: no items.
nf_status nf_shuffle(uint64_t seed, uint32_t items, uint64_t position, uint32_t count, uint32_t *index);

#define NF_NODES_NORM 0 // nf_importance_gradient split: one importance per group of nodes, the norm over it.
// nf_importance_gradient split: two per group, the norms of the positive and of the negative parts, which can combine
// linearly to the derivative itself: the choice for optimal MIS.
#define NF_NODES_SIGN 1

// Of each of `rows` items: || softmax(logits) - onehot(label) ||, the norm of the cross-entropy loss's derivative by
// the logits (6.10), 0 to 1.4143; the loss; and that derivative, where backpropagation starts. NULL: not wanted.
// logits[rows * classes]: finite, of any size. label[rows]: below classes. importance[rows], loss[rows], gradient[rows
// * classes]: outputs; a loss beyond the range of float becomes the largest finite float.
// NF_ERR_RANGE: a label, or no classes; NF_ERR_NOT_FINITE: a logit.
nf_status nf_importance_cross_entropy(const float *logits, const uint32_t *label, uint32_t rows, uint32_t classes,
    float *importance, float *loss, float *gradient);

// Of each of `rows` items || 2 (output - target) ||, the norm of the derivative of the loss sum (output - target)^2.
// output[rows * outputs], target[rows * outputs]: finite. importance[rows]: outputs, at most the largest finite float.
// NF_ERR_RANGE: no outputs; NF_ERR_NOT_FINITE.
nf_status nf_importance_squared_error(const float *output, const float *target, uint32_t rows, uint32_t outputs,
    float *importance);

// Of each of `rows` items one importance for each of `techniques` tables, from any derivative of the loss by the
// output nodes: || dL/dm || of section 6.1.4 for one table, after section 6.2.3 for several.
// gradient[rows * outputs]: dL/dm, finite. Node k belongs to group k % groups, groups being techniques with
// NF_NODES_NORM and half as many with NF_NODES_SIGN: importance[g] is the norm over group g, or importance[2 g],
// importance[2 g + 1] those of max(gradient, 0) and max(-gradient, 0), a split of our own. techniques:
// 1..NF_MIS_MAX_TECHNIQUES. importance[rows * techniques]: outputs, a row for each item, at most the largest float.
// NF_ERR_RANGE: split, techniques, or fewer outputs than groups; NF_ERR_NOT_FINITE.
nf_status nf_importance_gradient(const float *gradient, uint32_t rows, uint32_t outputs, uint32_t split,
    uint32_t techniques, float *importance);

// What nf_importance_gradient takes, for nf_check().
typedef struct nf_importance_arguments {
    uint32_t outputs; // At least one for each group.
    uint32_t split; // NF_NODES_*
    uint32_t techniques; // 1 to NF_MIS_MAX_TECHNIQUES, with NF_NODES_SIGN an even number.
} nf_importance_arguments;

// The optimal MIS gradient of a minibatch as a weight for each drawn item (section 6.2): (1 / batch) sum_s weight[s] *
// gradient_s is the mean loss's, for every parameter at once, by one backward pass over weighted losses.
// solver: NF_OMIS_RIDGE or NF_OMIS_PLAIN, consistent, of weights that may be negative, or NF_OMIS_BALANCE, unbiased.
// ridge: as for nf_omis_solve. techniques: J, 1..NF_MIS_MAX_TECHNIQUES. items: N, of the data set, at least 1.
// pdf[batch * J]: the probability, above 0 to 1 (1.001 for rounding), with which technique j draws the item of sample
// s, at s * J + j, before any update; 0 only for others than the technique that drew it: technique[batch].
// weight[batch]: the output; one beyond the range of float becomes the largest finite float.
//
// With n_j samples of technique j, S_s = sum_k n_k p_k, q = sum_s p_s / S_s and A = sum_s p_s p_s' / S_s^2, weight_s =
// (1 / S_s - (q - 1)' (A + ridge)^-1 p_s / S_s^2) batch / items.
// NF_ERR_RANGE: solver, ridge, techniques, items, a technique or a probability; NF_ERR_NOT_FINITE: ridge or a
// probability; NF_ERR_NO_SAMPLES: an empty batch; NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE.
nf_status nf_omis_weights(uint32_t solver, float ridge, uint32_t techniques, uint32_t items, const float *pdf,
    const uint32_t *technique, uint32_t batch, float *weight);

// Optimal MIS gradients from explicit per-item gradients, with momentum over steps (section 6.2.3): averages over the
// batches so far of J + 1 floats per parameter. May be moved and copied as nf_cv_accumulator. Without momentum
// nf_omis_weights gives the same estimate at the cost of one weighted backward pass.
typedef struct nf_gradient nf_gradient;

// Bytes of an nf_gradient, 4 (techniques + 1) per parameter and about 1.4 kB; 0 unless techniques is
// 1..NF_MIS_MAX_TECHNIQUES and parameters at least 1, or if no memory has them.
size_t nf_gradient_size(uint32_t techniques, uint32_t parameters);

// Makes an nf_gradient without a batch in `memory`, or makes one forget: `*out` is its handle, the same address.
// NF_ERR_RANGE: techniques or parameters; NF_ERR_MEMORY.
nf_status nf_gradient_init(void *memory, size_t bytes, uint32_t techniques, uint32_t parameters, nf_gradient **out);

// Adds a batch of drawn items, and estimates the gradient of the mean loss from it and, with momentum, those before.
//
// solver, ridge, items, pdf[batch * techniques], technique[batch]: as for nf_omis_weights. beta: the momentum, 0..1. A
// batch that is t steps old counts beta^t, divided by the sum of those weights: 0 forgets the earlier batches, 1
// averages all; from 2^16 batches on, more is 1 - 2^-16. Older gradients lag: with an optimiser's momentum, use 0.
// gradient[batch * parameters]: those of each sample, row after row, finite, unweighted; read twice.
// estimate[parameters]: the output; one beyond the range of float becomes the largest finite float.
// NF_ERR_RANGE also for beta, or gradients over probabilities beyond the range of float; NF_ERR_NOT_FINITE also for
// beta or a gradient; else as for nf_omis_weights.
nf_status nf_gradient_estimate(nf_gradient *state, uint32_t solver, float ridge, float beta, uint32_t items,
    const float *pdf, const uint32_t *technique, const float *gradient, uint32_t batch, float *estimate);

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_TABLE_H */
