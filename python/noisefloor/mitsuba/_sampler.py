"""The plugin `noisefloor`, a sampler.

The draws are recorded by Dr.Jit, with the bits of nf_sampler_draw(); the library gives the table alone.
"""

import ctypes
import math
import weakref

import drjit as dr
import mitsuba as mi
import numpy

from .. import _c

SIZE, BITS = 32, 6  # the table's pixels on a side, and the leading bits of a value that it is indexed by
FRAMES, SCRAMBLED = 0x6672616D, 0x73637261
FINE = 0x9E3779B9, 0xC13FA9A9
# The matrix of the second two of four numbers, and where further digits are added.
COLUMNS = (0x80000000, 0x40000000, 0xA0000000, 0xD0000000, 0x68000000, 0xFC000000, 0x72000000, 0xAB000000, 0xCB800000)
FURTHER = 6, 8, 9, 10, 16

# By variant. Not an attribute of the samplers: recorded loops would take it for a part of their state.
_tables = {}

# By sampler, films and whether there is a lens; not attributes, either. Films hold no samplers, so that nothing is kept
# alive in a circle.
_films = weakref.WeakKeyDictionary()


def table() -> "mi.UInt32":
    """The numbers that samplers read, on the variant's device: state of a function that `drjit.freeze` records.

    First the library's, then one for samples of which the first digits are all: of these it has both coordinates'
    leading digits, in one place.
    """
    variant = mi.variant()
    if variant not in _tables:
        numbers = ctypes.cast(_c.sampler_table(), ctypes.POINTER(ctypes.c_uint32))
        entries = numpy.ctypeslib.as_array(numbers, (SIZE * SIZE, 1 << BITS))
        first = numpy.arange(1 << BITS, dtype=numpy.uint32) << (32 - BITS)
        second = _pascal(first)
        leading = ((first >> 16) ^ (entries & 0xFFFF)) | (second ^ (entries[:, second >> (32 - BITS)] & 0xFFFF0000))
        _tables[variant] = mi.UInt32(numpy.concatenate([entries, leading], None))
        dr.eval(_tables[variant])
    return _tables[variant]


def _mix(h):
    h = (h ^ (h >> 16)) * 0x85EBCA6B
    h = (h ^ (h >> 13)) * 0xC2B2AE35
    return h ^ (h >> 16)


def _child(domain, key):
    h = _mix((mi.UInt32(key) * 0x9E3779B9) ^ domain)
    return dr.select(h == 0, mi.UInt32(0x2C9277B5), h)


def draw(domain, at, first, second=False, scrambled=False, few=False):
    """Two numbers of nf_sampler_draw(), of four the second two: for arrays of domains, pixels (the row in the upper
    half; hashed, if white) and reversed indices. With `few`, where all indices are below 2^BITS."""
    random = domain + ((at + domain) & 0xFFF8FFF8) * 0x2C1B3C6D
    random = (random ^ (random >> 15)) * 0x735A2D97
    random ^= random >> 15
    ordered = first ^ (first * (random << 1))
    ordered = ordered * ((random >> 15) | 1)
    first = dr.select(domain == 0, first, ordered)
    x, y = _move(domain, at, at >> 16)
    if second:
        x, y, first = x + 11, y + 5, _multiply(first)
    values = _pair(((y & (SIZE - 1)) << 5) | (x & (SIZE - 1)), first, few)
    if scrambled:
        number = 3 if second else 1
        values = [v ^ _mix(domain + (FINE[0] * (number + k) & 0xFFFFFFFF)) for k, v in enumerate(values)]
    return [mi.Float(v >> 8) * (1 / 16777216) for v in values]


def _move(domain, x, y):
    """Where in the table the domain's pixel is."""

    def bit(k):
        return ((domain >> k) & 1) != 0

    flipped = bit(31)
    x, y = dr.select(flipped, y, x), dr.select(flipped, x, y)
    return dr.select(bit(30), ~x, x) + domain, dr.select(bit(29), ~y, y) + (domain >> 8)


def _multiply(first):
    result = first & 0x007FFFFF
    for places in FURTHER:
        result ^= result << places
    for k, column in enumerate(COLUMNS):
        result ^= dr.select(((first >> (31 - k)) & 1) != 0, mi.UInt32(column), mi.UInt32(0))
    return result


def _pascal(first):
    second = first ^ (first << 16)
    for mask, shift in ((0x00FF00FF, 8), (0x0F0F0F0F, 4), (0x33333333, 2), (0x55555555, 1)):
        second ^= (second & mask) << shift
    return second


def _pair(pixel, first, few):
    def entry(value, begin=0):
        return dr.gather(mi.UInt32, table(), begin | (pixel << BITS) | (value >> (32 - BITS)))

    if few:
        leading = entry(first, SIZE * SIZE << BITS)
        values = leading << 16, leading & 0xFFFF0000
    else:
        second = _pascal(first)
        values = first ^ (entry(first) << 16), second ^ (entry(second) & 0xFFFF0000)
    return [v ^ ((((pixel << 8) | (v >> 24)) * factor) >> 8) for v, factor in zip(values, FINE)]


def _size(film):
    """How many pixels get samples, those of the border included."""
    border = 2 * film.rfilter().border_size() if film.sample_border() else 0
    return tuple(int(length) + border for length in film.crop_size())


def option(props, plugin, name, default, least=0, most=2**31 - 1):
    """A property of the default's type, and of numbers within the range."""
    value = props.get(name, default)
    if type(value) is not type(default):
        kind = "an integer" if type(default) is int else "a boolean"
        raise ValueError(f"{plugin}: {name} is {value!r}: {kind} is expected")
    if not least <= value <= most:
        raise ValueError(f"{plugin}: {name} is {value}: it must be {least} to {most}")
    return value


def kind():
    """The class of samplers of the variant that is set."""

    class NoisefloorSampler(mi.Sampler):
        """Dimensions are counted, and the count is the domain's key; the seed is the frame. With a lens the place on
        the film and that on the lens, the first two requests, are four numbers of one domain."""

        def __init__(self, props):
            super().__init__(props)
            if not self.sample_count():
                raise ValueError("noisefloor: sample_count is 0: it must be 1 at least")
            names = "white", "scramble", "lens"
            self.white, self.scramble, self.lens = (option(props, "noisefloor", name, False) for name in names)
            self.size = tuple(option(props, "noisefloor", name, 0) for name in ("width", "height"))
            self.corner = 0, 0
            self.first = option(props, "noisefloor", "seed", 0, most=2**32 - 1)  # the frame of seed 0
            self.per_wave = self.most = 1
            self._clear()

        def follow(self, *sensors):
            """The film of the sensor that is rendered says from now on how large it is."""
            _films[self] = list(dict.fromkeys((sensor.film(), sensor.needs_aperture_sample()) for sensor in sensors))
            self._fit(_films[self][0])

        def _fit(self, of):
            film, self.lens = of
            self.size, self.corner = _size(film), tuple(film.crop_offset())

        def _choose(self, films, wavefront_size):
            """Of several films that which is rendered: nobody says more of it than how many samples it has."""
            spp = self.sample_count()
            passes = [(of, *divmod(wavefront_size, math.prod(_size(of[0])))) for of in films]
            fitting = [of for of, count, rest in passes if count == spp and not rest]
            # An integrator may take a part of the samples at a time.
            fitting = fitting or [of for of, count, rest in passes if count and not rest and spp % count == 0]
            found = set()
            for of in fitting or films[:1]:
                self._fit(of)
                found.add((self.size, self.corner, self.lens))
            if len(found) > 1:
                raise ValueError(
                    "noisefloor: sensors share this sampler, and which of them is rendered cannot be told: they differ "
                    "in film, crop or lens. Mitsuba makes equal samplers one: load the scene with `optimize=False`"
                )

        def _clear(self):
            self.at, self.index, self.base, self.dimension = (mi.UInt32(0) for _ in range(4))
            self.requests = 0  # right outside of recorded loops only

        def seed(self, seed, wavefront_size=2**32 - 1):
            super().seed(seed, wavefront_size)
            self._clear()
            films = _films.get(self, ())
            if len(films) == 1:
                self._fit(films[0])
            elif films:
                self._choose(films, self.wavefront_size())
            wavefront_size, (width, height) = self.wavefront_size(), self.size
            if wavefront_size == 1 and width * height != 1:  # how Mitsuba frees a sampler's memory
                return
            # Not what set_samples_per_wavefront() said: integrators' calls do not come as far as here.
            self.per_wave, rest = divmod(wavefront_size, max(width * height, 1))
            if width < 1 or height < 1 or rest or self.sample_count() % self.per_wave:
                prepare = (
                    "Call noisefloor.mitsuba.prepare(scene) once the scene is loaded, or give the plugin the film's "
                    "`width` and `height`. "
                )
                raise ValueError(
                    f"noisefloor: the sampler takes its film for {width} x {height} pixels, and {wavefront_size} "
                    f"samples are no pass over it at {self.sample_count()} samples a pixel. "
                    f"{'' if films else prepare}It draws for the whole film of one sensor: for an integrator "
                    "that also samples something else, as with `guiding_proj` False, use another, independent say"
                )
            self.most = self.per_wave  # indices are below this
            # Opaque: as a literal it would be part of the kernel, and every seed would compile one.
            seed = mi.UInt32(seed) + self.first
            self.base = dr.select(seed == 0, mi.UInt32(0), _child(mi.UInt32(FRAMES), seed))
            if self.scramble:
                self.base = _child(self.base ^ SCRAMBLED, 1)
            dr.make_opaque(self.base)
            wave = dr.arange(mi.UInt32, wavefront_size)
            pixel = wave // self.per_wave
            self.index = wave - pixel * self.per_wave
            row = pixel // width
            x, y = self.corner
            self.at = ((pixel - row * width + x) & 0xFFFF) | ((row + y) << 16)
            if self.white:
                self.at = _mix(self.at * 0x9E3779B9)

        def advance(self):
            self.index = self.index + self.per_wave
            self.dimension, self.requests = mi.UInt32(0), 0
            self.most += self.per_wave

        def schedule_state(self):
            dr.schedule(self.at, self.index, self.base, self.dimension)

        def _copy(self, wavefront_size=0):
            props = mi.Properties()
            props["sample_count"] = self.sample_count()
            props["white"], props["scramble"], props["lens"] = self.white, self.scramble, self.lens
            props["seed"] = self.first
            other = type(self)(props)
            if wavefront_size:
                # This comes to seed() above, which would refuse the number where the film has changed since.
                other.size = wavefront_size, 1
                mi.Sampler.seed(other, 0, wavefront_size)
            other.size, other.corner = self.size, self.corner
            if self in _films:
                _films[other] = _films[self]
            return other

        def fork(self):
            return self._copy()

        def clone(self):
            other = self._copy(self.wavefront_size())
            other.per_wave = self.per_wave
            # Arrays of their own: a loop that changes one sampler must not change the other.
            for name in ("at", "index", "base", "dimension"):
                setattr(other, name, mi.UInt32(getattr(self, name)))
            other.requests, other.most = self.requests, self.most
            return other

        def _draw(self, count):
            on_lens = self.lens and self.requests == 1 and count == 2
            domain = _child(self.base, mi.UInt32(0) if on_lens else self.dimension)
            self.dimension = self.dimension + count
            self.requests += 1
            few = max(self.most, self.sample_count()) <= 1 << BITS
            return draw(domain, self.at, dr.brev(self.index), on_lens, self.scramble, few)

        def next_1d(self, active=True):
            return self._draw(1)[0]

        def next_2d(self, active=True):
            return mi.Point2f(*self._draw(2))

        def to_string(self):
            options = [name for name in ("white", "scramble", "lens") if getattr(self, name)]
            return f"NoisefloorSampler[sample_count={self.sample_count()}, size={self.size}, {options}]"

    return NoisefloorSampler
