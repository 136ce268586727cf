/* Importance functions: nf_importance_*() and nf_cross_entropy_gradient(). */
#include "check.h"

#define IS_NAN(x) ((x) != (x))

static int close_to(float actual, double expected)
{
    return fabs((double)actual - expected) <= 2e-7 * fabs(expected) + 1e-30;
}

static void values(void)
{
    static const float logits[3] = {1.0f, 2.0f, -1.0f}, target[3] = {0.5f, 2.0f, 0.0f};
    const double e[3] = {exp(1.0), exp(2.0), exp(-1.0)}, sum = e[0] + e[1] + e[2];
    float gradient[3];
    uint32_t label, k;
    for (label = 0; label < 3; ++label) {
        double square = 0.0;
        CHECK_STATUS(nf_cross_entropy_gradient(logits, 3, label, gradient), NF_OK);
        for (k = 0; k < 3; ++k) {
            const double g = e[k] / sum - (k == label ? 1.0 : 0.0);
            CHECK(close_to(gradient[k], g));
            square += g * g;
        }
        CHECK(close_to(nf_importance_cross_entropy(logits, 3, label), sqrt(square)));
        CHECK(close_to(nf_importance_gradient(gradient, 3), sqrt(square)));
        CHECK(close_to(nf_importance_cross_entropy_loss(logits, 3, label), log(sum) - (double)logits[label]));
    }
    CHECK(close_to(nf_importance_squared_error(logits, target, 3), 2.0 * sqrt(0.25 + 1.0)));
    CHECK(nf_importance_cross_entropy(logits, 1, 0) == 0.0f && nf_importance_cross_entropy_loss(logits, 1, 0) == 0.0f);
}

static void any_size(void)
{
    static const float huge[2] = {1e38f, -1e38f};
    float gradient[2];
    CHECK(nf_importance_cross_entropy(huge, 2, 0) == 0.0f && nf_importance_cross_entropy_loss(huge, 2, 0) == 0.0f);
    CHECK(close_to(nf_importance_cross_entropy(huge, 2, 1), sqrt(2.0)));
    CHECK(close_to(nf_importance_cross_entropy_loss(huge, 2, 1), 2e38));
    CHECK_STATUS(nf_cross_entropy_gradient(huge, 2, 1, gradient), NF_OK);
    CHECK(gradient[0] == 1.0f && gradient[1] == -1.0f);
    CHECK(close_to(nf_importance_gradient(huge, 2), sqrt(2.0) * 1e38));
    CHECK(close_to(nf_importance_squared_error(huge, gradient, 1), 2e38));
}

static void nodes(void)
{
    static const float gradient[5] = {3.0f, -1.0f, 4.0f, -1.0f, -5.0f};
    float q[10];
    CHECK_STATUS(nf_importance_nodes(gradient, 5, NF_NODES_NORM, 2, q), NF_OK);
    CHECK(close_to(q[0], sqrt(50.0)) && close_to(q[1], sqrt(2.0)));
    CHECK_STATUS(nf_importance_nodes(gradient, 5, NF_NODES_SIGN, 4, q), NF_OK);
#ifndef MDEBR_IS_WRONG /* an emulator's fault, which `cargo xtask targets` looks for */
    CHECK(q[0] == 5.0f && q[1] == 5.0f && q[2] == 0.0f && close_to(q[3], sqrt(2.0)));
#endif
    CHECK_STATUS(nf_importance_nodes(gradient, 5, NF_NODES_SIGN, 10, q), NF_OK);
#ifndef MDEBR_IS_WRONG
    CHECK(q[0] == 3.0f && q[1] == 0.0f && q[8] == 0.0f && q[9] == 5.0f);
#endif

    CHECK_REFUSED(nf_importance_nodes(NULL, 5, NF_NODES_NORM, 2, q), NF_ERR_NULL, q);
    CHECK_STATUS(nf_importance_nodes(gradient, 5, NF_NODES_NORM, 2, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_importance_nodes((const float *)misaligned(q), 1, NF_NODES_NORM, 1, q + 4), NF_ERR_ALIGNMENT, q);
    CHECK_REFUSED(nf_importance_nodes(gradient, 5, 2, 2, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_nodes(gradient, 5, UINT32_MAX, 2, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_nodes(gradient, 5, NF_NODES_NORM, 0, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_nodes(gradient, 5, NF_NODES_NORM, 17, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_nodes(gradient, 5, NF_NODES_NORM, UINT32_MAX, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_nodes(gradient, 5, NF_NODES_SIGN, 3, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_nodes(gradient, 5, NF_NODES_NORM, 6, q), NF_ERR_RANGE, q);
    CHECK_REFUSED(nf_importance_nodes(gradient, 0, NF_NODES_NORM, 1, q), NF_ERR_RANGE, q);
}

static void wrong_input(void)
{
    static const float good[2] = {0.0f, 1.0f};
    float out[2];
    int k;
    for (k = 0; k < 2; ++k) {
        float bad[2] = {0.0f, 0.0f};
        bad[1] = k == 0 ? not_a_number() : infinity_f();
        CHECK(IS_NAN(nf_importance_cross_entropy(bad, 2, 0)));
        CHECK(IS_NAN(nf_importance_cross_entropy_loss(bad, 2, 0)));
        CHECK(IS_NAN(nf_importance_squared_error(bad, good, 2)));
        CHECK(IS_NAN(nf_importance_squared_error(good, bad, 2)));
        CHECK(IS_NAN(nf_importance_gradient(bad, 2)));
        CHECK_REFUSED(nf_cross_entropy_gradient(bad, 2, 0, out), NF_ERR_NOT_FINITE, out);
        CHECK_REFUSED(nf_importance_nodes(bad, 2, NF_NODES_NORM, 2, out), NF_ERR_NOT_FINITE, out);
    }
    CHECK(IS_NAN(nf_importance_cross_entropy(NULL, 2, 0)));
    CHECK(IS_NAN(nf_importance_cross_entropy(good, 2, 2)));
    CHECK(IS_NAN(nf_importance_cross_entropy(good, 0, 0)));
    CHECK(IS_NAN(nf_importance_cross_entropy((const float *)misaligned(out), 1, 0)));
    CHECK(IS_NAN(nf_importance_cross_entropy_loss(NULL, 2, 0)));
    CHECK(IS_NAN(nf_importance_cross_entropy_loss(good, 2, UINT32_MAX)));
    CHECK(IS_NAN(nf_importance_squared_error(NULL, good, 2)));
    CHECK(IS_NAN(nf_importance_squared_error(good, NULL, 2)));
    CHECK(IS_NAN(nf_importance_squared_error(good, good, 0)));
    CHECK(IS_NAN(nf_importance_gradient(NULL, 2)));
    CHECK(IS_NAN(nf_importance_gradient(good, 0)));
    CHECK_REFUSED(nf_cross_entropy_gradient(NULL, 2, 0, out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_cross_entropy_gradient(good, 2, 0, NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_cross_entropy_gradient(good, 1, 0, (float *)misaligned(out)), NF_ERR_ALIGNMENT);
    CHECK_REFUSED(nf_cross_entropy_gradient(good, 2, 2, out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_cross_entropy_gradient(good, 0, 0, out), NF_ERR_RANGE, out);
}

int main(void)
{
    values();
    any_size();
    nodes();
    wrong_input();
    return report("importance");
}
