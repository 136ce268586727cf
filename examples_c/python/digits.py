"""Digits of 8 x 8 pixels in IDX files (examples_c/data/digits), and a linear classifier: in PyTorch where it is installed,
otherwise in plain Python. Both have the same three methods, so that train_digits.py has one loop."""

import ctypes
import math
import os
import random
import struct

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data", "digits")


def read_idx(name):
    """The bytes of an IDX file and their shape."""
    with open(os.path.join(DATA, name), "rb") as file:
        content = file.read()
    if len(content) < 4 or content[:3] != b"\0\0\x08":
        raise ValueError(f"{name} is no IDX file of bytes")
    rank = content[3]
    shape = struct.unpack_from(f">{rank}I", content, 4)
    values = content[4 + 4 * rank :]
    if len(values) != math.prod(shape):
        raise ValueError(f"{name} has {len(values)} values; its header says {math.prod(shape)}")
    return values, shape


def load(part):
    """Rows of 64 numbers in 0..1, and labels: part is "train" or "t10k"."""
    pixels, (items, height, width) = read_idx(f"{part}-images-idx3-ubyte")
    labels, _ = read_idx(f"{part}-labels-idx1-ubyte")
    size = height * width
    return [[pixel / 240 for pixel in pixels[i * size : (i + 1) * size]] for i in range(items)], list(labels)


class PlainModel:
    """Softmax regression with momentum, one list per class; the last number of each is the bias."""

    def __init__(self, size, classes, seed):
        generator = random.Random(seed)
        self.weights = [[0.01 * generator.gauss(0, 1) for _ in range(size)] + [0.0] for _ in range(classes)]
        self.velocity = [[0.0] * (size + 1) for _ in range(classes)]

    def logits(self, x):
        """One number per class."""
        return [sum(map(float.__mul__, row, x)) + row[-1] for row in self.weights]

    def importances(self, library, images, labels):
        """The forward pass. What it leaves are the derivatives by the logits, and the norm of each (6.10)."""
        self.inputs, self.deltas, norms = images, [], (ctypes.c_float * len(labels))()
        for k, (x, label) in enumerate(zip(images, labels)):
            logits = self.logits(x)
            largest = max(logits)
            powers = [math.exp(logit - largest) for logit in logits]
            total = sum(powers)
            self.deltas.append([power / total - (c == label) for c, power in enumerate(powers)])
            norms[k] = library.nf_importance_cross_entropy((ctypes.c_float * len(logits))(*logits), len(logits), label)
        return norms

    def gradient(self, weight):
        """Of (1 / batch) sum weight * loss: what the weighted batch estimates."""
        batch = len(self.inputs)
        gradient = [[0.0] * len(row) for row in self.weights]
        for x, delta, w in zip(self.inputs, self.deltas, weight):
            for row, d in zip(gradient, delta):
                scale = d * w / batch
                for i, value in enumerate(x):
                    row[i] += scale * value
                row[-1] += scale
        return gradient

    def step(self, weight, rate):
        """The backward pass of the weighted loss, and a step with momentum .9."""
        for row, velocity, gradient in zip(self.weights, self.velocity, self.gradient(weight)):
            for i, g in enumerate(gradient):
                velocity[i] = 0.9 * velocity[i] + g
                row[i] -= rate * velocity[i]

    def errors(self, images, labels):
        """The part of images that are taken for another digit, and the mean cross-entropy."""
        wrong, loss = 0, 0.0
        for x, label in zip(images, labels):
            logits = self.logits(x)
            largest = max(logits)
            wrong += logits.index(largest) != label
            loss += math.log(sum(math.exp(logit - largest) for logit in logits)) + largest - logits[label]
        return wrong / len(labels), loss / len(labels)


def torch_model(torch):
    """The same in PyTorch, with a hidden layer; `torch` is the module."""
    from noisefloor import pointer

    class TorchModel:
        def __init__(self, size, classes, seed):
            torch.manual_seed(seed)
            layers = torch.nn.Linear(size, 32), torch.nn.ReLU(), torch.nn.Linear(32, classes)
            self.network = torch.nn.Sequential(*layers)
            self.optimizer = torch.optim.SGD(self.network.parameters(), lr=1.0, momentum=0.9)

        def importances(self, library, images, labels):
            target = torch.tensor(labels)
            logits = self.network(torch.tensor(images))
            self.loss = torch.nn.functional.cross_entropy(logits, target, reduction="none")
            with torch.no_grad():
                derivative = torch.softmax(logits, 1) - torch.nn.functional.one_hot(target, logits.shape[1])
            return pointer(derivative.norm(dim=1))

        def step(self, weight, rate):
            for group in self.optimizer.param_groups:
                group["lr"] = rate
            self.optimizer.zero_grad()
            (torch.frombuffer(weight, dtype=torch.float32) * self.loss).mean().backward()
            self.optimizer.step()

        def errors(self, images, labels):
            with torch.no_grad():
                logits, target = self.network(torch.tensor(images)), torch.tensor(labels)
                wrong = (logits.argmax(1) != target).float().mean().item()
                return wrong, torch.nn.functional.cross_entropy(logits, target).item()

    return TorchModel


def model_class():
    """(its name, the class): PyTorch's if it can be imported and $NOISEFLOOR_PLAIN is not set."""
    if not os.environ.get("NOISEFLOOR_PLAIN"):
        try:
            import torch

            return f"PyTorch {torch.__version__}", torch_model(torch)
        except ImportError:
            pass
    return "plain Python", PlainModel
