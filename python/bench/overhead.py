"""Times of minibatches and integrals: the C library's calls, the package around them, PyTorch's ways to draw.

    python python/bench/overhead.py      needs torch; with torchrl installed, that too

Microseconds of processor time, medians of 7 runs in turns.
"""

import ctypes
import statistics
import time

import numpy
import output
import torch
from torch.nn.functional import cross_entropy

import noisefloor
from noisefloor import _c
from noisefloor.torch import ImportanceBatchSampler

try:
    from torchrl.data import LazyTensorStorage, PrioritizedSampler

    TORCHRL = True
except ImportError:
    TORCHRL = False
    print("without torchrl, which is not installed")

BATCH, FRACTION = 128, 0.2


def time_of(calls, repeats, runs):
    """The median over runs of the time of one call, for each of some functions; runs take turns."""
    times = {name: [] for name in calls}
    for _ in range(runs):
        for name, call in calls.items():
            call()
            start = time.process_time()
            for _ in range(repeats[name]):
                call()
            times[name].append((time.process_time() - start) / repeats[name] * 1e6)
    return {name: statistics.median(values) for name, values in times.items()}


def draws(items, runs):
    """Draw and update of a batch."""
    generator = numpy.random.default_rng(1)
    values = generator.random(items, numpy.float32) + 0.01
    table = noisefloor.Table(items, importance=values, seed=1)
    importance = generator.random(BATCH, numpy.float32)
    index, weight = numpy.empty(BATCH, numpy.uint32), numpy.empty(BATCH, numpy.float32)
    at = _c.data(index), _c.data(weight), _c.data(importance)

    def raw():
        _c.table_draw(table._at, table._rng_at, BATCH, at[0], at[1])
        _c.table_update(table._at, at[0], at[2], BATCH, 0.3)

    def package():
        index, _ = table.draw(BATCH)
        table.update(index, importance)

    q, new = torch.from_numpy(values), torch.from_numpy(importance)

    def multinomial():
        p = q * ((1 - FRACTION) / q.sum()) + FRACTION / items
        index = torch.multinomial(p, BATCH, replacement=True)
        _ = 1 / (items * p[index])
        q[index] = 0.3 * q[index] + 0.7 * new

    calls = {"C calls": raw, "package": package}
    # It takes no more categories.
    if items <= 2**24:
        calls["torch.multinomial"] = multinomial
    if items <= 10**7 and TORCHRL:
        calls["torchrl"] = torchrl(q, new)
    repeats = {"C calls": 2000, "package": 2000, "torch.multinomial": max(2, 4_000_000 // items), "torchrl": 200}
    return time_of(calls, repeats, runs)


def torchrl(q, new):
    """A prioritised replay buffer's draw and update, weights included; priorities are the importances."""
    items = len(q)
    storage, every = LazyTensorStorage(items), torch.arange(items)
    storage.set(range(items), torch.zeros(items, 1))
    sampler = PrioritizedSampler(items, alpha=1.0, beta=1.0)
    sampler.extend(every)
    sampler.update_priority(every, q)

    def call():
        index, _ = sampler.sample(storage, BATCH)
        sampler.update_priority(torch.as_tensor(index), new)

    return call


def steps(batch, runs):
    """A step of training, uniform as one writes it and by importance: a network of 784-256-256-10."""
    torch.manual_seed(1)
    items = 60_000
    layers = [torch.nn.Linear(784, 256), torch.nn.ReLU(), torch.nn.Linear(256, 256), torch.nn.ReLU()]
    model = torch.nn.Sequential(*layers, torch.nn.Linear(256, 10))
    optimizer = torch.optim.AdamW(model.parameters())
    x, y = torch.rand(items, 784), torch.randint(0, 10, (items,))
    sampler = ImportanceBatchSampler(items, batch, warmup=None, steps=10**9)
    batches = iter(sampler)

    def uniform():
        index = torch.randint(items, (batch,))
        loss = cross_entropy(model(x[index]), y[index])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()

    def importance():
        next(batches)
        index, weight = sampler.batch()
        logits = model(x[index])
        logits.retain_grad()
        loss = (weight * cross_entropy(logits, y[index], reduction="none")).mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        sampler.update_from(logits)

    # In many short turns: what is asked for is a small difference.
    return time_of({"uniform": uniform, "importance": importance}, {"uniform": 10, "importance": 10}, 10 * runs)


def integrals(runs, count=100_000, n=16, dims=2):
    """Many integrals of few samples: the library's one call, and the package's."""
    generator = numpy.random.default_rng(1)
    u = generator.random((count, n, dims), numpy.float32)
    f = numpy.exp(u.sum(-1))
    config = _c.default_config()
    config.dims = dims
    workspace = _c.workspace(_c.cv_workspace_size(ctypes.addressof(config), n))
    out = numpy.empty(count, _c.ESTIMATE)
    samples = _c.Samples(u=_c.data(u), f=_c.data(f), n=n)
    of = ctypes.addressof(config), ctypes.addressof(samples)
    at = *of, count, _c.data(workspace), workspace.nbytes, _c.data(out)
    u64, f64 = u.astype(numpy.float64), f.astype(numpy.float64)
    calls = {
        "C call": lambda: _c.cv_estimate(*at),
        "package, float32": lambda: noisefloor.estimate(u, f),
        "package, float64": lambda: noisefloor.estimate(u64, f64),
    }
    return time_of(calls, dict.fromkeys(calls, 1), runs)


def main():
    """Writes the tables."""
    options = output.arguments(__doc__)
    output.versions(options, "numpy", "torch", "torchrl")
    torch.set_num_threads(1)
    runs = 1 if options.quick else 7
    names = "C calls", "package", "torch.multinomial", "torchrl"
    rows = []
    for items in (20_000,) if options.quick else (20_000, 1_000_000, 10_000_000, 100_000_000):
        times = draws(items, runs)
        cells = [f"{times[name]:.1f}" if name in times else "-" for name in names]
        rows.append([f"{items:,} items", *cells, f"{times['package'] - times['C calls']:.1f}"])
    output.write(options, "draws", ["table of", *names, "package beyond C"], rows)
    rows = []
    for batch in (32,) if options.quick else (32, 128, 512):
        times = steps(batch, runs)
        share = 100 * (1 - times["uniform"] / times["importance"])
        rows.append([str(batch), f"{times['uniform']:.0f}", f"{times['importance']:.0f}", f"{share:.1f}"])
    output.write(options, "steps", ["batch", "uniform step", "step by importance", "share %"], rows)
    times = integrals(runs)
    rows = [[name, f"{value / 1000:.1f}", f"{value / times['C call']:.2f}"] for name, value in times.items()]
    output.write(options, "integrals", ["call", "milliseconds", "over C"], rows)


if __name__ == "__main__":
    main()
