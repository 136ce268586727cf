/*
 * An integrator around another, for Mitsuba 3's scalar variants: every pixel draws from noisefloor's default sampler.
 *
 * A scalar renderer tells a sampler a seed, but not its pixel, so no sampler plugin can arrange errors across pixels.
 * The integrator knows the pixel; it takes the number of samples from the sensor's sampler, and nothing else.
 */

#include <mitsuba/core/properties.h>
#include <mitsuba/core/spectrum.h>
#include <mitsuba/render/film.h>
#include <mitsuba/render/imageblock.h>
#include <mitsuba/render/integrator.h>
#include <mitsuba/render/sampler.h>
#include <mitsuba/render/sensor.h>

#include <drjit/morton.h>
#include <noisefloor/tile.h>

static const uint32_t *const noisefloor_table = nf_sampler_table();
#define NOISEFLOOR_TABLE(i) noisefloor_table[i]
#include <noisefloor_sampler.h>

NAMESPACE_BEGIN(mitsuba)

struct NoisefloorOptions {
    bool white, scramble, lens;
};

// Each request is a domain, whose key is the number of dimensions before it. With a lens the places on film and lens,
// the first two requests, are four numbers of one domain. The bits are those of the sampler of noisefloor.mitsuba.
template <typename Float, typename Spectrum>
class NoisefloorSampler final : public Sampler<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Sampler, m_sample_count)
    MI_IMPORT_TYPES()

    NoisefloorSampler(const NoisefloorOptions &options, uint32_t frame)
        : Base(Properties()), m_options(options), m_frame(frame) {}

    ref<Sampler<Float, Spectrum>> fork() override { return new NoisefloorSampler(m_options, m_frame); }
    ref<Sampler<Float, Spectrum>> clone() override { return new NoisefloorSampler(*this); }

    void seed(UInt32, uint32_t) override {
        Throw("noisefloor_scalar: the integrator within seeds its sampler, which would lose its pixel");
    }

    void start(uint32_t x, uint32_t y, uint32_t index) {
        m_root = m_options.white ? nfs_white(x, y, m_frame, index) : nfs_pixel(x, y, m_frame, index);
        if (m_options.scramble)
            m_root = nfs_scramble(m_root, 1);
        m_dimension = 0;
    }

    void advance() override {
        m_root.order = nfs_reverse(nfs_reverse(m_root.order) + 1);
        m_dimension = 0;
    }

    Float next_1d(Mask) override { return draw(1).x; }

    Point2f next_2d(Mask) override {
        if (m_options.lens && m_dimension == 2) {
            m_dimension = 4;
            nfs_floats u = nfs_draw4(nfs_domain(m_root, 0));
            return { u.z, u.w };
        }
        nfs_floats u = draw(2);
        return { u.x, u.y };
    }

    std::string to_string() const override { return "NoisefloorSampler[]"; }

    MI_DECLARE_CLASS(NoisefloorSampler)

private:
    NoisefloorSampler(const NoisefloorSampler &) = default;

    nfs_floats draw(uint32_t count) {
        nfs_floats u = nfs_draw2(nfs_domain(m_root, m_dimension));
        m_dimension += count;
        return u;
    }

    NoisefloorOptions m_options;
    uint32_t m_frame, m_dimension = 0;
    nfs m_root = {};
};

template <typename Float, typename Spectrum>
class NoisefloorScalar final : public SamplingIntegrator<Float, Spectrum> {
public:
    MI_IMPORT_BASE(SamplingIntegrator, render_sample, should_stop)
    MI_IMPORT_TYPES(Scene, Sensor, Film, Sampler, Medium, ImageBlock)

    NoisefloorScalar(const Properties &props) : Base(props) {
        for (auto &prop : props.objects()) {
            Base *integrator = prop.try_get<Base>();
            if (!integrator || m_inner)
                Throw("noisefloor_scalar: holds one integrator that starts at the sensor, and nothing else");
            m_inner = integrator;
        }
        if (!m_inner)
            Throw("noisefloor_scalar: holds no integrator: give it one, such as {\"type\": \"path\"}");
        m_white = props.get<bool>("white", false);
        m_scramble = props.get<bool>("scramble", false);
    }

    TensorXf render(Scene *scene, Sensor *sensor, UInt32 seed, uint32_t spp, bool develop, bool evaluate) override {
        // Blocks are told a multiple of it.
        m_frame = seed;
        return Base::render(scene, sensor, seed, spp, develop, evaluate);
    }

    std::pair<Spectrum, Mask> sample(const Scene *scene, Sampler *sampler, const RayDifferential3f &ray,
                                     const Medium *medium, Float *aovs, Mask active) const override {
        return m_inner->sample(scene, sampler, ray, medium, aovs, active);
    }

    std::vector<std::string> aov_names() const override { return m_inner->aov_names(); }

    void traverse(TraversalCallback *callback) override {
        callback->put("inner", m_inner, +ParamFlags::Differentiable);
    }

    std::string to_string() const override {
        return "NoisefloorScalar[white = " + std::to_string(m_white) + ", scramble = " + std::to_string(m_scramble) +
               ", inner = " + m_inner->to_string() + "]";
    }

    MI_DECLARE_CLASS(NoisefloorScalar)

protected:
    void render_block(const Scene *scene, const Sensor *sensor, Sampler *, ImageBlock *block, Float *aovs,
                      uint32_t sample_count, UInt32, uint32_t block_id, uint32_t block_size) const override {
        const Film *film = sensor->film();
        const int border = film->sample_border() ? (int) film->rfilter()->border_size() : 0;
        const ScalarVector2u size = film->crop_size() + 2 * border;
        const ScalarVector2u blocks = (size + block_size - 1) / block_size;
        // Where there are several passes, each continues the pixels' sequences.
        const uint32_t first = block_id / (blocks.x() * blocks.y()) * sample_count;
        NoisefloorOptions options = { m_white, m_scramble, sensor->needs_aperture_sample() };
        ref<NoisefloorSampler<Float, Spectrum>> sampler = new NoisefloorSampler<Float, Spectrum>(options, m_frame);
        sampler->set_sample_count(sample_count);
        const Float scale = dr::rsqrt((Float) sample_count);
        block->clear();
        for (uint32_t i = 0; i < block_size * block_size && !should_stop(); ++i) {
            Point2u within = dr::morton_decode<Point2u>(i);
            if (dr::any(within >= block->size()))
                continue;
            Point2i place = Point2i(within) + block->offset();
            Point2i pixel = place + border;
            sampler->start((uint32_t) pixel.x(), (uint32_t) pixel.y(), first);
            for (uint32_t k = 0; k < sample_count && !should_stop(); ++k) {
                render_sample(scene, sensor, sampler.get(), block, aovs, Vector2f(place), scale);
                sampler->advance();
            }
        }
    }

private:
    ref<Base> m_inner;
    bool m_white, m_scramble;
    uint32_t m_frame = 0;
};

// For the scalar variants of the Python package: the others know their pixels, and have noisefloor.mitsuba.
template <typename Float, typename Spectrum>
static void offer(std::string_view name, PluginRegisterFn add, const char *variant) {
    using Type = NoisefloorScalar<Float, Spectrum>;
    add(name, variant, Type::Type, [](void *, const Properties &props) -> ref<Object> { return new Type(props); });
}

extern "C" MI_EXPORT void init_plugin(std::string_view name, PluginRegisterFn add) {
    using Spectral = mitsuba::Spectrum<float, 4>;
    offer<float, Color<float, 3>>(name, add, "scalar_rgb");
    offer<float, Spectral>(name, add, "scalar_spectral");
    offer<float, MuellerMatrix<Spectral>>(name, add, "scalar_spectral_polarized");
}

NAMESPACE_END(mitsuba)
