"""Points whose error is small in each pixel, and arranged so that it vanishes across pixels."""

from __future__ import annotations

import secrets

import numpy
from numpy.typing import NDArray

from . import _arrays, _c


class Sampler:
    """The random numbers of a renderer: for any pixel and sample, in any order, with the least visible error.

    The samples of a pixel are one sequence without end, best at 1, 2, 4, 8, ... samples. Each decision of a path (lens,
    light, ...) has a domain of its own, unrelated to others but at numbers 0 and 1.

    Args:
        frame: 0 to 2**32 - 1. For a picture that is refined leave it, and let `first` count on; for moving frames that
            are averaged sample k is number k % 16 of frame k // 16.
        seed: 0 to 2**32 - 1; each but 0 scrambles all numbers, so that estimates are unbiased over seeds. A pixel's
            squared error is up to some three times as large; through a filter more of it is left.
        white: whether neighbouring pixels know nothing of each other, for denoisers that expect that.
    """

    def __init__(self, *, frame: int = 0, seed: int = 0, white: bool = False) -> None:
        self._frame = _arrays.integer("frame", frame, 0, _arrays.MAX_U32)
        self._seed = _arrays.integer("seed", seed, 0, _arrays.MAX_U32)
        self._white, self._keys = bool(white), ()

    def __repr__(self):
        keys = "".join(f".domain({key})" for key in self._keys)
        return f"Sampler(frame={self._frame}, seed={self._seed}, white={self._white}){keys}"

    def domain(self, key: int) -> Sampler:
        """The sampler of another decision, a child of this one; key: 0 to 2**32 - 1."""
        child = Sampler(frame=self._frame, seed=self._seed, white=self._white)
        child._keys = self._keys + (_arrays.integer("key", key, 0, _arrays.MAX_U32),)
        return child

    def image(
        self, width: int, height: int, samples: int, dims: int = 2, *, x: int = 0, y: int = 0, first: int = 0
    ) -> NDArray[numpy.float32]:
        """Numbers for many pixels.

        Args:
            width, height: how many pixels, from column x and row y on. Of both the last 16 bits count.
            samples: of each pixel, from number `first` on, up to number 2**32 - 1.
            dims: numbers of each sample, at least 1. The first four are stratified together, the first two arranged
                across pixels. Further ones come by fours from domains whose keys count down from 2**32 - 2.

        Returns:
            float32 of shape (height, width, samples, dims), at least 0 and below 1.
        """
        sizes = [
            _arrays.integer(name, value, 1, _arrays.MAX_U32)
            for name, value in (("width", width), ("height", height), ("samples", samples), ("dims", dims))
        ]
        width, height, samples, dims = sizes
        most = (("x", x, _arrays.MAX_U32), ("y", y, _arrays.MAX_U32), ("first", first, _arrays.MAX_U32 + 1 - samples))
        place = [_arrays.integer(name, value, 0, top) for name, value, top in most]
        # Before anything else that grows with dims: what memory has not is refused at once.
        u = numpy.empty((height, width, samples, dims), numpy.float32)
        groups = -(-dims // 4)
        samplers, parts = (_c.Sampler * groups)(), (_c.u32 * groups)()
        for group in range(groups):
            # Keys that nobody picks who counts decisions.
            keys = self._keys + ((_arrays.MAX_U32 - group,) if group else ())
            samplers[group], parts[group] = self._at(*place, keys), min(4, dims - 4 * group)
        status = _c.sampler_fill(
            _c.address(samplers), _c.address(parts), groups, width, height, samples, _c.data(u), u.size
        )
        if status:
            raise ValueError(f"{_c.message(status)}: {width} x {height} pixels, {samples} samples, {dims} dims")
        return u

    def pixel(self, x: int, y: int, samples: int, dims: int = 2, *, first: int = 0) -> NDArray[numpy.float32]:
        """The numbers of one pixel's samples, float32 of shape (samples, dims); arguments as for `image`."""
        return self.image(1, 1, samples, dims, x=x, y=y, first=first)[0, 0]

    def _at(self, x, y, index, keys):
        make = _c.sampler_white if self._white else _c.sampler_pixel
        sampler = _c.sampler_scramble(make(x, y, self._frame, index), self._seed)
        for key in keys:
            sampler = _c.sampler_domain(sampler, key)
        return sampler


class QMCEngine:
    """The same points as a sequence, with `random`, `fast_forward` and `reset` as the engines of `scipy.stats.qmc` have
    them. No subclass of theirs: what scipy itself does with engines takes its own only.

    Args:
        d: dims, 1 to 4. In 2 it is as good as `scipy.stats.qmc.Sobol` for edges, and for smooth functions up to some
            500 points; beyond, and in more dims, scipy's is the better engine.
        seed: 0 to 2**32 - 1. None: another one each time. First points are one of few sequences: of 1,024 pairs, of
            2,048 fours, of some 500,000 of 64 points, so that means of few points are slightly biased over seeds. For
            error bars of repetitions take scipy's `Sobol`.
    """

    def __init__(self, d: int, *, seed: int | None = None) -> None:
        self.d = _arrays.integer("d", d, 1, 4)
        self.seed = secrets.randbits(32) if seed is None else _arrays.integer("seed", seed, 0, _arrays.MAX_U32)
        self.num_generated = 0
        self._sampler = Sampler(frame=self.seed, white=True)

    def __repr__(self):
        return f"QMCEngine({self.d}, seed={self.seed})"

    def random(self, n: int = 1) -> NDArray[numpy.float64]:
        """The next n points, float64 of shape (n, d), at least 0 and below 1; best where n is a power of two."""
        n = _arrays.integer("n", n, 0, _arrays.MAX_U32 - self.num_generated)
        if n == 0:
            return numpy.empty((0, self.d))
        x, y = self.seed & 0xFFFF, self.seed >> 16
        points = self._sampler.pixel(x, y, n, self.d, first=self.num_generated)
        self.num_generated += n
        return points.astype(numpy.float64)

    def fast_forward(self, n: int) -> QMCEngine:
        """Leaves n points out."""
        self.num_generated += _arrays.integer("n", n, 0, _arrays.MAX_U32 - self.num_generated)
        return self

    def reset(self) -> QMCEngine:
        """Starts again."""
        self.num_generated = 0
        return self
