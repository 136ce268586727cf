"""noisefloor in Mitsuba 3: a sampler, `{"type": "noisefloor"}`, and an integrator, `{"type": "noisefloor_fits"}`.

`register()` makes both known to the variant that is set; `prepare(scene)` tells samplers which films they are for.

`noisefloor` has these parameters:

- `sample_count` (4), `seed` (0): samples of a pixel; the frame, to which a render's seed is added.
- `white` (False): neighbours know nothing of each other, for denoisers made for white noise.
- `scramble` (False): values are uniform over seeds, for gradients and light tracing.
- `width`, `height`, `lens`: the film, and whether the sensor has an aperture, where `prepare` cannot tell.

`noisefloor_fits` has these:

- `inner`: the integrator that renders.
- `order` (2), `stride` (8): of the polynomials; pixels from one window of 8 x 8 to the next, 1 to 8.
- `known` (True): also the light without its shadows, where one rectangle lights diffuse surfaces.
"""

from __future__ import annotations

from typing import Any

import mitsuba as mi

from . import _fits, _sampler
from ._sampler import table

__all__ = ["prepare", "register", "table"]


def register() -> None:
    """Makes the plugins known to the variant that is set."""
    variant = mi.variant() or "none"
    if not variant.startswith(("llvm", "cuda")):
        raise ValueError(
            f"noisefloor.mitsuba needs an LLVM or CUDA variant, but {variant} is set. In scalar variants use "
            "noisefloor_scalar, an integrator in C++: integrations/mitsuba/README.md"
        )
    sampler, integrator = _sampler.kind(), _fits.kind()
    mi.register_sampler("noisefloor", lambda props: sampler(props))
    mi.register_integrator("noisefloor_fits", lambda props: integrator(props))


def prepare(scene: mi.Scene | mi.Sensor) -> mi.Scene | mi.Sensor:
    """Tells the samplers of a scene's sensors, or of a sensor that is loaded by itself, which films they are for, and
    whether there is a lens; returns what was given."""
    if not isinstance(scene, (mi.Scene, mi.Sensor)):
        raise TypeError(f"scene is {scene!r:.200}: a scene or a sensor as mi.load_dict() returns it is expected")
    # Mitsuba makes equal samplers of several sensors one.
    sensors: dict[Any, list[mi.Sensor]] = {}
    for sensor in scene.sensors() if isinstance(scene, mi.Scene) else [scene]:
        if hasattr(sensor.sampler(), "follow"):
            sensors.setdefault(sensor.sampler(), []).append(sensor)
    for sampler, those in sensors.items():
        sampler.follow(*those)
    return scene
