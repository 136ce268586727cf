"""The C declarations that the package uses, all of them: of noisefloor.h's structs, constants and functions.

A test compiles them beside the header and refuses what differs. Other modules call the functions below without `nf_`.
"""

import ctypes
import os
import re

import numpy

ABI_VERSION = 1
FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "native")
LIBRARY = os.path.join(FOLDER, "lib", f"libnoisefloor.so.{ABI_VERSION}")

u16, u32, u64, f32, pointer = (
    ctypes.c_uint16,
    ctypes.c_uint32,
    ctypes.c_uint64,
    ctypes.c_float,
    ctypes.c_void_p,
)


def _fields(kind, names):
    return [(name, kind) for name in names.split()]


class Config(ctypes.Structure):
    """How to estimate."""

    C_NAME = "nf_cv_config"
    _fields_ = _fields(
        u32,
        "dims order channels estimator basis stratified slices edges controls stride solver precision nonfinite color "
        "folds",
    ) + _fields(f32, "ridge")


class Samples(ctypes.Structure):
    """Samples of integrals."""

    C_NAME = "nf_cv_samples"
    _fields_ = (
        _fields(pointer, "u f")
        + [("n", ctypes.c_size_t)]
        + _fields(pointer, "controls control_integrals known known_integrals")
    )


class Rectangle(ctypes.Structure):
    """Some pixels of an image."""

    C_NAME = "nf_cv_rectangle"
    _fields_ = _fields(u32, "x y width height")


class Image(ctypes.Structure):
    """The pixels of an image, and what is known of them."""

    C_NAME = "nf_cv_image"
    _fields_ = (
        _fields(u32, "width height frames window stride unordered")
        + [("samples", ctypes.c_size_t)]
        + _fields(pointer, "surfaces factors")
        + _fields(Rectangle, "given wanted")
    )


class Recommendation(ctypes.Structure):
    """What to use."""

    C_NAME = "nf_recommendation"
    _fields_ = (
        _fields(u32, "method image_stride tile_samples tile_dims")
        + _fields(f32, "error filtered_error cost pays_from")
        + [("config", Config)]
    )


class Sampler(ctypes.Structure):
    """A sample of a pixel."""

    C_NAME = "nf_sampler"
    _fields_ = _fields(u32, "domain index") + _fields(u16, "x y") + _fields(u32, "flags")


class Rng(ctypes.Structure):
    """A generator of random numbers."""

    C_NAME = "nf_rng"
    _fields_ = _fields(u64, "state increment")


class Table(ctypes.Structure):
    """The importances of a data set's items."""

    C_NAME = "nf_table"
    _fields_ = (
        _fields(pointer, "importance sums")
        + [("scale", ctypes.c_double)]
        + _fields(u32, "items blocks")
        + [("uniform_fraction", f32), ("magic", u32)]
    )


class Estimate(ctypes.Structure):
    """An estimate of one integral."""

    C_NAME = "nf_estimate"
    _fields_ = [("mean", f32 * 4), ("std_error", f32 * 4), ("samples", u32), ("gain", f32)]


STRUCTS = (Config, Samples, Rectangle, Image, Recommendation, Sampler, Rng, Table, Estimate)
#: Estimates as an array of NumPy's.
ESTIMATE = numpy.dtype(Estimate)

CONSTANTS = dict(
    NF_ABI_VERSION=ABI_VERSION,
    NF_ERR_MEMORY=-4,
    NF_CHECK_CV_CONFIG=0,
    NF_CHECK_CV_IMAGE=1,
    NF_CV_ROBUST=0,
    NF_CV_LEAST_SQUARES=1,
    NF_CV_LEAVE_ONE_OUT=2,
    NF_CV_K_FOLD=3,
    NF_CV_GRADIENT_DESCENT=4,
    NF_CV_INCREMENTAL=5,
    NF_BASIS_LEGENDRE=0,
    NF_BASIS_STEP=1,
    NF_BASIS_SINE=2,
    NF_BASIS_GAUSSIAN=3,
    NF_SOLVER_AUTO=0,
    NF_SOLVER_NORMAL_EQUATIONS=1,
    NF_SOLVER_SQUARE_ROOT=2,
    NF_SOLVER_DUAL=3,
    NF_RIDGE_AUTO=-1.0,
    NF_METHOD_PLAIN_MEAN=0,
    NF_METHOD_PER_PIXEL=1,
    NF_METHOD_SHARED=2,
    NF_OMIS_RIDGE=0,
    NF_OMIS_PLAIN=1,
    NF_OMIS_BALANCE=3,
    NF_MIS_MAX_TECHNIQUES=16,
    NF_TABLE_SAVED_HEADER=32,
)


def _names(prefix):
    """The constants of a prefix by their names in Python."""
    return {name[len(prefix) :].lower(): value for name, value in CONSTANTS.items() if name.startswith(prefix)}


ESTIMATORS, BASES, SOLVERS, METHODS, OMIS_SOLVERS = map(
    _names, ("NF_CV_", "NF_BASIS_", "NF_SOLVER_", "NF_METHOD_", "NF_OMIS_")
)
MAX_DIMS, MAX_ORDER, MAX_CHANNELS, MAX_TERMS, MAX_CONTROLS, MAX_DUAL = 16, 7, 4, 136, 4, 4096

FUNCTIONS = """
uint32_t nf_abi_version(void);
const char *nf_status_message(nf_status);
const char *nf_check(uint32_t, const void *);
size_t nf_cv_workspace_size(const nf_cv_config *, size_t);
nf_status nf_cv_estimate(const nf_cv_config *, const nf_cv_samples *, size_t, void *, size_t, nf_estimate *);
size_t nf_cv_image_workspace_size(const nf_cv_config *, const nf_cv_image *, const nf_cv_samples *);
nf_status nf_cv_image_estimate(const nf_cv_config *, const nf_cv_image *, const nf_cv_samples *, void *, size_t,
    nf_estimate *);
nf_status nf_recommend(uint32_t, uint32_t, uint32_t, uint32_t, float, nf_recommendation *);
nf_sampler nf_sampler_pixel(uint32_t, uint32_t, uint32_t, uint32_t);
nf_sampler nf_sampler_white(uint32_t, uint32_t, uint32_t, uint32_t);
nf_sampler nf_sampler_domain(nf_sampler, uint32_t);
nf_sampler nf_sampler_scramble(nf_sampler, uint32_t);
const uint32_t *nf_sampler_table(void);
nf_status nf_sampler_fill(const nf_sampler *, const uint32_t *, size_t, uint32_t, uint32_t, uint32_t, float *, size_t);
void nf_rng_seed(nf_rng *, uint64_t);
size_t nf_table_size(uint32_t);
nf_status nf_table_init(nf_table *, void *, size_t, uint32_t, const float *);
nf_status nf_table_draw(const nf_table *, nf_rng *, uint32_t, uint32_t *, float *);
nf_status nf_table_draw_stratified(const nf_table *, nf_rng *, uint32_t, uint32_t *, float *);
nf_status nf_table_draw_distinct(nf_table *, nf_rng *, uint32_t, uint32_t *, float *);
nf_status nf_table_update(nf_table *, const uint32_t *, const float *, uint32_t, float);
nf_status nf_table_append(nf_table *, const float *, uint32_t);
nf_status nf_table_probabilities(const nf_table *, const uint32_t *, uint32_t, uint32_t, float *);
nf_status nf_table_save(const nf_table *, void *, size_t);
nf_status nf_table_load(nf_table *, void *, size_t, const void *, size_t);
nf_status nf_shuffle(uint64_t, uint32_t, uint64_t, uint32_t, uint32_t *);
size_t nf_omis_size(uint32_t, uint32_t);
nf_status nf_omis_init(void *, size_t, uint32_t, uint32_t, const uint32_t *, nf_omis **);
nf_status nf_omis_add(nf_omis *, const float *, const uint32_t *, const float *, size_t);
nf_status nf_omis_solve(const nf_omis *, uint32_t, float, float *, float *);
nf_status nf_omis_weights(uint32_t, float, uint32_t, uint32_t, const float *, const uint32_t *, uint32_t, float *);
"""

_TYPES = {
    "void": None,
    "size_t": ctypes.c_size_t,
    "uint32_t": u32,
    "uint64_t": u64,
    "float": f32,
    "nf_status": ctypes.c_int32,
    "nf_sampler": Sampler,
}


def _type(text):
    """Python's type for C's: addresses are plain numbers."""
    if text.endswith("*"):
        return ctypes.c_char_p if "char" in text else pointer
    return _TYPES[text]


def _load():
    """The functions by their names without `nf_`."""
    try:
        library = ctypes.CDLL(LIBRARY)
    except OSError as error:
        raise ImportError(f"{error}. `pip install ./python`, from a clone, builds the library") from None
    found = library.nf_abi_version()
    if found != ABI_VERSION:
        raise ImportError(f"{LIBRARY} has ABI version {found}, and this package was written for {ABI_VERSION}")
    functions = {}
    for result, name, arguments in re.findall(r"([^;]*?)nf_(\w+)\(([^)]*)\);", FUNCTIONS):
        function = getattr(library, f"nf_{name}")
        function.restype = _type(result.strip())
        function.argtypes = [_type(argument.strip()) for argument in arguments.split(",") if argument != "void"]
        functions[name] = function
    return functions


globals().update(_load())
DRAWS = {"iid": table_draw, "stratified": table_draw_stratified, "distinct": table_draw_distinct}  # noqa: F821


def message(status):
    """The library's sentence for a status."""
    return status_message(status).decode()  # noqa: F821


def wrong(what):
    """What is wrong with a configuration or an image: the field and its range in words, or None."""
    kinds = {Config: "NF_CHECK_CV_CONFIG", Image: "NF_CHECK_CV_IMAGE"}
    words = check(CONSTANTS[kinds[type(what)]], address(what))  # noqa: F821
    return words and words.decode()


def default_config():
    """A configuration with the library's defaults."""
    return Config(dims=2, order=2, channels=1)


address = ctypes.addressof


def data(array):
    """Where an array's numbers are, or None for no array."""
    return None if array is None else array.__array_interface__["data"][0]


def workspace(size):
    """Memory for the library, aligned as it needs."""
    return numpy.empty((size + 7) // 8, numpy.uint64)
