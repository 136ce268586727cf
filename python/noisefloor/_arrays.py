"""Arrays of anybody's, made into those that the library reads, and refusals that name what is wrong."""

import math
import sys
import warnings

import numpy

#: The largest number of 32 bits: of those that the library counts items in.
MAX_U32 = 2**32 - 1


def array(name, value):
    """NumPy's view of a NumPy, PyTorch or JAX array, of anything with a buffer, DLPack or an array interface, or a copy
    of numbers in lists. Tensors on other devices are copied."""
    if isinstance(value, numpy.ma.MaskedArray):
        raise TypeError(f"{name} is a masked array: fill it, or leave out what is masked")
    if isinstance(value, numpy.ndarray):
        return value
    try:
        if isinstance(value, getattr(sys.modules.get("torch"), "Tensor", ())):
            value = value.detach().cpu().resolve_conj().resolve_neg()
            # NumPy has no bfloat16.
            value = value.float() if value.is_floating_point() and value.element_size() < 4 else value
            return value.numpy()
        if not hasattr(value, "__array__") and hasattr(value, "__dlpack__"):
            return numpy.from_dlpack(value)
        return numpy.asarray(value)
    except (BufferError, RuntimeError, TypeError, ValueError) as error:
        _refuse_traced(name, value)
        kind = ValueError if isinstance(error, ValueError) else TypeError
        raise kind(f"{name} is no array of numbers: {error}") from None


def _refuse_traced(name, value):
    """Says of JAX's stand-ins for arrays what to do."""
    if isinstance(value, getattr(sys.modules.get("jax.core"), "Tracer", ())):
        words = "call this outside of jit, grad and vmap, or within jax.experimental.io_callback"
        raise TypeError(f"{name} is traced by JAX and has no numbers yet: {words}") from None


def floats(name, value, kind=numpy.float32):
    """Numbers of float32, or of another kind, row after row. What is beyond that becomes infinite, and is refused: by
    `check_finite` as it was given."""
    view = array(name, value)
    # JAX's bfloat16 is none of NumPy's kinds.
    if view.dtype.kind not in "fiub" and view.dtype.name != "bfloat16":
        raise TypeError(f"{name} holds {view.dtype}: real numbers are expected, of NumPy's kinds or bfloat16")
    with numpy.errstate(over="ignore"):
        return plain(view, kind)


def plain(view, kind):
    """Numbers of a kind, row after row, where the library reads them: at multiples of their size."""
    numbers = numpy.asarray(view, kind, order="C")
    return numbers if numbers.flags.aligned else numbers.copy()


def warn_of_lost_digits(name, view, axis=None, what="a constant"):
    """Warns where numbers, those along the axis say, as float32 are some thousand different ones at most, though they
    need not be; and where all are so small that float32 has too few digits for them."""
    if view.dtype.kind not in "fiu" or view.itemsize <= 4 or view.size == 0:
        return
    least, most = float(view.min()), float(view.max())
    largest = max(abs(least), abs(most))
    words = None
    if 0 < largest < 2**-126:
        words = "which has few digits, or none, for such: multiply by a constant, and divide the mean"
    elif math.isfinite(largest):
        low, high = numpy.array([least]), numpy.array([most])
        if axis is not None:
            each = numpy.moveaxis(view, axis, -1)
            # Where two are apart, all are.
            each = each[_are_near(*(each[..., k].astype(numpy.float64) for k in (0, -1)))]
            low, high = (of(each, axis=-1).astype(numpy.float64) for of in (numpy.min, numpy.max))
        lost = _are_near(low, high) & (low < high)
        if lost.any():
            least, most = low[numpy.argmax(lost)], high[numpy.argmax(lost)]
            words = f"which has 7 digits: subtract {what}, and add its integral to the mean"
    if words:
        told = f"{name} is {least:.9g} to {most:.9g}, and rounded to float32, {words}"
        warnings.warn(told, RuntimeWarning, stacklevel=3)


def _are_near(a, b):
    """Whether numbers differ by less than 2^-14 of the larger one."""
    # Halves: their difference does not overflow.
    return abs(a / 2 - b / 2) < numpy.maximum(abs(a), abs(b)) * 2**-15


def integers(name, value, most):
    """uint32 numbers from 0 to most, row after row, as many as the library counts."""
    view = array(name, value)
    if view.size > MAX_U32:
        raise ValueError(f"{name} has {view.size} numbers: {MAX_U32} are the most")
    if view.dtype.kind not in "iu":
        if view.size:
            raise TypeError(f"{name} holds {view.dtype}: integers are expected")
        view = view.astype(numpy.int64)
    check(name, view, (view >= 0) & (view <= most), f"0 to {most}")
    return plain(view, numpy.uint32)


def integer(name, value, least, most):
    """An int from least to most."""
    try:
        number = value.__index__()
    except (AttributeError, TypeError):
        _refuse_traced(name, value)
        raise TypeError(f"{name} is {value!r}: an integer is expected") from None
    if not least <= number <= most:
        raise ValueError(f"{name} is {number}: it must be {least} to {most}")
    return number


def number(name, value, least, most):
    """A float from least to most."""
    try:
        result = value.__float__()
    except (AttributeError, TypeError, ValueError):
        _refuse_traced(name, value)
        raise TypeError(f"{name} is {value!r}: a number is expected") from None
    except OverflowError:
        raise ValueError(f"{name} is an integer beyond a float's range: it must be {least} to {most}") from None
    if not least <= result <= most:
        raise ValueError(f"{name} is {result}: it must be {least} to {most}")
    return result


def one_of(name, value, choices):
    """What a name stands for."""
    try:
        return choices[value]
    except (KeyError, TypeError):
        raise ValueError(f"{name} is {value!r}: it must be one of {', '.join(map(repr, choices))}") from None


def parts(state, *names):
    """These parts of a saved state."""
    try:
        return [state[name] for name in names]
    except (IndexError, TypeError):
        raise TypeError(f"the state is a {type(state).__name__}: what state_dict() returned is expected") from None
    except KeyError as error:
        raise ValueError(f"the state has no {error}: it must be state_dict()'s, of this version") from None


def broadcast(arrays):
    """The leading dimensions of arrays, named, each with how many axes are its own; and the arrays with these."""
    leadings = {name: array.shape[: array.ndim - axes] for name, (array, axes) in arrays.items()}
    try:
        leading = numpy.broadcast_shapes(*leadings.values())
    except ValueError:
        words = ", ".join(f"{name} {array.shape}" for name, (array, _) in arrays.items())
        raise ValueError(f"the leading dimensions of {words} do not broadcast") from None
    return leading, {
        name: numpy.broadcast_to(array, leading + array.shape[len(leadings[name]) :])
        for name, (array, _) in arrays.items()
    }


def some_of(array, dims, some):
    """Those of a range, counted over the first `dims` axes, one after the other: copied if they are broadcast."""
    if array.flags.c_contiguous:
        return array.reshape(-1, *array.shape[dims:])[some.start : some.stop]
    places = numpy.unravel_index(numpy.arange(some.start, some.stop), array.shape[:dims])
    return numpy.ascontiguousarray(array[places])


def check(name, values, good, allowed):
    """Refuses the first element that is not good."""
    if not numpy.all(good):
        at = numpy.unravel_index(numpy.argmin(good), values.shape)
        element = f"[{', '.join(map(str, at))}]" if at else ""
        raise ValueError(f"{name}{element} is {values[at]}: it must be {allowed}")


def check_shape(name, values, expected, meaning):
    """Refuses an array or tensor of another shape."""
    if tuple(values.shape) != expected:
        raise ValueError(f"{name} has the shape {tuple(values.shape)}: it must be {expected}, {meaning}")


def check_finite(name, view):
    """Numbers of an array as float32; refuses what is then not finite."""
    narrow = floats(name, view)
    check(name, view, numpy.isfinite(narrow), "finite, and within float32's range, 3.4e38")
    return narrow


def check_positive(name, view):
    """Numbers of an array as float32; refuses what is then no finite number of at least 0."""
    narrow = floats(name, view)
    check(name, view, numpy.isfinite(narrow) & (narrow >= 0), "at least 0 and finite, within float32's range, 3.4e38")
    return narrow
