"""A training run that can be killed at any time and goes on where it was: test_torch.py starts it."""

import hashlib
import os

import torch
from torch.utils.data import DataLoader, TensorDataset

from noisefloor.torch import ImportanceBatchSampler

ITEMS, BATCH, EPOCHS = 1000, 32, 3


def data():
    """A problem of two classes."""
    generator = torch.Generator().manual_seed(1)
    x = torch.randn(ITEMS, 8, generator=generator)
    return TensorDataset(x, (x[:, 0] * x[:, 1] > 0).long())


def step(model, optimizer, sampler, x, y, weight):
    """One step, and what it says to the sampler."""
    logits = model(x)
    logits.retain_grad()
    loss = (weight * torch.nn.functional.cross_entropy(logits, y, reduction="none")).mean()
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()
    sampler.update_from(logits)


def digest(model, sampler):
    """Of all that training has changed."""
    tensors = [*model.state_dict().values(), *sampler.state_dict()["tables"]]
    return hashlib.sha256(b"".join(tensor.numpy().tobytes() for tensor in tensors)).hexdigest()


def network(width=16, outputs=2, dropout=0.0):
    """A small model, the same each time."""
    torch.set_num_threads(1)
    torch.manual_seed(0)
    hidden = torch.nn.Linear(8, width), torch.nn.ReLU(), torch.nn.Dropout(dropout)
    return torch.nn.Sequential(*hidden, torch.nn.Linear(width, outputs))


def begin():
    """What a process of its own does first: its workers are not to be a server's, which would outlive it."""
    torch.multiprocessing.set_start_method("fork", force=True)


def main(checkpoint, workers, techniques, say):
    """Trains, and says "step" once its checkpoint is whole; at the end the digest."""
    begin()
    model = network(dropout=0.1)
    optimizer = torch.optim.Adam(model.parameters(), 1e-2)
    sampler = ImportanceBatchSampler(ITEMS, BATCH, seed=3, techniques=techniques)
    groups = optimizer.state_dict()["param_groups"]
    if os.path.exists(checkpoint):
        state = torch.load(checkpoint, weights_only=True)
        model.load_state_dict(state["model"])
        optimizer.load_state_dict({"state": state["optimizer"], "param_groups": groups})
        sampler.load_state_dict(state["sampler"])
        torch.set_rng_state(state["rng"])
    loader = DataLoader(data(), batch_sampler=sampler, num_workers=workers, generator=torch.Generator().manual_seed(1))
    for _ in range(sampler.epoch, EPOCHS):
        for x, y in loader:
            _, weight = sampler.batch()
            step(model, optimizer, sampler, x, y, weight)
            # Without numbers that are no tensors, which PyTorch 1.13 does not read with weights_only.
            state = {"model": model.state_dict(), "optimizer": optimizer.state_dict()["state"]}
            torch.save({**state, "sampler": sampler.state_dict(), "rng": torch.get_rng_state()}, checkpoint + ".new")
            os.replace(checkpoint + ".new", checkpoint)
            say("step")
    say(digest(model, sampler))
