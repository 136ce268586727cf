"""Trains a classifier of 8 x 8 digits with minibatches drawn uniformly and by importance, and prints its test errors.

pip install ./python torch
python examples_c/python/train_digits.py [EPOCHS [SEEDS]]
"""

import pathlib
import sys

import numpy
import torch
from torch.nn.functional import cross_entropy
from torch.utils.data import BatchSampler, DataLoader, RandomSampler, TensorDataset

from noisefloor.torch import ImportanceBatchSampler

DATA = pathlib.Path(__file__).parent.parent / "data" / "digits"
BATCH, RATE = 32, 0.003


def load(part):
    """Images and labels of a part, "train" or "t10k", from IDX files: 16 and 8 bytes of header, then bytes."""
    read = lambda name, header: numpy.fromfile(DATA / f"{part}-{name}-ubyte", numpy.uint8)[header:]
    images = torch.from_numpy(read("images-idx3", 16).reshape(-1, 64).astype(numpy.float32) / 240)
    return TensorDataset(images, torch.from_numpy(read("labels-idx1", 8).astype(numpy.int64)))


def train(data, sampler, epochs, seed):
    """The loop of any classifier; the calls to noisefloor are `batch` and `update_from`."""
    torch.manual_seed(seed)
    model = torch.nn.Sequential(torch.nn.Linear(64, 32), torch.nn.ReLU(), torch.nn.Linear(32, 10))
    optimizer = torch.optim.Adam(model.parameters(), RATE)
    for _ in range(epochs):
        for images, labels in DataLoader(data, batch_sampler=sampler):
            by_importance = isinstance(sampler, ImportanceBatchSampler)
            index, weight = sampler.batch() if by_importance else (None, 1)
            logits = model(images)
            logits.retain_grad()
            optimizer.zero_grad()
            (weight * cross_entropy(logits, labels, reduction="none")).mean().backward()
            optimizer.step()
            if by_importance:
                sampler.update_from(logits)
    return model


def main(epochs=15, seeds=5):
    """Means over the seeds."""
    data, (images, labels) = load("train"), load("t10k").tensors
    print(
        f"{len(data)} digits, {epochs} epochs of batches of {BATCH}, {seeds} seeds\nmethod      test error %  test loss"
    )
    for method in ("uniform", "importance"):
        logits = []
        for seed in range(seeds):
            uniform = BatchSampler(RandomSampler(data), BATCH, drop_last=False)
            sampler = uniform if method == "uniform" else ImportanceBatchSampler(len(data), BATCH, seed=seed)
            logits.append(train(data, sampler, epochs, seed)(images).detach())
        error = 100 * torch.stack([(z.argmax(1) != labels).float().mean() for z in logits]).mean()
        loss = torch.stack([cross_entropy(z, labels) for z in logits]).mean()
        print(f"{method:10}  {error:12.2f}  {loss:9.4f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
