// The program around the renderer: what it says, what it reads, and what it refuses before it starts.
#include "../../examples_c/pathtracer/app.hpp"
#include "check.hpp"

using namespace test;
using namespace demo;

namespace {

void names_in_json()
{
    expect(json("direct") == "\"direct\"", "json: a plain name");
    expect(json("a \"b\"\\c\n\x01") == "\"a \\\"b\\\"\\\\c\\u000a\\u0001\"",
           "json: quotes, backslashes, control characters");
    expect(json("Fl\xc3\xa4" "che") == "\"Fl\xc3\xa4" "che\"", "json: UTF-8 as it is");
}

// A file is read when its samplers' factory is made, and never again.
void tables_are_read_once(const std::string &path)
{
    FILE *file = std::fopen(path.c_str(), "wb");
    std::fputs("noisefloor-points 1 1 1 2\n", file);
    for (int i = 0; i < 2; ++i)
        std::fwrite("\0\0\0\x3f", 1, 4, file); // 0.5
    std::fclose(file);
    const SamplerFactory factory("table", "", path);
    std::remove(path.c_str());
    for (uint64_t seed : {1u, 2u}) {
        float u[2] = {0, 0};
        factory.make({{{Domain::light, 0, 2}}, 2, 1, 0, seed})->points(3, 4, u);
        expect(u[0] == 0.5f && u[1] == 0.5f, "table: a sampler of each seed, and one reading of the file");
    }
}

// Each pixel's value is u.
struct Ramp final : Integrand {
    std::vector<Domain> domains() const override { return {{Domain::light, 0, 2}}; }
    uint32_t lights() const override { return 1; }
    bool camera_ray_per_sample() const override { return false; }
    void evaluate(uint32_t, uint32_t, size_t n, const float *u, float *f, uint32_t *, Shown *) const override
    {
        for (size_t i = 0; i < 3 * n; ++i)
            f[i] = u[i / 3 * 2];
    }
};

// Which error, if any, making a renderer that accumulates ends with; nothing is run.
std::string refused(const Options &options)
{
    const Ramp ramp;
    const RandomSampler sampler({ramp.domains(), 2, options.spp, 0, 1});
    try {
        AccumulatingRenderer renderer(ramp, sampler, options);
    } catch (const std::exception &error) {
        return error.what();
    }
    return "";
}

void refusals_come_first()
{
    Options options;
    options.width = options.height = 4;
    options.accumulate = 8;
    for (const char *name : {"mc", "robust", "least_squares", "k_fold", "incremental"}) {
        options.estimators = {name};
        expect(refused(options).empty(), "an estimator that can be streamed is refused");
    }
    for (const char *name : {"leave_one_out", "shared", "known", "slices", "nonsense"}) {
        options.estimators = {"mc", name};
        expect(refused(options).find(name) != std::string::npos,
               "what cannot be streamed is not refused by name before threads start");
    }
}

// Of an integrand that says nothing of itself.
void known_is_refused()
{
    const Ramp ramp;
    Options options;
    options.spp = 4;
    const RandomSampler sampler({ramp.domains(), 2, options.spp, 0, 1});
    for (const char *name : {"known", "shared_known"}) {
        options.estimators = {name};
        std::string said;
        try {
            Renderer renderer(ramp, sampler, options);
        } catch (const std::exception &error) {
            said = error.what();
        }
        expect(said.find(name) != std::string::npos, "what needs to know the light is not refused where it is unknown");
    }
}

} // namespace

int main(int, char **argv)
{
    names_in_json();
    tables_are_read_once(std::string(argv[0]) + ".points");
    refusals_come_first();
    known_is_refused();
    return finish();
}
