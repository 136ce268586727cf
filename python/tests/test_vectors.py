"""The bits pinned in tests/vectors, which Rust's and C's tests read too."""

import concurrent.futures
import ctypes
import pathlib

import numpy

import noisefloor
from noisefloor import _c

FOLDER = pathlib.Path(__file__).resolve().parent.parent.parent / "tests/vectors"
ESTIMATORS, BASES = tuple(_c.ESTIMATORS), tuple(_c.BASES)
NEXT = ctypes.CDLL(_c.LIBRARY).nf_rng_next
NEXT.argtypes, NEXT.restype = [ctypes.c_void_p], ctypes.c_uint32


def lines(name):
    """What is given and what is expected, in words."""
    rows = (line.split(":") for line in (FOLDER / name).read_text().splitlines() if not line.startswith("#"))
    return [(given.split(), expected.split()) for given, expected in rows]


def floats(words):
    """Floats of hexadecimal bits."""
    return numpy.array([int(word, 16) for word in words], numpy.uint32).view(numpy.float32)


def next_u32(rng):
    """The library's next number."""
    return NEXT(_c.address(rng))


def importance(rng):
    """Of tests/c/table_vectors.c."""
    bits = next_u32(rng)
    return (1 + (bits >> 9) / 2**23) * 2.0 ** (bits % 32 - 12) if bits & 0xE0 else 0.0


def fnv(batch):
    """FNV-1a of a batch."""
    result = 0xCBF29CE484222325
    words = numpy.stack([batch[0].astype(numpy.uint32), batch[1].view(numpy.uint32)], 1)
    for byte in words.tobytes():
        result = (result ^ byte) * 0x100000001B3 % 2**64
    return f"{result:016x}"


def test_tables_draw_the_librarys_bits():
    rows = lines("table.txt")
    for (items, seed, draws, fraction), (*first, iid, stratified, _, _, _, _) in rows:
        items, draws, rng = int(items), int(draws), _c.Rng()
        _c.rng_seed(_c.address(rng), int(seed))
        values = [importance(rng) for _ in range(items)]
        values = [1.0 if k == 0 else 0.0 if k // 16 % 5 == 2 else value for k, value in enumerate(values)]
        table = noisefloor.Table(items, importance=values, uniform_fraction=floats([fraction])[0])
        table._rng.state, table._rng.increment = rng.state, rng.increment
        index, weight = batch = table.draw(draws)
        assert index[:2].tolist() == [int(item) for item in first[::2]][:draws]
        assert (weight[:2] == floats(first[1::2])[:draws]).all()
        assert fnv(batch) == iid
        index[1::3] = index[: len(index[1::3]) * 3 : 3]
        table.update(index, [3.0, *[importance(table._rng) for _ in range(draws)][1:]], float(numpy.float32(0.3)))
        assert fnv(table.draw(draws, "stratified")) == stratified
    assert len(rows) == 32


def test_estimates_have_the_librarys_bits():
    count = 0
    for given, (_, gain, *moments) in lines("cv.txt"):
        form, estimator, basis, dims, order, channels, slices, solver, precision, color, n, seed = map(int, given)
        if any((form, solver, precision, color)):
            continue
        rng, samples = _c.Rng(), []
        _c.rng_seed(_c.address(rng), seed)
        u = numpy.float32([[(next_u32(rng) >> 8) / 2**24 for _ in range(dims)] for _ in range(n)])
        b = u[:, -1]
        for c in range(channels):
            a = u[:, c % dims]
            samples.append(numpy.float32(c + 1) * ((1 + a) / (2 + b) + (a > 0.5)).astype(numpy.float32))
        found = noisefloor.estimate(
            u, numpy.stack(samples, 1), order=order, estimator=ESTIMATORS[estimator], basis=BASES[basis],
            slices=max(slices, 1), channels=True,
        )  # fmt: skip
        expected = floats([gain, *moments])
        assert found.gain == expected[0]
        assert numpy.array_equal(found.mean, expected[1 : 1 + channels])
        assert numpy.array_equal(found.std_error, expected[5 : 5 + channels])
        count += 1
    assert count == 56


def test_threads_change_no_bits():
    generator = numpy.random.default_rng(9)
    cases = [(generator.random((500, 32, 3)), generator.random((500, 32))) for _ in range(8)]
    alone = [noisefloor.estimate(*case) for case in cases]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda case: noisefloor.estimate(*case), cases))
    assert all(numpy.array_equal(a, b) for one, other in zip(alone, together) for a, b in zip(one, other))
