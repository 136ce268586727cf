"""noisefloor's sampler as a plugin of Mitsuba 3: `register()`, then `{"type": "noisefloor"}`. README.md says how.

In LLVM and CUDA variants the draws are recorded by Dr.Jit, with the bits of nf_sampler_draw(); the library gives the
table alone. In scalar variants every draw is a call of the library.
"""

import ctypes
import os

import drjit as dr
import mitsuba as mi

ABI_VERSION = 1
SIZE, BITS = 32, 6  # the table's pixels on a side, and the leading bits of a value that it is indexed by
FRAMES = 0x6672616D
FINE = 0x9E3779B9, 0xC13FA9A9


class _State(ctypes.Structure):
    """nf_sampler"""

    _fields_ = [("domain", ctypes.c_uint32), ("index", ctypes.c_uint32), ("x", ctypes.c_uint16),
                ("y", ctypes.c_uint16), ("flags", ctypes.c_uint32)]  # fmt: skip


def load(path=None):
    """The shared library: `path`, or $NOISEFLOOR_LIBRARY, or what the system's linker finds."""
    path = path or os.environ.get("NOISEFLOOR_LIBRARY") or f"libnoisefloor.so.{ABI_VERSION}"
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise OSError(f"cannot load {path}: {error}. Set NOISEFLOOR_LIBRARY to noisefloor's shared library") from None
    u32, state = ctypes.c_uint32, _State
    library.nf_abi_version.restype = u32
    if library.nf_abi_version() != ABI_VERSION:
        raise OSError(f"{path} has ABI version {library.nf_abi_version()}; this file is written for {ABI_VERSION}")
    for name, result, arguments in (
        ("nf_sampler_pixel", state, [u32] * 4),
        ("nf_sampler_white", state, [u32] * 4),
        ("nf_sampler_domain", state, [state, u32]),
        ("nf_sampler_draw", None, [state, u32, ctypes.POINTER(ctypes.c_float)]),
        ("nf_sampler_table", ctypes.POINTER(u32), []),
    ):
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


_library = None
# By variant. Not an attribute of the samplers: recorded loops would take it for a part of their state.
_tables = {}


def library():
    global _library
    _library = _library or load()
    return _library


def _table():
    variant = mi.variant()
    if variant not in _tables:
        _tables[variant] = mi.UInt32(library().nf_sampler_table()[: SIZE * SIZE << BITS])
        dr.eval(_tables[variant])
    return _tables[variant]


def _mix(h):
    h = (h ^ (h >> 16)) * 0x85EBCA6B
    h = (h ^ (h >> 13)) * 0xC2B2AE35
    return h ^ (h >> 16)


def _child(domain, key):
    h = _mix((key + 0x9E3779B9) ^ (domain * 0x2C9277B5))
    return dr.select(h == 0, mi.UInt32(1), h)


def draw2(domain, x, y, first):
    """Two numbers, for arrays of domains, pixels (hashed, if white) and reversed indices: nf_sampler_draw()."""
    random = domain + x * 0x2C1B3C6D + y * 0x297A2D39
    random = (random ^ (random >> 15)) * 0x735A2D97
    random ^= random >> 15
    ordered = first ^ (first * (random << 1))
    ordered = ordered * ((random >> 15) | 1)
    is_root = domain == 0
    first = dr.select(is_root, first, ordered)

    def bit(k):
        return ((domain >> k) & 1) != 0

    flipped = bit(31)
    x, y = dr.select(flipped, y, x), dr.select(flipped, x, y)
    x = dr.select(bit(30), ~x, x) + domain
    y = dr.select(bit(29), ~y, y) + (domain >> 8)
    pixel = ((y & (SIZE - 1)) << 5) | (x & (SIZE - 1))

    second = first ^ (first << 16)
    for mask, shift in ((0x00FF00FF, 8), (0x0F0F0F0F, 4), (0x33333333, 2), (0x55555555, 1)):
        second ^= (second & mask) << shift

    def entry(value):
        return dr.gather(mi.UInt32, _table(), (pixel << BITS) | (value >> (32 - BITS)))

    values = first ^ (entry(first) << 16), second ^ (entry(second) & 0xFFFF0000)
    fine = [v ^ ((((pixel << 8) | (v >> 24)) * factor) >> 8) for v, factor in zip(values, FINE)]
    return [mi.Float(v >> 8) * (1 / 16777216) for v in fine]


def _jit_sampler():
    class NoisefloorSampler(mi.Sampler):
        """Dimensions are counted, and the count is the domain's key; the seed is the frame."""

        def __init__(self, props):
            super().__init__(props)
            self.white = bool(props.get("white", False))
            self.size = int(props.get("width", 0)), int(props.get("height", 0))
            self.per_wave = 1
            self._clear()

        def _clear(self):
            self.x, self.y, self.index, self.base, self.dimension = (mi.UInt32(0) for _ in range(5))

        def seed(self, seed, wavefront_size=2**32 - 1):
            super().seed(seed, wavefront_size)
            self._clear()
            if wavefront_size == 1:  # how Mitsuba frees a sampler's memory
                return
            width, height = self.size
            # Not what set_samples_per_wavefront() said: integrators' calls do not come as far as here.
            self.per_wave, rest = divmod(wavefront_size, max(width * height, 1))
            if width < 1 or height < 1 or rest:
                raise ValueError(
                    f"noisefloor: the sampler takes its film for {width} x {height} pixels, and {wavefront_size} "
                    "samples are not so many times a number. Call noisefloor_mitsuba.prepare(scene) once the scene is "
                    "loaded, and after a film's size has changed, or give the plugin `width` and `height`")  # fmt: skip
            # Opaque: as a literal it would be part of the kernel, and every seed would compile one.
            seed = mi.UInt32(seed)
            self.base = dr.select(seed == 0, mi.UInt32(0), _child(mi.UInt32(FRAMES), seed))
            dr.make_opaque(self.base)
            wave = dr.arange(mi.UInt32, wavefront_size)
            pixel = wave // self.per_wave
            self.index = wave - pixel * self.per_wave
            self.y = pixel // width
            self.x = pixel - self.y * width
            if self.white:
                at = _mix((self.x & 0xFFFF) | (self.y << 16))
                self.x, self.y = at & 0xFFFF, at >> 16

        def advance(self):
            self.index = self.index + self.per_wave
            self.dimension = mi.UInt32(0)

        def schedule_state(self):
            dr.schedule(self.x, self.y, self.index, self.base, self.dimension)

        def _copy(self):
            props = mi.Properties()
            props["sample_count"], props["white"] = self.sample_count(), self.white
            props["width"], props["height"] = self.size
            return type(self)(props)

        def fork(self):
            return self._copy()

        def clone(self):
            other = self._copy()
            if self.wavefront_size():
                other.seed(0, self.wavefront_size())
            # Arrays of their own: a loop that changes one sampler must not change the other.
            for name in ("x", "y", "index", "base", "dimension"):
                setattr(other, name, mi.UInt32(getattr(self, name)))
            return other

        def _draw(self, count):
            domain = _child(self.base, self.dimension)
            self.dimension = self.dimension + count
            return draw2(domain, self.x, self.y, dr.brev(self.index))

        def next_1d(self, active=True):
            return self._draw(1)[0]

        def next_2d(self, active=True):
            return mi.Point2f(*self._draw(2))

        def to_string(self):
            return f"NoisefloorSampler[sample_count={self.sample_count()}, white={self.white}, size={self.size}]"

    return NoisefloorSampler


def _scalar_sampler():
    class NoisefloorSampler(mi.Sampler):
        """A scalar renderer says a seed, but not which pixel: so every pixel is well sampled, but nothing is arranged
        across pixels. nf_sampler_white()."""

        def __init__(self, props):
            super().__init__(props)
            self.number, self.index, self.dimension = 0, 0, 0
            self._begin()

        def _begin(self):
            self.state = library().nf_sampler_white(self.number & 0xFFFF, self.number >> 16, 0, self.index)
            self.dimension = 0

        def seed(self, seed, wavefront_size=1):
            self.number, self.index = seed & 0xFFFFFFFF, 0
            self._begin()

        def advance(self):
            self.index += 1
            self._begin()

        def schedule_state(self):
            pass

        def fork(self):
            props = mi.Properties()
            props["sample_count"] = self.sample_count()
            return type(self)(props)

        def clone(self):
            other = self.fork()
            other.number, other.index = self.number, self.index
            other._begin()
            other.dimension = self.dimension
            return other

        def _draw(self, count):
            u = (ctypes.c_float * 2)()
            library().nf_sampler_draw(library().nf_sampler_domain(self.state, self.dimension), 2, u)
            self.dimension += count
            return u

        def next_1d(self, active=True):
            return self._draw(1)[0]

        def next_2d(self, active=True):
            return mi.Point2f(*self._draw(2))

        def to_string(self):
            return f"NoisefloorSampler[sample_count={self.sample_count()}, scalar]"

    return NoisefloorSampler


def register():
    """Makes the plugin `noisefloor` known to the variant that is set."""
    library()
    is_jit = mi.variant().startswith(("llvm", "cuda"))
    sampler = (_jit_sampler if is_jit else _scalar_sampler)()
    mi.register_sampler("noisefloor", lambda props: sampler(props))


def prepare(scene):
    """Tells the samplers of the scene's sensors how large their films are; returns the scene."""
    for sensor in scene.sensors():
        film, sampler = sensor.film(), sensor.sampler()
        if hasattr(sampler, "size"):
            border = 2 * film.rfilter().border_size() if film.sample_border() else 0
            sampler.size = tuple(int(length) + border for length in film.crop_size())
    return scene
