// Samplers for Mitsuba 3's scalar variants: one that draws from noisefloor, and one that remembers what another gave.
#pragma once

#include "mitsuba_interface.hpp"
#include <array>

namespace mitsuba {

// Mitsuba tells a sampler no pixel, only a seed. Here seed = frame * pixels + y * width + x, as render_block can form
// it.
class NoisefloorSampler : public Sampler {
public:
    NoisefloorSampler(uint32_t sample_count, Point2u film_size) : Sampler(sample_count), m_film_size(film_size)
    {
    }
    ref<Sampler> fork() override { return std::make_shared<NoisefloorSampler>(m_sample_count, m_film_size); }
    ref<Sampler> clone() override { return std::make_shared<NoisefloorSampler>(*this); }

    void seed(uint32_t seed, uint32_t) override
    {
        const uint32_t pixels = m_film_size.x * m_film_size.y, pixel = seed % pixels;
        m_frame = seed / pixels, m_x = pixel % m_film_size.x, m_y = pixel / m_film_size.x;
        start(0);
    }
    void advance() override { start(m_index + 1); }

    // Each request has the count of dimensions as the key of a domain of its own.
    Float next_1d(Mask) override
    {
        Float u;
        nf_sampler_draw(nf_sampler_domain(m_sample, m_dimension), 1, &u);
        m_dimension += 1;
        return u;
    }
    Point2f next_2d(Mask) override
    {
        Float u[2];
        nf_sampler_draw(nf_sampler_domain(m_sample, m_dimension), 2, u);
        m_dimension += 2;
        return {u[0], u[1]};
    }

    // For estimators, after rendering: what every pixel's `samples` samples were given at a count of dimensions, sample
    // by sample within a pixel, pixel by pixel along the rows.
    std::vector<Float> numbers(uint32_t frame, uint32_t dimension, uint32_t dims, uint32_t samples) const
    {
        const nf_sampler first = nf_sampler_domain(nf_sampler_pixel(0, 0, frame, 0), dimension);
        std::vector<Float> u(std::size_t{dims} * m_film_size.x * m_film_size.y * samples);
        room::check(nf_sampler_fill(&first, &dims, 1, m_film_size.x, m_film_size.y, samples, u.data(), u.size()),
                    "nf_sampler_fill");
        return u;
    }

private:
    void start(uint32_t index)
    {
        m_index = index;
        m_sample = nf_sampler_pixel(m_x, m_y, m_frame, index);
        m_dimension = 0;
    }

    Point2u m_film_size;
    uint32_t m_frame = 0, m_x = 0, m_y = 0, m_index = 0, m_dimension = 0;
    nf_sampler m_sample{};
};

// Passes another sampler's numbers on, and keeps the first of each sample: for samplers that cannot be asked again.
class RecordingSampler : public Sampler {
public:
    explicit RecordingSampler(ref<Sampler> inner) : Sampler(inner->sample_count()), m_inner(std::move(inner)) {}
    ref<Sampler> fork() override { return std::make_shared<RecordingSampler>(m_inner->fork()); }
    ref<Sampler> clone() override
    {
        auto copy = std::make_shared<RecordingSampler>(*this);
        copy->m_inner = m_inner->clone();
        return copy;
    }
    void seed(uint32_t seed, uint32_t wavefront_size) override
    {
        m_inner->seed(seed, wavefront_size);
        m_count = 0;
    }
    void advance() override
    {
        m_inner->advance();
        m_count = 0;
    }
    Float next_1d(Mask active) override { return keep(m_inner->next_1d(active)); }
    Point2f next_2d(Mask active) override
    {
        const Point2f u = m_inner->next_2d(active);
        return {keep(u.x), keep(u.y)};
    }

    // Number `dimension` of this sample, as it was given. Whether a path asked for it or ended before, it must be
    // uniform: what was not asked for is drawn now.
    Float number(size_t dimension)
    {
        while (m_count <= dimension)
            next_1d(true);
        return m_numbers[dimension];
    }

private:
    Float keep(Float u)
    {
        if (m_count < m_numbers.size())
            m_numbers[m_count] = u;
        ++m_count;
        return u;
    }

    ref<Sampler> m_inner;
    std::array<Float, 16> m_numbers{};
    size_t m_count = 0;
};

} // namespace mitsuba
