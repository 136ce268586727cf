/* Importance functions: nf_importance_*(). */
#include "check.h"

static int close_to(float actual, double expected)
{
    return fabs((double)actual - expected) <= 2e-7 * fabs(expected) + 1e-30;
}

static void values(void)
{
    static const float row[3] = {1.0f, 2.0f, -1.0f}, target[3] = {0.5f, 2.0f, 0.0f};
    static const uint32_t labels[3] = {0, 1, 2};
    const double e[3] = {exp(1.0), exp(2.0), exp(-1.0)}, sum = e[0] + e[1] + e[2];
    float logits[9], gradient[9], importance[3], loss[3], again[9], norm[3];
    uint32_t label, k;
    for (k = 0; k < 9; ++k)
        logits[k] = row[k % 3];
    CHECK_STATUS(nf_importance_cross_entropy(logits, labels, 3, 3, importance, loss, gradient), NF_OK);
    CHECK_STATUS(nf_importance_gradient(gradient, 3, 3, NF_NODES_NORM, 1, norm), NF_OK);
    for (label = 0; label < 3; ++label) {
        double square = 0.0;
        for (k = 0; k < 3; ++k) {
            const double g = e[k] / sum - (k == label ? 1.0 : 0.0);
            CHECK(close_to(gradient[3 * label + k], g));
            square += g * g;
        }
        CHECK(close_to(importance[label], sqrt(square)) && close_to(norm[label], sqrt(square)));
        CHECK(close_to(loss[label], log(sum) - (double)row[label]));
    }
    /* Any of the three may be left out. */
    CHECK_STATUS(nf_importance_cross_entropy(logits, labels, 3, 3, NULL, NULL, again), NF_OK);
    CHECK(memcmp(gradient, again, sizeof gradient) == 0);
    CHECK_STATUS(nf_importance_cross_entropy(logits, labels, 3, 3, NULL, again, NULL), NF_OK);
    CHECK(memcmp(loss, again, sizeof loss) == 0);
    CHECK_STATUS(nf_importance_cross_entropy(logits, labels, 3, 3, again, NULL, NULL), NF_OK);
    CHECK(memcmp(importance, again, sizeof importance) == 0);
    CHECK_STATUS(nf_importance_cross_entropy(NULL, NULL, 0, 3, again, NULL, NULL), NF_OK);
    CHECK_STATUS(nf_importance_squared_error(row, target, 1, 3, norm), NF_OK);
    CHECK(close_to(norm[0], 2.0 * sqrt(0.25 + 1.0)));
}

static void nodes(void)
{
    static const float gradient[5] = {3.0f, -1.0f, 4.0f, -1.0f, -5.0f};
    nf_importance_arguments of = {5, NF_NODES_SIGN, 10};
    float q[10];
    CHECK_STATUS(nf_importance_gradient(gradient, 1, 5, NF_NODES_NORM, 2, q), NF_OK);
    CHECK(close_to(q[0], sqrt(50.0)) && close_to(q[1], sqrt(2.0)));
    CHECK_STATUS(nf_importance_gradient(gradient, 1, 5, NF_NODES_SIGN, 4, q), NF_OK);
#ifndef MDEBR_IS_WRONG /* an emulator's fault, which `cargo xtask targets` looks for */
    CHECK(q[0] == 5.0f && q[1] == 5.0f && q[2] == 0.0f && close_to(q[3], sqrt(2.0)));
#endif

    CHECK_REFUSED(nf_importance_gradient(NULL, 1, 5, NF_NODES_NORM, 2, q), NF_ERR_NULL, q);
    CHECK_STATUS(nf_importance_gradient(gradient, 1, 5, NF_NODES_NORM, 2, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_importance_gradient((const float *)misaligned(q), 1, 1, NF_NODES_NORM, 1, q + 4),
                  NF_ERR_ALIGNMENT, q);
    CHECK_NAMED(NF_CHECK_IMPORTANCE, &of, NULL);
    of.split = 2;
    CHECK_NAMED(NF_CHECK_IMPORTANCE, &of, "split must be one of NF_NODES_*, 0 or 1");
    of.split = NF_NODES_SIGN;
    of.techniques = 3;
    CHECK_NAMED(NF_CHECK_IMPORTANCE, &of, "techniques must be even");
    of.techniques = 12;
    CHECK_NAMED(NF_CHECK_IMPORTANCE, &of, "outputs must be at least techniques");
    of.techniques = 17;
    CHECK_NAMED(NF_CHECK_IMPORTANCE, &of, "techniques must be 1 to 16");
    CHECK_NAMED(NF_CHECK_IMPORTANCE, misaligned(&of), "misaligned");
    CHECK_REFUSED(nf_importance_gradient(gradient, 1, 5, 2, 2, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_gradient(gradient, 1, 5, UINT32_MAX, 2, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_gradient(gradient, 1, 5, NF_NODES_NORM, 0, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_gradient(gradient, 1, 5, NF_NODES_NORM, 17, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_gradient(gradient, 1, 5, NF_NODES_NORM, UINT32_MAX, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_gradient(gradient, 1, 5, NF_NODES_SIGN, 3, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_gradient(gradient, 1, 5, NF_NODES_NORM, 6, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_gradient(gradient, 1, 0, NF_NODES_NORM, 1, q), NF_ERR_RANGE, q);
}

static void wrong_input(void)
{
    static const float good[4] = {0.0f, 1.0f, 0.0f, 1.0f};
    static const uint32_t labels[2] = {0, 1}, beyond[2] = {0, 2};
    float out[4];
    int k;
    for (k = 0; k < 2; ++k) {
        float bad[4] = {0.0f, 0.0f, 0.0f, 0.0f};
        bad[3] = k == 0 ? not_a_number() : infinity_f();
        CHECK_REFUSED(nf_importance_cross_entropy(bad, labels, 2, 2, out, NULL, NULL), NF_ERR_NOT_FINITE, out);
        CHECK_REFUSED(nf_importance_cross_entropy(bad, labels, 2, 2, NULL, out, NULL), NF_ERR_NOT_FINITE, out);
        CHECK_REFUSED(nf_importance_cross_entropy(bad, labels, 2, 2, NULL, NULL, out), NF_ERR_NOT_FINITE, out);
        CHECK_REFUSED(nf_importance_squared_error(bad, good, 2, 2, out), NF_ERR_NOT_FINITE, out);
        CHECK_REFUSED(nf_importance_squared_error(good, bad, 2, 2, out), NF_ERR_NOT_FINITE, out);
        CHECK_REFUSED(nf_importance_gradient(bad, 2, 2, NF_NODES_NORM, 2, out), NF_ERR_NOT_FINITE, out);
    }
    CHECK_REFUSED(nf_importance_cross_entropy(NULL, labels, 2, 2, out, NULL, NULL), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_importance_cross_entropy(good, NULL, 2, 2, out, NULL, NULL), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_importance_cross_entropy(good, beyond, 2, 2, out, NULL, NULL), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_importance_cross_entropy(good, labels, 2, 0, out, NULL, NULL), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_importance_cross_entropy((const float *)misaligned(out), labels, 1, 1, NULL, NULL, out + 2),
                  NF_ERR_ALIGNMENT, out);
    CHECK_STATUS(nf_importance_cross_entropy(good, labels, 1, 1, NULL, NULL, (float *)misaligned(out)),
                 NF_ERR_ALIGNMENT);
    CHECK_REFUSED(nf_importance_squared_error(NULL, good, 2, 2, out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_importance_squared_error(good, NULL, 2, 2, out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_importance_squared_error(good, good, 2, 2, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_importance_squared_error(good, good, 1, 0, out), NF_ERR_RANGE, out);
    CHECK_STATUS(nf_importance_squared_error(good, (const float *)misaligned(out), 1, 1, out + 2), NF_ERR_ALIGNMENT);
}

int main(void)
{
    values();
    nodes();
    wrong_input();
    return report("importance");
}
