"""The plugin `noisefloor_fits`, an integrator around another: what it sees, through fits that neighbours share.

The fits see the numbers that chose the emitter at the first hit and the point on it, and each sample's value.
"""

import drjit as dr
import mitsuba as mi
import numpy

from .. import _c, image_estimate
from .._sampler import Sampler
from . import _known
from ._sampler import option


def _rays(sensor, position, sampler=None):
    """Rays through places of the film, with the sampler's numbers for lens and shutter, or the middle of both."""
    film = sensor.film()
    on_lens, opened = mi.Point2f(0.5), 0.5
    if sampler and sensor.needs_aperture_sample():
        on_lens = sampler.next_2d()
    if sampler and sensor.shutter_open_time() > 0:
        opened = sampler.next_1d()
    time = mi.Float(sensor.shutter_open() + opened * sensor.shutter_open_time())
    place = (position - mi.ScalarPoint2f(film.crop_offset())) / mi.ScalarPoint2f(film.crop_size())
    return sensor.sample_ray_differential(time, 0.5, place, on_lens)


def _middles(film):
    """The pixels' middles, row after row."""
    width, height = film.crop_size()
    k = dr.arange(mi.UInt32, width * height)
    offset = mi.ScalarPoint2f(film.crop_offset())
    return mi.Point2f(k % width, k // width) + offset + 0.5


def surfaces(hit):
    """A number for each shape and axis that the normal faces."""
    n, size = hit.n, dr.abs(hit.n)
    axis = dr.select(size.x >= dr.maximum(size.y, size.z), 0, dr.select(size.y >= size.z, 1, 2))
    along = dr.select(axis == 0, n.x, dr.select(axis == 1, n.y, n.z))
    shape = dr.reinterpret_array(mi.UInt32, hit.shape)
    found = 6 * shape + 2 * mi.UInt32(axis) + dr.select(along > 0, 1, 0)
    return numpy.array(dr.select(hit.is_valid(), found, 0))


def equally_likely(scene):
    """How many lights one number picks, each as likely as the others; 1 where that is not how they are picked."""
    emitters = scene.emitters()
    return len(emitters) if all(emitter.sampling_weight() == 1 for emitter in emitters) else 1


def kept(sensor, lights, width, height, spp, seed, white=False, scramble=False):
    """The numbers that the fits see: of the point on a light, and of several lights which."""
    before = 2 + 2 * sensor.needs_aperture_sample() + (sensor.shutter_open_time() > 0)
    source = Sampler(frame=seed, white=white, seed=int(scramble))
    x, y = sensor.film().crop_offset()
    u = source.domain(before).image(width, height, spp, 2, x=x, y=y)
    if lights == 1:
        return u
    # One number picks the light and is the first of the point on it: it is two.
    scaled = u[..., 0] * numpy.float32(lights)
    within = numpy.minimum(scaled - numpy.floor(scaled), numpy.float32(1 - 2**-24))
    return numpy.stack([within, u[..., 1], u[..., 0]], -1)


def on_film(film, mean, alpha):
    """The picture as the film has it, whose pixels get these means."""
    film.prepare([])
    block, at = film.create_block(), _middles(film) - 0.5
    channels = [mi.Float(numpy.ascontiguousarray(channel).ravel()) for channel in numpy.moveaxis(mean, -1, 0)]
    values = channels if len(channels) == 3 else 3 * channels
    if mi.has_flag(film.flags(), mi.FilmFlags.Alpha):
        values.append(mi.Float(alpha.ravel()))
    block.put(at, [*values, mi.Float(1)])
    film.put_block(block)
    return film.develop()


def _of_all(values, count):
    """An integrator may say one thing of all samples."""
    values = numpy.array(values)
    return numpy.broadcast_to(values, (*values.shape[:-1], count))


def _check(film, sampler, scene, inner, count):
    # Dr.Jit would end the process, or speak of loops.
    freezing = getattr(dr.JitFlag, "FreezingScope", None)
    if freezing is not None and dr.flag(freezing):
        raise ValueError("noisefloor_fits: fits are computed by the CPU, and no function that makes them can be frozen")
    if not film.rfilter().is_box_filter() or film.sample_border():
        raise ValueError("noisefloor_fits: the film needs a box filter, and no sample_border")
    if mi.has_flag(film.flags(), mi.FilmFlags.Special):
        raise ValueError(f"noisefloor_fits: the film must be one of colours such as hdrfilm, not {film.class_name()}")
    if not hasattr(sampler, "follow"):
        raise ValueError(f"noisefloor_fits: the sensor's sampler must be noisefloor, not {sampler.class_name()}")
    if inner.aov_names():
        raise ValueError(
            f"noisefloor_fits: {inner.class_name()} has further channels, {', '.join(inner.aov_names())}. Give it an "
            "integrator of light alone, path say, and render them by themselves"
        )
    if count >= 1 << 32:
        raise ValueError(
            f"noisefloor_fits: {count} samples; one frame has at most 2^32 - 1. Take fewer for each pixel, and the "
            "mean of frames of several seeds"
        )
    if mi.is_spectral or mi.is_polarized:
        raise ValueError(f"noisefloor_fits: {mi.variant()} has other numbers than RGB and monochromatic variants")
    if not 1 <= len(scene.emitters()) <= 64:
        raise ValueError(f"noisefloor_fits: {len(scene.emitters())} emitters; it is made for 1 to 64")


def kind():
    """The class of integrators of the variant that is set."""

    class NoisefloorFits(mi.CppADIntegrator):
        """Renders in one pass; `order`, `stride` and `known` are described in integrations/mitsuba/README.md."""

        def __init__(self, props):
            super().__init__(props)
            # Not of all: what nobody asks for Mitsuba refuses.
            found = [props[name] for name, held in props.objects(False) if isinstance(held, mi.Integrator)]
            if len(found) != 1:
                raise ValueError(f"noisefloor_fits: holds one integrator, not {len(found)}")
            if isinstance(found[0], (mi.CppADIntegrator, mi.AdjointIntegrator)):
                raise ValueError(f"noisefloor_fits: holds an integrator such as path, not {type(found[0]).__name__}")
            self.inner = found[0]
            self.order = option(props, "noisefloor_fits", "order", 2, most=_c.MAX_ORDER)
            self.stride = option(props, "noisefloor_fits", "stride", 8, 1, 8)
            self.known = option(props, "noisefloor_fits", "known", True)
            # Why `known` was left out, or "".
            self.unknown = ""

        def samples(self, scene, sensor, sampler):
            """Values of all samples, (height, width, samples, channels), and the pixels' alpha."""
            film, spp = sensor.film(), sampler.sample_count()
            (width, height), offset = film.crop_size(), mi.ScalarPoint2f(film.crop_offset())
            pixel = dr.arange(mi.UInt32, width * height * spp) // spp
            corner = mi.Point2f(pixel % width, pixel // width) + offset
            ray, weight = _rays(sensor, corner + sampler.next_2d(), sampler)
            radiance, valid, _ = self.inner.sample(scene, sampler, ray, sensor.get_medium())
            value = _of_all(weight * radiance, width * height * spp).T.reshape(height, width, spp, -1)
            # Others would take the whole picture with them.
            wrong = ~numpy.isfinite(value).all(-1)
            if wrong.any():
                mi.Log(mi.LogLevel.Warn, f"noisefloor_fits: {wrong.sum()} samples were not finite, and count as 0")
                value = numpy.where(wrong[..., None], numpy.float32(0), value)
            valid = _of_all(valid, width * height * spp).reshape(height, width, spp)
            return value, valid.mean(-1, dtype=numpy.float32)

        def sample(self, *_, **__):
            raise ValueError("noisefloor_fits: renders pictures alone; it holds other integrators, and is in none")

        def render(self, scene, sensor=0, seed=0, spp=0, develop=True, evaluate=True):
            sensor = scene.sensors()[sensor] if isinstance(sensor, int) else sensor
            film, sampler = sensor.film(), sensor.sampler().clone()
            if spp:
                sampler.set_sample_count(spp)
            spp, (width, height) = sampler.sample_count(), film.crop_size()
            _check(film, sampler, scene, self.inner, width * height * spp)
            sampler.follow(sensor)
            sampler.seed(seed, width * height * spp)
            f, alpha = self.samples(scene, sensor, sampler)
            lights, first = equally_likely(scene), int((mi.UInt32(seed) + sampler.first)[0])
            u = kept(sensor, lights, width, height, spp, first, sampler.white, sampler.scramble)
            middle = scene.ray_intersect(_rays(sensor, _middles(film))[0])
            more = {}
            if self.known:
                a, self.unknown = _known.light(scene, middle, u)
                if a is not None:
                    more = dict(zip(("known", "known_integrals"), a))
            found = image_estimate(
                u, f, surfaces=surfaces(middle).reshape(height, width), order=self.order, slices=lights,
                stride=self.stride, stratified=True, channels=True, threads=max(dr.thread_count(), 1), **more,
            )  # fmt: skip
            picture = on_film(film, found.mean, alpha)
            if evaluate:
                film.schedule_storage()
                dr.eval(picture)
            return picture if develop else mi.TensorXf()

        def aov_names(self):
            return []

        def to_string(self):
            return f"NoisefloorFits[order={self.order}, stride={self.stride}, known={self.known}, {self.inner}]"

    return NoisefloorFits
