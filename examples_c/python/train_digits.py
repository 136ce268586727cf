"""Trains a classifier of digits with minibatches drawn uniformly and by importance (Algorithms 3 and 4).

    NOISEFLOOR_LIBRARY=libnoisefloor.so python3 train_digits.py [EPOCHS [SEEDS]]
"""

import ctypes
import sys

import digits
import noisefloor

BATCH, RATE = 32, 0.05


def batches(library, items, epoch, seed, table):
    """Indices and weights of an epoch's minibatches: the first epoch sees every item once, whatever the method."""
    for first in range(0, items, BATCH):
        batch = min(BATCH, items - first)
        if table is None or epoch == 0:
            order = [library.nf_shuffle(seed * 1000 + epoch, items, first + k) for k in range(batch)]
            yield (ctypes.c_uint32 * batch)(*order), (ctypes.c_float * batch)(*[1.0] * batch)
        else:
            yield table.draw(batch)


def train(library, model, images, labels, epochs, seed, by_importance):
    """Runs `epochs` epochs; the calls to noisefloor are `draw` above and `update` below."""
    table = noisefloor.Table(library, len(labels), seed) if by_importance else None
    for epoch in range(epochs):
        for index, weight in batches(library, len(labels), epoch, seed, table):
            importance = model.importances(library, [images[i] for i in index], [labels[i] for i in index])
            model.step(weight, RATE)
            if table is not None:
                table.update(index, importance, 0.0 if epoch == 0 else 0.3)


def main(epochs=6, seeds=3):
    """A table of losses and errors: means over the seeds."""
    library = noisefloor.load()
    name, model_class = digits.model_class()
    images, labels = digits.load("train")
    test = digits.load("t10k")
    print(f"{name}, {len(labels)} digits, {epochs} epochs of batches of {BATCH}, {seeds} seeds")
    print("method      training loss  test error %")
    for method in ("uniform", "importance"):
        loss = error = 0.0
        for seed in range(1, seeds + 1):
            model = model_class(len(images[0]), 10, seed)
            train(library, model, images, labels, epochs, seed, method == "importance")
            loss += model.errors(images, labels)[1] / seeds
            error += 100 * model.errors(*test)[0] / seeds
        print(f"{method:10}  {loss:13.5f}  {error:12.2f}")


if __name__ == "__main__":
    try:
        main(*map(int, sys.argv[1:3]))
    except (OSError, ValueError) as error:
        sys.exit(f"train_digits: {error}")
