"""Optimal MIS weights: right against formulas in NumPy, of any shape and type, and refusals that name what is wrong."""

import math
import tracemalloc

import numpy
import pytest

import noisefloor


def samples(counts, seed=1, shape=()):
    """Densities 1 and 2 x on the unit interval; f = 3 x^2 + 1, of integral 2. The same techniques in every row."""
    generator = numpy.random.default_rng(seed)
    technique = numpy.repeat([0, 1], counts)
    u = generator.random((*shape, len(technique)))
    x = numpy.where(technique == 0, u, numpy.sqrt(1 - u))
    return numpy.stack([numpy.ones_like(x), 2 * x], -1), technique, 3 * x**2 + 1


def direct(pdf, technique, f, ridge=0.0):
    """(2.15) as the guide has it: A alpha = b, and the balance estimate less what the samples got wrong."""
    counts = numpy.bincount(technique)
    ratio = pdf / (pdf @ counts)[:, None]
    matrix, moment = ratio.T @ ratio, ratio.T @ (f / (pdf @ counts))
    extra = ridge * ((counts * numpy.diag(matrix)).sum() - 1) / len(f)
    alpha = numpy.linalg.solve(matrix + extra * numpy.diag(1 / counts), moment)
    return (f / (pdf @ counts)).sum() - (ratio.sum(0) - 1) @ alpha, alpha


def test_it_is_the_formula():
    pdf, technique, f = samples((40, 24))
    for solver, ridge, given in (("plain", 0, None), ("ridge", 2, None), ("ridge", 0.5, 0.5)):
        mean, alpha = direct(pdf, technique, f, ridge)
        found = noisefloor.optimal_mis(pdf, technique, f, solver=solver, ridge=given)
        assert type(found.mean) is float and math.isclose(found.mean, mean, rel_tol=1e-5)
        assert numpy.allclose(found.alpha, alpha, rtol=1e-3)
    balance = noisefloor.optimal_mis(pdf, technique, f, solver="balance")
    assert math.isclose(balance.mean, (f / (pdf @ [40, 24])).sum(), rel_tol=1e-6) and not balance.alpha.any()


def test_less_variance_than_the_balance_heuristic():
    pdf, technique, f = samples((32, 32), shape=(400,))
    optimal, balance = (noisefloor.optimal_mis(pdf, technique, f, solver=name).mean for name in ("ridge", "balance"))
    assert optimal.shape == (400,) and abs(optimal.mean() - 2) < 4 * optimal.std() / 20 + 0.01
    assert optimal.std() < 0.8 * balance.std()


def test_counts_are_proportions_where_chance_picks():
    generator = numpy.random.default_rng(3)
    technique = (generator.random(3000) < 0.25).astype(int)
    u = generator.random(3000)
    x = numpy.where(technique == 0, u, numpy.sqrt(u))
    pdf, f = numpy.stack([numpy.ones_like(x), 2 * x], -1), 3 * x**2 + 1
    found = noisefloor.optimal_mis(pdf, technique, f, counts=[3, 1])
    assert math.isclose(found.mean, 2, rel_tol=0.02)
    assert found.mean == noisefloor.optimal_mis(pdf, technique, f, counts=[6, 2]).mean


def test_leading_dimensions_channels_and_chunks(monkeypatch):
    pdf, technique, f = samples((9, 7), shape=(2, 3))
    colour = f[..., None] * [1, 0.5, 0]
    whole = noisefloor.optimal_mis(pdf, technique, colour, channels=True)
    assert whole.mean.shape == (2, 3, 3) and whole.alpha.shape == (2, 3, 3, 2) and not whole.mean[..., 2].any()
    single = noisefloor.optimal_mis(pdf, technique, f)
    assert single.alpha.shape == (2, 3, 2) and numpy.array_equal(single.mean, whole.mean[..., 0])
    monkeypatch.setattr(noisefloor._mis, "CHUNK", 5)
    again = noisefloor.optimal_mis(
        numpy.asfortranarray(pdf), technique.astype(numpy.uint8), colour.astype(">f8"), channels=True
    )
    assert all(numpy.array_equal(a, b) for a, b in zip(again, whole))
    monkeypatch.setattr(noisefloor._mis, "CHUNK", 40)
    again = noisefloor.optimal_mis(pdf, technique, colour, channels=True)
    assert all(numpy.array_equal(a, b) for a, b in zip(again, whole))
    one = noisefloor.optimal_mis(pdf[0, 0], technique, f[0, 0])
    assert one.mean == single.mean[0, 0]


def test_what_is_shared_is_copied_in_parts():
    pdf, technique, _ = samples((32, 32))
    f = numpy.ones((50_000, 64), numpy.float32)
    tracemalloc.start()
    found = noisefloor.optimal_mis(pdf, technique, f)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # Copies of pdf for all of them would have 26 MB.
    assert peak < 18e6 and numpy.ptp(found.mean) == 0
    with pytest.warns(RuntimeWarning, match="subtract a multiple of a density, and add its integral to the mean"):
        noisefloor.optimal_mis(pdf, technique, 1e9 + f[0].astype(float) * technique)


@pytest.mark.parametrize(
    "change, said",
    [
        ({"pdf": numpy.ones((4, 17))}, r"pdf has the shape \(4, 17\): the techniques, its last axis, are 1 to 16"),
        ({"pdf": numpy.ones(4)}, r"pdf has the shape \(4,\)"),
        ({"pdf": numpy.ones((3, 2))}, "pdf has 3 samples, technique 4 and f 4"),
        ({"pdf": [[1, 1], [1, 1], [1, -1], [1, 1]]}, r"pdf\[2, 1\] is -1: it must be at least 0"),
        ({"pdf": [[1, 1], [1, 1], [1, 0], [1, 1]]}, r"the density of its own technique, of sample\[2\] is 0"),
        ({"technique": [0, 0, 2, 1]}, r"technique\[2\] is 2: it must be 0 to 1"),
        ({"technique": [0.0, 0, 1, 1]}, "technique holds float64: integers are expected"),
        ({"technique": [0, 0, 0, 0]}, r"the number of samples of technique\[1\] is 0"),
        ({"f": [1, 2, 3, math.nan]}, r"f\[3\] is nan"),
        ({"counts": [1, 0]}, r"counts\[1\] is 0: it must be at least 1"),
        ({"counts": [1, 1, 1]}, r"counts has the shape \(3,\): it must be \(2,\)"),
        ({"solver": "progressive"}, "solver is 'progressive': it must be one of 'ridge', 'plain', 'balance'"),
        ({"ridge": 1, "solver": "plain"}, "ridge is 1, and solver 'plain': only 'ridge' has one"),
        ({"ridge": 1e9}, "ridge is 1000000000.0: it must be 1e-08 to 100000000.0"),
        ({"channels": True}, r"\(\.\.\., n, c\) are needed"),
        ({"pdf": numpy.ones((2, 4, 2)), "f": numpy.ones((3, 4))}, "do not broadcast"),
    ],
)
def test_refusals(change, said):
    arguments = {"pdf": numpy.ones((4, 2)), "technique": [0, 0, 1, 1], "f": [1, 2, 3, 4]} | change
    with pytest.raises((ValueError, TypeError), match=said):
        noisefloor.optimal_mis(**arguments)
