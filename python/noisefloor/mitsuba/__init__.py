"""noisefloor in Mitsuba 3: a sampler, `{"type": "noisefloor"}`, and an integrator, `{"type": "noisefloor_fits"}`.

`register()` makes both known to the variant that is set; `prepare(scene)` tells samplers which films they are for.
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


def prepare(scene: mi.Scene) -> mi.Scene:
    """Tells the samplers of the scene's sensors which films they are for, and whether there is a lens; returns the
    scene."""
    # Mitsuba makes equal samplers of several sensors one.
    sensors: dict[Any, list[mi.Sensor]] = {}
    for sensor in scene.sensors():
        if hasattr(sensor.sampler(), "follow"):
            sensors.setdefault(sensor.sampler(), []).append(sensor)
    for sampler, those in sensors.items():
        sampler.follow(*those)
    return scene
