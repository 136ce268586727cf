"""What a sample would be with nothing in the way of the light, and the exact mean of that: lamps that are rectangles,
seen from diffuse surfaces. J. H. Lambert's formula, Photometria, 1760."""

import drjit as dr
import mitsuba as mi
import numpy


def _corners(shape):
    matrix = numpy.array(mi.traverse(shape)["to_world"].matrix).reshape(4, 4)
    return [mi.ScalarPoint3f(*(matrix @ [x, y, 0, 1])[:3]) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def _form_factor(corners, p, n):
    """Pi times a polygon's form factor, and whether all of it is above the surface."""
    to = [dr.normalize(corner - p) for corner in corners]
    above = mi.Bool(True)
    for direction in to:
        above &= dr.dot(direction, n) > 1e-4
    total = mi.Vector3f(0)
    for a, b in zip(to, to[1:] + to[:1]):
        total += dr.normalize(dr.cross(a, b)) * dr.safe_acos(dr.dot(a, b))
    return 0.5 * dr.abs(dr.dot(total, n)), above


def light(scene, middle, u):
    """`known` and `known_integrals` for the numbers u, or None; and why not. 0 where a surface has no closed form."""
    emitters = scene.emitters()
    if len(emitters) > 1:
        return None, "several emitters"
    shape = emitters[0].get_shape()
    if shape is None or not str(shape).startswith("Rectangle"):
        return None, "the emitter is no rectangle"
    parameters = mi.traverse(emitters[0])
    if "radiance.value" not in parameters:
        return None, "the emitter's radiance is textured"
    radiance, corners = mi.Spectrum(parameters["radiance.value"]), _corners(shape)
    height, width, spp, _ = u.shape
    context, bsdf = mi.BSDFContext(), middle.bsdf()
    flags = bsdf.flags()
    is_diffuse = middle.is_valid() & mi.has_flag(flags, mi.BSDFFlags.DiffuseReflection)
    for other in (mi.BSDFFlags.Glossy, mi.BSDFFlags.Delta, mi.BSDFFlags.DiffuseTransmission):
        is_diffuse &= ~mi.has_flag(flags, other)
    n = dr.select(dr.dot(middle.n, middle.to_world(middle.wi)) > 0, middle.n, -middle.n)
    factor, above = _form_factor(corners, middle.p, n)
    lamp, _ = scene.sample_emitter_direction(middle, mi.Point2f(0.5), False)
    front = dr.dot(lamp.n, lamp.d) < 0
    wo = middle.to_local(n)
    albedo = bsdf.eval(context, middle, wo, middle.is_valid()) * dr.pi
    usable = is_diffuse & above & front
    exact = dr.select(usable, albedo * dr.inv_pi * factor * radiance, 0)
    # The same of each sample's point on the lamp.
    pixel = dr.arange(mi.UInt32, width * height * spp) // spp
    middle = dr.gather(type(middle), middle, pixel)
    at = mi.Point2f(*(mi.Float(numpy.ascontiguousarray(u[..., k]).ravel()) for k in range(2)))
    sample, weight = scene.sample_emitter_direction(middle, at, False)
    cosine = dr.maximum(dr.dot(dr.gather(mi.Normal3f, n, pixel), sample.d), 0)
    value = weight * cosine * dr.gather(mi.Spectrum, albedo, pixel) * dr.inv_pi
    value = dr.select(dr.gather(mi.Bool, usable, pixel), value, 0)
    arrays = numpy.array(value).T.reshape(height, width, spp, -1), numpy.array(exact).T.reshape(height, width, -1)
    return tuple(numpy.ascontiguousarray(numpy.maximum(array, 0)) for array in arrays), ""
