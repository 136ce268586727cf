"""The scenes of the report's chapter: none but what Mitsuba and a few lines of NumPy make."""

import mitsuba as mi
import numpy as np


def _scale(*s):
    return mi.ScalarTransform4f().scale(s)


def _at(x, y, z):
    return mi.ScalarTransform4f().translate([x, y, z])


def _rgb(*value):
    return {"type": "rgb", "value": list(value)}


def _diffuse(*value):
    return {"type": "diffuse", "reflectance": _rgb(*value)}


def _sphere(x, y, z, radius, bsdf):
    return {"type": "sphere", "center": [x, y, z], "radius": radius, "bsdf": bsdf}


def _camera(origin, target, **more):
    look = mi.ScalarTransform4f().look_at(origin=origin, target=target, up=[0, 1, 0])
    return {"type": "perspective", "fov": 40, "to_world": look, **more}


def _floor(bsdf, size=12):
    turn = mi.ScalarTransform4f().rotate([1, 0, 0], -90) @ _scale(size, size, 1)
    return {"type": "rectangle", "to_world": turn, "bsdf": bsdf}


def _texture(kind, size=256):
    """Wood or plaster: octaves of noise, so that neighbouring pixels differ a little."""
    generator, height = np.random.default_rng(kind), np.zeros((size, size))
    for octave in range(2, 8):
        grid = generator.random((1 << octave, 1 << octave))
        height += np.kron(grid, np.ones((size >> octave, size >> octave))) * 0.5 ** (octave - 1)
    value = height / height.max() if kind == 0 else 0.5 + 0.5 * np.sin(40 * height)
    colour = np.array([[0.75, 0.6, 0.45], [0.5, 0.62, 0.8]][kind])
    data = (value[:, :, None] * colour).astype(np.float32)
    return {"type": "bitmap", "data": mi.TensorXf(data), "raw": True, "filter_type": "bilinear"}


def cornell():
    scene = mi.cornell_box()
    scene["integrator"]["max_depth"] = 8
    return scene


def environment():
    """Glossy and rough spheres under a sky with a sun and windows of light."""
    v, u = np.mgrid[0:64, 0:128] / np.array([64.0, 128.0]).reshape(2, 1, 1)
    sky = np.stack([0.3 + 0.2 * v, 0.45 + 0.1 * v, 0.9 - 0.5 * v], 2) * (v < 0.5)[:, :, None] + 0.08
    sky[10:14, 30:34] += 60
    sky[18:26, 84:96] += 8
    emitter = {"type": "envmap", "bitmap": mi.Bitmap(sky.astype(np.float32))}
    gold = {"type": "roughconductor", "material": "Au", "alpha": 0.15}
    plastic = {"type": "roughplastic", "diffuse_reflectance": _rgb(0.6, 0.1, 0.1), "alpha": 0.1}
    return {
        "type": "scene", "integrator": {"type": "path", "max_depth": 6}, "emitter": emitter,
        "sensor": _camera([0, 2.2, 6], [0, 0.7, 0]), "floor": _floor(_diffuse(0.5, 0.5, 0.5)),
        "a": _sphere(-1.5, 0.8, 0, 0.8, gold), "b": _sphere(0.3, 0.7, 0.6, 0.7, plastic),
        "c": _sphere(1.7, 1, -0.8, 1, _diffuse(0.3, 0.5, 0.7)),
    }  # fmt: skip


def lights():
    """Sixteen spheres of light of many colours, and a lens."""
    scene = {
        "type": "scene", "integrator": {"type": "path", "max_depth": 6},
        "sensor": _camera([0, 2.4, 6.5], [0, 0.6, 0], type="thinlens", aperture_radius=0.12, focus_distance=6.6),
        "floor": _floor(_diffuse(0.6, 0.6, 0.6)),
    }  # fmt: skip
    for k in range(16):
        angle = k * 2 * np.pi / 16
        colour = [2.5 + 2.5 * np.sin(angle + shift) for shift in (0, 2, 4)]
        place = 3.2 * np.cos(angle), 1.2 + 0.7 * (k % 3), 3.2 * np.sin(angle) - 1
        light = {"type": "area", "radiance": _rgb(*colour)}
        scene[f"light{k}"] = {**_sphere(*place, 0.18, _diffuse(0, 0, 0)), "emitter": light}
    for k in range(5):
        plastic = {"type": "roughplastic", "diffuse_reflectance": _rgb(0.7, 0.15 * k, 0.4), "alpha": 0.2}
        scene[f"ball{k}"] = _sphere(-2 + k, 0.45, 1.5 - k, 0.45, plastic if k % 2 else _diffuse(0.7, 0.7, 0.7))
    return scene


def textures():
    """A textured room that a lamp under the ceiling lights, with glass and rough metal."""

    def wall(transform, bsdf):
        return {"type": "rectangle", "to_world": transform @ _scale(3, 3, 1), "bsdf": {"type": "twosided", "b": bsdf}}

    turn = mi.ScalarTransform4f().rotate
    plaster, wood = ({"type": "diffuse", "reflectance": _texture(kind)} for kind in (1, 0))
    lamp = _at(0.8, 2.6, 0) @ turn([1, 0, 0], 90) @ _scale(0.6, 0.35, 1)
    return {
        "type": "scene", "integrator": {"type": "path", "max_depth": 8},
        "sensor": _camera([0, 1.6, 6.8], [0, 1.2, 0]),
        "floor": wall(turn([1, 0, 0], -90), wood), "back": wall(_at(0, 0, -3), plaster),
        "left": wall(_at(-3, 0, 0) @ turn([0, 1, 0], 90), plaster),
        "right": wall(_at(3, 0, 0) @ turn([0, 1, 0], -90), _diffuse(0.6, 0.6, 0.55)),
        "top": wall(_at(0, 3, 0) @ turn([1, 0, 0], 90), _diffuse(0.8, 0.8, 0.8)),
        "lamp": {"type": "rectangle", "to_world": lamp, "emitter": {"type": "area", "radiance": _rgb(18, 16, 13)}},
        "glass": _sphere(-1.2, 0.7, 0.6, 0.7, {"type": "dielectric"}),
        "metal": _sphere(1.1, 0.8, -0.6, 0.8, {"type": "roughconductor", "material": "Cu", "alpha": 0.2}),
    }  # fmt: skip


SCENES = {"cornell": cornell, "environment": environment, "lights": lights, "textures": textures}
