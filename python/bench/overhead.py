"""What the package adds to the C library's calls, in microseconds of processor time: medians of 7 runs in turns.

python python/bench/overhead.py
"""

import ctypes
import statistics
import time

import numpy

import noisefloor
from noisefloor import _c

BATCH = 128


def time_of(calls, repeats, runs=7):
    """The median over runs of the time of one call, for each of some functions; runs take turns."""
    times = {name: [] for name in calls}
    for _ in range(runs):
        for name, call in calls.items():
            call()
            start = time.process_time()
            for _ in range(repeats):
                call()
            times[name].append((time.process_time() - start) / repeats * 1e6)
    return {name: statistics.median(values) for name, values in times.items()}


def minibatches(items):
    """Draw and update of a batch."""
    generator = numpy.random.default_rng(1)
    table = noisefloor.Table(items, importance=generator.random(items, numpy.float32) + 0.01, seed=1)
    importance = generator.random(BATCH, numpy.float32)
    index, weight = numpy.empty(BATCH, numpy.uint32), numpy.empty(BATCH, numpy.float32)
    at = _c.data(index), _c.data(weight), _c.data(importance)

    def raw():
        _c.table_draw(table._at, table._rng_at, BATCH, at[0], at[1])
        _c.table_update(table._at, at[0], at[2], BATCH, 0.3)

    def package():
        index, weight = table.draw(BATCH)
        table.update(index, importance)

    return time_of({"raw": raw, "package": package}, 2000)


def integrals(count=100_000, n=16, dims=2):
    """Many integrals of few samples: the library's one call, and the package's."""
    generator = numpy.random.default_rng(1)
    u = generator.random((count, n, dims), numpy.float32)
    f = numpy.exp(u.sum(-1))
    config = _c.default_config()
    config.dims = dims
    workspace = _c.workspace(_c.cv_workspace_size(ctypes.addressof(config), n))
    out = numpy.empty(count, _c.ESTIMATE)
    at = ctypes.addressof(config), _c.data(u), _c.data(f), n, count, _c.data(workspace), workspace.nbytes, _c.data(out)
    u64, f64 = u.astype(numpy.float64), f.astype(numpy.float64)
    return time_of(
        {
            "C": lambda: _c.cv_estimate_many(*at),
            "package": lambda: noisefloor.estimate(u, f),
            "package, float64": lambda: noisefloor.estimate(u64, f64),
        },
        1,
    )


if __name__ == "__main__":
    for items in (20_000, 1_000_000, 10_000_000):
        times = minibatches(items)
        print(f"draw and update of {BATCH}, {items} items:", {name: round(time, 1) for name, time in times.items()})
    times = integrals()
    print(
        "100,000 integrals of 16 samples over C's time:", {name: round(t / times["C"], 2) for name, t in times.items()}
    )
