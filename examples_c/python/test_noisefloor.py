"""Tests of noisefloor.py and of the training loop: `python3 test_noisefloor.py`, with NOISEFLOOR_LIBRARY set."""

import ctypes
import gc
import importlib.util
import unittest
import weakref

import digits
import noisefloor
import train_digits

LIBRARY = noisefloor.load()
IMAGES, LABELS = digits.load("train")


def installed(name):
    return importlib.util.find_spec(name) is not None


def dot(a, b):
    return sum(x * y for row, other in zip(a, b) for x, y in zip(row, other))


class TableTest(unittest.TestCase):
    def test_draws_repeat_and_survive_saving(self):
        table, again = noisefloor.Table(LIBRARY, 100, 7), noisefloor.Table(LIBRARY, 100, 7)
        index, weight = table.draw(50)
        table.update(index, (ctypes.c_float * 50)(*range(50)))
        self.assertEqual(list(again.draw(50)[0]), list(index))
        again.restore(table.save())
        later, weights = table.draw(50)
        index, weight = again.draw(50)
        self.assertEqual((list(index), list(weight)), (list(later), list(weights)))

    def test_weights_are_one_over_n_p(self):
        importance = (ctypes.c_float * 4)(1, 2, 3, 4)
        table = noisefloor.Table(LIBRARY, 4, 1, importance)
        for item, weight in zip(*table.draw(20)):
            self.assertAlmostEqual(weight, 1 / (4 * table.probability(item)), places=5)
            self.assertAlmostEqual(table.probability(item), 0.8 * importance[item] / 10 + 0.2 / 4, places=6)

    def test_errors_say_what_the_library_says(self):
        table = noisefloor.Table(LIBRARY, 4, 1)
        with self.assertRaisesRegex(ValueError, "range"):
            table.update((ctypes.c_uint32 * 1)(4), (ctypes.c_float * 1)(1))
        with self.assertRaisesRegex(ValueError, "NaN"):
            table.update((ctypes.c_uint32 * 1)(0), (ctypes.c_float * 1)(float("nan")))
        with self.assertRaises(ValueError):
            table.restore(b"no table")
        with self.assertRaisesRegex(OSError, "NOISEFLOOR_LIBRARY"):
            noisefloor.load("/nowhere/libnoisefloor.so")


class Device(str):
    @property
    def type(self):
        return self.split(":")[0]


class Tensor:
    """What `pointer` asks of PyTorch's tensors."""

    def __init__(self, *values, dtype="torch.float32", device="cpu", contiguous=True):
        self.values = (ctypes.c_float * len(values))(*values)
        self.shape, self.dtype, self.contiguous = (len(values),), dtype, contiguous
        self.device = Device(device)

    def data_ptr(self):
        return ctypes.addressof(self.values)

    def is_contiguous(self):
        return self.contiguous

    def numel(self):
        return len(self.values)


class PointerTest(unittest.TestCase):
    def check_reached(self, importance):
        table = noisefloor.Table(LIBRARY, 3, 1)
        table.update((ctypes.c_uint32 * 3)(0, 1, 2), importance, 0.0)
        self.assertAlmostEqual(table.probability(2), 0.8 * 7 / 18 + 0.2 / 3, places=6)

    def check_refused(self, error, said, array, element=ctypes.c_float):
        with self.assertRaisesRegex(error, said):
            noisefloor.pointer(array, element)

    def test_tensors_are_reached(self):
        self.check_reached(noisefloor.pointer(Tensor(5, 6, 7)))

    def test_other_tensors_are_refused(self):
        self.check_refused(TypeError, r"holds float64; .*float32: pass tensor\.to", Tensor(1, dtype="torch.float64"))
        self.check_refused(TypeError, "holds float32; .*uint32", Tensor(1), ctypes.c_uint32)
        self.check_refused(ValueError, r"on cuda:0; .*pass tensor\.cpu", Tensor(1, device="cuda:0"))
        self.check_refused(ValueError, r"shape \(2,\) is not contiguous.*pass tensor\.contig", Tensor(1, 2, contiguous=False))

    def test_what_is_no_array_is_refused(self):
        for value in ([1.0, 2.0], (ctypes.c_float * 2)(), 3.0, None):
            self.check_refused(TypeError, f"not {type(value).__name__}: numpy.asarray", value)

    def test_arrays_stay_alive(self):
        tensor = Tensor(5, 6, 7)
        alive = weakref.ref(tensor)
        importance = noisefloor.pointer(tensor)
        del tensor
        gc.collect()
        self.assertIsNotNone(alive())
        self.check_reached(importance)
        del importance
        gc.collect()
        self.assertIsNone(alive())

    def test_short_arrays_are_refused(self):
        table = noisefloor.Table(LIBRARY, 3, 1)
        for short in (noisefloor.pointer(Tensor(5, 6)), (ctypes.c_float * 2)(5, 6)):
            with self.assertRaisesRegex(ValueError, "importance has 2 elements for 3 items"):
                table.update((ctypes.c_uint32 * 3)(0, 1, 2), short)
            with self.assertRaisesRegex(ValueError, "importance has 2 elements for 3 items"):
                noisefloor.Table(LIBRARY, 3, 1, short)

    @unittest.skipUnless(installed("numpy"), "NumPy is not installed")
    def test_numpy(self):
        import numpy

        values = numpy.array([5, 6, 7], numpy.float32)
        self.check_reached(noisefloor.pointer(values))
        self.check_refused(TypeError, r"holds float64; .*float32: pass array\.astype", values.astype(numpy.float64))
        self.check_refused(TypeError, "holds >f4; .*float32", values.astype(">f4"))
        for view in (values[::2], values[::-1], numpy.ones((2, 3), numpy.float32).T):
            self.check_refused(ValueError, r"not contiguous.*pass numpy\.array", view)
        odd = numpy.frombuffer(bytes(9), numpy.float32, 2, 1)
        self.check_refused(ValueError, "not aligned", odd)
        # A temporary that nothing else holds.
        self.check_reached(noisefloor.pointer(values + 0))


class TrainingTest(unittest.TestCase):
    def trained(self, model, by_importance):
        before = model.errors(IMAGES, LABELS)[1]
        train_digits.train(LIBRARY, model, IMAGES, LABELS, 2, 1, by_importance)
        after, error = model.errors(IMAGES, LABELS)[1], model.errors(*digits.load("t10k"))[0]
        self.assertLess(after, before)
        self.assertLess(error, 0.5, "of ten classes")

    def test_plain_python_learns(self):
        for by_importance in (False, True):
            self.trained(digits.PlainModel(64, 10, 1), by_importance)

    @unittest.skipUnless(installed("torch"), "PyTorch is not installed")
    def test_torch_learns(self):
        import torch

        for by_importance in (False, True):
            self.trained(digits.torch_model(torch)(64, 10, 1), by_importance)

    def test_weighted_batches_are_unbiased_and_vary_less(self):
        """The exact mean and variance over draws, from the probabilities; then the mean over batches that were drawn."""
        model = digits.PlainModel(64, 10, 1)
        train_digits.train(LIBRARY, model, IMAGES, LABELS, 1, 1, False)
        items = len(LABELS)
        norms = model.importances(LIBRARY, IMAGES, LABELS)
        exact = model.gradient([1.0] * items)
        # The gradient of one item is delta x', so that a product with another matrix needs no matrix.
        deltas, inputs = model.deltas, [x + [1.0] for x in IMAGES]
        squares = [sum(d * d for d in delta) * sum(v * v for v in x) for delta, x in zip(deltas, inputs)]
        along = [
            sum(d * sum(map(float.__mul__, row, x)) for d, row in zip(delta, exact)) for delta, x in zip(deltas, inputs)
        ]
        table = noisefloor.Table(LIBRARY, items, 3, norms)
        p = [table.probability(i) for i in range(items)]
        self.assertAlmostEqual(sum(p), 1, places=4)
        uniform = sum(squares) / items - dot(exact, exact)
        importance = sum(s / (items * items * q) for s, q in zip(squares, p)) - dot(exact, exact)
        print(f"variance of a weighted draw's gradient over uniform sampling's: {importance / uniform:.3f}")
        self.assertLess(importance, uniform)

        draws = 200_000
        index, weight = table.draw(draws)
        values = [along[i] * w for i, w in zip(index, weight)]
        mean = sum(values) / draws
        variance = sum((value - mean) ** 2 for value in values) / (draws - 1)
        z = (mean - dot(exact, exact)) / (variance / draws) ** 0.5
        self.assertLess(abs(z), 4.5, "two-sided, one false alarm in 150,000 seeds; the seed is fixed")


if __name__ == "__main__":
    unittest.main()
