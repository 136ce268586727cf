"""What importance does to training: test error, log loss and calibration over uniform minibatches', paired by seed.

    python python/bench/training.py [SEEDS]      needs torch, scipy and Debian's dataset-fashion-mnist

20,000 images of Fashion-MNIST, a network of 784-128-64, batches of 64, AdamW for 10 epochs. "+-": half of a 95 %
confidence interval, Student's t over the seeds.
"""

import gzip
import pathlib
import sys

import numpy
import torch
from scipy import stats
from torch.nn.functional import cross_entropy

from noisefloor.torch import ImportanceBatchSampler

FOLDER = pathlib.Path("/usr/share/datasets/fashion-mnist")
ITEMS, BATCH, EPOCHS = 20_000, 64, 10
MODES = "uniform", "importance", "adaptive"
MEASURES = "error %", "log loss", "calibration error %"


def load(part, items):
    """Images as rows of 784 numbers, and labels."""

    def read(name, header):
        with gzip.open(FOLDER / f"{part}-{name}-ubyte.gz") as file:
            return torch.from_numpy(numpy.frombuffer(file.read(), numpy.uint8)[header:].copy())

    return read("images-idx3", 16).reshape(-1, 784)[:items] / 255, read("labels-idx1", 8).long()[:items]


def wrong(labels, part):
    """Labels of which a part is replaced by any of the ten."""
    generator = torch.Generator().manual_seed(5)
    chosen = torch.rand(len(labels), generator=generator) < part
    return torch.where(chosen, torch.randint(0, 10, labels.shape, generator=generator), labels)


def tasks():
    """Name, training and test images and labels, and how many classes."""
    (x, y), (test_x, test_y) = load("train", ITEMS), load("t10k", 10_000)
    yield "clean", x, y, test_x, test_y, 10
    yield "20 % wrong labels", x, wrong(y, 0.2), test_x, test_y, 10
    # Shirts, the class that others are taken for, of which a tenth is left: a hundredth of all.
    keep, test_keep = ((labels != 6) | (torch.arange(len(labels)) % 10 == 0) for labels in (y, test_y))
    yield "rare positives", x[keep], (y[keep] == 6).long(), test_x[test_keep], (test_y[test_keep] == 6).long(), 2


def train(x, y, classes, mode, rate, cosine, seed):
    """The network after all epochs; as many steps in every mode."""
    torch.manual_seed(seed)
    layers = [torch.nn.Linear(784, 128), torch.nn.ReLU(), torch.nn.Linear(128, 64), torch.nn.ReLU()]
    model = torch.nn.Sequential(*layers, torch.nn.Linear(64, classes))
    optimizer = torch.optim.AdamW(model.parameters(), rate)
    sampler = ImportanceBatchSampler(len(x), BATCH, seed=seed, weighted=mode == "importance")
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, EPOCHS * len(sampler)) if cosine else None
    for epoch in range(EPOCHS):
        order = torch.randperm(len(x))
        for step, batch in enumerate(sampler):
            index, weight = sampler.batch()
            if mode == "uniform" and epoch:
                index = order[step * BATCH : (step + 1) * BATCH]
            logits = model(x[index])
            logits.retain_grad()
            losses = cross_entropy(logits, y[index], reduction="none")
            optimizer.zero_grad()
            (losses if mode == "uniform" else weight * losses).mean().backward()
            optimizer.step()
            if mode != "uniform":
                sampler.update_from(logits)
            if schedule:
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


def main(seeds=6):
    """Prints a table for each task."""
    torch.set_num_threads(1)
    for name, x, y, test_x, test_y, classes in tasks():
        print(
            f"\n{name}: {len(x)} items, {seeds} seeds\n\n| rate | mode |",
            " | ".join(MEASURES),
            "|\n|---|---|---|---|---|",
        )
        for rate, cosine in ((0.0005, False), (0.002, True)):
            found = {}
            for seed in range(seeds):
                for mode in MODES:
                    model = train(x, y, classes, mode, rate, cosine, seed)
                    found.setdefault(mode, []).append(judge(model, test_x, test_y))
            uniform = numpy.array(found["uniform"])
            for mode in MODES:
                values = numpy.array(found[mode])
                difference = values - uniform
                half = stats.t.ppf(0.975, seeds - 1) * difference.std(0, ddof=1) / seeds**0.5
                cells = [f"{value:.3f}" for value in values.mean(0)]
                if mode != "uniform":
                    cells = [f"{cell} ({d:+.3f} +- {h:.3f})" for cell, d, h in zip(cells, difference.mean(0), half)]
                schedule = f"{rate}, to 0" if cosine else f"{rate}"
                print(f"| {schedule} | {mode} |", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
