// noisefloor for C++17: thin wrappers over noisefloor.h.
//
// Everything is header-only, and nothing allocates or owns: memory is the caller's, views are pointer and length, and
// objects end without a destructor. The C header has the full description of every function; here stand only the
// differences.
//
// A call that fails throws noisefloor::error. With NOISEFLOOR_NO_EXCEPTIONS defined, or exceptions turned off in the
// compiler, the same functions return a noisefloor::result<T> instead: see `returned`. Lengths of arrays that do not
// agree are status::length, but status::memory of fill(); every call with an object not made yet is status::state.
#ifndef NOISEFLOOR_HPP
#define NOISEFLOOR_HPP

#if __cplusplus < 201703L && (!defined(_MSVC_LANG) || _MSVC_LANG < 201703L)
#error "noisefloor.hpp needs C++17 or newer: -std=c++17, /std:c++17, target_compile_features(app PRIVATE cxx_std_17)"
#endif

#include "noisefloor.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#if !defined(NOISEFLOOR_NO_EXCEPTIONS) && !defined(__cpp_exceptions) && !(defined(_MSC_VER) && defined(_CPPUNWIND))
#define NOISEFLOOR_NO_EXCEPTIONS
#endif
#ifndef NOISEFLOOR_NO_EXCEPTIONS
#include <exception>
#endif

namespace noisefloor {
// Two namespaces, so that sources compiled with and without exceptions can be linked together.
#ifdef NOISEFLOOR_NO_EXCEPTIONS
inline namespace returning {
#else
inline namespace throwing {
#endif

// ---- Views ----

// A pointer and a length, as std::span: made from arrays, and from whatever has data() and size(). data() of no
// elements is NULL, which is how C says that an array is not there.
template <class T> class span {
public:
    constexpr span() noexcept = default;
    constexpr span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <std::size_t N> constexpr span(T (&array)[N]) noexcept : data_(array), size_(N) {}
    template <class C, class P = decltype(std::declval<C &>().data()), class = decltype(std::declval<C &>().size()),
              class = std::enable_if_t<std::is_convertible_v<std::remove_pointer_t<P> (*)[], T (*)[]>>>
    constexpr span(C &&container) noexcept : data_(container.data()), size_(static_cast<std::size_t>(container.size()))
    {
    }

    constexpr T *data() const noexcept { return empty() ? nullptr : data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr T *begin() const noexcept { return data_; }
    constexpr T *end() const noexcept { return data_ + size_; }
    constexpr T &operator[](std::size_t index) const noexcept { return data_[index]; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

namespace detail {
// Whether so many numbers are n rows; products could overflow.
inline bool is_rows(std::size_t size, std::size_t n, std::size_t width) noexcept
{
    return n == 0 ? size == 0 : size % n == 0 && size / n == width;
}
// If a C is a container that ends with the expression, and no view: what keeps a pointer to its elements refuses it.
// Arrays of constants pass: they look like views.
template <class C>
using if_ends = std::enable_if_t<!std::is_reference_v<C> &&
                                 !std::is_same_v<decltype(std::declval<std::remove_const_t<C> &>().data()),
                                                 decltype(std::declval<const C &>().data())>>;
template <class C, class = void> inline constexpr bool ends = false;
template <class C> inline constexpr bool ends<C, if_ends<C>> = true;
// std::is_trivial, which C++26 deprecates.
template <class T>
inline constexpr bool trivial = std::is_trivially_copyable_v<T> && std::is_trivially_default_constructible_v<T>;
// A span in a struct, which outlives the expression that makes it.
template <class T> class kept : public span<T> {
public:
    constexpr kept() noexcept = default;
    constexpr kept(T *data, std::size_t size) noexcept : span<T>(data, size) {}
    template <class C, class = std::enable_if_t<std::is_convertible_v<C, span<T>> && !ends<C>>>
    constexpr kept(C &&what) noexcept : span<T>(what)
    {
    }
};
} // namespace detail

// Memory for the library to work in, 8-byte aligned. Made from an array or container of any trivial type.
class memory {
public:
    constexpr memory() noexcept = default;
    constexpr memory(void *data, std::size_t bytes) noexcept : data_(data), bytes_(bytes) {}
    template <class T, std::size_t N> constexpr memory(T (&array)[N]) noexcept : data_(array), bytes_(N * sizeof(T))
    {
        static_assert(detail::trivial<T>, "memory is overwritten byte by byte");
    }
    template <class C, class P = decltype(std::declval<C &>().data()), class = decltype(std::declval<C &>().size()),
              class = std::enable_if_t<std::is_convertible_v<P, void *> && !std::is_same_v<std::decay_t<C>, memory>>>
    constexpr memory(C &&container) noexcept
        : data_(container.data()), bytes_(static_cast<std::size_t>(container.size()) * sizeof(*container.data()))
    {
        static_assert(detail::trivial<std::remove_pointer_t<P>>, "memory is overwritten byte by byte");
    }

    constexpr void *data() const noexcept { return data_; }
    constexpr std::size_t bytes() const noexcept { return bytes_; }

private:
    void *data_ = nullptr;
    std::size_t bytes_ = 0;
};

// ---- Errors ----

enum class status : nf_status {
    ok = NF_OK,
    null = NF_ERR_NULL,
    range = NF_ERR_RANGE,
    not_finite = NF_ERR_NOT_FINITE,
    memory = NF_ERR_MEMORY,
    alignment = NF_ERR_ALIGNMENT,
    no_samples = NF_ERR_NO_SAMPLES,
    unsupported = NF_ERR_UNSUPPORTED,
    state = NF_ERR_STATE,
    mismatch = NF_ERR_MISMATCH,
    foreign = NF_ERR_FOREIGN,
    version = NF_ERR_VERSION,
    length = NF_ERR_LENGTH,
    corrupt = NF_ERR_CORRUPT
};

inline const char *message(status code) noexcept { return nf_status_message(static_cast<nf_status>(code)); }

// What is wrong with one of these, in words: the field and its range. nullptr if nothing is.
inline const char *check(const nf_cv_config &what) noexcept { return nf_check(NF_CHECK_CV_CONFIG, &what); }
inline const char *check(const nf_cv_image &what) noexcept { return nf_check(NF_CHECK_CV_IMAGE, &what); }
inline const char *check(const nf_cv_descent &what) noexcept { return nf_check(NF_CHECK_CV_DESCENT, &what); }
inline const char *check(const nf_omis_arguments &what) noexcept { return nf_check(NF_CHECK_OMIS, &what); }
inline const char *check(const nf_importance_arguments &what) noexcept { return nf_check(NF_CHECK_IMPORTANCE, &what); }
inline const char *check(const nf_table &what) noexcept { return nf_check(NF_CHECK_TABLE, &what); }
inline const char *check(const nf_tile &what) noexcept { return nf_check(NF_CHECK_TILE, &what); }
inline const char *check(const nf_tile_sampler &what) noexcept { return nf_check(NF_CHECK_TILE_SAMPLER, &what); }

namespace detail {
// How a call ended, and which field is to blame, if one is.
struct outcome {
    outcome(nf_status code_, const char *words_ = nullptr) noexcept : code(code_), words(words_) {}
    nf_status code;
    const char *words;
};
// Blames the first of `what` that is out of its range.
template <class... What> outcome blame(nf_status code, const What &...what) noexcept
{
    const char *words = nullptr;
    if (code == NF_ERR_RANGE || code == NF_ERR_NOT_FINITE || code == NF_ERR_UNSUPPORTED)
        static_cast<void>((((words = check(what)) != nullptr) || ...));
    return {code, words};
}
// Why lengths do not agree: of a configuration that check() refuses they could not.
template <class... What> nf_status lengths(const What &...what) noexcept
{
    return ((check(what) == nullptr) && ...) ? NF_ERR_LENGTH : NF_ERR_RANGE;
}
// What a call with an object returned; every call with one that was not made yet is NF_ERR_STATE.
inline nf_status made(const void *object, nf_status code) noexcept { return object != nullptr ? code : NF_ERR_STATE; }
} // namespace detail

#ifndef NOISEFLOOR_NO_EXCEPTIONS

class error final : public std::exception {
public:
    // `words`: what check() says, or another static sentence; nullptr for the code's message().
    explicit error(status code, const char *words = nullptr) noexcept : code_(code), words_(words) {}
    status code() const noexcept { return code_; }
    const char *what() const noexcept override { return words_ != nullptr ? words_ : message(code_); }

private:
    status code_;
    const char *words_;
};

// What a function that computes a T returns: the T.
template <class T> using returned = T;

namespace detail {
inline void finish(const outcome &of)
{
    if (of.code != NF_OK)
        throw error(static_cast<status>(of.code), of.words);
}
template <class T> T finish(const outcome &of, const T &value)
{
    finish(of);
    return value;
}
} // namespace detail

#else

// A value, or why there is none. `value` means something only if `code` is status::ok.
template <class T> struct [[nodiscard]] result {
    status code = status::ok;
    T value{};
    constexpr bool ok() const noexcept { return code == status::ok; }
    constexpr explicit operator bool() const noexcept { return ok(); }
    constexpr const T &operator*() const & noexcept { return value; }
    constexpr T &operator*() & noexcept { return value; }
    // Of a temporary a value, and no pointer: what keeps one (a tile_sampler, say) takes no temporary.
    constexpr T operator*() const && noexcept { return value; }
    constexpr const T *operator->() const & noexcept { return &value; }
    constexpr T *operator->() & noexcept { return &value; }
    void operator->() const && = delete;
};
template <> struct [[nodiscard]] result<void> {
    status code = status::ok;
    constexpr bool ok() const noexcept { return code == status::ok; }
    constexpr explicit operator bool() const noexcept { return ok(); }
};

// What a function that computes a T returns: a result<T>.
template <class T> using returned = result<T>;

namespace detail {
inline result<void> finish(const outcome &of) noexcept { return {static_cast<status>(of.code)}; }
template <class T> result<T> finish(const outcome &of, const T &value) noexcept
{
    return {static_cast<status>(of.code), value};
}
} // namespace detail

#endif

// Whether header and library belong together.
inline bool abi_matches() noexcept { return nf_abi_version() == NF_ABI_VERSION; }

// ---- Control variates ----

enum class estimator : std::uint32_t {
    robust = NF_CV_ROBUST,
    least_squares = NF_CV_LEAST_SQUARES,
    leave_one_out = NF_CV_LEAVE_ONE_OUT,
    k_fold = NF_CV_K_FOLD,
    gradient_descent = NF_CV_GRADIENT_DESCENT,
    incremental = NF_CV_INCREMENTAL
};
enum class basis : std::uint32_t {
    legendre = NF_BASIS_LEGENDRE,
    step = NF_BASIS_STEP,
    sine = NF_BASIS_SINE,
    gaussian = NF_BASIS_GAUSSIAN
};
enum class solver : std::uint32_t {
    automatic = NF_SOLVER_AUTO,
    normal_equations = NF_SOLVER_NORMAL_EQUATIONS,
    square_root = NF_SOLVER_SQUARE_ROOT,
    dual = NF_SOLVER_DUAL
};
// nf_cv_config with its defaults, and functions that change one thing and can be chained:
// `config(3, 2, 3).with(estimator::k_fold).with_folds(2)`. The C fields remain accessible.
struct [[nodiscard]] config : nf_cv_config {
    config() noexcept : config(2, 2) {}
    config(std::uint32_t dims_, std::uint32_t order_, std::uint32_t channels_ = 1) noexcept : nf_cv_config()
    {
        dims = dims_;
        order = order_;
        channels = channels_;
    }
    explicit config(const nf_cv_config &other) noexcept : nf_cv_config(other) {}

    config with(noisefloor::estimator value) const noexcept
    {
        return set(&nf_cv_config::estimator, static_cast<std::uint32_t>(value));
    }
    config with(noisefloor::basis value) const noexcept
    {
        return set(&nf_cv_config::basis, static_cast<std::uint32_t>(value));
    }
    config with(noisefloor::solver value) const noexcept
    {
        return set(&nf_cv_config::solver, static_cast<std::uint32_t>(value));
    }
    config with_stratified_samples(bool value = true) const noexcept
    {
        return set(&nf_cv_config::stratified, std::uint32_t{value});
    }
    config with_slices(std::uint32_t count) const noexcept { return set(&nf_cv_config::slices, count); }
    config with_edges(std::uint32_t first) const noexcept { return set(&nf_cv_config::edges, first); }
    config with_controls(std::uint32_t count) const noexcept { return set(&nf_cv_config::controls, count); }
    config with_stride(std::uint32_t floats) const noexcept { return set(&nf_cv_config::stride, floats); }
    config with_single_precision(bool value = true) const noexcept
    {
        return set(&nf_cv_config::precision, value ? std::uint32_t{NF_PRECISION_F32} : std::uint32_t{NF_PRECISION_F64});
    }
    config with_non_finite_skipped(bool value = true) const noexcept
    {
        return set(&nf_cv_config::nonfinite,
                   value ? std::uint32_t{NF_NONFINITE_SKIP} : std::uint32_t{NF_NONFINITE_ERROR});
    }
    config with_luminance_ratio(bool value = true) const noexcept
    {
        return set(&nf_cv_config::color,
                   value ? std::uint32_t{NF_COLOR_LUMINANCE_RATIO} : std::uint32_t{NF_COLOR_PER_CHANNEL});
    }
    config with_folds(std::uint32_t count) const noexcept { return set(&nf_cv_config::folds, count); }
    config with_ridge(float strength) const noexcept { return set(&nf_cv_config::ridge, strength); }
    config with_automatic_ridge() const noexcept { return with_ridge(NF_RIDGE_AUTO); }

    // 0 for a configuration that is out of range.
    std::uint32_t terms() const noexcept { return nf_cv_terms(this); }
    bool valid() const noexcept { return check(*this) == nullptr; }
    // Bytes; 0 for a configuration that is out of range.
    std::size_t workspace_size(std::size_t n) const noexcept { return nf_cv_workspace_size(this, n); }
    // For n samples in each pixel, of which something may be known.
    std::size_t image_workspace_size(const nf_cv_image &where, std::size_t n, bool has_known = false) const noexcept
    {
        const float any = 0; // it is not read
        nf_cv_samples samples{};
        samples.n = n;
        samples.known = has_known ? &any : nullptr;
        return nf_cv_image_workspace_size(this, &where, &samples);
    }
    std::size_t accumulator_size() const noexcept { return nf_cv_accumulator_size(this, nullptr); }
    std::size_t accumulator_workspace_size() const noexcept
    {
        std::size_t bytes = 0;
        nf_cv_accumulator_size(this, &bytes);
        return bytes;
    }

private:
    template <class T> config set(T nf_cv_config::*field, T value) const noexcept
    {
        config copy = *this;
        copy.*field = value;
        return copy;
    }
};

// nf_cv_image: the pixels of an image and what is known of them, and functions that add one thing and can be chained:
// `image(640, 480).with_surfaces(ids).with_window(16)`. The C fields remain accessible, but the lengths of arrays that
// they point to are then unknown: only the functions set them. The arrays must outlive the image.
class [[nodiscard]] image : public nf_cv_image {
public:
    image(std::uint32_t width_, std::uint32_t height_, std::uint32_t frames_ = 1) noexcept : nf_cv_image()
    {
        width = width_;
        height = height_;
        frames = frames_;
    }

    // 0 for the default `step`, half of `side`.
    image with_window(std::uint32_t side, std::uint32_t step = 0) const noexcept
    {
        image copy = *this;
        copy.window = side;
        copy.stride = step;
        return copy;
    }
    // A number for each pixel.
    image with_surfaces(span<const std::uint32_t> ids) const noexcept
    {
        image copy = *this;
        copy.surfaces = ids.data();
        copy.surfaces_ = ids.size();
        copy.has_surfaces_ = true;
        return copy;
    }
    template <class C, class = detail::if_ends<C>> image with_surfaces(C &&) const = delete;
    // config::channels numbers for each pixel.
    image with_factors(span<const float> values) const noexcept
    {
        image copy = *this;
        copy.factors = values.data();
        copy.factors_ = values.size();
        copy.has_factors_ = true;
        return copy;
    }
    template <class C, class = detail::if_ends<C>> image with_factors(C &&) const = delete;

    // nf_cv_image::wanted and nf_cv_image::given: the pixels to estimate, and those that the arrays hold.
    image with_parts(const nf_cv_rectangle &wanted_pixels, const nf_cv_rectangle &given_pixels) const noexcept
    {
        image copy = *this;
        copy.wanted = wanted_pixels;
        copy.given = given_pixels;
        return copy;
    }
    // Which pixels must be given for those that are wanted: whole windows.
    returned<nf_cv_rectangle> needed() const
    {
        nf_cv_rectangle all{};
        const nf_status code = nf_cv_image_needed(this, &all);
        return detail::finish(detail::blame(code, *this), all);
    }

    // How many of each pixel's samples count, its first: nf_cv_image::samples.
    image with_samples(std::size_t first) const noexcept
    {
        image copy = *this;
        copy.samples = first;
        return copy;
    }
    // Pixels in no order: nf_cv_image::unordered.
    image without_places(bool value = true) const noexcept
    {
        image copy = *this;
        copy.unordered = value ? 1u : 0u;
        return copy;
    }

    // That the arrays hold, of all frames; 0 if that is more than a std::size_t counts.
    std::size_t pixels() const noexcept
    {
        return is_empty(given) ? count(width, height) : count(given.width, given.height);
    }
    // That are estimated, likewise.
    std::size_t estimates() const noexcept
    {
        return is_empty(wanted) ? pixels() : count(wanted.width, wanted.height);
    }
    // Whether the arrays are as long as they must be.
    bool fits(const nf_cv_config &how) const noexcept
    {
        const bool factors_fit = how.channels != 0 && detail::is_rows(factors_, how.channels, pixels());
        return (!has_surfaces_ || surfaces_ == pixels()) && (!has_factors_ || factors_fit);
    }

private:
    static bool is_empty(const nf_cv_rectangle &of) noexcept
    {
        return of.x == 0 && of.y == 0 && of.width == 0 && of.height == 0;
    }
    std::size_t count(std::size_t columns, std::size_t rows) const noexcept
    {
        const std::size_t most = SIZE_MAX, all_frames = frames == 0 ? 1 : frames;
        if (rows == 0 || columns > most / rows || columns * rows > most / all_frames)
            return 0;
        return columns * rows * all_frames;
    }

    // An array that was given but is empty is an error, not "none".
    bool has_surfaces_ = false, has_factors_ = false;
    std::size_t surfaces_ = 0, factors_ = 0;
};

// Samples in caller arrays, which must outlive it. The number of samples is f.size() / channels, and all lengths must
// agree with it: u has config::stride (0: dims) numbers for each sample, of the last at least
// config::dims.
struct samples {
    detail::kept<const float> u;
    detail::kept<const float> f;
    detail::kept<const float> controls{};
    detail::kept<const float> control_integrals{};
    // Of an image: what f would be with nothing in the way, and config::channels integrals of it for each pixel.
    detail::kept<const float> known{};
    detail::kept<const float> known_integrals{};
};

namespace detail {
// How many samples the arrays hold, or why they hold none.
inline nf_status count(const nf_cv_config &how, const samples &what, std::size_t &n) noexcept
{
    const std::size_t channels = how.channels, stride = how.stride == 0 ? how.dims : how.stride;
    if (channels == 0 || what.f.size() % channels != 0)
        return lengths(how);
    n = what.f.size() / channels;
    if (n == 0)
        return NF_ERR_NO_SAMPLES;
    // Products that overflow would say "enough": divide instead.
    if (stride == 0 || what.u.size() < how.dims || (what.u.size() - how.dims) / stride < n - 1 ||
        (what.u.size() - 1) / stride > n - 1)
        return lengths(how);
    const std::size_t used = how.controls;
    if (what.control_integrals.size() != used || !is_rows(what.controls.size(), n, used))
        return lengths(how);
    return NF_OK;
}
// For the C functions: n samples of each integral.
inline nf_cv_samples view(const samples &what, std::size_t n) noexcept
{
    nf_cv_samples out{};
    out.u = what.u.data(), out.f = what.f.data(), out.n = n;
    out.controls = what.controls.data(), out.control_integrals = what.control_integrals.data();
    out.known = what.known.data(), out.known_integrals = what.known_integrals.data();
    return out;
}
} // namespace detail

// nf_cv_estimate() of one integral: the estimate from all samples.
inline returned<nf_estimate> estimate(const nf_cv_config &how, const samples &what, memory workspace)
{
    nf_estimate out{};
    std::size_t n = 0;
    nf_status code = detail::count(how, what, n);
    const nf_cv_samples all = detail::view(what, n);
    if (code == NF_OK)
        code = nf_cv_estimate(&how, &all, 1, workspace.data(), workspace.bytes(), &out);
    return detail::finish(detail::blame(code, how), out);
}

// nf_cv_estimate() of as many integrals as `out` has room for, at least one, from as many samples of each.
inline returned<void> estimate_each(const nf_cv_config &how, const samples &what, memory workspace,
                                    span<nf_estimate> out)
{
    std::size_t n = 0;
    nf_status code = detail::count(how, what, n);
    if (code == NF_OK && (out.empty() || n % out.size() != 0))
        code = detail::lengths(how);
    if (code == NF_OK) {
        const nf_cv_samples all = detail::view(what, n / out.size());
        code = nf_cv_estimate(&how, &all, out.size(), workspace.data(), workspace.bytes(), out.data());
    }
    return detail::finish(detail::blame(code, how));
}

// nf_cv_gradient_descent(): `coefficients` are the start, and afterwards the solution.
inline returned<nf_estimate> gradient_descent(const nf_cv_config &how, const samples &what, span<float> coefficients,
                                              memory workspace, const nf_cv_descent &steps = {})
{
    nf_estimate out{};
    std::size_t n = 0;
    nf_status code = detail::count(how, what, n);
    const nf_cv_samples all = detail::view(what, n);
    const std::size_t rows = how.color == NF_COLOR_LUMINANCE_RATIO ? 1 : how.channels;
    const std::size_t terms = nf_cv_terms(&how);
    if (code == NF_OK && terms > 0 && coefficients.size() != rows * (terms - 1))
        code = detail::lengths(how, steps);
    if (code == NF_OK)
        code = nf_cv_gradient_descent(&how, &all, &steps, coefficients.data(), workspace.data(), workspace.bytes(),
                                      &out);
    return detail::finish(detail::blame(code, how, steps), out);
}

// nf_cv_image_estimate(): one estimate for each wanted pixel, from as many samples of each.
inline returned<void> estimate_image(const nf_cv_config &how, const image &where, const samples &what, memory workspace,
                                     span<nf_estimate> out)
{
    std::size_t n = 0;
    nf_status code = detail::count(how, what, n);
    const std::size_t pixels = where.pixels();
    const bool divides = !out.empty() && out.size() == where.estimates() && pixels > 0 && n % pixels == 0;
    const bool knows = !what.known.empty() || !what.known_integrals.empty();
    if (code == NF_OK && !(divides && where.fits(how) &&
                           (!knows || (what.known.size() == what.f.size() &&
                                       detail::is_rows(what.known_integrals.size(), pixels, how.channels)))))
        code = detail::lengths(how, where);
    if (code == NF_OK) {
        const nf_cv_samples all = detail::view(what, n / pixels);
        code = nf_cv_image_estimate(&how, &where, &all, workspace.data(), workspace.bytes(), out.data());
    }
    return detail::finish(detail::blame(code, how, where));
}

// A view of an nf_cv_accumulator in caller memory: copying the view does not copy the sums.
class accumulator {
public:
    // Makes an empty accumulator in `where`, or empties the one that is there.
    static returned<accumulator> create(const nf_cv_config &how, memory where)
    {
        accumulator made(how);
        const nf_status code = nf_cv_accumulator_init(where.data(), where.bytes(), &how, &made.handle_);
        return detail::finish(detail::blame(code, how), made);
    }
    template <class C, class = detail::if_ends<C>>
    static returned<accumulator> create(const nf_cv_config &, C &&) = delete;
    // A view of the one that is in `where`, bytes copied there say; status::mismatch if it was made with another
    // configuration. `scratch` is overwritten, and no part of `where`; both have config::accumulator_size() bytes.
    static returned<accumulator> resume(const nf_cv_config &how, memory where, memory scratch)
    {
        accumulator found(how), empty(how);
        nf_cv_accumulator *const there = static_cast<nf_cv_accumulator *>(where.data());
        nf_status code = NF_OK;
        if (where.bytes() < nf_cv_accumulator_size(&how, nullptr))
            code = NF_ERR_MEMORY;
        else if (there != nullptr && where.data() == scratch.data())
            code = NF_ERR_RANGE;
        else
            code = nf_cv_accumulator_init(scratch.data(), scratch.bytes(), &how, &empty.handle_);
        // Only what was made with one configuration can be merged.
        if (code == NF_OK)
            code = nf_cv_accumulator_merge(empty.handle_, there);
        if (code == NF_OK)
            found.handle_ = there;
        return detail::finish(detail::blame(code, how), found);
    }
    template <class C, class = detail::if_ends<C>>
    static returned<accumulator> resume(const nf_cv_config &, C &&, memory) = delete;
    accumulator() noexcept = default;

    returned<void> add(const samples &what)
    {
        std::size_t n = 0;
        nf_status code = detail::count(how_, what, n);
        const nf_cv_samples all = detail::view(what, n);
        if (code == NF_OK)
            code = nf_cv_accumulator_add(handle_, &all);
        return detail::finish(detail::made(handle_, code));
    }
    returned<void> merge(const accumulator &other)
    {
        const nf_status code = nf_cv_accumulator_merge(handle_, other.handle_);
        return detail::finish(detail::made(handle_, detail::made(other.handle_, code)));
    }
    returned<nf_estimate> estimate(memory workspace) const
    {
        nf_estimate out{};
        const nf_status code = nf_cv_accumulator_estimate(handle_, workspace.data(), workspace.bytes(), &out);
        return detail::finish(detail::made(handle_, code), out);
    }
    nf_cv_accumulator *handle() const noexcept { return handle_; }

private:
    explicit accumulator(const nf_cv_config &how) noexcept : how_(how) {}

    nf_cv_accumulator *handle_ = nullptr;
    nf_cv_config how_{};
};

enum class sampling : std::uint32_t { independent = NF_SAMPLING_INDEPENDENT, stratified = NF_SAMPLING_STRATIFIED };

// nf_recommend(): which estimator and which tile to use for `spp` samples per pixel of `dims` coordinates, each of so
// many nanoseconds; infinity: the best fit, if one pays.
inline returned<nf_recommendation> recommend(std::uint32_t dims, std::uint32_t spp, sampling kind, bool can_share,
                                             float sample_cost = std::numeric_limits<float>::infinity())
{
    nf_recommendation out{};
    const nf_status code =
        nf_recommend(dims, spp, static_cast<std::uint32_t>(kind), can_share ? 1u : 0u, sample_cost, &out);
    return detail::finish(code, out);
}

// ---- Multiple importance sampling ----

namespace mis {

constexpr std::size_t max_techniques = NF_MIS_MAX_TECHNIQUES;

// Densities and numbers of samples of the techniques at one point; both of one length.
struct point {
    noisefloor::detail::kept<const float> pdf;
    noisefloor::detail::kept<const std::uint32_t> counts;
};

namespace detail {
inline nf_status fits(const point &at) noexcept
{
    return at.pdf.size() != at.counts.size() ? NF_ERR_LENGTH : at.pdf.size() <= max_techniques ? NF_OK : NF_ERR_RANGE;
}
inline std::uint32_t techniques(const point &at) noexcept { return static_cast<std::uint32_t>(at.pdf.size()); }
inline returned<float> weight(std::uint32_t heuristic, float parameter, const point &at, std::uint32_t technique)
{
    float weight = 0;
    nf_status code = fits(at);
    if (code == NF_OK)
        code = nf_mis_weight(heuristic, parameter, at.pdf.data(), at.counts.data(), techniques(at), technique, &weight);
    return noisefloor::detail::finish(code, weight);
}
} // namespace detail

inline returned<float> balance(const point &at, std::uint32_t technique)
{
    return detail::weight(NF_MIS_BALANCE, 0, at, technique);
}
inline returned<float> power(const point &at, std::uint32_t technique, float beta = 2.0f)
{
    return detail::weight(NF_MIS_POWER, beta, at, technique);
}
inline returned<float> cutoff(const point &at, std::uint32_t technique, float epsilon)
{
    return detail::weight(NF_MIS_CUTOFF, epsilon, at, technique);
}
inline returned<float> maximum(const point &at, std::uint32_t technique)
{
    return detail::weight(NF_MIS_MAXIMUM, 0, at, technique);
}
inline returned<float> optimal_contribution(const point &at, std::uint32_t technique, span<const float> alpha,
                                            float value)
{
    float term = 0;
    nf_status code = alpha.size() == at.pdf.size() ? detail::fits(at) : NF_ERR_LENGTH;
    if (code == NF_OK)
        code = nf_mis_optimal_contribution(at.pdf.data(), at.counts.data(), detail::techniques(at), technique,
                                           alpha.data(), value, &term);
    return noisefloor::detail::finish(code, term);
}

} // namespace mis

// A view of an nf_omis in caller memory: copying the view does not copy the sums.
class optimal_mis {
public:
    enum class solver : std::uint32_t {
        ridge = NF_OMIS_RIDGE,
        plain = NF_OMIS_PLAIN,
        progressive = NF_OMIS_PROGRESSIVE,
        balance = NF_OMIS_BALANCE
    };

    // Bytes.
    static std::size_t size(std::uint32_t techniques, std::uint32_t integrals) noexcept
    {
        return nf_omis_size(techniques, integrals);
    }

    // Empty sums in `where`, or empties those that are there, for techniques that draw counts[j] samples a round.
    static returned<optimal_mis> create(span<const std::uint32_t> counts, std::uint32_t integrals, memory where)
    {
        optimal_mis made;
        nf_status code = NF_ERR_RANGE;
        if (counts.size() <= mis::max_techniques) {
            made.techniques_ = static_cast<std::uint32_t>(counts.size());
            made.integrals_ = integrals;
            code = nf_omis_init(where.data(), where.bytes(), made.techniques_, integrals, counts.data(), &made.handle_);
        }
        if (integrals == 0)
            return detail::finish(detail::outcome{NF_ERR_RANGE, "integrals must be at least 1"}, made);
        nf_omis_arguments all{};
        all.counts = counts.data(), all.techniques = static_cast<std::uint32_t>(counts.size());
        all.integrals = integrals;
        return detail::finish(detail::blame(code, all), made);
    }
    template <class C, class = detail::if_ends<C>>
    static returned<optimal_mis> create(span<const std::uint32_t>, std::uint32_t, C &&) = delete;
    optimal_mis() noexcept = default;

    // One sample. pdf[techniques], value[integrals]
    returned<void> add(span<const float> pdf, std::uint32_t technique, span<const float> value)
    {
        return add(pdf, span<const std::uint32_t>(&technique, 1), value);
    }
    // n samples. pdf[n * techniques], technique[n], value[n * integrals]
    returned<void> add(span<const float> pdf, span<const std::uint32_t> technique, span<const float> value)
    {
        const std::size_t n = technique.size();
        const bool fits = detail::is_rows(pdf.size(), n, techniques_) && detail::is_rows(value.size(), n, integrals_);
        return finish(fits ? nf_omis_add(handle_, pdf.data(), technique.data(), value.data(), n) : NF_ERR_LENGTH);
    }
    // out[integrals]
    returned<void> solve(span<float> out, solver how = solver::ridge, float ridge = 0.0f) const
    {
        const bool fits = out.size() == integrals_;
        return finish(fits ? nf_omis_solve(handle_, static_cast<std::uint32_t>(how), ridge, out.data(), nullptr)
                           : NF_ERR_LENGTH,
                      how, ridge);
    }
    // out[integrals * techniques], an integral after the other
    returned<void> alpha(span<float> out, solver how = solver::ridge, float ridge = 0.0f) const
    {
        const bool fits = detail::is_rows(out.size(), techniques_, integrals_);
        return finish(fits ? nf_omis_solve(handle_, static_cast<std::uint32_t>(how), ridge, nullptr, out.data())
                           : NF_ERR_LENGTH,
                      how, ridge);
    }
    returned<void> next_batch(solver how = solver::ridge, float ridge = 0.0f, float beta = 1.0f)
    {
        return finish(nf_omis_next_batch(handle_, static_cast<std::uint32_t>(how), ridge, beta), how, ridge, beta);
    }
    returned<void> merge(const optimal_mis &other)
    {
        return finish(detail::made(other.handle_, nf_omis_merge(handle_, other.handle_)));
    }
    nf_omis *handle() const noexcept { return handle_; }

private:
    returned<void> finish(nf_status code, solver how = solver::ridge, float ridge = 0.0f, float beta = 1.0f) const
    {
        nf_omis_arguments all{};
        all.techniques = techniques_;
        all.solver = static_cast<std::uint32_t>(how), all.ridge = ridge, all.beta = beta;
        return detail::finish(detail::blame(detail::made(handle_, code), all));
    }

    nf_omis *handle_ = nullptr;
    std::uint32_t techniques_ = 0, integrals_ = 0;
};

// ---- Samplers and tiles ----

// nf_tile: a view of sample points. The C fields remain accessible.
struct tile : nf_tile {
    tile() noexcept : nf_tile() {}
    // One that comes with the library: nf_tile_128_1spp_2d and its like.
    explicit tile(const nf_tile &other) noexcept : nf_tile(other) {}

    // Of an .nft file's bytes, which must outlive the tile.
    static returned<tile> from_bytes(const void *bytes, std::size_t len)
    {
        tile made;
        return detail::finish(nf_tile_from_bytes(bytes, len, &made), made);
    }
    static returned<tile> from_bytes(span<const unsigned char> bytes) { return from_bytes(bytes.data(), bytes.size()); }
    template <class C, class = detail::if_ends<C>> static returned<tile> from_bytes(C &&) = delete;
};

namespace detail {
// By nf_sampler_draw() or nf_tile_sampler_draw().
template <class State> returned<void> draw(void (*from)(State, std::uint32_t, float *), State state, span<float> u)
{
    const bool fits = u.size() >= 1 && u.size() <= 4;
    if (fits)
        from(state, static_cast<std::uint32_t>(u.size()), u.data());
    return finish(fits ? NF_OK : NF_ERR_RANGE);
}
} // namespace detail

// nf_sampler: one sample of one pixel of the default sampler. `sampler(x, y, frame, index).domain(3).draw<2>()`.
class sampler {
public:
    sampler(std::uint32_t x, std::uint32_t y, std::uint32_t frame, std::uint32_t index) noexcept
        : state_(nf_sampler_pixel(x, y, frame, index))
    {
    }
    explicit sampler(const nf_sampler &state) noexcept : state_(state) {}
    // For denoisers: white over the image.
    static sampler white(std::uint32_t x, std::uint32_t y, std::uint32_t frame, std::uint32_t index) noexcept
    {
        return sampler(nf_sampler_white(x, y, frame, index));
    }

    [[nodiscard]] sampler domain(std::uint32_t key) const noexcept { return sampler(nf_sampler_domain(state_, key)); }
    [[nodiscard]] sampler scramble(std::uint32_t seed) const noexcept
    {
        return sampler(nf_sampler_scramble(state_, seed));
    }
    // N numbers.
    template <std::uint32_t N> [[nodiscard]] std::array<float, N> draw() const noexcept
    {
        static_assert(N >= 1 && N <= 4, "a domain has 1 to 4 numbers");
        std::array<float, N> u{};
        nf_sampler_draw(state_, N, u.data());
        return u;
    }
    // One number.
    [[nodiscard]] float draw() const noexcept { return draw<1>()[0]; }
    // As many numbers as `u` has places: 1 to 4, else it does not compile.
    template <std::size_t N> void draw(std::array<float, N> &u) const noexcept { u = draw<N>(); }
    template <std::size_t N> void draw(float (&u)[N]) const noexcept
    {
        static_assert(N <= 4, "a domain has 1 to 4 numbers");
        nf_sampler_draw(state_, std::uint32_t{N}, u);
    }
    // status::range unless there are 1 to 4 places.
    returned<void> draw(span<float> u) const { return detail::draw(nf_sampler_draw, state_, u); }
    const nf_sampler &state() const noexcept { return state_; }

private:
    nf_sampler state_;
};

// nf_sampler_fill(): u[height][width][samples][sum of dims] from samplers of the first pixel and sample, dims[i] from
// samplers[i].
inline returned<void> fill(span<const nf_sampler> samplers, span<const std::uint32_t> dims, std::uint32_t width,
                           std::uint32_t height, std::uint32_t samples, span<float> u)
{
    return detail::finish(samplers.size() != dims.size() ? NF_ERR_LENGTH
                                                         : nf_sampler_fill(samplers.data(), dims.data(), dims.size(),
                                                                           width, height, samples, u.data(), u.size()));
}

// nf_tile_sampler: one sample of one pixel, by value. `tile_sampler(tile, x, y, frame, index).domain(3).draw<2>()`.
class tile_sampler {
public:
    // The tile must outlive the sampler and stay where it is.
    tile_sampler(const nf_tile &from, std::uint32_t x, std::uint32_t y, std::uint32_t frame,
                 std::uint32_t index) noexcept
        : state_(nf_tile_sampler_pixel(&from, x, y, frame, index))
    {
    }
    tile_sampler(const nf_tile &&, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t) = delete;
    explicit tile_sampler(const nf_tile_sampler &state) noexcept : state_(state) {}

    [[nodiscard]] tile_sampler domain(std::uint32_t key) const noexcept
    {
        return tile_sampler(nf_tile_sampler_domain(state_, key));
    }
    [[nodiscard]] tile_sampler scramble(std::uint32_t seed) const noexcept
    {
        return tile_sampler(nf_tile_sampler_scramble(state_, seed));
    }
    // The first N coordinates.
    template <std::uint32_t N> [[nodiscard]] std::array<float, N> draw() const noexcept
    {
        static_assert(N >= 1 && N <= 4, "a domain has 1 to 4 dimensions");
        std::array<float, N> u{};
        nf_tile_sampler_draw(state_, N, u.data());
        return u;
    }
    // The first coordinate.
    [[nodiscard]] float draw() const noexcept { return draw<1>()[0]; }
    // As many coordinates as `u` has places: 1 to 4, else it does not compile.
    template <std::size_t N> void draw(std::array<float, N> &u) const noexcept { u = draw<N>(); }
    template <std::size_t N> void draw(float (&u)[N]) const noexcept
    {
        static_assert(N <= 4, "a domain has 1 to 4 dimensions");
        nf_tile_sampler_draw(state_, std::uint32_t{N}, u);
    }
    // status::range unless there are 1 to 4 places.
    returned<void> draw(span<float> u) const { return detail::draw(nf_tile_sampler_draw, state_, u); }
    const nf_tile_sampler &state() const noexcept { return state_; }

private:
    nf_tile_sampler state_;
};

// nf_tile_sampler_fill(), likewise.
inline returned<void> fill(span<const nf_tile_sampler> samplers, span<const std::uint32_t> dims, std::uint32_t width,
                           std::uint32_t height, std::uint32_t samples, span<float> u)
{
    const nf_status code = samplers.size() != dims.size()
                               ? NF_ERR_LENGTH
                               : nf_tile_sampler_fill(samplers.data(), dims.data(), dims.size(), width, height, samples,
                                                      u.data(), u.size());
    return detail::finish(code);
}

// ---- Random numbers ----

// nf_rng as a standard uniform random bit generator.
class rng {
public:
    using result_type = std::uint32_t;
    explicit rng(std::uint64_t seed) noexcept { nf_rng_seed(&state_, seed); }
    explicit rng(const nf_rng &state) noexcept : state_(state) {}
    static constexpr result_type (min)() noexcept { return 0; }
    static constexpr result_type (max)() noexcept { return UINT32_MAX; }
    result_type operator()() noexcept { return nf_rng_next(&state_); }
    float uniform() noexcept { return nf_rng_uniform(&state_); }
    void fill(span<float> out) noexcept
    {
        for (float &value : out)
            value = uniform();
    }
    const nf_rng &state() const noexcept { return state_; }
    nf_rng &state() noexcept { return state_; }

private:
    nf_rng state_{};
};

// ---- Minibatches ----

// nf_table: the importances of a data set's items, in memory of the caller's. It may be moved, not copied: the memory
// would be shared. An empty `weight` stands for none.
class table {
public:
    // Bytes.
    static std::size_t size(std::uint32_t items) noexcept { return nf_table_size(items); }

    // A table that cannot be used before init() or load().
    table() noexcept = default;
    table(table &&other) noexcept : state_(std::exchange(other.state_, nf_table{})) {}
    table &operator=(table &&other) noexcept
    {
        state_ = std::exchange(other.state_, nf_table{});
        return *this;
    }

    // Makes a table of `items` items of importance 1.
    returned<void> init(memory where, std::uint32_t items)
    {
        return detail::finish(nf_table_init(&state_, where.data(), where.bytes(), items, nullptr));
    }
    // Makes a table of these importances.
    returned<void> init(memory where, span<const float> importance)
    {
        const bool fits = importance.size() <= UINT32_MAX && importance.data() != nullptr;
        return detail::finish(
            fits ? nf_table_init(&state_, where.data(), where.bytes(), length(importance), importance.data())
                 : NF_ERR_RANGE);
    }
    template <class C, class = detail::if_ends<C>> returned<void> init(C &&, std::uint32_t) = delete;
    template <class C, class = detail::if_ends<C>> returned<void> init(C &&, span<const float>) = delete;
    returned<void> draw(rng &random, span<std::uint32_t> index, span<float> weight = {}) const
    {
        return finish_draw(nf_table_draw, &state_, random, index, weight);
    }
    returned<void> draw_stratified(rng &random, span<std::uint32_t> index, span<float> weight = {}) const
    {
        return finish_draw(nf_table_draw_stratified, &state_, random, index, weight);
    }
    returned<void> draw_distinct(rng &random, span<std::uint32_t> index, span<float> weight = {})
    {
        return finish_draw(nf_table_draw_distinct, &state_, random, index, weight);
    }
    // This process's part of a batch over all shards.
    returned<void> draw_shard(span<const nf_shard> all, rng &random, span<std::uint32_t> index,
                              span<float> weight = {}) const
    {
        const bool fit = fits(index, weight) && all.size() <= UINT32_MAX;
        return finish(fit ? nf_table_draw_shard(&state_, all.data(), length(all), &random.state(), length(index),
                                                index.data(), weight.data())
                          : NF_ERR_LENGTH);
    }
    returned<void> update(span<const std::uint32_t> index, span<const float> importance, float momentum)
    {
        const bool fits = index.size() == importance.size() && index.size() <= UINT32_MAX;
        return finish(fits ? nf_table_update(&state_, index.data(), importance.data(), length(index), momentum)
                           : NF_ERR_LENGTH);
    }
    returned<void> set_uniform_fraction(float fraction)
    {
        const bool is_fraction = fraction >= 0.0f && fraction <= 1.0f;
        if (is_fraction && state_.importance != nullptr)
            state_.uniform_fraction = fraction;
        return finish(is_fraction ? NF_OK : NF_ERR_RANGE);
    }
    returned<void> add_epsilon(float epsilon) { return finish(nf_table_add_epsilon(&state_, epsilon)); }
    returned<void> append(span<const float> importance)
    {
        return finish(importance.size() <= UINT32_MAX
                          ? nf_table_append(&state_, importance.data(), length(importance))
                          : NF_ERR_RANGE);
    }

    std::uint32_t items() const noexcept { return state_.items; }
    // 0 for an item that does not exist.
    float probability(std::uint32_t item) const noexcept
    {
        float p = 0;
        return nf_table_probabilities(&state_, &item, 1, 1, &p) == NF_OK ? p : 0.0f;
    }
    // p[k * stride] of index[k].
    returned<void> probabilities(span<const std::uint32_t> index, span<float> p, std::uint32_t stride = 1) const
    {
        const bool fits = index.size() <= UINT32_MAX && stride > 0 &&
                          (index.empty() || (p.size() > 0 && (p.size() - 1) / stride >= index.size() - 1));
        return finish(fits         ? nf_table_probabilities(&state_, index.data(), length(index), stride, p.data())
                      : stride > 0 ? NF_ERR_LENGTH
                                   : NF_ERR_RANGE);
    }
    float importance(std::uint32_t item) const noexcept { return item < items() ? state_.importance[item] : 0.0f; }
    // The sum of all importances.
    double total() const noexcept
    {
        nf_shard all{};
        return nf_table_shard(&state_, &all) == NF_OK ? all.importance : 0.0;
    }
    returned<nf_shard> shard() const
    {
        nf_shard out{};
        return detail::finish(detail::made(state_.importance, nf_table_shard(&state_, &out)), out);
    }

    std::size_t saved_size() const noexcept { return NF_TABLE_SAVED_HEADER + std::size_t{4} * items(); }
    returned<void> save(span<unsigned char> saved) const
    {
        return finish(nf_table_save(&state_, saved.data(), saved.size()));
    }
    returned<void> load(memory where, span<const unsigned char> saved)
    {
        return detail::finish(nf_table_load(&state_, where.data(), where.bytes(), saved.data(), saved.size()));
    }
    template <class C, class = detail::if_ends<C>> returned<void> load(C &&, span<const unsigned char>) = delete;
    const nf_table &state() const noexcept { return state_; }

private:
    template <class T> static std::uint32_t length(const span<T> &what) noexcept
    {
        return static_cast<std::uint32_t>(what.size());
    }
    static bool fits(const span<std::uint32_t> &index, const span<float> &weight) noexcept
    {
        return index.size() <= UINT32_MAX && (weight.empty() || weight.size() == index.size());
    }
    template <class F, class T>
    returned<void> finish_draw(F function, T *state, rng &random, const span<std::uint32_t> &index,
                               const span<float> &weight) const
    {
        return finish(fits(index, weight)
                          ? function(state, &random.state(), length(index), index.data(), weight.data())
                          : NF_ERR_LENGTH);
    }
    returned<void> finish(nf_status code) const { return detail::finish(detail::made(state_.importance, code)); }

    nf_table state_{};
};

// nf_shards_allocate(): how many of a batch's items each shard draws.
inline returned<void> allocate(span<const nf_shard> shards, float uniform_fraction, rng &random, std::uint32_t batch,
                               span<std::uint32_t> counts)
{
    const bool fits = shards.size() == counts.size() && shards.size() <= UINT32_MAX;
    return detail::finish(fits ? nf_shards_allocate(shards.data(), static_cast<std::uint32_t>(shards.size()),
                                                    uniform_fraction, &random.state(), batch, counts.data())
                               : NF_ERR_LENGTH);
}

// nf_omis_weights(): pdf[batch * techniques], technique[batch], weight[batch].
inline returned<void> omis_weights(std::uint32_t techniques, std::uint32_t items, span<const float> pdf,
                                   span<const std::uint32_t> technique, span<float> weight,
                                   optimal_mis::solver how = optimal_mis::solver::ridge, float ridge = 0.0f)
{
    const std::size_t batch = weight.size();
    const bool fits = batch <= UINT32_MAX && technique.size() == batch && techniques > 0 &&
                      detail::is_rows(pdf.size(), batch, techniques);
    return detail::finish(fits ? nf_omis_weights(static_cast<std::uint32_t>(how), ridge, techniques, items, pdf.data(),
                                                 technique.data(), static_cast<std::uint32_t>(batch), weight.data())
                          : techniques > 0 ? NF_ERR_LENGTH
                                           : NF_ERR_RANGE);
}

// nf_shuffle(): the elements from `position` on of a random permutation.
inline returned<void> shuffle(std::uint64_t seed, std::uint32_t items, std::uint64_t position,
                              span<std::uint32_t> index)
{
    const bool fits = index.size() <= UINT32_MAX;
    return detail::finish(
        fits ? nf_shuffle(seed, items, position, static_cast<std::uint32_t>(index.size()), index.data())
             : NF_ERR_RANGE);
}

// Importances of many items at once; rows are the items.
namespace importance {

enum class split : std::uint32_t { norm = NF_NODES_NORM, sign = NF_NODES_SIGN };

namespace detail {
inline std::uint32_t number(std::size_t size) noexcept { return static_cast<std::uint32_t>(size); }
// How many values each of so many rows has, of none `least`; 0 if they do not agree.
inline std::uint32_t columns(std::size_t size, std::size_t rows, std::uint32_t least = 1) noexcept
{
    if (rows == 0)
        return size == 0 ? least : 0;
    const bool fits = rows <= UINT32_MAX && size % rows == 0 && size / rows <= UINT32_MAX;
    return fits ? number(size / rows) : 0;
}
} // namespace detail

// nf_importance_cross_entropy(): logits[rows * classes], label[rows]; empty outputs are not wanted.
inline returned<void> cross_entropy(span<const float> logits, span<const std::uint32_t> label, span<float> norm,
                                    span<float> loss = {}, span<float> gradient = {})
{
    const std::size_t rows = label.size();
    const std::uint32_t classes = detail::columns(logits.size(), rows);
    const bool fits = classes > 0 && (norm.empty() || norm.size() == rows) && (loss.empty() || loss.size() == rows) &&
                      (gradient.empty() || gradient.size() == logits.size());
    return noisefloor::detail::finish(
        fits ? nf_importance_cross_entropy(logits.data(), label.data(), detail::number(rows), classes, norm.data(),
                                           loss.data(), gradient.data())
             : NF_ERR_LENGTH);
}
// nf_importance_squared_error(): output[rows * outputs], target[rows * outputs], norm[rows].
inline returned<void> squared_error(span<const float> output, span<const float> target, span<float> norm)
{
    const std::uint32_t outputs = detail::columns(output.size(), norm.size());
    const bool fits = outputs > 0 && target.size() == output.size();
    return noisefloor::detail::finish(
        fits ? nf_importance_squared_error(output.data(), target.data(), detail::number(norm.size()), outputs,
                                           norm.data())
             : NF_ERR_LENGTH);
}
// nf_importance_gradient(): derivatives[rows * outputs], out[rows * techniques].
inline returned<void> gradient(span<const float> derivatives, std::uint32_t techniques, span<float> out,
                               split how = split::norm)
{
    const bool whole = techniques > 0 && out.size() % techniques == 0;
    const std::size_t rows = whole ? out.size() / techniques : 0;
    const std::uint32_t outputs = whole ? detail::columns(derivatives.size(), rows, techniques) : 0;
    return noisefloor::detail::finish(
        outputs > 0      ? nf_importance_gradient(derivatives.data(), detail::number(rows), outputs,
                                                  static_cast<std::uint32_t>(how), techniques, out.data())
        : techniques > 0 ? NF_ERR_LENGTH
                         : NF_ERR_RANGE);
}

} // namespace importance

// A view of an nf_gradient in caller memory: copying the view does not copy the averages.
class optimal_gradient {
public:
    // Bytes.
    static std::size_t size(std::uint32_t techniques, std::uint32_t parameters) noexcept
    {
        return nf_gradient_size(techniques, parameters);
    }
    // Makes one that has seen no batch in `where`, or makes the one that is there forget.
    static returned<optimal_gradient> create(std::uint32_t techniques, std::uint32_t parameters, memory where)
    {
        optimal_gradient made;
        made.techniques_ = techniques;
        made.parameters_ = parameters;
        const nf_status code =
            nf_gradient_init(where.data(), where.bytes(), techniques, parameters, &made.handle_);
        return detail::finish(code, made);
    }
    template <class C, class = detail::if_ends<C>>
    static returned<optimal_gradient> create(std::uint32_t, std::uint32_t, C &&) = delete;
    optimal_gradient() noexcept = default;

    // pdf[batch * techniques], technique[batch], gradients[batch * parameters], out[parameters]
    returned<void> estimate(std::uint32_t items, span<const float> pdf, span<const std::uint32_t> technique,
                            span<const float> gradients, span<float> out, float momentum = 0.0f,
                            optimal_mis::solver how = optimal_mis::solver::ridge, float ridge = 0.0f)
    {
        const std::uint64_t batch = technique.size();
        const bool fits = batch <= UINT32_MAX && pdf.size() == batch * techniques_ &&
                          gradients.size() == batch * parameters_ && out.size() == parameters_;
        const nf_status code = fits ? nf_gradient_estimate(handle_, static_cast<std::uint32_t>(how), ridge, momentum,
                                                           items, pdf.data(), technique.data(), gradients.data(),
                                                           static_cast<std::uint32_t>(batch), out.data())
                                    : NF_ERR_LENGTH;
        return detail::finish(detail::made(handle_, code));
    }
    nf_gradient *handle() const noexcept { return handle_; }

private:
    nf_gradient *handle_ = nullptr;
    std::uint32_t techniques_ = 0, parameters_ = 0;
};

static_assert(sizeof(config) == sizeof(nf_cv_config), "config is an nf_cv_config");
static_assert(std::is_trivially_copyable_v<config> && std::is_trivially_copyable_v<accumulator>,
              "views and values only");
static_assert(std::is_trivially_destructible_v<optimal_mis> && std::is_trivially_destructible_v<accumulator>,
              "nothing to destroy");

} // inline namespace
} // namespace noisefloor

#endif // NOISEFLOOR_HPP
