"""Which estimator to use."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from . import _arrays, _c
from ._estimate import ImageEstimator


class Recommendation(NamedTuple):
    """What to use, and what to expect of it.

    Attributes:
        method: "plain_mean", "per_pixel" (`estimate`) or "shared" (`image_estimate`).
        order, estimator, stratified: what to give to that function.
        image_stride: `stride` of `image_estimate`, None of other methods; without it windows overlap,
            which has less error and takes more time.
        error: mean squared error over that of the plain mean of independent samples.
        filtered_error: the same of an image seen through a Gaussian of 2.1 pixels.
        cost: nanoseconds that the method takes for each sample.
        pays_from: nanoseconds that a sample must cost for the method to pay; infinite if none pays.
        dims: how many coordinates to give to that function, the first; 15 of 20, say.
    """

    method: Literal["plain_mean", "per_pixel", "shared"]
    order: int
    estimator: ImageEstimator
    stratified: bool
    image_stride: int | None
    error: float
    filtered_error: float
    cost: float
    pays_from: float
    dims: int


def recommend(
    dims: int, samples: int, *, stratified: bool = False, can_share: bool = False, sample_cost: float = math.inf
) -> Recommendation:
    """Which estimator to use.

    Args:
        dims: coordinates of a sample, at least 1.
        samples: of each integral or pixel, at least 1.
        stratified: whether points are a Sobol sequence's, a lattice's or `Sampler`'s.
        can_share: whether neighbouring pixels' samples are at hand, of integrands that are alike.
        sample_cost: nanoseconds that a sample costs, above 0; infinity: the best fit, if one pays at all.

    Returns:
        A `Recommendation`, by measurements in rendered images. Of stratified points without neighbours it is their
        mean: a fit may do a little better, and for some smooth integrands half as bad again.
    """
    out = _c.Recommendation()
    dims = _arrays.integer("dims", dims, 1, _arrays.MAX_U32)
    samples = _arrays.integer("samples", samples, 1, _arrays.MAX_U32)
    cost = _arrays.number("sample_cost", sample_cost, 1e-30, math.inf)
    status = _c.recommend(dims, samples, bool(stratified), bool(can_share), cost, _c.address(out))
    if status:
        raise ValueError(f"{_c.message(status)}: {dims} dims, {samples} samples, {cost} ns")

    def name(names, value):
        return next(name for name, number in names.items() if number == value)

    config, method = out.config, name(_c.METHODS, out.method)
    return Recommendation(
        method=method,
        order=config.order,
        estimator=name(_c.ESTIMATORS, config.estimator),
        stratified=bool(config.stratified),
        image_stride=out.image_stride if method == "shared" else None,
        error=out.error,
        filtered_error=out.filtered_error,
        cost=out.cost,
        pays_from=out.pays_from,
        dims=config.dims,
    )
