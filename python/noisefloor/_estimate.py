"""Estimates of integrals from samples, with less error than their mean."""

from __future__ import annotations

import concurrent.futures
import math
from typing import Any, Literal, NamedTuple, get_args

import numpy

from . import _arrays, _c

ImageEstimator = Literal["robust", "leave_one_out", "k_fold"]
Estimator = Literal[ImageEstimator, "least_squares", "gradient_descent", "incremental"]
Basis = Literal["legendre", "step", "sine", "gaussian"]
Solver = Literal["auto", "normal_equations", "square_root", "dual"]

#: Samples of one call: the interpreter sees an interrupt between two.
CHUNK = 1 << 19
#: As many numbers as are copied for one call, where arrays are broadcast.
COPIED = 1 << 24
#: Strengths that the library does not raise, and that float32 has.
RIDGES = 1e-12, 3e38


class Estimate(NamedTuple):
    """Estimates of integrals, with their leading dimensions: arrays of float32, or floats of a single integral.

    Attributes:
        mean: the integral; a last axis for the channels, if there are channels.
        std_error: the mean's standard error, of the same shape; infinite where one sample is all there is, or,
            with the gain, least squares has no more samples than terms.
        gain: estimated variance relative to the plain mean's, without that axis; 1 is no gain.

    Of `estimate` with `stratified`, std_error and gain are those of as many independent samples: mostly far too large,
    and no bound. For the error of such points repeat with several seeds.
    """

    # Any: which of the two it is depends on shapes, which types do not tell.
    mean: Any
    std_error: Any
    gain: Any


def estimate(
    u: Any,
    f: Any,
    *,
    controls: Any = None,
    control_integrals: Any = None,
    order: int = 2,
    estimator: Estimator = "robust",
    basis: Basis = "legendre",
    dims: int | None = None,
    slices: int = 1,
    stratified: bool = False,
    channels: bool = False,
    ridge: float | Literal["auto"] | None = None,
    folds: int | None = None,
    solver: Solver = "auto",
) -> Estimate:
    """Estimates the integral of f over the unit cube from n samples, or many integrals from n samples of each.

    The samples' values may also be divided by a density: u are then the uniform numbers that made the point.

    Args:
        u: shape (..., n, d), 0 to 1: the coordinates of each sample.
        f: shape (..., n), finite; with `channels` (..., n, c), 1 to 4 of them. Leading dimensions broadcast with u's.
        controls: shape (..., n, k): 1 to 4 functions of known integral at the samples, to be regressed as well. Of many
            integrals they take a call for each, some 70 microseconds.
        control_integrals: shape (k,), or (..., k): those integrals, over the unit cube.
        order: largest total degree of the functions, 0 to 7; 0 is the plain mean, or the controls alone. At most 136
            terms.
        estimator: "robust", never noticeably worse than the mean; "least_squares", for many samples per term, and for
            Sobol points; "leave_one_out" and "k_fold", exactly unbiased, the first but for `controls` and the "auto"
            ridge; "gradient_descent"; "incremental".
        basis: "legendre", "step", "sine" or "gaussian".
        dims: how many of the coordinates are regressed, the first 1 to 16; None: all.
        slices: above 1, the last of them picks one of so many equally likely alternatives.
        stratified: whether the points are (Sobol's, a lattice's, `Sampler`'s). All but "least_squares" and
            "gradient_descent" are then their plain mean; std_error and gain are those of independent samples.
        channels: whether f's last axis holds the values of a sample.
        ridge: strength per sample, above 0; None: the default; "auto": the best of a few by leave-one-out errors. Not
            of "robust" and "gradient_descent".
        folds: of "k_fold" alone, 2 to 16; None: 4.
        solver: "auto"; "normal_equations"; "square_root", of "least_squares", for badly placed samples; "dual", of at
            most 4,096 samples.

    Returns:
        An `Estimate` with u's and f's leading dimensions. u and f are rounded to float32: of f = 1e8 + g nothing of g
        is left, and the standard error is that of what is left. Warnings say so of float64, and of tiny values:
        estimate g, or a multiple. Results are float32.
    """
    given = _arrays.array("u", u), _arrays.array("f", f)
    u, f = _arrays.floats("u", given[0]), _arrays.floats("f", given[1])
    values = 1 if channels else 0
    if u.ndim < 2 or f.ndim < 1 + values:
        one = "; for one dim u[:, None]" if u.ndim == 1 else ""
        raise ValueError(
            f"u has the shape {u.shape} and f {f.shape}: (..., n, d) and (..., n{', c' * values}) are needed{one}"
        )
    n, d = u.shape[-2:]
    own = f.shape[f.ndim - 1 - values :]
    if own[0] != n:
        last = "; if f's last axis are values of a sample: channels=True" if f.shape[-2:-1] == (n,) else ""
        raise ValueError(f"u has {n} samples and f {own[0]}, in the shapes {u.shape} and {f.shape}{last}")
    if n == 0:
        raise ValueError(f"u has the shape {u.shape}: there are no samples")
    if channels and own[1] > _c.MAX_CHANNELS:
        most = f"{_c.MAX_CHANNELS} are the most; for more put them first: numpy.moveaxis(f, -1, 0)"
        raise ValueError(f"the number of f's channels is {own[1]}: {most}")
    # Arrays by their names in C, each with how many of its axes are one integral's.
    arrays = {"u": (u, 2), "f": (f, 1 + values)}
    if (controls is None) != (control_integrals is None):
        raise ValueError("controls and control_integrals belong together: one of them is None")
    if controls is not None:
        controls = _arrays.check_finite("controls", _arrays.array("controls", controls))
        integrals = _arrays.check_finite("control_integrals", _arrays.array("control_integrals", control_integrals))
        if controls.ndim < 2 or controls.shape[-2] != n or controls.shape[-1] == 0:
            raise ValueError(f"controls has the shape {controls.shape}: (..., {n}, k) is needed, k from 1 to 4")
        if integrals.shape[-1:] != controls.shape[-1:]:
            words = f"control_integrals has the shape {integrals.shape}"
            raise ValueError(f"{words}: (..., {controls.shape[-1]}) is needed")
        arrays |= {"controls": (controls, 2), "control_integrals": (integrals, 1)}
    takes_ridge = estimator not in ("robust", "gradient_descent")
    for name, option, takes in (("folds", folds, estimator == "k_fold"), ("ridge", ridge, takes_ridge)):
        if option is not None and not takes:
            raise ValueError(f"{name} is {option!r}, and estimator {estimator!r} takes none")
    count = 0 if controls is None else controls.shape[-1]
    config = configure(
        order,
        estimator,
        basis,
        d,
        dims,
        slices,
        stratified,
        own[1] if channels else 1,
        controls=count,
        ridge=ridge,
        folds=folds,
        solver=solver,
    )
    if config.solver == _c.SOLVERS["dual"] and n > _c.MAX_DUAL:
        raise ValueError(f"solver is 'dual', and u has {n} samples: it takes at most {_c.MAX_DUAL}")
    leading, wide = _arrays.broadcast(arrays)
    _arrays.warn_of_lost_digits("f", given[1], -1 - values)
    out = numpy.empty(leading, _c.ESTIMATE)
    workspace = _c.workspace(_c.cv_workspace_size(_c.address(config), n))
    samples = _c.Samples(n=n)
    each = max(1, CHUNK // n)
    if not all(array.flags.c_contiguous for array in wide.values()):
        each = max(1, min(each, COPIED // (n * (d + config.channels))))
    if count:
        # The library takes controls of one integral.
        each = 1
    for first in range(0, out.size, each):
        some = range(first, min(first + each, out.size))
        # The names keep copies alive during the call.
        held = {name: _arrays.some_of(array, len(leading), some) for name, array in wide.items()}
        for name, array in held.items():
            setattr(samples, name, _c.data(array))
        status = _c.cv_estimate(
            _c.address(config),
            _c.address(samples),
            len(some),
            _c.data(workspace),
            workspace.nbytes,
            _c.data(out) + first * out.itemsize,
        )
        if status:
            _refuse(status, *given, config)
    return _result(out, channels, config.channels)


def image_estimate(
    u: Any,
    f: Any,
    *,
    surfaces: Any = None,
    factors: Any = None,
    known: Any = None,
    known_integrals: Any = None,
    order: int = 2,
    estimator: ImageEstimator = "robust",
    basis: Basis = "legendre",
    dims: int | None = None,
    slices: int = 1,
    edges: int = 0,
    stratified: bool = False,
    channels: bool = False,
    ridge: float | None = None,
    window: int = 8,
    stride: int | None = None,
    unordered: bool = False,
    threads: int = 1,
) -> Estimate:
    """Estimates every pixel of an image, by fits that neighbouring pixels share. One sample in each pixel is enough.

    Args:
        u: shape (height, width, n, d), 0 to 1, as for `estimate`, or (frames, height, width, n, d).
        f: shape (height, width, n), or with `channels` (height, width, n, c); frames as u. Rounded to float32.
        surfaces: integers of shape (height, width), frames as u: only pixels with the same number share fits.
        factors: shape (height, width), with `channels` (height, width, c), frames as u, at least 0: what a pixel's
            values are proportional to, an albedo say.
        known: of f's shape: what each sample would be with nothing in the way; not for "k_fold".
        known_integrals: of `factors`' shape, at least 0: the exact integrals of that.
        order, estimator, basis, dims, slices, channels: as for `estimate`; "robust", "leave_one_out" or "k_fold".
        edges: where two coordinates that pick a point of a light begin, counted from 1; 0: nowhere. With 4 and more
            samples fits then follow shadows' edges in them. "robust" and "k_fold" use it, without a `ridge`.
        stratified: whether each pixel's points are, `Sampler`'s say.
        ridge: strength per sample, above 0; None: the default. With one, and without `known`, "robust" is exactly
            unbiased, too, and fits even where the mean is better.
        window: width and height of the windows that share a fit, 1 to 32 pixels; over all frames at most 1,024.
        stride: pixels from one window to the next; None: half of a window.
        unordered: whether pixels have no places, as points of a cloud: all share a fit, whatever window and stride are;
            with `surfaces`, of at most 1,024 pixels, all of one surface. Their order must not follow a picture.
        threads: how many share the rows of pixels, unless `unordered`; the result has the same bits.

    Returns:
        An `Estimate`, of shape (height, width), with `channels` of (height, width, c); frames as u.
    """
    given = _arrays.array("u", u), _arrays.array("f", f)
    u, f = _arrays.floats("u", given[0]), _arrays.floats("f", given[1])
    _arrays.warn_of_lost_digits("f", given[1])
    values = 1 if channels else 0
    if u.ndim not in (4, 5) or 0 in u.shape:
        raise ValueError(f"u has the shape {u.shape}: (height, width, n, d) or (frames, height, width, n, d) is needed")
    *pixels, n, d = u.shape
    if f.shape[: len(pixels) + 1] != u.shape[:-1] or f.ndim != u.ndim - 1 + values:
        raise ValueError(f"f has the shape {f.shape}: with this u it must be {u.shape[:-1] + ('c',) * values}")
    own = f.shape[u.ndim - 1 :]
    _arrays.one_of("estimator", estimator, dict.fromkeys(get_args(ImageEstimator)))
    if known is not None and estimator == "k_fold":
        raise ValueError("known is given, and estimator is 'k_fold': with known it must be 'robust' or 'leave_one_out'")
    if isinstance(ridge, str):
        raise TypeError(f"ridge is {ridge!r}: a number is expected, or None")
    config = configure(order, estimator, basis, d, dims, slices, stratified, *own, ridge=ridge)
    config.edges = _arrays.integer("edges", edges, 0, max(0, config.dims - 1 - (config.slices > 1)))
    image = _c.Image(width=pixels[-1], height=pixels[-2], frames=pixels[0] if len(pixels) == 3 else 1)
    window = image.window = _arrays.integer("window", window, 1, 32)
    image.stride = 0 if stride is None else _arrays.integer("stride", stride, 1, window)
    image.unordered = bool(unordered)
    samples = _c.Samples(u=_c.data(u), f=_c.data(f), n=n)
    kept = []

    def give(place, name, array, shape):
        _arrays.check_shape(name, array, tuple(shape), "as u and f say")
        setattr(place, name, _c.data(array))
        kept.append(array)

    if surfaces is not None:
        give(image, "surfaces", _arrays.integers("surfaces", surfaces, _arrays.MAX_U32), pixels)
    for place, name, array, shape in (
        (image, "factors", factors, (*pixels, *own)),
        (samples, "known", known, f.shape),
        (samples, "known_integrals", known_integrals, (*pixels, *own)),
    ):
        if array is not None:
            array = _arrays.array(name, array)
            checked = _arrays.check_finite if name == "known" else _arrays.check_positive
            give(place, name, checked(name, array), shape)
    if (known is None) != (known_integrals is None):
        raise ValueError("known and known_integrals belong together: one of them is None")
    words = _c.wrong(image)
    if words:
        raise ValueError(f"{words}; u has the shape {u.shape}")

    def rows(wanted, held=(u, f, kept)):
        """The status, and what the library writes for rows of pixels. A thread that is interrupted holds the arrays."""
        part = _c.Image.from_buffer_copy(image)
        if not image.unordered:
            part.wanted = _c.Rectangle(0, wanted.start, image.width, len(wanted))
        workspace = _c.workspace(_c.cv_image_workspace_size(_c.address(config), _c.address(part), _c.address(samples)))
        out = numpy.empty((*pixels[:-2], len(wanted), pixels[-1]), _c.ESTIMATE)
        status = _c.cv_image_estimate(
            _c.address(config),
            _c.address(part),
            _c.address(samples),
            _c.data(workspace),
            workspace.nbytes,
            _c.data(out),
        )
        return status, out

    # Whole windows: those at the borders of rows are fitted to twice.
    threads = _arrays.integer("threads", threads, 1, 1024)
    each = image.height if unordered else window * -(-image.height // (window * threads))
    wanted = [range(y, min(y + each, image.height)) for y in range(0, image.height, each)]
    if len(wanted) == 1:
        found = [rows(wanted[0])]
    else:
        with concurrent.futures.ThreadPoolExecutor(len(wanted)) as pool:
            found = list(pool.map(rows, wanted))
    for status, _ in found:
        if status:
            _refuse(status, *given, config)
    out = numpy.concatenate([part for _, part in found], -2)
    return _result(out, channels, config.channels)


def configure(
    order,
    estimator,
    basis,
    d,
    dims,
    slices,
    stratified,
    channels=1,
    *,
    controls=0,
    ridge=None,
    folds=None,
    solver="auto",
):
    """The library's configuration, each field refused by its name."""
    config = _c.default_config()
    config.estimator = _arrays.one_of("estimator", estimator, _c.ESTIMATORS)
    config.basis = _arrays.one_of("basis", basis, _c.BASES)
    config.solver = _arrays.one_of("solver", solver, _c.SOLVERS)
    config.controls = _arrays.integer("the number of controls", controls, 0, _c.MAX_CONTROLS)
    config.folds = 0 if folds is None else _arrays.integer("folds", folds, 2, 16)
    if isinstance(ridge, str):
        config.ridge = _arrays.one_of("ridge", ridge, {"auto": _c.CONSTANTS["NF_RIDGE_AUTO"]})
    elif ridge is not None:
        config.ridge = _arrays.number("ridge", ridge, *RIDGES)
    config.order = _arrays.integer("order", order, 0, _c.MAX_ORDER)
    config.slices = _arrays.integer("slices", slices, 1, _c.MAX_TERMS - 1)
    config.stratified = bool(stratified)
    if dims is None and not 1 <= d <= _c.MAX_DIMS:
        raise ValueError(f"u has {d} coordinates: 1 to {_c.MAX_DIMS} can be regressed; `dims` says how many of them")
    config.dims = d if dims is None else _arrays.integer("dims", dims, 1, min(d, _c.MAX_DIMS))
    config.stride = d
    config.channels = _arrays.integer("the number of f's channels", channels, 1, _c.MAX_CHANNELS)
    wrong = _c.wrong(config)
    if wrong:
        own = config.slices if config.slices > 1 else 0
        terms = math.comb(config.dims - bool(own) + config.order, config.order) + own + config.controls
        if terms <= _c.MAX_TERMS:
            raise ValueError(f"{wrong}; estimator is {estimator!r}, ridge {ridge!r} and solver {solver!r}")
        words = f"order {order} in {config.dims} dims with {slices} slices makes {terms} terms: at most {_c.MAX_TERMS}"
        while config.order > 1 and _c.wrong(config):
            config.order -= 1
        raise ValueError(f"{words}; {'fewer dims or slices fit' if _c.wrong(config) else f'order {config.order} fits'}")
    return config


def _refuse(status, u, f, config):
    """Says what the library refused, of arrays as they were given."""
    seen = u[..., : config.dims]
    narrow = _arrays.floats("u", seen)
    _arrays.check("u", seen, (narrow >= 0) & (narrow <= 1), "0 to 1")
    _arrays.check_finite("f", f)
    names = {number: name for name, number in _c.ESTIMATORS.items()}
    raise ValueError(
        f"{_c.message(status)}: estimator {names[config.estimator]!r}, order {config.order}, {config.dims} dims, "
        f"{config.slices} slices, samples of the shapes {u.shape} and {f.shape}"
    )


def _result(out, channels, count):
    """What the library wrote, as arrays or floats."""
    which = slice(count) if channels else 0
    mean, std_error = (out[name][..., which].copy() for name in ("mean", "std_error"))
    parts = mean, std_error, out["gain"].copy()
    return Estimate(*(part if part.ndim else float(part) for part in parts))
