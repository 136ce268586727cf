"""Trains a classifier of 8 x 8 digits, uniformly and by importance: pip install ./python torch, then run it."""

import pathlib

import torch
from torch.nn.functional import cross_entropy
from torch.utils.data import DataLoader, TensorDataset

from noisefloor.torch import ImportanceBatchSampler


def load(part):
    """Images and labels from IDX files: 16 and 8 bytes of header, then bytes."""
    folder = pathlib.Path(__file__).parent.parent / "data" / "digits"
    read = lambda name: torch.frombuffer(bytearray((folder / f"{part}-{name}-ubyte").read_bytes()), dtype=torch.uint8)
    return TensorDataset(read("images-idx3")[16:].reshape(-1, 64) / 240, read("labels-idx1")[8:].long())


def train(loader, sampler, epochs=15):
    """The loop of any classifier; the calls to noisefloor are `batch` and `update_from`."""
    model = torch.nn.Sequential(torch.nn.Linear(64, 32), torch.nn.ReLU(), torch.nn.Linear(32, 10))
    optimizer = torch.optim.Adam(model.parameters(), 0.003)
    for images, labels in (batch for _ in range(epochs) for batch in loader):
        weight = sampler.batch()[1] if sampler else 1
        logits = model(images)
        logits.retain_grad()
        optimizer.zero_grad()
        (weight * cross_entropy(logits, labels, reduction="none")).mean().backward()
        optimizer.step()
        if sampler:
            sampler.update_from(logits)
    return model


data, (images, labels) = load("train"), load("t10k").tensors
for seed in range(5):
    sampler = ImportanceBatchSampler(len(data), 32, seed=seed)
    for name, by in (("uniform", None), ("importance", sampler)):
        torch.manual_seed(seed)
        model = train(DataLoader(data, batch_sampler=sampler) if by else DataLoader(data, 32, shuffle=True), by)
        print(f"{name:10} {(model(images).argmax(1) != labels).float().mean():.2%} of test digits wrong", flush=True)
