// The estimator that the settings ask for.
#pragma once

#include "estimators.hpp"
#include "settings.hpp"
#include <cmath>

namespace noisefloor_povray {

inline bool stratified(const Settings &settings) { return settings.sampler != "random"; }

// What NOISEFLOOR_ESTIMATOR may be. `slices` is not for POV-Ray: here no number of a sample picks a light.
inline std::vector<std::string> estimator_choices()
{
    std::vector<std::string> names{"recommended", "accumulator"};
    for (const demo::EstimatorName &known : demo::estimator_names)
        if (std::string(known.name) != "slices")
            names.push_back(known.name);
    return names;
}

inline void check_estimator(const std::string &name)
{
    std::string list;
    for (const std::string &known : estimator_choices()) {
        if (name == known)
            return;
        list += (list.empty() ? "" : ", ") + known;
    }
    throw std::runtime_error("NOISEFLOOR_ESTIMATOR=" + name + " is not one of " + list);
}

// By a name of estimators.hpp, or `accumulator`, or `recommended`: what nf_recommend() says.
inline std::unique_ptr<demo::Estimator> make_estimator(const Settings &settings, uint32_t dims, uint32_t side,
                                                       uint32_t samples)
{
    std::string name = settings.estimator;
    check_estimator(name);
    uint32_t order = settings.order;
    demo::EstimatorSetup setup{};
    setup.settings = "NOISEFLOOR_ORDER sets the order; dims are two for each of the pixel, the lens, and an area light";
    if (name == "recommended" || order == 0) {
        nf_recommendation advice;
        uint32_t sampling = stratified(settings) ? NF_SAMPLING_STRATIFIED : NF_SAMPLING_INDEPENDENT;
        demo::check(nf_recommend(dims, samples, sampling, side > 1, INFINITY, &advice), "nf_recommend");
        static const char *const methods[] = {"mc", "robust", "shared"}; // NF_METHOD_*
        if (name == "recommended")
            name = methods[advice.method];
        if (order == 0)
            order = advice.config.order > 0 ? advice.config.order : 2;
    }
    if (name == "accumulator") { // what a renderer does that keeps no samples
        nf_cv_config config = {};
        config.dims = config.stride = dims;
        config.order = order;
        config.channels = 3;
        config.stratified = stratified(settings);
        if (nf_cv_accumulator_size(&config, nullptr) == 0)
            throw std::runtime_error(demo::refusal(name, config, setup));
        return std::make_unique<demo::Streaming>(config);
    }
    setup.dims = setup.regressed = dims;
    setup.order = order;
    setup.lights = 1;
    setup.side = side;
    setup.samples = samples;
    setup.stratified = stratified(settings);
    return demo::make_estimator(name, setup);
}

} // namespace noisefloor_povray
