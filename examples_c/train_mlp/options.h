/* The command line. */
#ifndef TRAIN_MLP_OPTIONS_H
#define TRAIN_MLP_OPTIONS_H

#include "common.h"
#include <errno.h>

/* How minibatches are drawn and weighted. */
enum mode { UNIFORM, IMPORTANCE, ADAPTIVE, BALANCE, OMIS, MODES };
static const char *const mode_name[MODES] = {"uniform", "importance", "adaptive", "balance", "omis"};

#define MAX_TECHNIQUES 16
#define MAX_BATCH 4096
#define MAX_SEEDS 100
#define MAX_EPOCHS 1000

typedef struct options {
    const char *data;
    enum mode modes[MODES];
    uint32_t mode_count;
    uint32_t seed, seeds;
    uint32_t epochs, batch, rows;
    uint32_t hidden[2];
    int adam;
    float rate, final_rate, sgd_momentum;
    float gamma, delta, epsilon;
    int stratified;
    uint32_t techniques;
    const char *variance; /* NULL, or the file for the table of variances */
} options;

static const char usage[] =
    "train_mlp: trains a multilayer perceptron on images in IDX files, with minibatches drawn by noisefloor\n"
    "usage: train_mlp --data FOLDER [options]\n"
    "  --data FOLDER       train-images-idx3-ubyte, train-labels-idx1-ubyte and the same with t10k- to test\n"
    "  --modes A,B,...     (or --mode A; default uniform,importance) of:\n"
    "      uniform         every item once per epoch, in random order\n"
    "      importance      in proportion to ||softmax - onehot|| when last seen, weighted by 1 / (N p): unbiased\n"
    "      adaptive        the same items, weight 1: biased, it minimises another loss\n"
    "      balance         several importances (the signs of groups of outputs), balance heuristic: unbiased\n"
    "      omis            the same items, optimal-MIS weights: lower variance, slightly biased\n"
    "  --epochs N          10; the first is uniform for all modes and fills their tables\n"
    "  --batch N           64\n"
    "  --hidden A,B        128,64: sizes of the hidden layers\n"
    "  --optimizer NAME    adam (default) or sgd\n"
    "  --rate X            learning rate: 0.001 with adam, 0.1 with sgd\n"
    "  --final-rate X      1: the rate falls linearly, after the last step to that share of itself\n"
    "  --sgd-momentum X    0.9\n"
    "  --gamma X           0.3: an item's importance is gamma old + (1 - gamma) new\n"
    "  --delta X           0.2: share of items drawn uniformly; bounds every weight by 1 / delta\n"
    "  --epsilon X         0: added to every importance after each epoch\n"
    "  --stratified        one draw in each of as many equal parts of the distribution as there are items in the "
    "batch\n"
    "  --techniques J      8: distributions of balance and omis, an even number\n"
    "  --seed N            1; the first seed\n"
    "  --seeds N           1; runs with that many seeds, and a summary\n"
    "  --rows N            1: rows per epoch\n"
    "  --variance FILE     instead: one network, trained uniformly; FILE (CSV) gets the gradient's variance under each "
    "way\n"
    "                      to draw, relative to uniform draws\n"
    "Standard output: CSV. seconds is processor time spent in training, without evaluation. Standard error: the "
    "summary.\n";

static double option_number(const char *name, const char *text, double low, double high)
{
    char *end;
    errno = 0;
    double value = strtod(text, &end);
    if (end == text || *end != '\0' || errno != 0 || !(value >= low && value <= high))
        fail("%s: `%s` is not a number from %g to %g", name, text, low, high);
    return value;
}

static uint32_t option_whole(const char *name, const char *text, uint32_t low, uint32_t high)
{
    double value = option_number(name, text, low, high);
    if (value != (double)(uint32_t)value)
        fail("%s: `%s` is not a whole number", name, text);
    return (uint32_t)value;
}

static void option_modes(options *o, const char *text)
{
    o->mode_count = 0;
    while (*text != '\0') {
        size_t length = strcspn(text, ",");
        int mode = 0;
        while (mode < MODES && (strlen(mode_name[mode]) != length || strncmp(mode_name[mode], text, length) != 0))
            ++mode;
        if (mode == MODES)
            fail("there is no mode `%.*s`", (int)length, text);
        for (uint32_t i = 0; i < o->mode_count; ++i)
            if (o->modes[i] == (enum mode)mode)
                fail("mode `%s` is named twice", mode_name[mode]);
        o->modes[o->mode_count++] = (enum mode)mode;
        text += length;
        text += *text == ',';
    }
    if (o->mode_count == 0)
        fail("--modes names none");
}

/* Whether anything draws from several distributions, as many as --techniques says. */
static int options_use_techniques(const options *o)
{
    int use = o->variance != NULL;
    for (uint32_t i = 0; i < o->mode_count; ++i)
        use |= o->modes[i] == BALANCE || o->modes[i] == OMIS;
    return use;
}

static options options_parse(int count, char **words)
{
    options o = {0};
    o.modes[0] = UNIFORM, o.modes[1] = IMPORTANCE, o.mode_count = 2;
    o.seed = 1, o.seeds = 1, o.epochs = 10, o.batch = 64, o.rows = 1;
    o.hidden[0] = 128, o.hidden[1] = 64;
    o.adam = 1, o.final_rate = 1.0f, o.sgd_momentum = 0.9f;
    o.gamma = 0.3f, o.delta = 0.2f, o.techniques = 8;
    const char *compared = NULL; /* an option that --variance, which compares no runs, does not read */
    for (int i = 1; i < count; ++i) {
        const char *name = words[i];
        if (strcmp(name, "--help") == 0) {
            fputs(usage, stdout);
            if (fflush(stdout) != 0)
                fail("cannot write the output");
            exit(EXIT_SUCCESS);
        }
        if (strcmp(name, "--stratified") == 0) {
            o.stratified = 1;
            continue;
        }
        const char *value = i + 1 < count ? words[++i] : NULL;
        if (strncmp(name, "--", 2) != 0)
            fail("`%s` is no option; --help lists them", name);
        if (value == NULL)
            fail("%s: unknown, or its value is missing; --help lists the options", name);
        if (strcmp(name, "--mode") == 0 || strcmp(name, "--modes") == 0 || strcmp(name, "--seeds") == 0 ||
            strcmp(name, "--batch") == 0 || strcmp(name, "--rows") == 0)
            compared = name;
        if (strcmp(name, "--data") == 0)
            o.data = value;
        else if (strcmp(name, "--mode") == 0 || strcmp(name, "--modes") == 0)
            option_modes(&o, value);
        else if (strcmp(name, "--seed") == 0)
            o.seed = option_whole(name, value, 0, 1000000000);
        else if (strcmp(name, "--seeds") == 0)
            o.seeds = option_whole(name, value, 1, MAX_SEEDS);
        else if (strcmp(name, "--epochs") == 0)
            o.epochs = option_whole(name, value, 1, MAX_EPOCHS);
        else if (strcmp(name, "--batch") == 0)
            o.batch = option_whole(name, value, 1, MAX_BATCH);
        else if (strcmp(name, "--rows") == 0)
            o.rows = option_whole(name, value, 1, 100);
        else if (strcmp(name, "--hidden") == 0) {
            const char *comma = strchr(value, ',');
            char first[16] = "";
            if (comma == NULL || (size_t)(comma - value) >= sizeof first)
                fail("--hidden: `%s` is not two sizes, as in 128,64", value);
            memcpy(first, value, (size_t)(comma - value));
            o.hidden[0] = option_whole(name, first, 1, 65536);
            o.hidden[1] = option_whole(name, comma + 1, 1, 65536);
        } else if (strcmp(name, "--optimizer") == 0) {
            o.adam = strcmp(value, "adam") == 0;
            if (!o.adam && strcmp(value, "sgd") != 0)
                fail("there is no optimizer `%s`", value);
        } else if (strcmp(name, "--rate") == 0)
            o.rate = (float)option_number(name, value, 1e-9, 1e3);
        else if (strcmp(name, "--final-rate") == 0)
            o.final_rate = (float)option_number(name, value, 0.0, 1.0);
        else if (strcmp(name, "--sgd-momentum") == 0)
            o.sgd_momentum = (float)option_number(name, value, 0.0, 0.9999);
        else if (strcmp(name, "--gamma") == 0)
            o.gamma = (float)option_number(name, value, 0.0, 0.9999);
        else if (strcmp(name, "--delta") == 0)
            o.delta = (float)option_number(name, value, 0.0, 1.0);
        else if (strcmp(name, "--epsilon") == 0)
            o.epsilon = (float)option_number(name, value, 0.0, 1e6);
        else if (strcmp(name, "--techniques") == 0) {
            o.techniques = option_whole(name, value, 2, MAX_TECHNIQUES);
            if (o.techniques % 2 != 0)
                fail("--techniques: %u is odd", o.techniques);
        } else if (strcmp(name, "--variance") == 0)
            o.variance = value;
        else
            fail("there is no option `%s`; --help lists them", name);
    }
    if (o.data == NULL)
        fail("--data FOLDER is missing; --help lists the options");
    if (o.variance != NULL && compared != NULL)
        fail("%s: not with --variance, which has one network, all ways to draw, and batches of its own", compared);
    if (options_use_techniques(&o) && o.techniques > o.batch)
        fail("--batch: %u items are not one for each of %u distributions", o.batch, o.techniques);
    if (o.rate == 0.0f)
        o.rate = o.adam ? 0.001f : 0.1f;
    return o;
}

#endif
