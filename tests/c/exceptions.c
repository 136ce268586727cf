/* No invalid operation, no division by zero and no overflow: hosts that trap them, as renderers in debug builds do, go
 * on. Values of magnitudes 1e-15 to 1e15, black ones and constants; x86-64 alone, where the flags are known to be kept.
 */
#include "check.h"
#include <fenv.h>

#if defined(__x86_64__) && defined(FE_INVALID)
#define WATCHED (FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW)
#else
#define WATCHED 0
#endif

/* valgrind raises no flags: what can be found there is wrong memory, and a fifth of the calls have it too. */
#ifdef UNDER_VALGRIND
#define TURNS(count) ((count) / 5)
#else
#define TURNS(count) (count)
#endif

static nf_rng rng;

/* Calls, and how many of them were not refused: a refusal says nothing. */
static int calls, accepted;

static void count(nf_status status)
{
    ++calls;
    accepted += status == NF_OK;
}

/* At least so many percent of a family's calls must have done something. */
static void check_accepted(const char *family, int percent)
{
    if (100 * accepted < percent * calls)
        fprintf(stderr, "%s: of %d calls %d were accepted, fewer than %d %%\n", family, calls, accepted, percent);
    CHECK(calls > 0 && 100 * accepted >= percent * calls);
    calls = accepted = 0;
}

static uint32_t below(uint32_t bound) { return nf_rng_next(&rng) % bound; }

/* The call may refuse, but quietly. `values` says what it was given. */
static void check_quiet(const char *call, const char *values, int a, int b, int c)
{
    const int raised = fetestexcept(WATCHED);
    if (raised)
        fprintf(stderr, "%s of %s (%d %d %d):%s%s%s\n", call, values, a, b, c, raised & FE_INVALID ? " invalid" : "",
                raised & FE_DIVBYZERO ? " division by zero" : "", raised & FE_OVERFLOW ? " overflow" : "");
    CHECK(raised == 0);
    feclearexcept(FE_ALL_EXCEPT);
}

/* Memory of numbers that raise what is watched for, float or double, where they are computed with. */
static memory workspace_new(size_t bytes)
{
    const int is_float = below(2);
    memory work = memory_new(bytes);
    uint32_t *words = (uint32_t *)work.start;
    size_t i;
    for (i = 0; i < bytes / 4; ++i)
        words[i] = is_float ? 0x7FA00001u : i % 2 ? 0x7FF40000u : 1u;
    return work;
}

#define KINDS 9
static const char *const kind_names[KINDS] = {"zero",      "a constant", "a product",    "a step",       "rare values",
                                              "large ones", "tiny ones",  "all magnitudes", "both signs"};

/* n values of one kind at n points. */
static void fill_values(int kind, const float *u, size_t dims, float *f, size_t n, size_t channels)
{
    size_t i;
    for (i = 0; i < n * channels; ++i) {
        const float x = u[i / channels * dims];
        const float magnitude = powf(10.0f, 30.0f * nf_rng_uniform(&rng) - 15.0f);
        switch (kind) {
        case 0: f[i] = 0.0f; break;
        case 1: f[i] = 3.7e-3f; break;
        case 2: f[i] = expf(-x); break;
        case 3: f[i] = x > 0.5f ? 1.0f : 0.0f; break;
        case 4: f[i] = below(10) == 0 ? 100.0f : 0.0f; break;
        case 5: f[i] = 1e15f * (1.0f + x); break;
        case 6: f[i] = 1e-15f * (1.0f + x); break;
        case 7: f[i] = magnitude; break;
        default: f[i] = below(2) ? magnitude : -magnitude; break;
        }
    }
}

static void fill_points(float *u, size_t count)
{
    const int all_equal = below(8) == 0;
    size_t i;
    for (i = 0; i < count; ++i)
        u[i] = all_equal ? 0.25f : nf_rng_uniform(&rng);
}

static void control_variates(void)
{
    static float u[5 * 80], f[4 * 80], controls[80];
    static const uint32_t solvers[3] = {NF_SOLVER_AUTO, NF_SOLVER_NORMAL_EQUATIONS, NF_SOLVER_SQUARE_ROOT};
    int turn;
    for (turn = 0; turn < TURNS(6000); ++turn) {
        const int kind = turn % KINDS;
        nf_cv_config config = make_config(1 + below(5), below(4), 1 + below(4), (uint32_t)turn / KINDS % 6);
        float size = 1.0f, integral;
        const size_t n = 1 + below(turn % 2 ? 80 : 6);
        nf_estimate out;
        nf_cv_descent steps = {0, 0, 0.0f, 0.0f};
        float coefficients[4 * 136] = {0};
        nf_cv_accumulator *accumulator = NULL, *other = NULL;
        memory work, state, others;
        size_t i;
        config.precision = below(2) ? NF_PRECISION_F32 : NF_PRECISION_F64;
        config.solver = solvers[below(3)];
        config.color = config.channels == 3 && below(2) ? NF_COLOR_LUMINANCE_RATIO : NF_COLOR_PER_CHANNEL;
        config.ridge = below(4) == 0 ? NF_RIDGE_AUTO : 0.0f;
        config.slices = config.dims > 1 && below(4) == 0 ? 3 : 0;
        config.controls = below(4) == 0;
        if (below(2)) { /* squares of squares must fit */
            const float digits = config.precision == NF_PRECISION_F32 ? 8.0f : 15.0f;
            size = powf(10.0f, digits * (2.0f * nf_rng_uniform(&rng) - 1.0f));
        }
        integral = 0.5f * size;
        fill_points(u, n * config.dims);
        fill_values(kind, u, config.dims, f, n, config.channels);
        for (i = 0; i < n; ++i)
            controls[i] = size * u[i * config.dims];
        work = workspace_new(nf_cv_workspace_size(&config, n));
        feclearexcept(FE_ALL_EXCEPT);
        count(estimate_controlled(&config, u, f, controls, &integral, n, work.start, work.bytes, &out));
        check_quiet("nf_cv_estimate", kind_names[kind], (int)config.estimator, (int)config.precision, (int)n);
        steps.optimizer = below(2) ? NF_OPTIMIZER_ADAM : NF_OPTIMIZER_MOMENTUM;
        feclearexcept(FE_ALL_EXCEPT);
        count(descend(&config, u, f, n, &steps, coefficients, work.start, work.bytes, &out));
        check_quiet("nf_cv_gradient_descent", kind_names[kind], (int)config.estimator, (int)config.precision, (int)n);
        memory_free(&work);
        state = memory_new(nf_cv_accumulator_size(&config, NULL));
        others = memory_new(nf_cv_accumulator_size(&config, NULL));
        work = workspace_new(accumulator_workspace_size(&config));
        feclearexcept(FE_ALL_EXCEPT);
        if (state.bytes > 0 && nf_cv_accumulator_init(state.start, state.bytes, &config, &accumulator) == NF_OK &&
            nf_cv_accumulator_init(others.start, others.bytes, &config, &other) == NF_OK) {
            nf_cv_samples samples = samples_of(u, f, n);
            samples.controls = controls;
            samples.control_integrals = &integral;
            count(nf_cv_accumulator_add(accumulator, &samples));
            samples.n = n / 2 + 1 < n ? n / 2 + 1 : n;
            count(nf_cv_accumulator_add(other, &samples));
            count(nf_cv_accumulator_merge(accumulator, other));
            count(nf_cv_accumulator_estimate(accumulator, work.start, work.bytes, &out));
            check_quiet("nf_cv_accumulator", kind_names[kind], (int)config.estimator, (int)config.precision, (int)n);
        }
        memory_free(&work);
        memory_free(&state);
        memory_free(&others);
    }
}

static void images(void)
{
    static float u[2 * 256 * 4], f[256 * 4 * 3], factors[256 * 3], known[256 * 4 * 3], integrals[256 * 3];
    static uint32_t surfaces[256];
    static nf_estimate out[256];
    int turn;
    for (turn = 0; turn < TURNS(720); ++turn) {
        const int kind = turn % KINDS;
        const size_t n = 1 + below(4);
        nf_cv_config config = make_config(2, 1 + below(3), 1 + 2 * below(2), (uint32_t)turn / KINDS % 6);
        nf_cv_image image;
        nf_cv_samples samples = samples_of(u, f, n);
        memory work;
        size_t i;
        if (below(3) == 0) /* the second number picks one of many slices */
            config.slices = below(2) ? 12 : 40;
        memset(&image, 0, sizeof image);
        image.width = image.height = 16;
        config.precision = below(2) ? NF_PRECISION_F32 : NF_PRECISION_F64;
        fill_points(u, 2 * 256 * n);
        fill_values(kind, u, 2, f, 256 * n, config.channels);
        if (below(2)) /* half of the picture is black */
            memset(f, 0, 128 * n * config.channels * sizeof *f);
        for (i = 0; i < 256; ++i)
            surfaces[i] = below(4);
        for (i = 0; i < 256 * 3; ++i)
            factors[i] = below(4) ? powf(10.0f, 30.0f * nf_rng_uniform(&rng) - 15.0f) : 0.0f;
        image.surfaces = below(2) ? surfaces : NULL;
        image.factors = below(2) ? factors : NULL;
        fill_values(below(KINDS), u, 2, known, 256 * n, config.channels);
        for (i = 0; i < 256 * 3; ++i)
            integrals[i] = below(4) ? fabsf(known[i]) : 0.0f;
        if (below(2)) {
            samples.known = known;
            samples.known_integrals = integrals;
        }
        if (below(3) == 0)
            image.window = 16;
        if (below(4) == 0 && config.slices == 0)
            config.edges = 1;
        /* Then the same pixels without places, surfaces and factors. */
        for (i = 0; i < 2; ++i) {
            work = workspace_new(nf_cv_image_workspace_size(&config, &image, &samples));
            feclearexcept(FE_ALL_EXCEPT);
            count(nf_cv_image_estimate(&config, &image, &samples, work.start, work.bytes, out));
            check_quiet("nf_cv_image_estimate", kind_names[kind], (int)config.estimator, (int)config.precision, (int)n);
            memory_free(&work);
            memset(&image, 0, sizeof image);
            image.width = image.height = 16;
            image.unordered = 1;
            samples = samples_of(u, f, n);
        }
    }
}

static void tables(void)
{
    static float importance[500], weight[100];
    static uint32_t index[100];
    int turn;
    for (turn = 0; turn < TURNS(900); ++turn) {
        const int kind = turn % KINDS;
        const uint32_t items = 1 + below(500), batch = 1 + below(items < 100 ? items : 100);
        memory work = workspace_new(nf_table_size(items));
        nf_table table;
        uint32_t i;
        fill_points(importance, items);
        fill_values(kind, importance, 1, importance, items, 1);
        for (i = 0; i < items; ++i)
            importance[i] = fabsf(importance[i]);
        feclearexcept(FE_ALL_EXCEPT);
        if (nf_table_init(&table, work.start, work.bytes, items, below(3) ? importance : NULL) == NF_OK) {
            count(nf_table_draw(&table, &rng, batch, index, weight));
            count(nf_table_draw_stratified(&table, &rng, batch, index, weight));
            count(nf_table_draw_distinct(&table, &rng, batch, index, weight));
            count(nf_table_update(&table, index, importance, batch, 0.3f));
            table.uniform_fraction = 0.1f;
            count(nf_table_draw(&table, &rng, batch, index, weight));
            count(nf_table_probabilities(&table, index, 1, 1, weight));
        }
        check_quiet("nf_table", kind_names[kind], (int)items, (int)batch, 0);
        memory_free(&work);
    }
}

static void importances(void)
{
    static const uint32_t label = 3;
    float values[10], others[10], gradient[10], nodes[10], loss, norm;
    int turn;
    for (turn = 0; turn < TURNS(900); ++turn) {
        const int kind = turn % KINDS;
        fill_points(values, 10);
        fill_values(kind, values, 1, others, 10, 1);
        fill_values(kind, others, 1, values, 10, 1);
        feclearexcept(FE_ALL_EXCEPT);
        count(nf_importance_cross_entropy(values, &label, 1, 10, &norm, &loss, gradient));
        count(nf_importance_squared_error(values, others, 1, 10, &norm));
        count(nf_importance_gradient(values, 1, 10, NF_NODES_NORM, 1, &norm));
        count(nf_importance_gradient(gradient, 1, 10, NF_NODES_SIGN, 2, nodes));
        check_quiet("nf_importance", kind_names[kind], 0, 0, 0);
    }
}

static void weights(void)
{
    static const uint32_t counts[3] = {2, 1, 1};
    static const uint32_t technique[4] = {0, 0, 1, 2};
    int turn;
    for (turn = 0; turn < TURNS(1800); ++turn) {
        const int kind = turn % KINDS;
        const uint32_t solver = (uint32_t)turn / KINDS % 4;
        float pdf[12], value[12], alpha[3] = {0.0f, 0.0f, 0.0f}, weight[4], gradient[12], out[3];
        nf_omis *omis = NULL;
        nf_gradient *state = NULL;
        memory work = workspace_new(nf_omis_size(3, 1));
        memory gradients = workspace_new(nf_gradient_size(3, 3));
        uint32_t i;
        fill_points(value, 12);
        fill_values(kind, value, 1, gradient, 12, 1);
        fill_values(kind, gradient, 1, value, 12, 1);
        fill_values(below(2) ? 2 : 7, value, 1, pdf, 12, 1);
        for (i = 0; i < 12; ++i)
            pdf[i] = fabsf(pdf[i]);
        feclearexcept(FE_ALL_EXCEPT);
        count(nf_mis_weight(NF_MIS_BALANCE, 0.0f, pdf, counts, 3, 0, weight));
        count(nf_mis_weight(NF_MIS_POWER, 2.0f, pdf, counts, 3, 0, weight));
        count(nf_mis_weight(NF_MIS_CUTOFF, 0.1f, pdf, counts, 3, 0, weight));
        count(nf_mis_weight(NF_MIS_MAXIMUM, 0.0f, pdf, counts, 3, 0, weight));
        check_quiet("nf_mis", kind_names[kind], 0, 0, 0);
        if (nf_omis_init(work.start, work.bytes, 3, 1, counts, &omis) == NF_OK) {
            for (i = 0; i < 4; ++i)
                count(nf_omis_add(omis, pdf + 3 * i, technique + i, value + i, 1));
            count(nf_omis_solve(omis, solver, 0.0f, out, NULL));
            count(nf_omis_solve(omis, solver, 0.0f, NULL, alpha));
            count(nf_omis_next_batch(omis, solver, 0.0f, 0.5f));
        }
        check_quiet("nf_omis", kind_names[kind], (int)solver, 0, 0);
        count(nf_mis_optimal_contribution(pdf, counts, 3, 0, alpha, value[0], weight));
        check_quiet("nf_mis_optimal", kind_names[kind], (int)solver, 0, 0);
        count(nf_omis_weights(solver, 0.0f, 3, 500, pdf, technique, 4, weight));
        check_quiet("nf_omis_weights", kind_names[kind], (int)solver, 0, 0);
        if (nf_gradient_init(gradients.start, gradients.bytes, 3, 3, &state) == NF_OK)
            count(nf_gradient_estimate(state, solver, 0.0f, 0.5f, 500, pdf, technique, gradient, 4, out));
        check_quiet("nf_gradient", kind_names[kind], (int)solver, 0, 0);
        memory_free(&work);
        memory_free(&gradients);
    }
}

int main(void)
{
    nf_rng_seed(&rng, 320);
    control_variates();
    check_accepted("control variates", 60);
    images();
    check_accepted("images", 30);
    tables();
    check_accepted("tables", 95);
    importances();
    check_accepted("importances", 95);
    weights();
    check_accepted("weights", 70);
    return report("exceptions");
}
