/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_TABLE_H
#define NOISEFLOOR_TABLE_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Minibatches: items drawn in proportion to their importance, and gradients of the mean loss from them.
 * Guides, in docs/: minibatch.md, minibatch_gradients.md. */

// The importances of the items of a data set, from which minibatches are drawn (Algorithm 3).
//
// Item i is drawn with probability p_i = (1 - d) q_i / sum q + d / N: q_i is its importance, d the uniform fraction,
// .2 unless set. No weight 1 / (N p_i) is then above 1 / d. Where all importances are 0 draws are uniform, or
// NF_ERR_NO_SAMPLES if d is 0.
//
// A complete struct that refers to the memory its items live in; the fields are to be read, never written. A copy
// refers to the same memory: keep one. Nothing to destroy. Should that memory change on its own, what is drawn are
// still items that exist, if not as often as they should be.
typedef struct nf_table {
    // The importance of each item, in the memory given to nf_table_init.
    float *importance;
    // The sums over them, behind.
    int64_t *sums;
    // A power of two: importances times this are what is summed.
    double scale;
    // How many items there are: N.
    uint32_t items;
    // How many blocks of 16 items there is room for.
    uint32_t blocks;
    // The part of draws that are uniform.
    float uniform_fraction;
    // Says that this is a table.
    uint32_t magic;
} nf_table;

// The bytes of memory a table of so many items needs, at most 4.6 for each and a few hundred; 0 for 0 items or a size
// that no memory has.
size_t nf_table_size(uint32_t items);

// Makes a table of `items` items in `memory`.
//
// memory: at least nf_table_size(items) bytes, 8-byte aligned; what it holds is lost. More is room for
// nf_table_append. importance[items]: at least 0, finite, not all 0; or NULL, which makes all 1, for an initial epoch
// that visits every item (Algorithm 4).
//
// NF_ERR_NULL; NF_ERR_RANGE: no items, or a negative importance; NF_ERR_NOT_FINITE; NF_ERR_NO_SAMPLES: all are 0;
// NF_ERR_MEMORY; NF_ERR_ALIGNMENT.
nf_status nf_table_init(nf_table *table, void *memory, size_t bytes, uint32_t items, const float *importance);

// Draws `batch` items with replacement, independently, in proportion to importance.
//
// index[batch]: the items. weight[batch]: 1 / (N p) of each, for importance sampling: gradients times weights,
// averaged over the batch, estimate the gradient of the mean loss without bias (6.3). NULL where they are not wanted:
// without weights it is adaptive sampling (w = p in Algorithm 3), which favours important items, a bias by design.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_NO_SAMPLES: nothing can be drawn. A batch of 0 is no error.
nf_status nf_table_draw(const nf_table *table, nf_rng *rng, uint32_t batch, uint32_t *index, float *weight);

// As nf_table_draw, from `batch` equal parts of the line of probabilities: item i comes about `batch` p_i times, so
// that the estimate varies less where neighbouring items are alike. Items drawn uniformly come first, and all in the
// order of the data set: use the batch as a whole.
nf_status nf_table_draw_stratified(const nf_table *table, nf_rng *rng, uint32_t batch, uint32_t *index, float *weight);

// Draws `batch` different items, without replacement, the k-th being item i with probability
//     c_i = ((1 - d) q_i / sum q + d / N) / (1 - d (k - 1) / N),
// the sum being that of the items not yet drawn, and d the uniform fraction (1 where that sum is 0). Weights make the
// same estimate as nf_table_draw's, without bias (Raj 1956): (1 / c_k + batch - k) / N for the k-th item.
//
// The table is the same afterwards, but is written meanwhile. A draw takes the time of some ten updates; where a few
// items have nearly all of the sum the table is built again without them, which takes time for every item.
//
// Other arguments and errors as for nf_table_draw; NF_ERR_RANGE: more than there are items; NF_ERR_NO_SAMPLES also
// where the uniform fraction is 0 and fewer items have an importance above 0.
nf_status nf_table_draw_distinct(nf_table *table, nf_rng *rng, uint32_t batch, uint32_t *index, float *weight);

// Sets the importance of visited items, one after the other: q = momentum q + (1 - momentum) importance (line 13 of
// Algorithm 3, (6.11)). An item that comes twice is changed twice.
//
// index[batch]; importance[batch]: at least 0, finite. momentum: 0..1; 0 forgets the old value, .3 is a good choice.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: an item that does not exist, a negative importance, momentum;
// NF_ERR_NOT_FINITE.
nf_status nf_table_update(nf_table *table, const uint32_t *index, const float *importance, uint32_t batch,
    float momentum);

// Sets the uniform fraction d, 0..1. 0 draws by importance alone: an item of importance 0 is never drawn, and one
// whose importance is out of date can get a weight of thousands. 1 draws uniformly.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE; NF_ERR_NOT_FINITE.
nf_status nf_table_set_uniform_fraction(nf_table *table, float fraction);

// Adds epsilon, at least 0, to every importance: line 15 of Algorithm 3, after an epoch. The uniform fraction does as
// much and costs nothing.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE; NF_ERR_NOT_FINITE.
nf_status nf_table_add_epsilon(nf_table *table, float epsilon);

// Adds `count` items behind the last.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_MEMORY: the memory given to nf_table_init has no room; NF_ERR_RANGE: a negative
// importance; NF_ERR_NOT_FINITE.
nf_status nf_table_append(nf_table *table, const float *importance, uint32_t count);

// The probability p_i of drawing an item; 0 if there is no such item or no table. It comes with the item in
// nf_table_draw's weight; this is for items that another table drew.
float nf_table_probability(const nf_table *table, uint32_t item);

// The probabilities of count items: p[k * stride] of index[k]. With J tables, stride J and p + j for the j-th table
// make the rows of densities that nf_omis_weights takes.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: an item that does not exist, or stride 0; NF_ERR_NO_SAMPLES as for
// nf_table_draw.
nf_status nf_table_probabilities(const nf_table *table, const uint32_t *index, uint32_t count, uint32_t stride,
    float *p);

// The importance q_i of an item; 0 if there is no such item or no table.
float nf_table_importance(const nf_table *table, uint32_t item);

// The sum of all importances; 0 if there is no table.
double nf_table_total(const nf_table *table);

// The bytes that nf_table_save writes; 0 if there is no table.
size_t nf_table_saved_size(const nf_table *table);

// Writes the table, the same bytes on every target, to exactly nf_table_saved_size bytes, of any alignment.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_LENGTH.
nf_status nf_table_save(const nf_table *table, void *saved, size_t len);

// The number of items in what nf_table_save wrote, to make memory for it with nf_table_size; 0 if it is no saved
// table. Only the first bytes are looked at.
uint32_t nf_table_saved_items(const void *saved, size_t len);

// A table as it was when nf_table_save wrote it, in memory as for nf_table_init. It draws the same items from the same
// generator.
//
// NF_ERR_NULL; NF_ERR_FOREIGN, NF_ERR_VERSION, NF_ERR_LENGTH, NF_ERR_CORRUPT: what is wrong with the bytes;
// NF_ERR_MEMORY; NF_ERR_ALIGNMENT.
nf_status nf_table_load(nf_table *table, void *memory, size_t bytes, const void *saved, size_t len);

// What the processes of a data-parallel trainer must know of each other's tables. Each owns the table of its part of
// the data; before a draw all gather these 16 bytes from each (MPI_Allgather, for example).
typedef struct nf_shard {
    // The sum of the importances.
    double importance;
    // The number of items.
    uint64_t items;
} nf_shard;

// What the other processes must know of this table.
//
// NF_ERR_NULL; NF_ERR_STATE.
nf_status nf_table_shard(const nf_table *table, nf_shard *out);

// How many of a batch's items each process draws: counts[shards], in proportion to the shards' probabilities, rounded
// up or down at random so that each is right on average. They sum to batch.
//
// Every process calls it with the same shards and a generator of the same seed, and finds its own count among the
// results. uniform_fraction: 0..1, that of all tables.
//
// NF_ERR_NULL; NF_ERR_RANGE: a negative sum, 2^53 items or more, uniform_fraction; NF_ERR_NOT_FINITE;
// NF_ERR_NO_SAMPLES: no shards, no items, or nothing that can be drawn.
nf_status nf_shards_allocate(const nf_shard *shard, uint32_t shards, float uniform_fraction, nf_rng *rng,
    uint32_t batch, uint32_t *counts);

// As nf_table_draw, for this process's part of a batch over all shards, of which this table is one: weights are those
// of the whole. Gradients times weights, summed over all processes and divided by the whole batch's size, estimate the
// gradient of the mean loss over all items.
//
// All tables must have the same uniform fraction; batch is what nf_shards_allocate gave to this process.
//
// Other arguments and errors as for nf_table_draw and nf_shards_allocate; NF_ERR_RANGE: the shards together have less
// than this table. A table must not have changed since its nf_shard was made. Where the others dwarf it a weight may
// be infinite.
nf_status nf_table_draw_shard(const nf_table *table, const nf_shard *shard, uint32_t shards, nf_rng *rng,
    uint32_t batch, uint32_t *index, float *weight);

// The element at `position` of a random permutation of 0..items-1, which seed chooses: the order of an initial epoch
// (Algorithm 4), or of minibatches drawn uniformly without replacement, with no array of indices. 0 if there are no
// items; positions beyond the last start again.
uint32_t nf_shuffle(uint64_t seed, uint32_t items, uint32_t position);

// nf_importance_nodes split: one importance per group of nodes, the norm over it.
#define NF_NODES_NORM 0
// nf_importance_nodes split: two per group, the norm of the positive parts and that of the negative parts. Importances
// of one sign can combine linearly to the derivative itself, which norms cannot: the choice for optimal MIS.
#define NF_NODES_SIGN 1

// || softmax(logits) - onehot(label) ||, the norm of the cross-entropy loss's derivative by the logits (6.10):
// 0..1.4143.
//
// logits[classes]: finite, of any size. label: below classes. No backward pass is needed; a norm near 0 keeps its
// relative accuracy.
//
// NaN, which nf_table_update refuses, for NULL, misaligned, a label out of range, or a logit that is NaN or infinite.
float nf_importance_cross_entropy(const float *logits, uint32_t classes, uint32_t label);

// The cross-entropy loss -ln softmax(logits)[label] itself, at least 0; one beyond the range of float becomes the
// largest finite float.
//
// Arguments, and NaN, as for nf_importance_cross_entropy.
float nf_importance_cross_entropy_loss(const float *logits, uint32_t classes, uint32_t label);

// || 2 (output - target) ||, the norm of the derivative of the loss sum (output - target)^2 by the outputs.
//
// output[outputs], target[outputs]: finite. One beyond the range of float becomes the largest finite float.
//
// NaN for NULL, misaligned, no outputs, or a value that is NaN or infinite.
float nf_importance_squared_error(const float *output, const float *target, uint32_t outputs);

// The L2 norm of any derivative of the loss by the outputs: || dL/dm || of (6.1.4).
//
// gradient[outputs]: finite. A norm beyond the range of float becomes the largest finite float.
//
// NaN for NULL, misaligned, no outputs, or a value that is NaN or infinite.
float nf_importance_gradient(const float *gradient, uint32_t outputs);

// The derivative of the cross-entropy loss by the logits, softmax(logits) - onehot(label) (6.10), where
// backpropagation starts.
//
// logits[classes]: finite, of any size. label: below classes. gradient[classes]: the output.
//
// NF_ERR_NULL; NF_ERR_RANGE: label; NF_ERR_NOT_FINITE: a logit.
nf_status nf_cross_entropy_gradient(const float *logits, uint32_t classes, uint32_t label, float *gradient);

// Importances of one item for several tables, from the derivative of the loss by each output node (6.2.3).
//
// gradient[outputs]: dL/dm, finite; at least one node per group. Node k belongs to group k % groups, so that every
// node has its table: a subset of the nodes, as section 6.2.3 proposes, leaves the gradients of the others uncovered.
// split: NF_NODES_NORM: groups = techniques, importance[g] = the norm over group g. NF_NODES_SIGN: techniques is even,
// groups = techniques / 2, importance[2 g] = the norm of max(gradient, 0) over group g, importance[2 g + 1] that of
// max(-gradient, 0).
// techniques: 1..NF_MIS_MAX_TECHNIQUES. importance[techniques]: the output, at least 0. An importance may be 0: the
// tables' uniform fraction is what still draws the item.
//
// NF_ERR_NULL; NF_ERR_RANGE: split, techniques, or fewer outputs than groups; NF_ERR_NOT_FINITE: a gradient.
nf_status nf_importance_nodes(const float *gradient, uint32_t outputs, uint32_t split, uint32_t techniques,
    float *importance);

// The optimal MIS gradient of a minibatch as one weight per drawn item (6.2): the gradient of the mean loss is
// (1 / batch) sum_s weight[s] * gradient_s for every parameter at once, so that one backward pass over weighted losses
// computes it. The same convention as the weights of nf_table_draw.
//
// solver: NF_OMIS_RIDGE, the default: shrinks to the balance heuristic where the batch says little. NF_OMIS_PLAIN:
// exact where a gradient is a linear combination of the probabilities; heavy-tailed with similar techniques or small
// batches. Both are consistent, not unbiased, and their weights may be negative. NF_OMIS_BALANCE: unbiased, positive.
// ridge: for NF_OMIS_RIDGE, as for nf_omis_solve: 1e-8..1e8, or 0 for the default 2; otherwise ignored. techniques: J
// in 1..NF_MIS_MAX_TECHNIQUES. items: N, the size of the data set, at least 1. pdf[batch * techniques]: at s *
// techniques + j the probability with which technique j draws the item of sample s; each technique's sum to 1 over the
// items. Finite, at least 0 and at most 1, positive for the technique that drew it. Those of before the batch was
// drawn: tables may be updated meanwhile. technique[batch]: which technique drew sample s. Their numbers n_j are
// counted from it; a technique that drew nothing has no part in the weights. batch: the number of samples, at least 1.
// weight[batch]: the output. One beyond the range of float becomes the largest finite float.
//
// With S_s = sum_k n_k p_k, q = sum_s p_s / S_s and A = sum_s p_s p_s' / S_s^2,
// weight_s = (1 / S_s - (q - 1)' (A + ridge)^-1 p_s / S_s^2) batch / items.
//
// NF_ERR_NULL; NF_ERR_RANGE: solver, ridge, techniques, items, a technique or a probability; NF_ERR_NOT_FINITE: ridge
// or a probability; NF_ERR_NO_SAMPLES: an empty batch; NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE.
nf_status nf_omis_weights(uint32_t solver, float ridge, uint32_t techniques, uint32_t items, const float *pdf,
    const uint32_t *technique, uint32_t batch, float *weight);

// Optimal MIS gradients from explicit per-item gradients, with momentum over steps (6.2.3): averages over the batches
// so far of the linear system that all parameters share, and J + 1 floats per parameter.
//
// Without momentum nf_omis_weights gives the same estimate, at the cost of one weighted backward pass.
//
// Lives in caller memory of nf_gradient_size bytes, 8-byte aligned; nothing to destroy. May be moved and copied as
// bytes between calls, in one process or among those that run the same library file; no file format, and for no one
// else to change, as for nf_cv_accumulator.
typedef struct nf_gradient nf_gradient;

// The bytes of memory an nf_gradient needs: 4 (techniques + 1) per parameter and about 1.4 kB. 0 unless techniques is
// in 1..NF_MIS_MAX_TECHNIQUES, parameters at least 1, and the size one that memory can have.
size_t nf_gradient_size(uint32_t techniques, uint32_t parameters);

// Makes an nf_gradient that has seen no batch in `memory`, `*out` being its handle (the same address).
//
// memory: at least nf_gradient_size(techniques, parameters) bytes, 8-byte aligned; what it holds is lost.
// techniques: J in 1..NF_MIS_MAX_TECHNIQUES. parameters: at least 1.
//
// NF_ERR_NULL; NF_ERR_RANGE: techniques or parameters; NF_ERR_MEMORY; NF_ERR_ALIGNMENT.
nf_status nf_gradient_init(void *memory, size_t bytes, uint32_t techniques, uint32_t parameters, nf_gradient **out);

// Adds a batch of drawn items, and estimates the gradient of the mean loss from it and, with momentum, those before.
//
// solver: NF_OMIS_RIDGE, NF_OMIS_PLAIN or NF_OMIS_BALANCE, and ridge, as for nf_omis_weights, where it is said which
// is unbiased. They may change from call to call. beta: 0..1, the momentum. A batch that is t steps old counts beta^t,
// divided by the sum of those weights: the estimate has its right size from the first step on. 0 forgets the earlier
// batches, and the estimate is that of nf_omis_weights but for rounding, which NF_OMIS_PLAIN magnifies where
// techniques are nearly alike; 1 averages all. Older gradients lag: under an optimiser with momentum of its own, such
// as Adam, use 0. items, pdf[batch * techniques], technique[batch]: as for nf_omis_weights, with the techniques of
// nf_gradient_init. gradient[batch * parameters]: that of sample s by parameter p at s * parameters + p, finite,
// unweighted. It is read twice: once to see that all of it is finite. batch: the number of samples.
// estimate[parameters]: the output. One beyond the range of float becomes the largest finite float.
//
// Sums are in float, in an order that does not depend on the processor.
//
// NF_ERR_NULL; NF_ERR_STATE; NF_ERR_RANGE: solver, ridge, beta, items, a technique or probability, or gradients over
// probabilities beyond the range of float; NF_ERR_NOT_FINITE: ridge, beta, a probability or gradient;
// NF_ERR_NO_SAMPLES: an empty batch; NF_ERR_UNSUPPORTED: NF_OMIS_PROGRESSIVE.
nf_status nf_gradient_estimate(nf_gradient *state, uint32_t solver, float ridge, float beta, uint32_t items,
    const float *pdf, const uint32_t *technique, const float *gradient, uint32_t batch, float *estimate);

// Forgets every batch; techniques and parameters stay.
//
// NF_ERR_NULL; NF_ERR_STATE.
nf_status nf_gradient_reset(nf_gradient *state);

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_TABLE_H */
