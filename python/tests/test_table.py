"""Tables: what they draw, what they refuse, and that they survive copies, processes and threads."""

import copy
import json
import math
import multiprocessing
import os
import pathlib
import pickle
import subprocess
import sys
import threading

import hypothesis
import numpy
import pytest
from hypothesis import strategies
from hypothesis.extra import numpy as arrays

import noisefloor

METHODS = "iid", "stratified", "distinct"


def same(a, b, batch=50):
    """Whether two tables draw alike."""
    return all(numpy.array_equal(x, y) for x, y in zip(a.draw(batch), b.draw(batch)))


def test_distinct_items_are_distinct():
    """Weights are at most 1 / uniform_fraction + 1."""
    table, most = noisefloor.Table(40, importance=[1e6] + 39 * [1], seed=1), []
    for _ in range(100):
        index, weight = table.draw(40, "distinct")
        assert sorted(index) == list(range(40))
        most.append(weight.max())
    assert 5 < max(most) < 6


def test_probabilities_follow_importance():
    table = noisefloor.Table(4, importance=[1, 2, 3, 4])
    expected = 0.8 * numpy.arange(1, 5) / 10 + 0.05
    assert numpy.allclose(table.probabilities(), expected)
    index, weight = table.draw(20)
    assert numpy.allclose(weight, 1 / (4 * expected[index]))
    table.update([0, 0], [3.0, 3.0], 0.5)
    assert numpy.allclose(table.probabilities([[0], [3]]), 0.8 * numpy.array([[2.5], [4]]) / 11.5 + 0.05)
    table.uniform_fraction = 1
    assert numpy.allclose(table.probabilities(), 0.25)
    assert len(table) == 4 and repr(table) == "Table(4, uniform_fraction=1)"


@pytest.mark.parametrize("batch", [0, 1, 4096, 4097, 20000])
def test_batches_of_all_sizes(batch):
    table, again = noisefloor.Table(30000, seed=2), noisefloor.Table(30000, seed=2)
    for method in METHODS:
        index, weight = table.draw(batch, method)
        assert index.shape == weight.shape == (batch,)
        parts = again.draw(batch, method)
        assert numpy.array_equal(parts[0], index)
        table.update(index, weight)
        again.update(index, weight)
    assert same(table, again)


def test_many_minibatches_at_once():
    table, again = (noisefloor.Table(500, importance=numpy.arange(500), seed=6) for _ in range(2))
    for method in METHODS:
        index, weight = table.draw((3, 2, 40), method)
        assert index.shape == weight.shape == (3, 2, 40)
        assert index.dtype == numpy.int64 and weight.dtype == numpy.float32
        parts = [again.draw(40, method) for _ in range(6)] if method != "iid" else [again.draw(240)]
        for found, expected in zip((index, weight), zip(*parts)):
            assert numpy.array_equal(found.reshape(-1), numpy.concatenate(expected))
        table.update(index, weight)
        again.update(index.reshape(-1), weight.reshape(-1))
    table.update(7, 0.5)
    again.update([7], [0.5])
    assert same(table, again)
    assert table.draw((0, 4), "distinct")[0].shape == (0, 4)


@hypothesis.given(
    arrays.arrays(
        strategies.sampled_from(
            [numpy.float16, numpy.float32, numpy.float64, numpy.int32, numpy.uint8, numpy.dtype(">f4")]
        ),
        strategies.integers(1, 70),
        elements=strategies.integers(0, 100),
    ),
    strategies.sampled_from([numpy.int8, numpy.uint16, numpy.int32, numpy.int64, numpy.uint64, numpy.dtype(">i8")]),
    strategies.integers(-3, 3).filter(bool),
)
def test_any_type_and_stride_is_the_same_update(importance, kind, step):
    plain, table = noisefloor.Table(100), noisefloor.Table(100)
    index = numpy.arange(len(importance), dtype=kind)
    plain.update(index[::step].astype(numpy.int64), importance[::step].astype(numpy.float32))
    table.update(index[::step], importance[::step])
    assert same(plain, table)


@hypothesis.given(
    arrays.arrays(numpy.float64, 10, elements=strategies.floats(allow_nan=True, allow_infinity=True)),
    arrays.arrays(numpy.int64, 10),
)
def test_what_is_refused_changes_nothing(importance, index):
    table, before = noisefloor.Table(100, seed=4), noisefloor.Table(100, seed=4)
    good = (index >= 0).all() and (index < 100).all()
    with numpy.errstate(over="ignore"):
        narrow = importance.astype(numpy.float32)
    good = good and numpy.isfinite(narrow).all() and (narrow >= 0).all()
    if good:
        table.update(index, importance)
    else:
        with pytest.raises(ValueError, match=r"(index|importance)\[\d\] is .*: it must be "):
            table.update(index, importance)
        assert same(table, before)


@hypothesis.given(strategies.lists(strategies.integers(0, 60), max_size=8), strategies.sampled_from([0, 0.2, 1]))
def test_grown_tables_are_those_made_at_once(counts, fraction):
    values = numpy.random.default_rng(1).random(1 + sum(counts), dtype=numpy.float32)
    grown = noisefloor.Table(1, importance=values[:1], uniform_fraction=fraction, seed=3)
    expected = noisefloor.Table(len(values), importance=values, uniform_fraction=fraction, seed=3)
    for end, count in zip(1 + numpy.cumsum(counts, dtype=int), counts):
        grown.append(values[end - count : end])
        assert len(grown) == end
    assert numpy.array_equal(grown.probabilities(), expected.probabilities())
    for table in (grown, expected):
        table.update([0, len(table) - 1], [0.5, 0.25])
    assert same(grown, expected) and same(copy.copy(grown), pickle.loads(pickle.dumps(expected)))
    expected.load_state_dict(grown.state_dict())
    assert same(grown, expected)


def test_a_state_brings_its_items():
    grown = noisefloor.Table(1, capacity=50, seed=3)
    memory = grown._memory()[0]
    grown.append(2.0)
    grown.append(numpy.arange(40))
    assert len(grown) == 42 and grown._memory()[0] is memory
    assert numpy.array_equal(grown.importances(), [1, 2, *range(40)])
    before = grown.importances([[1, 41]])
    grown.update([1], 3.0, momentum=0)
    assert numpy.array_equal(before, [[2, 39]]) and grown.importances(1).shape == () and grown.importances(1) == 3
    for other in (noisefloor.Table(1), noisefloor.Table(1000), copy.deepcopy(grown)):
        other.load_state_dict(grown.state_dict())
        assert len(other) == 42 and numpy.array_equal(other.importances(), grown.importances())
        other.append(7.0)
        other.update([3, 42], 5.0, momentum=0)
        assert numpy.array_equal(other.importances([3, 42, 4]), [5, 5, 2])
    memory = pickle.loads(pickle.dumps(grown))._memory()[0]
    assert memory.nbytes >= grown._memory()[0].nbytes
    with pytest.raises(ValueError):
        grown.load_state_dict(damaged(grown.state_dict()))
    assert len(grown._memories) == 1 and grown._memory()[0].nbytes <= memory.nbytes


def test_a_copy_that_is_seeded_draws_its_own():
    table = noisefloor.Table(1000, seed=1)
    other = copy.copy(table)
    other.reseed(2)
    assert not numpy.array_equal(other.draw(20)[0], table.draw(20)[0])
    other.reseed(1)
    assert numpy.array_equal(other.draw(20)[0], noisefloor.Table(1000, seed=1).draw(20)[0])


class Equal(noisefloor.Table):
    """One of a kind that cannot be hashed."""

    def __eq__(self, other):
        return isinstance(other, Equal)


FORKS = """
import os, signal, threading, noisefloor
tables, ends = [noisefloor.Table(100, seed=1)], threading.Event()

def draw():
    while not ends.is_set():
        for table in list(tables):
            table.draw(20_000)

def make():
    while not ends.is_set():
        tables[1:] = [noisefloor.Table(10) for _ in range(20)]

def interrupt(*_):
    own = os.fork()
    if own == 0:
        os._exit(0)
    os.waitpid(own, 0)

def child():
    signal.alarm(20)
    # Another thread, to which the forking one's locks are closed, unless it has given them back.
    other = threading.Thread(target=lambda: [table.draw(4) for table in tables])
    other.start()
    other.join()
    os._exit(0)

signal.alarm(100)
workers = [threading.Thread(target=work) for work in (draw, make)]
for worker in workers:
    worker.start()
signal.signal(signal.SIGUSR1, interrupt)
for turn in range(30):
    timer = threading.Timer(0.002, lambda: os.kill(os.getpid(), signal.SIGUSR1))
    if turn % 3 == 0:
        timer.start()
    pid = os.fork()
    if pid == 0:
        child()
    assert os.waitpid(pid, 0)[1] == 0, turn
    if turn % 3 == 0:
        timer.join()
ends.set()
for worker in workers:
    worker.join()
# Nothing is held any more.
last = threading.Thread(target=lambda: [table.draw(1) for table in tables])
last.start()
last.join()
print("ended")
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no processes are forked here")
def test_forks_while_others_draw_make_tables_and_are_interrupted():
    """In a process of its own, where no other library has hooks and threads."""
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", FORKS], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and done.stdout.endswith("ended\n"), (done.returncode, done.stdout, done.stderr)
    assert len(Equal(3)) == 3


def test_what_cannot_be_appended_changes_nothing():
    table, before = noisefloor.Table(4, seed=4), noisefloor.Table(4, seed=4)
    for wrong, words in (
        ([1, -1.0], r"importance\[1\] is -1.0: it must be at least 0"),
        ([1e39], r"importance\[0\] is 1e\+39: it must be"),
        ([[1.0]], "shape"),
        (-1.0, r"importance\[0\] is -1.0"),
        (numpy.broadcast_to(numpy.float32(1), 2**32 - 4), "n is 4294967296: it must be 1 to 4294967295"),
    ):
        with pytest.raises(ValueError, match=words):
            table.append(wrong)
    assert len(table) == 4 and same(table, before)


class OnlyDLPack:
    """An array that says no more than the protocol."""

    def __init__(self, array):
        self._array = array

    def __dlpack__(self, **options):
        return self._array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self._array.__dlpack_device__()


def test_arrays_of_anybody():
    plain = noisefloor.Table(100, seed=7)
    index, weight = plain.draw(10)
    others = [
        (index.tolist(), weight.tolist()),
        (memoryview(index), memoryview(weight)),
        (OnlyDLPack(index), OnlyDLPack(weight)),
    ]
    for name, make in (("torch", "from_numpy"), ("jax.numpy", "asarray")):
        try:
            module = __import__(name, fromlist=["x"])
        except ImportError:
            continue
        others.append((getattr(module, make)(index), getattr(module, make)(weight)))
        if hasattr(module, "from_dlpack"):
            assert (module.from_dlpack(weight) == module.asarray(weight)).all()
    plain.update(index, weight)
    for other_index, other_weight in others:
        table = noisefloor.Table(100, importance=None, seed=7)
        table.draw(10)
        table.update(other_index, other_weight)
        assert numpy.array_equal(table.probabilities(), plain.probabilities())


def damaged(state):
    """One that claims 2^32 - 1 items."""
    state["table"][12:16] = 255
    return state


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda t: t.update([10], [1.0]), r"index\[0\] is 10: it must be 0 to 9"),
        (lambda t: t.update([2**32 + 1], [1.0]), r"index\[0\] is 4294967297: it must be 0 to 9"),
        (lambda t: t.update([1, -1], [1.0, 1.0]), r"index\[1\] is -1"),
        (lambda t: t.update([[1, 2], [-1, 3]], [[1.0, 1.0], [1.0, 1.0]]), r"index\[1, 0\] is -1"),
        (lambda t: t.update([1.5], [1.0]), "index holds float64: integers"),
        (lambda t: t.update([1], [1j]), "importance holds complex128: real numbers"),
        (lambda t: t.update([1], ["a"]), "importance holds <U1"),
        (lambda t: t.update([1], numpy.ma.array([1.0], mask=[True])), "importance is a masked array"),
        (lambda t: t.update([1], [1.0], "0.5"), "momentum is '0.5': a number"),
        (lambda t: t.update([1, 2], [1.0]), r"importance has the shape \(1,\): it must be \(2,\)"),
        (lambda t: t.update([[1]], [1.0]), r"importance has the shape \(1,\): it must be \(1, 1\)"),
        (lambda t: t.update([1, 2], [1, 1e300]), r"importance\[1\] is 1e\+300: it must be at least 0 and finite"),
        (lambda t: t.draw(()), r"batch is \(\): it must be one number or several, of a product up to 4294967295"),
        (lambda t: t.draw((2**20, 2**20)), r"batch is \(1048576, 1048576\): it must be"),
        (lambda t: t.draw((2**31, 2**31, 3), "distinct"), r"batch is \(2147483648, 2147483648, 3\): it must be"),
        (lambda t: t.draw((2, -1)), "batch is -1"),
        (lambda t: t.draw((2, 1.5)), "batch is 1.5: an integer"),
        (lambda t: t.draw((2, 11), "distinct"), "batch is 11: a distinct draw takes 0 to 10"),
        (lambda t: t.draw((0, 11), "distinct"), "batch is 11: a distinct draw takes 0 to 10"),
        (lambda t: t.draw((0, 1), "all"), "method is 'all': it must be one of"),
        (lambda t: t.update([1], [1.0], 1.5), r"momentum is 1.5: it must be 0 to 1"),
        (lambda t: t.update([1], [1.0], math.nan), "momentum is nan"),
        (lambda t: t.draw(-1), "batch is -1: it must be 0 to"),
        (lambda t: t.draw(2.0), "batch is 2.0: an integer"),
        (lambda t: t.draw(11, "distinct"), "batch is 11: a distinct draw takes 0 to 10"),
        (lambda t: t.draw(5000, "distinct"), "batch is 5000: it must be 0 to 10"),
        (lambda t: t.draw(1, "alias"), "method is 'alias': it must be one of 'iid', "),
        (lambda t: t.draw(1, []), r"method is \[\]"),
        (lambda t: t.probabilities([10]), r"index\[0\] is 10"),
        (lambda t: setattr(t, "uniform_fraction", 2), "uniform_fraction is 2.0"),
        (lambda t: t.load_state_dict({}), "the state has no 'table': it must be state_dict"),
        (lambda t: t.load_state_dict(damaged(t.state_dict())), "bytes: "),
        (lambda t: t.reseed(-1), "seed is -1"),
        (lambda t: t.importances([10]), r"index\[0\] is 10"),
        (lambda t: t.update([1, 2], -1.0), r"importance\[0\] is -1.0"),
        (lambda t: noisefloor.Table(10, capacity=9), "capacity is 9: it must be 10 to"),
        (
            lambda t: t.load_state_dict({"table": numpy.zeros(300, numpy.uint8), "rng": (0, 0)}),
            "300 bytes: the bytes are not",
        ),
        (lambda t: t.load_state_dict(None), "the state is a NoneType: what state_dict"),
        (lambda t: t.load_state_dict({**t.state_dict(), "rng": (1,)}), r"rng is \(1,\): it must be two integers"),
        (lambda t: t.load_state_dict({**t.state_dict(), "rng": 5}), "rng is 5: it must be two integers"),
        (lambda t: t.load_state_dict({**t.state_dict(), "rng": {0: 1, 1: 2}}), "rng is .*: it must be two integers"),
        (
            lambda t: t.load_state_dict({**t.state_dict(), "table": t.state_dict()["table"].astype(numpy.int16)}),
            "table holds int16: uint8 is expected",
        ),
        (lambda t: t.load_state_dict({**t.state_dict(), "table": bytes(72)}), "table holds .*: uint8 is expected"),
        (lambda t: noisefloor.Table(0), "n is 0: it must be 1 to 4294967295"),
        (lambda t: noisefloor.Table(2**32), "n is 4294967296"),
        (lambda t: noisefloor.Table("7"), "n is '7': an integer"),
        (lambda t: noisefloor.Table(3, importance=[1, 2]), r"importance has the shape \(2,\): it must be \(3,\)"),
        (lambda t: noisefloor.Table(3, importance=[0, 1e-60, 0]), "importance is 0 for all of 3 items, as float32: at"),
        (lambda t: noisefloor.Table(3, importance=[1, -2, 0]), r"importance\[1\] is -2: it must be at least 0"),
        (lambda t: noisefloor.Table(3, seed=-1), "seed is -1"),
        (lambda t: noisefloor.Table(1, importance=numpy.float64(1)), r"importance has the shape \(\)"),
    ],
)
def test_refusals_name_argument_value_and_range(call, said):
    with pytest.raises((ValueError, TypeError), match=said):
        call(noisefloor.Table(10, seed=1))


def test_without_importance_nothing_can_be_drawn():
    table = noisefloor.Table(3, uniform_fraction=0)
    table.update([0, 1, 2], [0.0, 0.0, 0.0], 0.0)
    for call in (lambda: table.draw(1), table.probabilities):
        with pytest.raises(ValueError, match="uniform_fraction is 0"):
            call()


def test_a_distinct_draw_says_how_many_it_takes():
    table = noisefloor.Table(4, importance=[0.0, 1.0, 0.0, 2.0], uniform_fraction=0)
    assert sorted(table.draw(2, "distinct")[0]) == [1, 3]
    said = "^batch is 3: a distinct draw takes 0 to 2, .*, and uniform_fraction is 0$"
    for batch in (3, (1, 3)):
        with pytest.raises(ValueError, match=said):
            table.draw(batch, "distinct")


def test_copies_draw_the_same():
    table = noisefloor.Table(300, importance=numpy.arange(300), uniform_fraction=0.1, seed=9)
    table.update(*table.draw(20))
    fresh = noisefloor.Table(300)
    fresh.load_state_dict(table.state_dict())
    copies = [fresh, copy.deepcopy(table), copy.copy(table), pickle.loads(pickle.dumps(table))]
    expected = table.draw(40)
    for other in copies:
        assert all(numpy.array_equal(a, b) for a, b in zip(expected, other.draw(40)))
        other.update([0], [5.0])
    assert table.probabilities([0]) < copies[0].probabilities([0])


class Named(noisefloor.Table):
    """A table with attributes of its own."""

    def __init__(self, n, name):
        super().__init__(n)
        self.name, self.notes = name, []


def test_copies_carry_a_subclasss_attributes():
    table = Named(10, "losses")
    table.update([3], [5.0])
    for other in (copy.copy(table), copy.deepcopy(table), pickle.loads(pickle.dumps(table))):
        assert type(other) is Named and other.name == "losses" and other.notes == []
        assert numpy.array_equal(other.probabilities(), table.probabilities())
    assert copy.copy(table).notes is table.notes is not copy.deepcopy(table).notes


def _draw_elsewhere(table, results):
    results.put((table.draw(30), table.draw(5000)[0].sum()))


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_other_processes_draw_the_same(method):
    table = noisefloor.Table(1000, importance=numpy.arange(1000), seed=9)
    context = multiprocessing.get_context(method)
    results = context.Queue()
    processes = [context.Process(target=_draw_elsewhere, args=(table, results)) for _ in range(2)]
    for process in processes:
        process.start()
    found = [results.get(timeout=60) for _ in processes]
    for process in processes:
        process.join()
    expected = table.draw(30), table.draw(5000)[0].sum()
    for draw, total in found:
        assert numpy.array_equal(draw[0], expected[0][0]) and numpy.array_equal(draw[1], expected[0][1])
        assert total == expected[1]


def test_threads_share_a_table():
    """Every thread's batch is a whole one of the table's, and none is drawn twice."""
    table, alone = noisefloor.Table(500, importance=numpy.arange(500), seed=3), None
    alone = copy.deepcopy(table)
    found, lock = [], threading.Lock()

    def work():
        for _ in range(300):
            index, weight = table.draw(16)
            with lock:
                found.append((*index, *weight))

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expected = [alone.draw(16) for _ in found]
    assert sorted(found) == sorted((*index, *weight) for index, weight in expected)


def test_a_signals_handler_may_save():
    program = """
import signal, noisefloor
table, saved = noisefloor.Table(100), []
signal.signal(signal.SIGALRM, lambda *_: saved.append(table.state_dict()))
signal.setitimer(signal.ITIMER_REAL, 1e-3, 1e-3)
while len(saved) < 300:
    table.update(*table.draw(64))
signal.setitimer(signal.ITIMER_REAL, 0)
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def pages():
    """Of this process in memory."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1])


def test_estimates_and_points_take_no_memory():
    u = noisefloor.Sampler().image(4, 4, 8)
    f, flat = numpy.exp(u.sum(-1)), u.reshape(-1, 2)

    def work(calls):
        for _ in range(calls):
            noisefloor.estimate(flat, f.reshape(-1))
            noisefloor.image_estimate(u, f)
            noisefloor.Sampler(frame=3).image(2, 2, 4, 9)
            with pytest.raises(ValueError):
                noisefloor.estimate(flat, f)

    work(500)
    before = pages()
    work(5000)
    assert (pages() - before) * 4096 < 2e6


def test_a_million_calls_take_no_memory():
    table, importance = noisefloor.Table(1000, seed=1), numpy.ones(1, numpy.float32)

    def work(calls):
        for _ in range(calls // 2):
            index, _ = table.draw(1)
            table.update(index, importance)

    work(100_000)
    before = pages()
    work(900_000)
    for _ in range(200):
        copied = pickle.loads(pickle.dumps(noisefloor.Table(100_000)))
        copied.draw(5000)
        with pytest.raises(ValueError):
            copied.update([-1], [1.0])
    assert (pages() - before) * 4096 < 4e6


def test_a_hundred_million_bits_of_index_are_reached():
    """A table of 20 million items: the last is drawn once it is all that matters."""
    items = 20_000_000
    table = noisefloor.Table(items, uniform_fraction=0)
    table.update([items - 1], [1e12], 0.0)
    index, weight = table.draw(100)
    assert (index == items - 1).mean() > 0.99 and weight.min() > 0


def test_saving_takes_a_copy_and_no_more(tmp_path):
    """Bytes for an item: 4.6 of the table, 4 of what is saved; so .4 GB beyond a table of a hundred million items."""
    items, program = 20_000_000, pathlib.Path(__file__).parent.parent / "bench/memory.py"
    command = [sys.executable, program, "--use", str(items), tmp_path / "table.npy"]
    # What this process holds is none of the other's.
    held = numpy.ones(30_000_000)
    table, whole = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert held[0] and 4.4 < table / items < 4.65
    assert 8 < whole / items < 4.6 + 4.6
