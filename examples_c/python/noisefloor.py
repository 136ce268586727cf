"""noisefloor's minibatches from Python, through ctypes: one file to copy, the standard library alone.

The prototypes below are those of noisefloor.h, letter by letter; `python3 noisefloor.py` prints a C file that a compiler
holds against the header. Arrays are anything that ctypes can point to: `(ctypes.c_float * n)()`, or a NumPy array or a
PyTorch tensor by `pointer`.
"""

import ctypes
import os
import re
import sys

PROTOTYPES = """
uint32_t nf_abi_version(void);
const char *nf_status_message(nf_status status);
void nf_rng_seed(nf_rng *rng, uint64_t seed);
uint32_t nf_shuffle(uint64_t seed, uint32_t items, uint32_t position);
size_t nf_table_size(uint32_t items);
nf_status nf_table_init(nf_table *table, void *memory, size_t bytes, uint32_t items, const float *importance);
nf_status nf_table_set_uniform_fraction(nf_table *table, float fraction);
nf_status nf_table_draw(const nf_table *table, nf_rng *rng, uint32_t batch, uint32_t *index, float *weight);
nf_status nf_table_update(nf_table *table, const uint32_t *index, const float *importance, uint32_t batch, float momentum);
float nf_table_probability(const nf_table *table, uint32_t item);
size_t nf_table_saved_size(const nf_table *table);
nf_status nf_table_save(const nf_table *table, void *saved, size_t len);
nf_status nf_table_load(nf_table *table, void *memory, size_t bytes, const void *saved, size_t len);
float nf_importance_cross_entropy(const float *logits, uint32_t classes, uint32_t label);
"""

ABI_VERSION = 1


class Rng(ctypes.Structure):
    """nf_rng."""

    _fields_ = [("state", ctypes.c_uint64), ("increment", ctypes.c_uint64)]


class TableStruct(ctypes.Structure):
    """nf_table; `Table` is what to use."""

    _fields_ = [
        ("importance", ctypes.POINTER(ctypes.c_float)),
        ("sums", ctypes.POINTER(ctypes.c_int64)),
        ("scale", ctypes.c_double),
        ("items", ctypes.c_uint32),
        ("blocks", ctypes.c_uint32),
        ("uniform_fraction", ctypes.c_float),
        ("magic", ctypes.c_uint32),
    ]


STRUCTS = {"nf_rng": Rng, "nf_table": TableStruct}
TYPES = {
    "float": ctypes.c_float,
    "int64_t": ctypes.c_int64,
    "nf_status": ctypes.c_int32,
    "size_t": ctypes.c_size_t,
    "uint32_t": ctypes.c_uint32,
    "uint64_t": ctypes.c_uint64,
    "double": ctypes.c_double,
    **STRUCTS,
}


def ctype(declaration):
    """The ctypes type of `const float *importance` and its like."""
    words = re.findall(r"\w+", declaration.replace("const ", ""))
    if "*" not in declaration:
        return None if words[0] == "void" else TYPES[words[0]]
    if words[0] in ("void", "char"):
        return ctypes.c_char_p if words[0] == "char" else ctypes.c_void_p
    return ctypes.POINTER(TYPES[words[0]])


def declare(library):
    """Gives every function of PROTOTYPES its types."""
    for line in PROTOTYPES.strip().splitlines():
        head, arguments = re.fullmatch(r"(.*?)\((.*)\);", line).groups()
        name = re.findall(r"\w+", head)[-1]
        function = getattr(library, name)
        function.restype = ctype(head[: head.index(name)])
        function.argtypes = [] if arguments == "void" else [ctype(argument) for argument in arguments.split(", ")]


def load(path=None):
    """The shared library: `path`, or $NOISEFLOOR_LIBRARY, or what the system's linker finds."""
    path = path or os.environ.get("NOISEFLOOR_LIBRARY") or f"libnoisefloor.so.{ABI_VERSION}"
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise OSError(f"cannot load {path}: {error}. Set NOISEFLOOR_LIBRARY to noisefloor's shared library") from None
    # First: a library of another version may lack functions.
    library.nf_abi_version.restype = ctypes.c_uint32
    if library.nf_abi_version() != ABI_VERSION:
        raise OSError(f"{path} has ABI version {library.nf_abi_version()}; this file is written for {ABI_VERSION}")
    declare(library)
    return library


def check(library, status):
    """Raises what a function that failed says."""
    if status != 0:
        raise ValueError("noisefloor: " + library.nf_status_message(status).decode())


# What NumPy and PyTorch call the elements of the library's arrays.
ELEMENTS = {ctypes.c_float: "float32", ctypes.c_uint32: "uint32"}


def pointer(array, element=ctypes.c_float):
    """A pointer to the first element of a contiguous NumPy array or PyTorch tensor of the CPU, not copied.

    It keeps the array alive, and has its number of elements as `length`. Anything else is refused, with what to do.
    """
    tensor = hasattr(array, "data_ptr")
    if not tensor and not hasattr(array, "__array_interface__"):
        raise TypeError(
            f"pointer() takes a NumPy array or a PyTorch tensor, not {type(array).__name__}: "
            f"numpy.asarray(values, dtype=numpy.{ELEMENTS[element]}), or ({element.__name__} * n)(*values) without pointer()"
        )
    kind = "tensor" if tensor else "array"
    if tensor and array.device.type != "cpu":
        raise ValueError(f"the tensor is on {array.device}; noisefloor reads the CPU's memory: pass tensor.cpu()")
    name = str(array.dtype).replace("torch.", "")
    if name != ELEMENTS[element]:
        # A NumPy dtype of the other byte order prints as ">f4".
        convert = f"tensor.to(torch.{ELEMENTS[element]})" if tensor else f"array.astype(numpy.{ELEMENTS[element]})"
        raise TypeError(f"the {kind} holds {name}; noisefloor reads {ELEMENTS[element]}: pass {convert}")
    if not (array.is_contiguous() if tensor else array.flags.c_contiguous and array.flags.aligned):
        copy = "tensor.contiguous()" if tensor else "numpy.array(array)"
        shape = tuple(array.shape)
        raise ValueError(f"the {kind} of shape {shape} is not contiguous, or not aligned, in memory: pass {copy}")
    result = ctypes.cast(array.data_ptr() if tensor else array.ctypes.data, ctypes.POINTER(element))
    result.array, result.length = array, array.numel() if tensor else array.size
    return result


def check_length(name, array, items):
    """Raises if a ctypes array or a `pointer` has fewer elements than the library would read."""
    length = array.length if hasattr(array, "length") else len(array)
    if length < items:
        raise ValueError(f"{name} has {length} elements for {items} items: pass one for each")


class Table:
    """An nf_table, its memory, and a generator. See docs/minibatch.md."""

    def __init__(self, library, items, seed, importance=None):
        self.library, self.table, self.rng = library, TableStruct(), Rng()
        # Eight-byte aligned, as every object of the library must be.
        self.memory = (ctypes.c_uint64 * ((library.nf_table_size(items) + 7) // 8))()
        library.nf_rng_seed(self.rng, seed)
        bytes_ = ctypes.sizeof(self.memory)
        if importance is not None:
            check_length("importance", importance, items)
        check(library, library.nf_table_init(self.table, self.memory, bytes_, items, importance))

    def draw(self, batch):
        """`batch` items and the weight 1 / (N p) of each, as two ctypes arrays."""
        index, weight = (ctypes.c_uint32 * batch)(), (ctypes.c_float * batch)()
        check(self.library, self.library.nf_table_draw(self.table, self.rng, batch, index, weight))
        return index, weight

    def update(self, index, importance, momentum=0.3):
        """The new importances of items that were visited: ctypes arrays, `importance` or a `pointer`."""
        check_length("importance", importance, len(index))
        check(self.library, self.library.nf_table_update(self.table, index, importance, len(index), momentum))

    def probability(self, item):
        """That of drawing the item now."""
        return self.library.nf_table_probability(self.table, item)

    def save(self):
        """The table as bytes, the same on every target. Keep `rng.state` and `rng.increment` beside them."""
        saved = ctypes.create_string_buffer(self.library.nf_table_saved_size(self.table))
        check(self.library, self.library.nf_table_save(self.table, saved, len(saved)))
        return saved.raw

    def restore(self, saved):
        """Makes it the table that `save` wrote, of as many items or fewer."""
        bytes_ = ctypes.sizeof(self.memory)
        check(self.library, self.library.nf_table_load(self.table, self.memory, bytes_, saved, len(saved)))


def c_check():
    """A C11 file that compiles only if these declarations are the header's."""
    lines = ['#include "noisefloor.h"', f"_Static_assert(NF_ABI_VERSION == {ABI_VERSION}, \"version\");"]
    for name, struct in STRUCTS.items():
        lines.append(f'_Static_assert(sizeof({name}) == {ctypes.sizeof(struct)}, "size of {name}");')
        for field, type_ in struct._fields_:
            here = getattr(struct, field)
            lines.append(f'_Static_assert(offsetof({name}, {field}) == {here.offset}, "{name}.{field}");')
            lines.append(f'_Static_assert(sizeof((({name} *)0)->{field}) == {here.size}, "{name}.{field}");')
    # Declared again: an error unless the types are the same.
    return "\n".join(lines) + PROTOTYPES


if __name__ == "__main__":
    sys.stdout.write(c_check())
