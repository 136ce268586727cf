"""Minibatches by importance for PyTorch's data loaders."""

from __future__ import annotations

import math
import warnings
import zlib
from collections import deque
from collections.abc import Iterator, Mapping, Sized
from typing import Any, Literal

import numpy
import torch
import torch.distributed
import torch.nn.functional
from torch.utils.data import Sampler

from . import _arrays, _c
from ._table import Table

__all__ = ["ImportanceBatchSampler", "cross_entropy_importance"]

#: Weights nearer to 0, which optimal MIS may give, hide the gradient: such items keep their importance.
LEAST_WEIGHT = 1e-3
#: Of an importance, as float32.
LARGEST = float(numpy.finfo(numpy.float32).max)


class ImportanceBatchSampler(Sampler):
    """Batches of indices, drawn in proportion to what `update` was told: `DataLoader(data, batch_sampler=sampler)`.

    A step of training:

        for x, y in loader:
            index, weight = sampler.batch()          # of the batch that the loader has just handed over
            logits = model(x)
            logits.retain_grad()
            optimizer.zero_grad()
            (weight * cross_entropy(logits, y, reduction="none")).mean().backward()
            optimizer.step()
            sampler.update_from(logits)

    Warm-up visits every item once, with weights of 1; its last batch is filled up with items from its start. What
    follows draws with replacement. An epoch counts once `batch` was called for all of its batches.

    In data-parallel training every process makes the same sampler, after `init_process_group`, and gets its part of
    each batch; what `update` is told is gathered, so that all have the same table. Gradients are averaged over
    processes, as `DistributedDataParallel` does.

    Args:
        n: how many items the data set has, 1 to 2**32 - 1, or what has a length: the data set itself.
        batch_size: items in a batch, of each process.
        steps: batches in an epoch; None: n / batch_size / processes, rounded up.
        warmup: "epoch": each item once before any is drawn by importance; None: by importance at once. Items that
            nothing was said of count as the mean of what `update` is told first.
        uniform_fraction: the part of draws that are uniform, 0 to 1; with one technique no weight is above
            1 / uniform_fraction.
        momentum: 0 to 1: of an item's importance, from one visit to the next; none in warm-up.
        techniques: 1 to 16 tables, each with importances of its own; more than 1 is optimal multiple importance
            sampling. A divisor of the batch of all processes. Weights are then slightly biased and may be negative.
        ridge: 1e-8 to 1e8, of several techniques: how strongly their weights shrink to the balance heuristic's.
        weighted: False gives weights of 1: adaptive sampling, which is biased towards difficult items.
        seed: 0 to 2**63 - 1, the same in all processes, which is why it has a default. PyTorch's `manual_seed` changes
            nothing here.
        process_group: which processes share batches. None: all, where torch.distributed is initialised.
    """

    def __init__(
        self,
        n: int | Sized,
        batch_size: int,
        *,
        steps: int | None = None,
        warmup: Literal["epoch"] | None = "epoch",
        uniform_fraction: float = 0.2,
        momentum: float = 0.3,
        techniques: int = 1,
        ridge: float = 2.0,
        weighted: bool = True,
        seed: int = 0,
        process_group: Any = None,
    ) -> None:
        self._distributed, self._group = is_distributed(), process_group
        if process_group is not None and not self._distributed:
            raise ValueError("process_group is given, but torch.distributed is not initialised")
        self._rank = torch.distributed.get_rank(process_group) if self._distributed else 0
        self._processes = torch.distributed.get_world_size(process_group) if self._distributed else 1
        if self._rank < 0:
            raise ValueError(f"process_group is {process_group}: it must be one that this process belongs to")
        # Arrays without axes only say that they have a length, and a text's is not meant.
        if isinstance(n, Sized) and getattr(n, "ndim", 1) and not isinstance(n, str):
            n = len(n)
        self._n = _arrays.integer("n", n, 1, _arrays.MAX_U32)
        self.batch_size = _arrays.integer("batch_size", batch_size, 1, _arrays.MAX_U32 // self._processes)
        self._whole = self.batch_size * self._processes
        steps = -(-self._n // self._whole) if steps is None else steps
        self._steps = _arrays.integer("steps", steps, 1, 2**63 - 1)
        self._momentum = _arrays.number("momentum", momentum, 0, 1)
        self._ridge = _arrays.number("ridge", ridge, 1e-8, 1e8)
        self._weighted = bool(weighted)
        self._seed = _arrays.integer("seed", seed, 0, 2**63 - 1)
        techniques = _arrays.integer("techniques", techniques, 1, _c.CONSTANTS["NF_MIS_MAX_TECHNIQUES"])
        if self._whole % techniques:
            raise ValueError(f"techniques is {techniques}: it must be a divisor of the whole batch, {self._whole}")
        self._warmup = -(-self._n // self._whole) if _arrays.one_of("warmup", warmup, WARMUPS) else 0
        # Seeds that no other sampler's tables have, unless its seed is as far away as nobody counts.
        seeds = [(self._seed + j * 0x9E3779B97F4A7C15) % 2**64 for j in range(techniques)]
        self._tables = [Table(self._n, uniform_fraction=uniform_fraction, seed=own) for own in seeds]
        self.epoch = 0
        self._drawn = self._step = self._unasked = self._loop = 0
        self._fresh, self._has_ended = [True] * techniques, False
        self._ahead, self._replay, self._last, self._resumed = deque(), deque(), None, False

    def __len__(self) -> int:
        return self._steps

    def __repr__(self):
        return (
            f"ImportanceBatchSampler({self._n}, {self.batch_size}, steps={self._steps}, "
            f"techniques={len(self._tables)}, seed={self._seed})"
        )

    def probabilities(self) -> torch.Tensor:
        """With which probability each item is drawn next, after warm-up: float32 of shape (n,); of several techniques
        the mean."""
        return torch.from_numpy(numpy.mean([table.probabilities() for table in self._tables], 0))

    def __iter__(self) -> Iterator[list[int]]:
        """The batches of an epoch, or what is left of it after `load_state_dict`: a list of indices for each. One loop
        at a time; a new one ends that before."""
        if self._unasked == 2:
            raise RuntimeError(
                "batch() was not called for any batch of two epochs: it is for each batch of the loader, once, and "
                f"without it `epoch` stays {self.epoch}"
            )
        waiting = len(self._ahead)
        if self._has_ended and not self._resumed and 0 < waiting < self._step:
            warnings.warn(
                f"batch() was called for {self._step - waiting} of {self._step} batches: but for a loop that was left, "
                "weights went to other batches than theirs. batch(index) refuses that",
                RuntimeWarning,
                stacklevel=2,
            )
        if self._resumed:
            # What was glanced at comes again.
            self._replay.extendleft(reversed(self._ahead))
        else:
            self._step = 0
            # First visits that did not come about, because the loader was left, are made up for.
            self._drawn = min(self._drawn, self._warmup) - sum(first for *_, first in (*self._ahead, *self._replay))
            self._replay.clear()
        self._ahead.clear()
        self._loop += 1
        loop, self._has_ended = self._loop, False
        while self._replay or self._step < self._steps:
            batch = self._replay.popleft() if self._replay else self._draw()
            self._ahead.append(batch)
            yield batch[0][self._rank :: self._processes].tolist()
            if self._loop != loop:
                raise RuntimeError(
                    "another loop over this sampler has begun, or a state was loaded: one loop at a time; evaluate "
                    "with a loader of its own"
                )
        self._unasked += 1
        self._has_ended = True

    def _draw(self):
        """Indices and weights of the next batch of all processes, and whether it is the first visit of its items."""
        first = self._drawn < self._warmup
        if first:
            order = numpy.empty(self._whole, numpy.uint32)
            # After the last item the permutation starts again.
            _c.shuffle(self._seed, self._n, self._drawn * self._whole, self._whole, _c.data(order))
            index, weight = order.astype(numpy.int64), numpy.ones(self._whole, numpy.float32)
        elif len(self._tables) == 1:
            index, weight = self._tables[0].draw(self._whole)
        else:
            index, weight = self._draw_techniques()
        if not self._weighted:
            weight = numpy.ones(self._whole, numpy.float32)
        self._drawn += 1
        self._step += 1
        return index, weight, first

    def _draw_techniques(self):
        """As many items from each table, with the weights of optimal MIS."""
        techniques = len(self._tables)
        each = self._whole // techniques
        index = numpy.concatenate([table.draw(each)[0] for table in self._tables])
        pdf = numpy.ascontiguousarray(numpy.stack([table.probabilities(index) for table in self._tables], 1))
        technique = numpy.repeat(numpy.arange(techniques, dtype=numpy.uint32), each)
        weight = numpy.empty(self._whole, numpy.float32)
        status = _c.omis_weights(
            _c.CONSTANTS["NF_OMIS_RIDGE"],
            self._ridge,
            techniques,
            self._n,
            _c.data(pdf),
            _c.data(technique),
            self._whole,
            _c.data(weight),
        )
        if status:
            raise ValueError(_c.message(status))
        return index, weight

    def batch(self, index: Any = None) -> tuple[torch.Tensor, torch.Tensor]:
        """Index and weight, int64 and float32 tensors of shape (batch_size,) on the CPU, of the batch that the
        loader has just handed over; once for each batch. The mean of weight times loss estimates the mean loss over all
        items.

        Args:
            index: what the data set handed over with the items; refused if it is not this batch's.
        """
        if not self._distributed and is_distributed() and torch.distributed.get_world_size() > 1:
            raise RuntimeError("this sampler knows of no other process: make it after init_process_group")
        if not self._ahead:
            raise RuntimeError(
                "batch() is for each batch of the loader, once: there is none that it was not called for"
            )
        own = self._ahead[0][0][self._rank :: self._processes]
        if index is not None and not numpy.array_equal(_arrays.integers("index", index, self._n - 1), own):
            number = self._step - len(self._ahead) - len(self._replay) + 1
            raise RuntimeError(
                f"these are not the items of batch {number} of {self._steps}: batch() was left out, or the loader is "
                "out of order"
            )
        self._last, self._unasked, self._resumed = self._ahead.popleft(), 0, False
        if not self._ahead and not self._replay and self._step >= self._steps:
            self.epoch += 1
        return self._own(0), self._own(1)

    def _own(self, part):
        """This process's part of the last batch."""
        if self._last is None:
            raise RuntimeError("there is no batch yet: call batch() first")
        return torch.from_numpy(self._last[part][self._rank :: self._processes].copy())

    @torch.no_grad()
    def update(self, importance: Any, index: Any = None) -> None:
        """Says how large each item's gradient was, of `batch`'s items or of these.

        Args:
            importance: shape (batch_size,), finite, at least 0; with several techniques (batch_size, techniques). Only
                ratios count.
            index: integers of shape (batch_size,); None: the items of the last `batch`. As many in every process.
        """
        self._learn(importance, index)

    def _learn(self, importance, index=None, scaled=None):
        """`update`, and `update_from`: leaves out items of negative importance, which no norm is, and those that
        overflowed where the loss was scaled."""
        # Until all were visited once, what was stands for nothing.
        handed = self._drawn - len(self._ahead) - len(self._replay)
        first = self._last[2] if self._last is not None else handed < max(self._warmup, int(self.epoch == 0))
        if index is None:
            own = self._own(0)
        else:
            own = torch.from_numpy(_arrays.integers("index", index, self._n - 1).astype(numpy.int64))
        if not isinstance(importance, torch.Tensor) or importance.is_complex():
            importance = torch.tensor(_arrays.floats("importance", importance, numpy.float64))
        # NumPy has no bfloat16; of what is beyond float32 the table says how large it is.
        importance = importance.detach().to(torch.promote_types(importance.dtype, torch.float32))
        techniques = len(self._tables)
        shape = (own.numel(),) if techniques == 1 else (own.numel(), techniques)
        _arrays.check_shape("index", own, shape[:1], "one item after the other")
        _arrays.check_shape("importance", importance, shape, "a number for each index and technique")
        if index is None:
            index = torch.from_numpy(self._last[0])
        else:
            # The other processes are reached from the importances' device.
            index = self._gather(own.to(importance.device))
        importance = self._gather(importance).reshape(len(index), techniques).numpy()
        index = index.numpy()
        if not ((importance >= 0) & (importance <= LARGEST)).all():
            known = self._known(importance, scaled)
            index, importance = index[known], importance[known]
        means = (importance.sum(0, dtype=numpy.float64) / max(len(index), 1)).astype(numpy.float32)
        for j, table in enumerate(self._tables):
            if self._fresh[j] and means[j] > 0:
                # Else items of which nothing is known yet would count as 1, whatever the scale.
                table._fill(means[j])
                self._fresh[j] = False
            table.update(index, importance[:, j], 0.0 if first else self._momentum)

    def _known(self, importance, scaled):
        """Of which items of all processes the importance is one; refuses what must be."""
        narrow = _arrays.floats("importance", importance)
        finite, positive = numpy.isfinite(narrow).all(1), (narrow >= 0).all(1)
        if scaled is None:
            for process in range(self._processes):
                own = importance[process :: self._processes]
                _arrays.check_positive(self._whose(process) + "importance", own if own.shape[1] > 1 else own[:, 0])
        if scaled is False and not finite.all():
            item, process = divmod(int(finite.argmin()), self._processes)
            raise ValueError(
                f"{self._whose(process)}logits.grad[{item}] is not finite: the loss is not, or a GradScaler "
                "multiplied it and scale was not given; scale=1.0 leaves such items out"
            )
        return finite & positive

    def _whose(self, process):
        """The process's name, where there are several."""
        return f"process {process}'s " if self._processes > 1 else ""

    def _gather(self, own):
        """The parts of all processes, in the order of the whole batch, on the CPU."""
        if self._processes == 1:
            return own.cpu()
        # Beside them goes which batch they are of: 24 bits, which any type of theirs holds.
        batch = 0 if self._last is None else zlib.crc32(self._last[0].tobytes()) >> 8
        own = torch.cat([own, own.new_full((1, *own.shape[1:]), batch)])
        backend = torch.distributed.get_backend(self._group)
        # Each reaches the others from its own kind of memory only.
        if backend == "gloo":
            own = own.cpu()
        elif backend == "nccl":
            own = own if own.is_cuda else own.cuda()
        parts = [torch.empty_like(own) for _ in range(self._processes)]
        torch.distributed.all_gather(parts, own, group=self._group)
        whole = torch.stack(parts, 1).cpu()
        if (whole[-1] != batch).any():
            raise RuntimeError(
                "processes have parts of different batches: all must make the sampler alike, load the same state, and "
                "ask for as many batches between updates"
            )
        return whole[:-1].flatten(0, 1)

    @torch.no_grad()
    def update_from(
        self,
        logits: torch.Tensor,
        *,
        reduction: Literal["mean", "sum"] = "mean",
        scale: float | None = None,
        split: Literal["sign", "norm"] = "sign",
    ) -> None:
        """As `update`, by the norm of each item's derivative of the loss by its outputs, of the items of the last
        `batch`: once after each backward pass, before the next `batch`, with `logits.retain_grad()` before the pass.

        Args:
            logits: the model's outputs, (batch_size,) or (batch_size, ...), any loss's.
            reduction: "mean" or "sum": how the weighted losses of the batch were added up.
            scale: what the loss was multiplied by besides, 1e-30 to 3.4e38: `scaler.get_scale()` of a GradScaler,
                before `scaler.update()`, in every process. If given, items whose derivatives overflowed are left out,
                as the scaler leaves out the step; else they are refused.
            split: of several techniques (section 6.2.3), output k belonging to group k modulo their number. "norm": as
                many groups as techniques, each with the norm of its derivatives. "sign": half as many, each with the
                norm of the positive ones, then of the negative ones.
        """
        scaled, scale = scale is not None, _arrays.number("scale", 1.0 if scale is None else scale, 1e-30, 3.4e38)
        check_tensor("logits", logits)
        if logits.grad is None:
            raise ValueError("logits.grad is None: call logits.retain_grad() before the backward pass")
        if logits.is_complex():
            raise TypeError(f"logits holds {logits.dtype}: real numbers are expected")
        weight = self._own(1).to(logits.device)
        if logits.shape[:1] != weight.shape:
            raise ValueError(
                f"logits has the shape {tuple(logits.shape)}: (batch_size, ...) is needed, of the last batch's "
                f"{len(weight)} items"
            )
        count = _arrays.one_of("reduction", reduction, {"mean": len(weight), "sum": 1})
        is_by_sign = _arrays.one_of("split", split, {"sign": True, "norm": False})
        gradient = logits.grad.float().reshape(len(weight), -1) * (count / scale) / weight[:, None]
        if len(self._tables) == 1:
            self._learn(torch.linalg.vector_norm(gradient, dim=1), scaled=scaled)
            return
        if is_by_sign and len(self._tables) % 2:
            raise ValueError(f"techniques is {len(self._tables)}: split must be 'norm' where it is odd")
        signs = (gradient.clamp(min=0), (-gradient).clamp(min=0)) if is_by_sign else (gradient,)
        groups, outputs = len(self._tables) // len(signs), gradient.shape[1]
        if outputs < groups:
            allowed = f"{outputs} outputs allow {outputs * len(signs)} with split={split!r}"
            raise ValueError(f"techniques is {len(self._tables)}: {allowed}")
        parts = [torch.linalg.vector_norm(sign[:, group::groups], dim=1) for group in range(groups) for sign in signs]
        importance = torch.stack(parts, 1)
        importance[weight.abs() < LEAST_WEIGHT] = -1
        self._learn(importance, scaled=scaled)

    def state_dict(self) -> dict[str, Any]:
        """All that decides the batches to come, those that workers were asked for included, but for the constructor's
        arguments: tensors and numbers, which `torch.load` reads with `weights_only=True`. After `update`, not between
        `batch` and it."""
        ahead = [*self._ahead, *self._replay]
        tables = [table.state_dict() for table in self._tables]
        return {
            "n": self._n,
            "whole_batch": self._whole,
            "seed": self._seed,
            "tables": [torch.from_numpy(table["table"]) for table in tables],
            "rng": [list(table["rng"]) for table in tables],
            "epoch": self.epoch,
            "fresh": list(self._fresh),
            "drawn": self._drawn,
            "step": self._step,
            "ahead": [(torch.from_numpy(index), torch.from_numpy(weight), first) for index, weight, first in ahead],
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Goes on where `state_dict` was called: the next `iter` gives what was left of the epoch, and a loop in
        progress ends. Of the constructor's arguments `n`, `batch_size` and `techniques` must be the same, and `seed`
        becomes the state's. Several techniques take the memory of one more table meanwhile."""
        mine = {"n": self._n, "whole_batch": self._whole, "tables": len(self._tables)}
        n, whole, states, rngs, ahead = _arrays.parts(state, "n", "whole_batch", "tables", "rng", "ahead")
        its = {"n": n, "whole_batch": whole, "tables": len(states)}
        if mine != its:
            raise ValueError(f"the state is another sampler's: it has {its}, this one {mine}")
        # Nothing of this sampler changes before all of the state has been read.
        replay = deque((*(_arrays.array("ahead", part) for part in parts), first) for *parts, first in ahead)
        seed, epoch, fresh, drawn, step = _arrays.parts(state, "seed", "epoch", "fresh", "drawn", "step")
        tables = [{"table": table, "rng": rng} for table, rng in zip(states, rngs)]
        if len(tables) > 1:  # one table refuses by itself; of several none may have been changed before
            spare = Table(self._n)
            for table in tables:
                spare._load(table, self._n)
        for own, table in zip(self._tables, tables):
            fraction = own.uniform_fraction
            own._load(table, self._n)
            own.uniform_fraction = fraction
        self._seed, self.epoch, self._fresh, self._drawn, self._step = seed, epoch, list(fresh), drawn, step
        self._replay, self._last = replay, None
        # A loop in progress would give batches of the state to items of its own.
        self._loop += 1
        self._has_ended = False
        self._ahead.clear()
        self._unasked = 0
        # At the end of an epoch the next begins.
        self._resumed = bool(self._replay) or self._step < self._steps


WARMUPS = {"epoch": True, None: False}


def is_distributed() -> bool:
    """Whether this process has joined others."""
    return torch.distributed.is_available() and torch.distributed.is_initialized()


def check_tensor(name, value):
    """Refuses what is no tensor."""
    if not isinstance(value, torch.Tensor):
        raise TypeError(f"{name} is a {type(value).__name__}: a tensor is expected")


def cross_entropy_importance(logits: torch.Tensor, target: torch.Tensor) -> torch.Tensor:
    """The norm of the cross-entropy loss's derivative by the logits, || softmax - onehot ||, without a backward pass.

    Args:
        logits: shape (batch, classes), no NaN and no infinity but -inf.
        target: integers of shape (batch,), 0 to classes - 1.

    Returns:
        float32 of shape (batch,), 0 to 1.4143.
    """
    check_tensor("logits", logits)
    check_tensor("target", target)
    if logits.ndim != 2:
        raise ValueError(f"logits has the shape {tuple(logits.shape)}: it must be (batch, classes)")
    _arrays.check_shape("target", target, tuple(logits.shape[:1]), "a class for each item")
    _arrays.integers("target", target, logits.shape[1] - 1)
    with torch.no_grad():
        derivative = torch.softmax(logits.float(), 1) - torch.nn.functional.one_hot(target.long(), logits.shape[1])
        return derivative.norm(dim=1)
