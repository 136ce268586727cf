/* Several processes train one model, each with a part of the data: minibatches by importance over all parts.
 *
 * Per step they exchange 16 bytes each (the size and total importance of their table) and, as any data-parallel
 * trainer, the sum of their gradients. Here through pipes; on a cluster all_gather() is MPI_Allgather() and
 * all_reduce() MPI_Allreduce(). */
#define _POSIX_C_SOURCE 200112L
#include "noisefloor.h"
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

/* MESSAGE: the most bytes that a process says at once: an nf_shard, or up to 8 sums. */
enum { RANKS = 4, BATCH = 64, MESSAGE = 64, MOST = 20000 };
static const uint32_t sizes[RANKS] = {12000, 3000, 20000, 5000};

/* ---- communication ---- */

static int up[RANKS][2], down[RANKS][2], rank;

/* A signal may come in between: nothing was transferred then. */
static int transfer(int receive, int file, void *data, size_t bytes)
{
    char *at = data;
    while (bytes > 0) {
        ssize_t n = receive ? read(file, at, bytes) : write(file, at, bytes);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return 0;
        at += n;
        bytes -= (size_t)n;
    }
    return 1;
}

/* What every process has to say, in the order of their ranks, to every process. */
static void all_gather(const void *mine, size_t bytes, void *all)
{
    char message[MESSAGE] = {0}, gathered[RANKS][MESSAGE];
    int r;
    if (bytes > MESSAGE) {
        fprintf(stderr, "process %d: %zu bytes are more than a message of %d\n", rank, bytes, MESSAGE);
        exit(1);
    }
    memcpy(message, mine, bytes);
    if (!transfer(0, up[rank][1], message, MESSAGE) || !transfer(1, down[rank][0], gathered, sizeof gathered))
        exit(1);
    for (r = 0; r < RANKS; ++r)
        memcpy((char *)all + (size_t)r * bytes, gathered[r], bytes);
}

static void all_reduce(double *values, int count)
{
    double all[RANKS * MESSAGE / sizeof(double)];
    int r, k;
    all_gather(values, (size_t)count * sizeof *values, all);
    memset(values, 0, (size_t)count * sizeof *values);
    for (r = 0; r < RANKS; ++r)
        for (k = 0; k < count; ++k)
            values[k] += all[r * count + k];
}

/* The process in the middle passes messages on until the first rank has ended. */
static void relay(void)
{
    char gathered[RANKS][MESSAGE];
    int r;
    for (;;) {
        for (r = 0; r < RANKS; ++r)
            if (!transfer(1, up[r][0], gathered[r], MESSAGE))
                return;
        for (r = 0; r < RANKS; ++r)
            if (!transfer(0, down[r][1], gathered, sizeof gathered))
                return;
    }
}

/* ---- the model: y = a x + b, loss (a x + b - y)^2 / 2 ---- */

static float x[MOST], y[MOST];

static void make_data(void)
{
    nf_rng rng;
    uint32_t i;
    nf_rng_seed(&rng, 1000 + (uint64_t)rank);
    for (i = 0; i < sizes[rank]; ++i) {
        float wide = nf_rng_uniform(&rng) < 0.02f ? 10.0f : 1.0f; /* a few items matter more than all others, */
        if (rank == 3)
            wide *= 3.0f; /* and one process has most of them */
        x[i] = wide * (2.0f * nf_rng_uniform(&rng) - 1.0f);
        y[i] = 2.0f * x[i] - 1.0f + 0.2f * (nf_rng_uniform(&rng) - 0.5f);
    }
}

static void check(nf_status status)
{
    if (status != NF_OK) {
        fprintf(stderr, "process %d: %s\n", rank, nf_status_message(status));
        exit(1);
    }
}

static double residual(const double *theta, uint32_t item) { return theta[0] * x[item] + theta[1] - y[item]; }

/* The norm of an item's gradient: the best importance there is. */
static float importance(const double *theta, uint32_t item)
{
    return (float)(fabs(residual(theta, item)) * sqrt(1.0 + (double)x[item] * x[item]));
}

/* Every process's part of one batch, and the estimate of the gradient of the mean loss over the items of all of them.
 */
static void estimate(nf_table *table, nf_rng *common, nf_rng *own, double *theta, double *gradient)
{
    nf_shard mine, shards[RANKS];
    uint32_t counts[RANKS], index[BATCH], k;
    float weight[BATCH], seen[BATCH];
    check(nf_table_shard(table, &mine));
    all_gather(&mine, sizeof mine, shards);
    /* The same seed and the same calls everywhere: all processes agree on the counts. */
    check(nf_shards_allocate(shards, RANKS, table->uniform_fraction, common, BATCH, counts));
    check(nf_table_draw_shard(table, shards, RANKS, own, counts[rank], index, weight));
    gradient[0] = gradient[1] = 0.0;
    for (k = 0; k < counts[rank]; ++k) {
        double r = weight[k] * residual(theta, index[k]) / BATCH; /* the whole batch's size */
        gradient[0] += r * x[index[k]];
        gradient[1] += r;
        seen[k] = importance(theta, index[k]);
    }
    check(nf_table_update(table, index, seen, counts[rank], 0.3f));
    all_reduce(gradient, 2);
}

/* Mean and variance of the estimates where the model stands still, against the exact gradient and uniform minibatches.
 */
static int statistics(nf_table *table, nf_rng *common, nf_rng *own)
{
    const int steps = 3000;
    double theta[2] = {0.0, 0.0}, exact[3] = {0.0, 0.0, 0.0}, gradient[2], items = 0.0, sum = 0.0, squares = 0.0,
           uniform, variance, z;
    uint32_t i;
    int step;
    for (i = 0; i < sizes[rank]; ++i) {
        double g = residual(theta, i) * x[i];
        exact[0] += g;
        exact[1] += g * g;
        exact[2] += 1.0;
    }
    all_reduce(exact, 3);
    items = exact[2];
    uniform = (exact[1] / items - exact[0] / items * (exact[0] / items)) / BATCH;
    for (step = 0; step < steps; ++step) {
        estimate(table, common, own, theta, gradient);
        sum += gradient[0];
        squares += gradient[0] * gradient[0];
    }
    sum /= steps;
    variance = (squares - steps * sum * sum) / (steps - 1);
    z = (sum - exact[0] / items) / sqrt(variance / steps);
    if (rank == 0) {
        printf("gradient: exact %.5f, mean of %d estimates %.5f, z = %.2f\n", exact[0] / items, steps, sum, z);
        printf("variance: %.5f, of uniform minibatches %.5f, ratio %.3f\n", variance, uniform, variance / uniform);
    }
    return fabs(z) < 4.42 && variance < 0.5 * uniform; /* z: significance 1e-5 */
}

/* Stochastic gradient descent, against least squares over all items. */
static int train(nf_table *table, nf_rng *common, nf_rng *own)
{
    double theta[2] = {0.0, 0.0}, s[5] = {0.0, 0.0, 0.0, 0.0, 0.0}, gradient[2], a, b;
    uint32_t i;
    int step;
    for (step = 0; step < 1000; ++step) {
        const double rate = 0.2 / (1.0 + step / 50.0);
        estimate(table, common, own, theta, gradient);
        theta[0] -= rate * gradient[0];
        theta[1] -= rate * gradient[1];
    }
    for (i = 0; i < sizes[rank]; ++i) {
        s[0] += 1.0;
        s[1] += x[i];
        s[2] += (double)x[i] * x[i];
        s[3] += y[i];
        s[4] += (double)x[i] * y[i];
    }
    all_reduce(s, 5);
    a = (s[0] * s[4] - s[1] * s[3]) / (s[0] * s[2] - s[1] * s[1]);
    b = (s[3] - a * s[1]) / s[0];
    if (rank == 0)
        printf("fit: %.4f x + %.4f, least squares: %.4f x + %.4f\n", theta[0], theta[1], a, b);
    return fabs(theta[0] - a) < 0.02 && fabs(theta[1] - b) < 0.02;
}

static int run(void)
{
    static uint64_t memory[MOST * 5 / 8 + 64];
    static uint32_t every[MOST];
    static float first[MOST];
    const double start[2] = {0.0, 0.0};
    nf_table table;
    nf_rng common, own;
    uint32_t i;
    int good;
    make_data();
    nf_rng_seed(&common, 7);                     /* the same in every process */
    nf_rng_seed(&own, 100 + (uint64_t)rank);     /* another in each */
    check(nf_table_init(&table, memory, sizeof memory, sizes[rank], NULL));
    /* An initial epoch would visit the items in minibatches; here at once. */
    for (i = 0; i < sizes[rank]; ++i) {
        every[i] = i;
        first[i] = importance(start, i);
    }
    check(nf_table_update(&table, every, first, sizes[rank], 0.0f));
    good = statistics(&table, &common, &own);
    good &= train(&table, &common, &own);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "process %d: standard output cannot be written\n", rank);
        good = 0;
    }
    return good ? 0 : 1;
}

int main(void)
{
    pid_t child[RANKS];
    int r, k, started, failed = 0;
    signal(SIGPIPE, SIG_IGN); /* who writes to a process that has ended is told by write(), and ends with a status */
    for (r = 0; r < RANKS; ++r)
        if (pipe(up[r]) != 0 || pipe(down[r]) != 0) {
            perror("pipe");
            return 2;
        }
    for (started = 0; started < RANKS; ++started) {
        child[started] = fork();
        if (child[started] < 0) {
            perror("fork");
            failed = 1;
            break;
        }
        if (child[started] == 0) {
            rank = r = started;
            for (k = 0; k < RANKS; ++k) {
                close(up[k][0]);
                close(down[k][1]);
                if (k != r) {
                    close(up[k][1]);
                    close(down[k][0]);
                }
            }
            exit(run());
        }
    }
    for (r = 0; r < RANKS; ++r) {
        close(up[r][1]);
        close(down[r][0]);
    }
    if (started == RANKS)
        relay();
    for (r = 0; r < RANKS; ++r) {
        close(up[r][0]);
        close(down[r][1]); /* whoever still waits is told */
    }
    for (r = 0; r < started; ++r) {
        int status = 1;
        failed |= waitpid(child[r], &status, 0) != child[r] || !WIFEXITED(status) || WEXITSTATUS(status) != 0;
    }
    return failed;
}
