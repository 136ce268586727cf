"""What importance does to training: test error, log loss and calibration over uniform minibatches', paired by seed.

    python python/bench/training.py      needs torch and scipy; data.py says which data, and leaves out what is missing

Batches of 64, AdamW, 6 seeds. "+-": half of a 95 % confidence interval, Student's t over the seeds.
"""

import itertools
import math
import multiprocessing
import pathlib

import data
import numpy
import output
import torch
from scipy import stats
from torch.nn.functional import cross_entropy

from noisefloor.torch import ImportanceBatchSampler

BATCH = 64
MODES = "uniform", "importance", "adaptive"
MEASURES = "error %", "log loss", "calibration error %"
#: A rate that anyone would try, and those of which the best for uniform minibatches is taken where it falls to 0.
MODERATE, RATES = 0.0005, (0.001, 0.002, 0.004, 0.008)
#: What the processes of a pool, which are forked, train on.
TASK = None


def train(task, mode, rate, falls, seed):
    """The network after all epochs; as many steps in every mode."""
    torch.manual_seed(seed)
    model = task.network()
    optimizer = torch.optim.AdamW(model.parameters(), rate)
    sampler = ImportanceBatchSampler(len(task.x), BATCH, seed=seed, weighted=mode == "importance")
    steps = task.epochs * len(sampler)
    # A twentieth of the steps to warm up, then half of a cosine's wave.
    factor = lambda step: min(1, 20 * (step + 1) / steps) * (1 + math.cos(math.pi * step / steps)) / 2
    schedule = torch.optim.lr_scheduler.LambdaLR(optimizer, factor if falls else lambda _: 1)
    for epoch in range(task.epochs):
        order = torch.randperm(len(task.x))
        for step, _ in enumerate(sampler):
            index, weight = sampler.batch()
            if mode == "uniform" and epoch:
                index = order[step * BATCH : (step + 1) * BATCH]
            logits = model(task.x[index])
            logits.retain_grad()
            losses = cross_entropy(logits, task.y[index], reduction="none")
            optimizer.zero_grad()
            (losses if mode == "uniform" else weight * losses).mean().backward()
            optimizer.step()
            if mode != "uniform":
                sampler.update_from(logits)
            schedule.step()
    return model


@torch.no_grad()
def judge(model, x, y):
    """Error, log loss, and the expected calibration error over 15 bins."""
    logits = model(x)
    confidence, predicted = torch.softmax(logits, 1).max(1)
    right = (predicted == y).float()
    bins = (confidence * 15).long().clamp(max=14)
    gaps = [(confidence[bins == b] - right[bins == b]).sum().abs() for b in range(15)]
    return 100 * (1 - right.mean()).item(), cross_entropy(logits, y).item(), 100 * (sum(gaps) / len(y)).item()


def measure(mode, rate, falls, seed):
    """Trains and judges."""
    return judge(train(TASK, mode, rate, falls, seed), TASK.test_x, TASK.test_y)


def best_rate(pool, rates):
    """Uniform minibatches' of least log loss, where the rate falls to 0; by a seed of its own."""
    found = pool.starmap(measure, [("uniform", rate, True, 1000) for rate in rates], 1)
    return min(zip(rates, found), key=lambda pair: pair[1][1])[0]


def compare(pool, rate, falls, seeds):
    """A row for each mode."""
    jobs = [(mode, rate, falls, seed) for mode, seed in itertools.product(MODES, range(seeds))]
    every = pool.starmap(measure, jobs, 1)
    found = {mode: every[at * seeds : (at + 1) * seeds] for at, mode in enumerate(MODES)}
    for mode, values in found.items():
        difference = numpy.array(values) - numpy.array(found["uniform"])
        half = stats.t.ppf(0.975, seeds - 1) * difference.std(0, ddof=1) / seeds**0.5
        row = [TASK.name, "falling" if falls else "constant", mode, f"{rate}"]
        for value, d, h in zip(numpy.mean(values, 0), difference.mean(0), half):
            row += [f"{value:.3f}", "-" if mode == "uniform" else f"{d:+.3f} +- {h:.3f}"]
        yield row


def main():
    """Writes a row for each task, schedule and mode."""
    global TASK
    options = output.arguments(__doc__, lambda add: add("--data", type=pathlib.Path, default="target/data"))
    seeds, rates = (2, RATES[:1]) if options.quick else (6, RATES)
    torch.set_num_threads(1)
    found, tasks = [], []
    for TASK in data.tasks(options.data, options.quick):
        tasks += [[TASK.name, TASK.about, f"{len(TASK.x):,}", f"{len(TASK.test_x):,}", str(TASK.epochs)]]
        with multiprocessing.get_context("fork").Pool() as pool:
            found += compare(pool, MODERATE, False, seeds)
            found += compare(pool, best_rate(pool, rates), True, seeds)
        print(f"{TASK.name}: done", flush=True)
    output.write(options, "tasks", ["task", "what is learned", "items", "test", "epochs"], tasks)
    headings = ["task", "rates", "mode", "rate"]
    for name in MEASURES:
        headings += [name, name.replace(" %", "") + " change"]
    output.write(options, "training", headings, found)


if __name__ == "__main__":
    main()
