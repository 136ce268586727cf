"""Arrays that the library itself would not read: at odd addresses, or of more numbers than it counts."""

import numpy
import pytest

import noisefloor


def unaligned(array):
    """The same numbers, a byte further on."""
    numbers = numpy.empty(array.nbytes + 1, numpy.uint8)[1:].view(array.dtype).reshape(array.shape)
    numbers[...] = array
    assert not numbers.flags.aligned
    return numbers


def same(call, *given):
    """Whether results are those of arrays at even addresses."""
    return all(numpy.array_equal(a, b) for a, b in zip(call(*given), call(*map(unaligned, given))))


def test_odd_addresses_are_read():
    u = noisefloor.Sampler().image(8, 8, 2)
    f, factors = u.sum(-1), 1 + u[:, :, 0, 0]
    surfaces = numpy.arange(64, dtype=numpy.uint32).reshape(8, 8) // 32
    assert same(noisefloor.estimate, u, f)
    assert same(lambda u, f, s, a: noisefloor.image_estimate(u, f, surfaces=s, factors=a), u, f, surfaces, factors)

    def table(index, importance, items):
        table = noisefloor.Table(len(importance), importance=importance)
        table.update(index, importance[::-1])
        table.update(index, importance)
        return (table.probabilities(items),)

    for items in 10, 10_000:
        importance = numpy.arange(items, dtype=numpy.float32)
        assert same(table, numpy.arange(items), importance, numpy.arange(items, dtype=numpy.uint32))


def test_more_than_the_library_counts_are_refused():
    index, importance = (numpy.broadcast_to(kind(1), 2**32) for kind in (numpy.int64, numpy.float32))
    table = noisefloor.Table(10)
    for call in (lambda: table.update(index, importance), lambda: table.probabilities(index)):
        with pytest.raises(ValueError, match="index has 4294967296 numbers: 4294967295 are the most"):
            call()
