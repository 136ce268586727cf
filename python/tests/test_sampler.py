"""Points: the library's, stratified, and with the manners of scipy's engines."""

import math

import numpy
import pytest

import noisefloor

stats = pytest.importorskip("scipy.stats")


def test_parts_are_parts_of_the_whole():
    sampler = noisefloor.Sampler(frame=3)
    whole = sampler.image(20, 10, 8, 6)
    assert whole.shape == (10, 20, 8, 6) and whole.dtype == numpy.float32
    assert (whole >= 0).all() and (whole < 1).all()
    assert numpy.array_equal(sampler.image(5, 4, 3, 6, x=7, y=2, first=4), whole[2:6, 7:12, 4:7])
    assert numpy.array_equal(sampler.pixel(7, 2, 8, 6), whole[2, 7])
    assert numpy.array_equal(sampler.pixel(7, 2, 8, 3), whole[2, 7, :, :3])
    assert numpy.array_equal(sampler.domain(2**32 - 2).pixel(7, 2, 8, 2), whole[2, 7, :, 4:])
    assert not (sampler.domain(1).pixel(7, 2, 8, 2) == whole[2, 7, :, 4:]).any()


def test_domains_frames_seeds_and_white_differ():
    plain = noisefloor.Sampler()
    others = [
        plain.domain(0),
        plain.domain(1),
        plain.domain(1).domain(1),
        noisefloor.Sampler(frame=1),
        noisefloor.Sampler(seed=1),
        noisefloor.Sampler(white=True),
    ]
    points = [sampler.image(4, 4, 2) for sampler in (plain, *others)]
    assert len({array.tobytes() for array in points}) == len(points)
    assert repr(others[2]) == "Sampler(frame=0, seed=0, white=False).domain(1).domain(1)"


def test_engine_has_scipys_manners():
    engine, sobol = noisefloor.QMCEngine(3, seed=5), stats.qmc.Sobol(3, seed=5)
    points = engine.random(64)
    assert points.shape == sobol.random(64).shape and points.dtype == sobol.random(1).dtype
    assert engine.num_generated == 64 and repr(engine) == "QMCEngine(3, seed=5)"
    assert numpy.array_equal(engine.reset().random(64), points)
    assert numpy.array_equal(noisefloor.QMCEngine(3, seed=5).fast_forward(10).random(5), points[10:15])
    assert engine.random(0).shape == (0, 3)
    assert not numpy.array_equal(noisefloor.QMCEngine(3).random(4), noisefloor.QMCEngine(3).random(4))
    assert stats.qmc.discrepancy(points) < 0.3 * stats.qmc.discrepancy(numpy.random.default_rng(1).random((64, 3)))


def test_engines_are_unbiased_over_seeds():
    """Two-sided, one false alarm in 150,000 seeds, which are fixed."""
    means = [numpy.exp(noisefloor.QMCEngine(2, seed=seed).random(16).sum(1)).mean() for seed in range(4000)]
    z = (numpy.mean(means) - (math.e - 1) ** 2) / (numpy.std(means) / math.sqrt(len(means)))
    assert abs(z) < 4.5


def test_first_points_of_engines_are_of_few_sequences():
    """What the docstring says: that seeds are no replications there."""
    firsts = [noisefloor.QMCEngine(2, seed=seed).random(64) for seed in range(20000)]
    pairs, fours, all_64 = (len({points[:n].tobytes() for points in firsts}) for n in (2, 4, 64))
    assert (pairs, fours) == (1024, 2048)
    # Some 500,000 sequences make 400 of 200 million pairs of seeds the same.
    assert 300 < 20000 - all_64 < 500


def test_what_memory_has_not_is_refused_at_once():
    with pytest.raises((MemoryError, ValueError)):
        noisefloor.Sampler().image(2**31, 2**31, 1, 2**32 - 1)


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda: noisefloor.Sampler(frame=-1), "frame is -1: it must be 0 to 4294967295"),
        (lambda: noisefloor.Sampler().domain(2**32), "key is 4294967296"),
        (lambda: noisefloor.Sampler().image(0, 1, 1), "width is 0: it must be 1 to"),
        (lambda: noisefloor.Sampler().image(1, 1, 1, 0), "dims is 0"),
        (lambda: noisefloor.Sampler().image(1, 1, 4, first=2**32 - 3), "first is 4294967293: it must be 0 to"),
        (lambda: noisefloor.Sampler().pixel(1, 1, 1.0), "samples is 1.0: an integer"),
        (lambda: noisefloor.QMCEngine(5), "d is 5: it must be 1 to 4"),
        (lambda: noisefloor.QMCEngine(1).random(-1), "n is -1"),
    ],
)
def test_refusals_name_argument_value_and_range(call, said):
    with pytest.raises((ValueError, TypeError), match=said):
        call()
