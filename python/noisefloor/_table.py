"""Minibatches drawn in proportion to importance."""

from __future__ import annotations

import math
import os
import threading
import weakref
from collections.abc import Mapping
from typing import Any, Literal, SupportsIndex

import numpy
from numpy.typing import NDArray

from . import _arrays, _c

#: Larger batches, which take longer anyway, have arrays of their own.
ROOM = 4096

#: The locks of all tables, so that none is in use where a process forks; those that are held for it, as forks of
#: signals' handlers may come between; and what keeps tables from being made meanwhile.
_locks: weakref.WeakValueDictionary[int, Any] = weakref.WeakValueDictionary()
_held: list[list[Any]] = []
_forking = threading.RLock()


def _hold():
    held = []
    _forking.acquire()
    _held.append(held)
    for reference in _locks.valuerefs():  # a list, which no other thread changes
        lock = reference()
        if lock is not None:
            lock.acquire()
            held.append(lock)


def _release():
    for lock in _held.pop():
        lock.release()
    _forking.release()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_hold, after_in_parent=_release, after_in_child=_release)


class Table:
    """The importances of a data set's items, from which minibatches are drawn.

    Item i is drawn with probability p_i = (1 - d) q_i / sum(q) + d / n, where q_i is its importance and d the uniform
    fraction. Its weight is 1 / (n p_i), but for "distinct": the mean of weight times gradient estimates the gradient of
    the mean loss without bias. A draw and an update take time of O(log n), but for updates that change the sum a
    millionfold, which take O(n). 4.6 bytes for each item that there is room for.

    Any number of threads may use one table, and a signal's handler may call `state_dict` alone. Tables can be pickled
    and copied. A copy draws the same minibatches, as that in a forked process does: see `reseed`. A handler that raises
    while the process forks leaves its child with locks that nobody gives back, as Python ignores what is raised there.

    Args:
        n: how many items, 1 to 2**32 - 1.
        importance: shape (n,), finite, at least 0 and not all 0; None makes all 1.
        uniform_fraction: the part of draws that are uniform, 0 to 1. Weights are at most 1 / uniform_fraction,
            but of "distinct".
        seed: of the table's own random numbers, 0 to 2**64 - 1. The same by default, so that a program does the same
            each time: tables that are to differ need seeds that do.
        capacity: for how many items there is room, with those that `append` adds; None is as many as there are. Beyond
            it `append` makes twice as much room.
    """

    def __init__(
        self,
        n: int,
        *,
        importance: Any = None,
        uniform_fraction: float = 0.2,
        seed: int = 0,
        capacity: int | None = None,
    ) -> None:
        n = _arrays.integer("n", n, 1, _arrays.MAX_U32)
        fraction = _arrays.number("uniform_fraction", uniform_fraction, 0, 1)
        seed = _arrays.integer("seed", seed, 0, 2**64 - 1)
        values = None
        if importance is not None:
            importance = _arrays.array("importance", importance)
            values = _arrays.floats("importance", importance)
            _arrays.check_shape("importance", values, (n,), "a number for each item")
        self._prepare(n, n if capacity is None else _arrays.integer("capacity", capacity, n, _arrays.MAX_U32))
        memory = self._memories[0]
        status = _c.table_init(self._at, _c.data(memory), memory.nbytes, n, _c.data(values))
        if status:
            _arrays.check_positive("importance", importance)
            raise ValueError(f"importance is 0 for all of {n} items, as float32: at least one must be above 0")
        self._table.uniform_fraction = fraction
        _c.rng_seed(self._rng_at, seed)

    def reseed(self, seed: int) -> None:
        """Begins the table's own random numbers anew, from 0 to 2**64 - 1: a copy then draws minibatches of its own."""
        seed = _arrays.integer("seed", seed, 0, 2**64 - 1)
        with self._lock:
            _c.rng_seed(self._rng_at, seed)

    def _prepare(self, n, capacity):
        """Memory for as many items, of which n are there."""
        self._n = n
        self._table, self._rng, self._lock = _c.Table(), _c.Rng(), threading.RLock()
        with _forking:
            _locks[id(self._lock)] = self._lock
        self._at, self._rng_at = _c.address(self._table), _c.address(self._rng)
        # Where the items are; while they move, and if a signal's handler has raised meanwhile, one of two.
        self._memories = [_c.workspace(_c.table_size(capacity))]
        # Where the library reads and writes batches, so that their addresses need not be asked for each time.
        self._index, self._value = numpy.empty(ROOM, numpy.uint32), numpy.empty(ROOM, numpy.float32)
        self._index_at, self._value_at = _c.data(self._index), _c.data(self._value)

    def __len__(self) -> int:
        return self._n

    def __repr__(self):
        return f"Table({self._n}, uniform_fraction={self.uniform_fraction:.6g})"

    @property
    def uniform_fraction(self) -> float:
        """The part of draws that are uniform, 0 to 1; may be set."""
        return self._table.uniform_fraction

    @uniform_fraction.setter
    def uniform_fraction(self, value: float) -> None:
        value = _arrays.number("uniform_fraction", value, 0, 1)
        with self._lock:
            self._table.uniform_fraction = value

    def draw(
        self,
        batch: SupportsIndex | tuple[SupportsIndex, ...],
        method: Literal["iid", "stratified", "distinct"] = "iid",
    ) -> tuple[NDArray[numpy.int64], NDArray[numpy.float32]]:
        """Draws items in proportion to importance.

        Args:
            batch: how many, 0 to 2**32 - 1; (k, b) for k minibatches of b, and so on.
            method: "iid", independently and with replacement; "stratified", one from each of `batch` equal parts of the
                probabilities, in the order of the data set but within blocks of 16: use the batch as a whole;
                "distinct", without replacement, at most n: use that as a whole, too. Its weights depend on the place in
                the batch (D. Raj, 1956), and are at most 1 / uniform_fraction + 1.

        Returns:
            index, int64, and weight, float32, both of shape (batch,): the mean of weight times gradient estimates the
            gradient of the mean loss over all items. For a tuple they have that shape.
        """
        if isinstance(batch, tuple):
            return self._draw_many(batch, method)
        try:
            draw = _c.DRAWS[method]
        except (KeyError, TypeError):
            draw = _arrays.one_of("method", method, _c.DRAWS)
        if type(batch) is not int or not 0 <= batch <= ROOM:
            batch = _arrays.integer("batch", batch, 0, self._n if method == "distinct" else _arrays.MAX_U32)
        if batch > ROOM:
            index, weight = numpy.empty(batch, numpy.uint32), numpy.empty(batch, numpy.float32)
            with self._lock:
                status = draw(self._at, self._rng_at, batch, _c.data(index), _c.data(weight))
            if not status:
                return index.astype(numpy.int64), weight
        else:
            with self._lock:
                status = draw(self._at, self._rng_at, batch, self._index_at, self._value_at)
                if not status:
                    return self._index[:batch].astype(numpy.int64), self._value[:batch].copy()
        raise self._draw_error(batch, method)

    def _draw_many(self, shape, method):
        """Minibatches, in arrays of this shape."""
        _arrays.one_of("method", method, _c.DRAWS)
        shape = tuple(_arrays.integer("batch", size, 0, _arrays.MAX_U32) for size in shape)
        most = _arrays.MAX_U32
        if not shape or math.prod(shape) > most:
            raise ValueError(f"batch is {shape}: it must be one number or several, of a product up to {most}")
        if method == "distinct" and shape[-1] > self._n:
            raise self._draw_error(shape[-1], method)
        if method == "iid":
            # Independent of each other they may be drawn as one.
            index, weight = self.draw(math.prod(shape))
            return index.reshape(shape), weight.reshape(shape)
        index, weight = numpy.empty(shape, numpy.int64), numpy.empty(shape, numpy.float32)
        for at in numpy.ndindex(*shape[:-1]):
            index[at], weight[at] = self.draw(shape[-1], method)
        return index, weight

    def _draw_error(self, batch, method):
        if method == "distinct" and batch > self._n:
            return ValueError(f"batch is {batch}: a distinct draw takes 0 to {self._n}, as many as there are items")
        words = "no item has an importance above 0"
        if method == "distinct" and (items := int(numpy.count_nonzero(self.importances()))):
            words = f"batch is {batch}: a distinct draw takes 0 to {items}, as many items have an importance above 0"
        return ValueError(f"{words}, and uniform_fraction is {self.uniform_fraction:.6g}")

    def update(self, index: Any, importance: Any, momentum: float = 0.3) -> None:
        """Sets the importance of items: q = momentum q + (1 - momentum) importance.

        Args:
            index: integers, 0 to n - 1, of shape (batch,) or any other. An item that comes twice is changed twice.
            importance: of index's shape, or one number for all; finite and at least 0: the norm of each item's
                gradient, say. Only ratios count, once no item has the 1 any more that it begins with.
            momentum: 0 to 1. 0 forgets the old value: for an item's first, where that 1 stands for nothing.
        """
        if type(index) is not numpy.ndarray:
            index = _arrays.array("index", index)
        if type(importance) is not numpy.ndarray:
            importance = _arrays.array("importance", importance)
        if importance.ndim == 0:
            importance = numpy.full(index.shape, importance)
        given = index, importance
        if index.dtype.char != "l":
            index = _arrays.integers("index", index, self._n - 1).astype(numpy.int64)
        if importance.dtype.char != "f":
            importance = _arrays.floats("importance", importance)
        batch = index.size
        if importance.shape != index.shape:
            _arrays.check_shape("importance", importance, index.shape, "a number for each index")
        if index.ndim != 1:
            index, importance = index.reshape(-1), importance.reshape(-1)
        if type(momentum) is not float or not 0 <= momentum <= 1:
            momentum = _arrays.number("momentum", momentum, 0, 1)
        # What is no number of 32 bits would become another item's.
        is_plain = 0 < batch <= ROOM and not numpy.bitwise_or.reduce(index) >> 32
        if is_plain:
            with self._lock:
                self._index[:batch], self._value[:batch] = index, importance
                if not _c.table_update(self._at, self._index_at, self._value_at, batch, momentum):
                    return
        index, importance = _arrays.integers("index", given[0], self._n - 1), _arrays.floats("importance", importance)
        with self._lock:
            status = _c.table_update(self._at, _c.data(index), _c.data(importance), batch, momentum)
        if status:
            _arrays.check_positive("importance", given[1])
            raise ValueError(_c.message(status))

    def append(self, importance: Any) -> None:
        """Adds items behind the last: of a replay buffer, say.

        Args:
            importance: shape (count,), or a number for one item; finite and at least 0. Items of the largest so far
                are soon drawn, and updated.
        """
        importance = numpy.atleast_1d(_arrays.array("importance", importance))
        _arrays.check_shape("importance", importance, (importance.size,), "a number for each new item")
        with self._lock:
            n = _arrays.integer("n", self._n + importance.size, 1, _arrays.MAX_U32)
            values = _arrays.floats("importance", importance)
            status = _c.table_append(self._at, _c.data(values), values.size)
            if status == _c.CONSTANTS["NF_ERR_MEMORY"]:
                # Twice as many, so that items are rarely moved.
                status = self._move(self._saved(), min(max(n, 2 * self._room()), _arrays.MAX_U32))
                assert not status, _c.message(status)
                status = _c.table_append(self._at, _c.data(values), values.size)
            if not status:
                self._n = n
                return
        _arrays.check_positive("importance", importance)
        raise ValueError(_c.message(status))

    def _room(self):
        """For how many items there is room."""
        return 16 * self._table.blocks

    def _memory(self):
        """Where the items are, and how far into it."""
        for memory in self._memories:
            begin = (self._table.importance or _c.data(memory)) - _c.data(memory)
            if 0 <= begin < memory.nbytes:
                return memory, begin

    def _move(self, saved, items):
        """Takes what was saved, into other memory if there is no room for as many items."""
        memory = there = self._memory()[0]
        if _c.table_size(items) > there.nbytes:
            memory = _c.workspace(_c.table_size(items))
        self._memories = [there, memory]
        status = _c.table_load(self._at, _c.data(memory), memory.nbytes, _c.data(saved), saved.nbytes)
        self._memories = [self._memory()[0]]
        return status

    def _fill(self, importance):
        """All items get this importance, above 0 as float32."""
        with self._lock:
            values, fraction = numpy.full(self._n, importance, numpy.float32), self.uniform_fraction
            memory, _ = self._memory()
            status = _c.table_init(self._at, _c.data(memory), memory.nbytes, self._n, _c.data(values))
            assert not status, _c.message(status)
            self._table.uniform_fraction = fraction

    def importances(self, index: Any = None) -> NDArray[numpy.float32]:
        """The importance of each of these items, float32, of index's shape; of all items for None."""
        if index is not None:
            index = _arrays.array("index", index)
        with self._lock:
            memory, begin = self._memory()
            values = memory.view(numpy.float32)[begin // 4 :][: self._n]
            if index is None:
                return values.copy()
            index = _arrays.integers("index", index, self._n - 1)
            return values.take(index, out=numpy.empty(index.shape, numpy.float32))

    def probabilities(self, index: Any = None) -> NDArray[numpy.float32]:
        """The probability of drawing each of these items, float32, of index's shape; of all items for None."""
        if index is not None:
            index = _arrays.array("index", index)
        with self._lock:
            if index is None:
                index = numpy.arange(self._n, dtype=numpy.uint32)
            index = _arrays.integers("index", index, self._n - 1)
            p = numpy.empty(index.shape, numpy.float32)
            status = _c.table_probabilities(self._at, _c.data(index), index.size, 1, _c.data(p))
        if status:
            raise self._draw_error(0, None)
        return p

    def state_dict(self) -> dict[str, Any]:
        """All that decides what is drawn next: "table", uint8 of shape (bytes,), and "rng", two ints. The same bytes on
        every machine. For `torch.load` with `weights_only=True` make "table" a tensor, by `torch.from_numpy`."""
        with self._lock:
            return {"table": self._saved(), "rng": (self._rng.state, self._rng.increment)}

    def _saved(self):
        saved = numpy.empty(_c.CONSTANTS["NF_TABLE_SAVED_HEADER"] + 4 * self._n, numpy.uint8)
        status = _c.table_save(self._at, _c.data(saved), saved.nbytes)
        assert not status, _c.message(status)
        return saved

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Becomes the table that `state_dict` saw, with as many items."""
        self._load(state)

    def _load(self, state, n=None):
        """With `n` the state must have as many items."""
        saved, rng = _arrays.parts(state, "table", "rng")
        saved = _arrays.array("table", saved)
        if saved.dtype != numpy.uint8:
            raise TypeError(f"table holds {saved.dtype}: uint8 is expected")
        saved = numpy.ascontiguousarray(saved)
        # What is no table at all, the library says.
        items = int.from_bytes(saved[12:16].tobytes(), "little") if saved[:8].tobytes() == b"nf_table" else 0
        if n is not None and items not in (0, n):
            raise ValueError(f"the state has {items} items, this table {n}")
        try:
            first, second = () if isinstance(rng, Mapping) else rng
        except (TypeError, ValueError):
            raise ValueError(f"rng is {rng!r}: it must be two integers") from None
        rng = [_arrays.integer("rng", number, 0, 2**64 - 1) for number in (first, second)]
        with self._lock:
            # A damaged number of items asks for no more memory than the state's bytes could fill.
            status = self._move(saved, min(items, saved.nbytes // 4))
            if status:
                raise ValueError(f"the state's table, {saved.nbytes} bytes: {_c.message(status)}")
            self._n = self._table.items
            self._rng.state, self._rng.increment = rng

    def __getstate__(self):
        others = {name: value for name, value in vars(self).items() if name not in OWN}
        return {"capacity": self._room(), "others": others, **self.state_dict()}

    def __setstate__(self, state):
        capacity, others = _arrays.parts(state, "capacity", "others")
        vars(self).update(others)
        self._prepare(0, _arrays.integer("capacity", capacity, 1, _arrays.MAX_U32))
        self.load_state_dict(state)


#: Attributes that a copy makes anew; those of subclasses it carries.
OWN = frozenset(vars(Table(1)))
