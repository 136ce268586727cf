"""What importance does to training: test error, log loss and calibration over uniform minibatches', paired by seed.

    python python/bench/training.py      needs torch, scipy and Debian's dataset-fashion-mnist

10,000 images of Fashion-MNIST, a network of 784-128-64, batches of 64, AdamW for 10 epochs, 6 seeds. "+-": half of a
95 % confidence interval, Student's t over the seeds.
"""

import gzip
import pathlib

import numpy
import output
import torch
from scipy import stats
from torch.nn.functional import cross_entropy

from noisefloor.torch import ImportanceBatchSampler

FOLDER = pathlib.Path("/usr/share/datasets/fashion-mnist")
BATCH = 64
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


def tasks(items):
    """Name, training and test images and labels, and how many classes."""
    (x, y), (test_x, test_y) = load("train", items), load("t10k", 10_000)
    yield "clean", x, y, test_x, test_y, 10
    yield "20 % wrong labels", x, wrong(y, 0.2), test_x, test_y, 10
    # Shirts, which others are taken for; a fifth of them is left: two in a hundred of all.
    keep, test_keep = ((labels != 6) | (torch.arange(len(labels)) % 5 == 0) for labels in (y, test_y))
    yield "rare positives", x[keep], (y[keep] == 6).long(), test_x[test_keep], (test_y[test_keep] == 6).long(), 2


def train(x, y, classes, mode, epochs, rate, cosine, seed):
    """The network after all epochs; as many steps in every mode."""
    torch.manual_seed(seed)
    layers = [torch.nn.Linear(784, 128), torch.nn.ReLU(), torch.nn.Linear(128, 64), torch.nn.ReLU()]
    model = torch.nn.Sequential(*layers, torch.nn.Linear(64, classes))
    optimizer = torch.optim.AdamW(model.parameters(), rate)
    sampler = ImportanceBatchSampler(len(x), BATCH, seed=seed, weighted=mode == "importance")
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs * len(sampler)) if cosine else None
    for epoch in range(epochs):
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


def main():
    """Writes a row for each task, schedule and mode."""
    options = output.arguments(__doc__)
    items, epochs, seeds = (500, 1, 2) if options.quick else (10_000, 10, 6)
    torch.set_num_threads(1)
    rows = []
    for name, x, y, test_x, test_y, classes in tasks(items):
        for rate, cosine in ((0.0005, False), (0.002, True)):
            found = {mode: [] for mode in MODES}
            for seed in range(seeds):
                for mode, values in found.items():
                    model = train(x, y, classes, mode, epochs, rate, cosine, seed)
                    values.append(judge(model, test_x, test_y))
            for mode, values in found.items():
                difference = numpy.array(values) - numpy.array(found["uniform"])
                half = stats.t.ppf(0.975, seeds - 1) * difference.std(0, ddof=1) / seeds**0.5
                row = [name, f"{rate}, falling to 0" if cosine else f"{rate}, constant", mode]
                for value, d, h in zip(numpy.mean(values, 0), difference.mean(0), half):
                    row += [f"{value:.3f}", "-" if mode == "uniform" else f"{d:+.3f} +- {h:.3f}"]
                rows.append(row)
    headings = ["task", "rate", "mode"]
    for measure in MEASURES:
        headings += [measure, f"{measure} minus uniform's"]
    output.write(options, "training", headings, rows)


if __name__ == "__main__":
    main()
