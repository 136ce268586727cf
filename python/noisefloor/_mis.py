"""Integrals from samples of several techniques, weighted so that they vary least."""

from __future__ import annotations

import ctypes
import math
from typing import Any, Literal, NamedTuple

import numpy

from . import _arrays, _c
from ._estimate import CHUNK, COPIED

MISSolver = Literal["ridge", "plain", "balance"]


class OptimalMIS(NamedTuple):
    """Estimates of integrals, with their leading dimensions: arrays of float32, or floats of a single integral.

    Attributes:
        mean: the integral; a last axis for the channels, if there are channels.
        alpha: of the mean's shape and a last axis for the J techniques: Σ alpha_j p_j is what is taken from f. For
            other samples than these, n_j of each technique, Σ alpha_j and the sum over them of
            (f - Σ alpha_j p_j) / Σ n_j p_j are together unbiased.
    """

    # Any: which of the two it is depends on shapes, which types do not tell.
    mean: Any
    alpha: Any


def optimal_mis(
    pdf: Any,
    technique: Any,
    f: Any,
    *,
    counts: Any = None,
    solver: MISSolver = "ridge",
    ridge: float | None = None,
    channels: bool = False,
) -> OptimalMIS:
    """Estimates the integral of f from samples of J techniques by multiple importance sampling with optimal weights
    (Kondapaneni et al., 2019), or many integrals.

    Args:
        pdf: shape (..., n, J), at least 0: the density of each of 1 to 16 techniques at each sample's point. A draw
            that failed has f 0, density 1 of its technique and 0 of the others: every sample counts.
        technique: integers of shape (..., n), 0 to J - 1: which technique drew the sample. Its density is above 0.
        f: shape (..., n), with `channels` (..., n, c): the integrand there, not divided by any density. Leading
            dimensions of all three broadcast.
        counts: shape (J,), integers of at least 1, [3, 1] say for three to one: how often techniques draw, where chance
            picked; one may then have no sample. None: each drew as many as there are of it, at least 1.
        solver: "ridge", consistent; "plain", the direct estimator, with heavy tails of similar techniques or few
            samples; "balance", the balance heuristic, unbiased.
        ridge: of "ridge" alone: as many samples that know nothing of f, 1e-8 to 1e8; None: 2.
        channels: whether f's last axis holds the values of a sample.

    Returns:
        An `OptimalMIS` with the leading dimensions, of float32. Inputs are rounded to that; a warning says where f has
        too many digits.
    """
    given = {"pdf": _arrays.array("pdf", pdf), "f": _arrays.array("f", f)}
    pdf, f = _arrays.check_positive("pdf", given["pdf"]), _arrays.check_finite("f", given["f"])
    values = 1 if channels else 0
    _arrays.warn_of_lost_digits("f", given["f"], what="a multiple of a density")
    technique = _arrays.array("technique", technique)
    are_there = pdf.ndim > 1 and technique.ndim > 0 and f.ndim > values
    if not are_there or 0 in pdf.shape[-2:] + f.shape[f.ndim - values :]:
        raise ValueError(
            f"pdf has the shape {pdf.shape}, technique {technique.shape} and f {f.shape}: (..., n, J), (..., n) and "
            f"(..., n{', c' * values}) are needed, of at least 1 each"
        )
    n, techniques = pdf.shape[-2:]
    own = f.shape[f.ndim - 1 - values :]
    if not n == technique.shape[-1] == own[0]:
        raise ValueError(f"pdf has {n} samples, technique {technique.shape[-1]} and f {own[0]}: they must agree")
    if techniques > _c.CONSTANTS["NF_MIS_MAX_TECHNIQUES"]:
        raise ValueError(f"pdf has the shape {pdf.shape}: the techniques, its last axis, are 1 to 16")
    technique = _arrays.integers("technique", technique, techniques - 1)
    if counts is not None:
        counts = _arrays.integers("counts", counts, _arrays.MAX_U32)
        _arrays.check_shape("counts", counts, (techniques,), "a number for each of pdf's techniques")
        _arrays.check("counts", counts, counts > 0, "at least 1")
    number = _arrays.one_of("solver", solver, _c.OMIS_SOLVERS)
    if ridge is not None and solver != "ridge":
        raise ValueError(f"ridge is {ridge!r}, and solver {solver!r}: only 'ridge' has one")
    ridge = 0 if ridge is None else _arrays.number("ridge", ridge, 1e-8, 1e8)
    _, pairs = _arrays.broadcast({"pdf": (pdf, 2), "technique": (technique, 1)})
    drawn = pairs["technique"].astype(numpy.intp)[..., None]
    density = numpy.take_along_axis(pairs["pdf"], drawn, -1)[..., 0]
    _arrays.check("the density of its own technique, of sample", density, density > 0, "above 0, in float32")
    if counts is None:
        counts = numpy.stack([(technique == j).sum(-1, dtype=numpy.uint32) for j in range(techniques)], -1)
        _arrays.check("the number of samples of technique", counts, counts > 0, "at least 1; or give `counts`")
    arrays = {"pdf": (pdf, 2), "technique": (technique, 1), "f": (f, 1 + values), "counts": (counts, 1)}
    leading, wide = _arrays.broadcast(arrays)
    integrals, count = own[1] if channels else 1, math.prod(leading)
    mean = numpy.empty((count, integrals), numpy.float32)
    alpha = numpy.empty((count, integrals, techniques), numpy.float32)
    memory = _c.workspace(_c.omis_size(techniques, integrals))
    place, handle = _c.data(memory), ctypes.c_void_p()
    out = ctypes.addressof(handle)
    each = max(1, min(CHUNK, COPIED // (1 + techniques + integrals)) // n)
    for begin in range(0, count, each):
        some = range(begin, min(begin + each, count))
        # Copies live as long as their name.
        held = [_arrays.some_of(array, len(leading), some) for array in wide.values()]
        held += [array[begin : some.stop] for array in (mean, alpha)]
        parts = zip(*(range(_c.data(array), _c.data(array) + array.nbytes, array[0].nbytes) for array in held))
        for *inputs, sizes, means, alphas in parts:
            status = _c.omis_init(place, memory.nbytes, techniques, integrals, sizes, out)
            for first in range(0, n, CHUNK):
                rows = (start + first * 4 * width for start, width in zip(inputs, (techniques, 1, integrals)))
                status = status or _c.omis_add(handle, *rows, min(CHUNK, n - first))
            status = status or _c.omis_solve(handle, number, ridge, means, alphas)
            if status:
                raise ValueError(f"{_c.message(status)}: of {techniques} techniques and {integrals} integrals")
    mean, alpha = mean.reshape(*leading, integrals), alpha.reshape(*leading, integrals, techniques)
    if not channels:
        mean, alpha = mean[..., 0], alpha[..., 0, :]
    return OptimalMIS(mean if mean.ndim else float(mean), alpha)
