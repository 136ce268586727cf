"""Estimates: right, of any shape and type, and refusals that name what is wrong."""

import math
import threading
import time
import tracemalloc
import warnings
from typing import get_args

import hypothesis
import numpy
import pytest
from hypothesis import strategies
from hypothesis.extra import numpy as arrays

import noisefloor

ESTIMATORS = "robust", "least_squares", "leave_one_out", "k_fold", "gradient_descent", "incremental"


def samples(*shape, seed=1):
    """Uniform points."""
    return numpy.random.default_rng(seed).random(shape)


def smooth(u):
    """exp of the sum, whose integral is (e - 1)^d."""
    return numpy.exp(u.sum(-1))


def test_order_0_is_the_mean():
    u, f = samples(7, 5, 3), samples(7, 5, seed=2)
    estimate = noisefloor.estimate(u, f, order=0)
    assert numpy.allclose(estimate.mean, f.mean(-1), rtol=1e-6)
    assert numpy.allclose(estimate.std_error, f.std(-1, ddof=1) / math.sqrt(5), rtol=1e-4)
    assert (estimate.gain == 1).all()
    stratified = noisefloor.estimate(u, f, stratified=True)
    assert numpy.array_equal(stratified.mean, estimate.mean)


def test_one_integral_is_floats():
    u = samples(32, 2)
    estimate = noisefloor.estimate(u, smooth(u))
    assert all(type(part) is float for part in estimate)
    assert math.isinf(noisefloor.estimate(u[:1], [1.0]).std_error)


@hypothesis.given(
    arrays.mutually_broadcastable_shapes(num_shapes=2, max_dims=3, max_side=3),
    strategies.integers(1, 4),
    strategies.integers(1, 12),
    strategies.sampled_from([0, 1, 2, 3, 4]),
)
def test_leading_dimensions_broadcast(shapes, dims, n, channels):
    generator = numpy.random.default_rng(5)
    u = generator.random((*shapes.input_shapes[0], n, dims))
    f = generator.random((*shapes.input_shapes[1], n) + ((channels,) if channels else ()))
    estimate = noisefloor.estimate(u, f, order=1, channels=channels > 0)
    leading = shapes.result_shape
    wide_u = numpy.broadcast_to(u, (*leading, n, dims))
    wide_f = numpy.broadcast_to(f, leading + f.shape[len(shapes.input_shapes[1]) :])
    assert numpy.shape(estimate.gain) == leading
    assert numpy.shape(estimate.mean) == leading + ((channels,) if channels else ())
    for at in numpy.ndindex(*leading):
        one = noisefloor.estimate(wide_u[at], wide_f[at], order=1, channels=channels > 0)
        for part, whole in zip(one, estimate):
            assert numpy.array_equal(part, numpy.asarray(whole)[at], equal_nan=True)


def test_controls_of_known_integral():
    """f is a combination of controls, and of what no sample tells: of order 0 nothing is left but that."""
    u = samples(5, 30, 2)
    controls = numpy.stack([numpy.sin(9 * u[..., 0]), u[..., 1] > 0.3], -1)
    integrals = numpy.array([(1 - math.cos(9)) / 9, 0.7])
    f = controls @ [2.0, -1.0] + 4
    options = {"controls": controls, "control_integrals": integrals, "order": 0, "estimator": "least_squares"}
    found = noisefloor.estimate(u, f, **options)
    assert found.mean.shape == (5,) and numpy.allclose(found.mean, integrals @ [2.0, -1.0] + 4, atol=1e-5)
    one = noisefloor.estimate(u[2], f[2], **options | {"controls": controls[2]})
    assert one.mean == found.mean[2]
    # Integrals of their own, and channels.
    each = integrals + numpy.arange(5)[:, None]
    moved = noisefloor.estimate(u, f[..., None] * [1, 2], channels=True, **options | {"control_integrals": each})
    assert numpy.allclose(moved.mean, (each @ [2.0, -1.0] + 4)[:, None] * [1, 2], atol=1e-4)
    robust = noisefloor.estimate(u, f, controls=controls, control_integrals=integrals)
    assert numpy.isfinite(robust.mean).all() and (robust.std_error < 0.2).all()


def test_ridge_folds_and_solver():
    u = samples(200, 2)
    f = smooth(u)
    default = noisefloor.estimate(u, f, estimator="leave_one_out")
    same = noisefloor.estimate(u, f, estimator="leave_one_out", ridge=0.01)
    assert same.mean == pytest.approx(default.mean, rel=1e-6)
    for ridge in (2e-5, "auto"):
        assert noisefloor.estimate(u, f, estimator="leave_one_out", ridge=ridge).std_error < default.std_error
    assert noisefloor.estimate(u, f, estimator="k_fold") == noisefloor.estimate(u, f, estimator="k_fold", folds=4)
    assert noisefloor.estimate(u, f, estimator="k_fold") != noisefloor.estimate(u, f, estimator="k_fold", folds=8)
    names = get_args(noisefloor.Solver)
    fits = [noisefloor.estimate(u, f, estimator="least_squares", solver=name).mean for name in names]
    assert numpy.allclose(fits, fits[0], rtol=1e-4)


def test_what_is_broadcast_is_copied_in_parts(monkeypatch):
    u, f = samples(256, 4), samples(6, 50, 256, seed=2)
    for shared, other in ((u, f), (samples(50, 256, 4), f), (samples(6, 1, 256, 4), f), (f[..., None], f[0, 0])):
        wide = [
            numpy.ascontiguousarray(numpy.broadcast_to(part, (6, 50) + part.shape[part.ndim - own :]))
            for part, own in ((shared, 2), (other, 1))
        ]
        expected = noisefloor.estimate(*wide, order=1)
        for chunk, copied in ((1 << 19, 1 << 24), (7 * 256, 1 << 24), (1 << 19, 5000), (1, 1)):
            monkeypatch.setattr(noisefloor._estimate, "CHUNK", chunk)
            monkeypatch.setattr(noisefloor._estimate, "COPIED", copied)
            for part, whole in zip(noisefloor.estimate(shared, other, order=1), expected):
                assert numpy.array_equal(part, whole)
    f = numpy.zeros((10_000, 256), numpy.float32)
    monkeypatch.setattr(noisefloor._estimate, "COPIED", 1 << 18)
    tracemalloc.start()
    noisefloor.estimate(u, f, order=0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # Copies of u for all of them would have 41 MB; what is there beside has a few.
    assert peak < 20e6


@hypothesis.given(
    strategies.sampled_from([numpy.float16, numpy.float32, numpy.float64, numpy.dtype(">f8")]),
    strategies.sampled_from(["C", "F"]),
    strategies.integers(-2, 2).filter(bool),
)
def test_any_type_and_stride_is_the_same(kind, order, step):
    u, f = samples(6, 20, 3).astype(kind), samples(6, 20, seed=3).astype(kind)
    plain = noisefloor.estimate(
        numpy.array(u[:, ::step], numpy.float32, order="C"), numpy.array(f[:, ::step], numpy.float32)
    )
    other = noisefloor.estimate(numpy.array(u, order=order)[:, ::step], numpy.array(f, order=order)[:, ::step])
    assert all(numpy.array_equal(a, b) for a, b in zip(plain, other))


@hypothesis.given(
    arrays.arrays(numpy.float64, (3, 4, 2), elements=strategies.floats()),
    arrays.arrays(numpy.float64, (3, 4), elements=strategies.floats()),
    strategies.sampled_from(ESTIMATORS),
    strategies.integers(0, 7),
)
def test_any_numbers_give_finite_means_or_a_refusal(u, f, estimator, order):
    with numpy.errstate(over="ignore"):
        good = ((u.astype(numpy.float32) >= 0) & (u.astype(numpy.float32) <= 1)).all()
        good = good and numpy.isfinite(f.astype(numpy.float32)).all()
    if good:
        assert numpy.isfinite(noisefloor.estimate(u, f, estimator=estimator, order=order).mean).all()
    else:
        with pytest.raises(ValueError, match=r"[uf]\[\d, \d(, \d)?\] is .*: it must be "):
            noisefloor.estimate(u, f, estimator=estimator, order=order)


def test_no_integrals_and_very_many():
    assert noisefloor.estimate(samples(0, 4, 2), samples(0, 4)).mean.shape == (0,)
    u = samples(70_000, 3, 1)
    estimate = noisefloor.estimate(u, u[..., 0], order=1, estimator="least_squares")
    last = noisefloor.estimate(u[-1], u[-1, :, 0], order=1, estimator="least_squares")
    assert estimate.mean[-1] == numpy.float32(last.mean)


@pytest.mark.parametrize(
    "arguments, options, said",
    [
        ((samples(4, 2), samples(5)), {}, r"u has 4 samples and f 5"),
        ((samples(4, 2), samples()), {}, r"u has the shape \(4, 2\) and f \(\): "),
        ((samples(4), samples(4)), {}, r"\(\.\.\., n, d\) .* are needed; for one dim u\[:, None\]"),
        ((samples(4, 2), samples(4, 3)), {}, r"u has 4 samples and f 3, .* values of a sample: channels=True$"),
        ((samples(4, 2), samples(5, 3)), {}, r"u has 4 samples and f 3, in the shapes \(4, 2\) and \(5, 3\)$"),
        ((samples(0, 2), samples(0)), {}, "there are no samples"),
        ((samples(2, 4, 2), samples(3, 4)), {}, "do not broadcast"),
        ((2 * samples(4, 2) + 1, samples(4)), {}, r"u\[0, 0\] is .*: it must be 0 to 1"),
        ((samples(4, 2), numpy.full(4, math.nan)), {}, r"f\[0\] is nan: it must be finite"),
        ((samples(4, 2), numpy.full(4, 1e39)), {}, r"f\[0\] is 1e\+39: .*within float32's range"),
        ((samples(4, 2), numpy.full(4, "a")), {}, "f holds <U1: real numbers"),
        ((samples(4, 17), samples(4)), {}, "u has 17 coordinates: 1 to 16 can be regressed; `dims`"),
        ((samples(4, 0), samples(4)), {}, "u has 0 coordinates"),
        ((samples(4, 12), samples(4)), {"order": 4}, "makes 1820 terms: at most 136; order 2 fits"),
        ((samples(4, 6), samples(4)), {"order": 7}, "order 7 in 6 dims with 1 slices makes 1716 terms: .* 3 fits"),
        ((samples(4, 3), samples(4)), {"slices": 131}, "with 131 slices makes 137 terms: at most 136; order 1 fits"),
        ((samples(4, 2), samples(4)), {"slices": 135, "order": 1}, "makes 137 terms: .* fewer dims or slices fit"),
        ((samples(4, 2), samples(4)), {"slices": 200, "order": 0}, "slices is 200: it must be 1 to 135"),
        ((samples(4, 2), samples(4)), {"order": 8}, "order is 8: it must be 0 to 7"),
        ((samples(4, 2), samples(4)), {"order": 1.5}, "order is 1.5: an integer"),
        ((samples(4, 2), samples(4)), {"dims": 3}, "dims is 3: it must be 1 to 2"),
        ((samples(4, 2), samples(4)), {"estimator": "best"}, "estimator is 'best': it must be one of 'robust'"),
        ((samples(4, 2), samples(4)), {"basis": "cubic"}, "basis is 'cubic'"),
        ((samples(4, 2), samples(4)), {"slices": 0}, "slices is 0"),
        ((samples(4, 2), samples(4, 5)), {"channels": True}, r"channels is 5: 4 are the most; .*moveaxis\(f, -1, 0\)"),
        ((samples(4, 2), samples(4, 0)), {"channels": True}, "f's channels is 0: it must be 1 to 4"),
        (([[1.0, 2.0], [1.0]], [1.0, 2.0]), {}, "u is no array of numbers"),
        ((samples(4, 2), samples(4)), {"controls": samples(4, 1)}, "controls and control_integrals belong together"),
        (
            (samples(4, 2), samples(4)),
            {"controls": samples(3, 1), "control_integrals": [0.5]},
            r"controls has the shape \(3, 1\): \(\.\.\., 4, k\) is needed",
        ),
        (
            (samples(4, 2), samples(4)),
            {"controls": samples(4, 2), "control_integrals": [0.5]},
            r"control_integrals has the shape \(1,\): \(\.\.\., 2\) is needed",
        ),
        (
            (samples(4, 2), samples(4)),
            {"controls": samples(4, 5), "control_integrals": samples(5)},
            "the number of controls is 5: it must be 0 to 4",
        ),
        (
            (samples(4, 2), samples(4)),
            {"controls": [[1], [2], [math.inf], [3]], "control_integrals": [0.5]},
            r"controls\[2, 0\] is inf: it must be finite",
        ),
        (
            (samples(4, 2), samples(4)),
            {"controls": samples(4, 1), "control_integrals": [0.5], "solver": "dual"},
            "solver must not be the dual with controls; .* solver 'dual'",
        ),
        ((samples(4, 2), samples(4)), {"solver": "square_root"}, "solver must not be the square root but .* 'robust'"),
        ((samples(4, 2), samples(4)), {"solver": "qr"}, "solver is 'qr': it must be one of 'auto', "),
        ((samples(4097, 2), samples(4097)), {"solver": "dual"}, "solver is 'dual', and u has 4097 samples"),
        ((samples(4, 2), samples(4)), {"ridge": 1}, "ridge is 1, and estimator 'robust' takes none"),
        ((samples(4, 2), samples(4)), {"folds": 4}, "folds is 4, and estimator 'robust' takes none"),
        ((samples(4, 2), samples(4)), {"ridge": 0, "estimator": "k_fold"}, "ridge is 0.0: it must be 1e-12 to 3e"),
        ((samples(4, 2), samples(4)), {"ridge": "best", "estimator": "k_fold"}, "ridge is 'best': .* one of 'auto'"),
        ((samples(4, 2), samples(4)), {"folds": 1, "estimator": "k_fold"}, "folds is 1: it must be 2 to 16"),
        ((samples(4, 2), numpy.ma.array(samples(4), mask=[0, 1, 0, 0])), {}, "f is a masked array"),
    ],
)
def test_refusals_name_argument_value_and_range(arguments, options, said):
    with pytest.raises((ValueError, TypeError), match=said):
        noisefloor.estimate(*arguments, **options)


def test_lost_digits_are_told():
    """float64 of which float32 keeps too little; not float32's own, nor constants, nor what is only small."""
    u = samples(64, 2)
    f = smooth(u)
    for lost in (f + 1e8, -f - 1e8, (1e8 * f).astype(numpy.int64) + 10**14):
        with pytest.warns(RuntimeWarning, match="subtract a constant, and add its integral to the mean") as told:
            noisefloor.estimate(u, lost)
        assert told[0].filename == __file__
    with pytest.warns(RuntimeWarning, match="f is 10000000"):
        noisefloor.estimate(u, numpy.stack([f, f + 1e8]))
    with pytest.warns(RuntimeWarning, match="few digits, or none, for such: multiply by a constant"):
        noisefloor.estimate(u, 1e-80 * f)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for kept in (f + 1e3, 1e-30 * f, (f + 1e8).astype(numpy.float32), numpy.full(64, 1e8), numpy.full(64, math.pi)):
            noisefloor.estimate(u, kept)
        with pytest.raises(ValueError, match=r"f\[1\] is nan"):
            noisefloor.estimate(u[:3], [1.0, math.nan, math.inf])


def test_of_longer_paths_the_first_dims_count():
    u = samples(50, 20)
    f = u[:, 0] + u[:, 1]
    assert noisefloor.estimate(u, f, dims=2) == noisefloor.estimate(u[:, :2], f)


def image(samples_per_pixel=1, size=24, channels=()):
    """A picture of soft light, of points of the sampler."""
    u = noisefloor.Sampler().image(size, size, samples_per_pixel)
    x = numpy.arange(size) / size
    f = smooth(u) * (1 + x)[:, None, None]
    exact = (math.e - 1) ** 2 * (1 + x)[:, None] * numpy.ones(size)
    return u, numpy.stack([f * (1 + c) for c in range(*channels)], -1) if channels else f, exact


@pytest.mark.parametrize("spp", [1, 4])
def test_images_have_less_error(spp):
    u, f, exact = image(spp)
    estimate = noisefloor.image_estimate(u, f, stratified=True)
    errors = [((x - exact) ** 2).mean() for x in (f.mean(-1), estimate.mean)]
    assert errors[1] < 0.2 * errors[0]
    assert estimate.mean.shape == estimate.gain.shape == exact.shape


def test_images_of_channels_frames_surfaces_and_factors():
    u, f, _ = image(2, channels=(3,))
    plain = noisefloor.image_estimate(u, f, channels=True)
    assert plain.mean.shape == plain.std_error.shape == (24, 24, 3) and plain.gain.shape == (24, 24)
    frames = noisefloor.image_estimate(u[None], f[None], channels=True)
    assert numpy.array_equal(frames.mean[0], plain.mean)
    apart = numpy.arange(24 * 24, dtype=numpy.int16).reshape(24, 24)
    alone = noisefloor.image_estimate(u[..., :1, :], f[..., :1, :], channels=True, surfaces=apart)
    assert numpy.array_equal(alone.mean, f[..., 0, :].astype(numpy.float32))
    steps = noisefloor.image_estimate(u, f, channels=True, basis="step")
    assert steps.mean.shape == plain.mean.shape and not numpy.array_equal(steps.mean, plain.mean)
    albedo = samples(24, 24) + 0.1
    textured = noisefloor.image_estimate(u, f[..., 0] * albedo[..., None], factors=albedo)
    assert numpy.allclose(textured.mean / albedo, noisefloor.image_estimate(u, f[..., 0]).mean, rtol=1e-3)


@hypothesis.given(
    strategies.lists(strategies.integers(1, 9), min_size=2, max_size=2),
    strategies.sampled_from([(), (1,), (2,)]),
    strategies.integers(1, 5),
    strategies.integers(1, 3),
    strategies.integers(0, 4),
    strategies.sampled_from([numpy.float16, numpy.float32, numpy.float64]),
    strategies.booleans(),
)
def test_images_of_any_shape_type_stride_and_number_of_threads(size, frames, n, dims, channels, kind, is_reversed):
    generator = numpy.random.default_rng(8)
    u = generator.random((*frames, *size, n, dims)).astype(kind)
    f = generator.random((*frames, *size, n) + ((channels,) if channels else ())).astype(kind)
    u, f = (u[..., ::-1, :, :], f[..., ::-1]) if is_reversed else (u, f)
    estimate = noisefloor.image_estimate(u, f, order=1, channels=channels > 0, window=2)
    plain = (array.astype(numpy.float32, order="C") for array in (u, f))
    again = noisefloor.image_estimate(*plain, order=1, channels=channels > 0, window=2, threads=n)
    assert estimate.gain.shape == (*frames, *size) and numpy.isfinite(estimate.mean).all()
    assert estimate.mean.shape == estimate.std_error.shape == f.shape[: len(frames) + 2] + f.shape[len(frames) + 3 :]
    assert all(numpy.array_equal(a, b, equal_nan=True) for a, b in zip(estimate, again))


def test_pixels_without_places():
    u, f, _ = image(2)
    u, f = u.reshape(-1, 1, 2, u.shape[-1]), f.reshape(-1, 1, 2)
    cloud = noisefloor.image_estimate(u, f, unordered=True, threads=3)
    assert numpy.array_equal(cloud.mean, noisefloor.image_estimate(u, f, unordered=True).mean)
    assert not numpy.array_equal(cloud.mean, noisefloor.image_estimate(u, f).mean)
    with pytest.raises(ValueError, match="pixels with surfaces must be at most 1024 where they are unordered; u has"):
        tiled = [numpy.concatenate([array] * 2) for array in (u, f)]
        noisefloor.image_estimate(*tiled, unordered=True, surfaces=numpy.zeros((len(tiled[0]), 1), int))


def test_windows_are_numbers_of_any_type():
    u, f, _ = image()
    expected = noisefloor.image_estimate(u, f, window=8, threads=32).mean
    for kind in (numpy.int8, numpy.uint8):
        assert numpy.array_equal(noisefloor.image_estimate(u, f, window=kind(8), threads=32).mean, expected)


def test_edges_of_shadows():
    u, f, _ = image(4)
    shadowed = numpy.where(u[..., 0] + 0.3 * u[..., 1] < 0.6, f, 0)
    plain, edges = (noisefloor.image_estimate(u, shadowed, edges=first).mean for first in (0, 1))
    assert numpy.isfinite(edges).all() and not numpy.array_equal(edges, plain)


def test_known_light_leaves_no_error():
    u, f, exact = image(1)
    estimate = noisefloor.image_estimate(u, f, known=f, known_integrals=exact, estimator="leave_one_out")
    assert numpy.allclose(estimate.mean, exact, rtol=0.02)


@pytest.mark.parametrize(
    "options, said",
    [
        ({"surfaces": numpy.zeros((24, 23), int)}, r"surfaces has the shape \(24, 23\): it must be \(24, 24\)"),
        ({"surfaces": numpy.full((24, 24), -1)}, r"surfaces\[0, 0\] is -1"),
        ({"surfaces": numpy.zeros((24, 24))}, "surfaces holds float64: integers"),
        ({"factors": numpy.full((24, 24), -1)}, r"factors\[0, 0\] is -1: it must be at least 0"),
        ({"known": numpy.zeros((24, 24, 1))}, "known and known_integrals belong together"),
        ({"known": numpy.zeros((24, 24, 2))}, r"known has the shape \(24, 24, 2\)"),
        ({"edges": 2}, "edges is 2: it must be 0 to 1"),
        ({"ridge": "auto"}, "ridge is 'auto': a number is expected, or None"),
        ({"window": 33}, "window is 33: it must be 1 to 32"),
        ({"stride": 9}, "stride is 9: it must be 1 to 8"),
        ({"threads": 0}, "threads is 0: it must be 1 to 1024"),
        ({"estimator": "incremental"}, "estimator is 'incremental': .* one of 'robust', 'leave_one_out', 'k_fold'$"),
        ({"known": numpy.zeros((24, 24, 1)), "estimator": "k_fold"}, "known is given, and estimator is 'k_fold': "),
        ({"channels": True}, r"f has the shape \(24, 24, 1\): with this u it must be"),
    ],
)
def test_refusals_of_images(options, said):
    u, f, _ = image()
    with pytest.raises((ValueError, TypeError), match=said):
        noisefloor.image_estimate(u, f, **options)


def test_other_threads_run_meanwhile():
    """A call of a second or so: a thread that sleeps for milliseconds must wake many times."""
    u = samples(100_000, 64, 3).astype(numpy.float32)
    f, wakes, done = smooth(u), [], threading.Event()

    def wake():
        while not done.is_set():
            time.sleep(0.001)
            wakes.append(time.perf_counter())

    thread = threading.Thread(target=wake)
    thread.start()
    noisefloor.estimate(u[:1], f[:1])
    start = time.perf_counter()
    noisefloor._estimate.CHUNK, before = f.size, noisefloor._estimate.CHUNK
    try:
        noisefloor.estimate(u, f)
    finally:
        noisefloor._estimate.CHUNK = before
        end = time.perf_counter()
        done.set()
        thread.join()
    inside = [at for at in wakes if start < at < end]
    assert end - start > 0.05 and len(inside) > 10


def test_recommendations():
    best = noisefloor.recommend(2, 16)
    assert best.method == "per_pixel" and best.estimator in ESTIMATORS and 0 < best.error < 1
    u = samples(16, 2)
    noisefloor.estimate(u, smooth(u), order=best.order, estimator=best.estimator, stratified=best.stratified)
    # What is recommended can be called: of many dims the first.
    best = noisefloor.recommend(20, 64)
    u = samples(64, 20)
    noisefloor.estimate(u[:, : best.dims], smooth(u), order=best.order, estimator=best.estimator)
    assert best.method == "per_pixel" and best.image_stride is None
    best = noisefloor.recommend(2, 1, stratified=True, can_share=True)
    assert best.method == "shared" and best.image_stride == 8
    # What docs/python.md says of Sobol points: no fit is safe.
    for dims, n in ((1, 64), (2, 256), (4, 1024), (8, 4096)):
        assert noisefloor.recommend(dims, n, stratified=True).method == "plain_mean"
    assert noisefloor.recommend(2, 16, sample_cost=1e-3).method == "plain_mean"
    for options, said in (
        ({"sample_cost": 0}, "sample_cost is 0.0"),
        ({"sample_cost": math.nan}, "sample_cost is nan"),
        ({"sample_cost": 10**400}, "sample_cost is an integer beyond a float's range"),
    ):
        with pytest.raises(ValueError, match=said):
            noisefloor.recommend(2, 16, **options)
    with pytest.raises(ValueError, match="dims is 0"):
        noisefloor.recommend(0, 1)
