"""noisefloor in Mitsuba 3: a sampler, `{"type": "noisefloor"}`, and an integrator, `{"type": "noisefloor_fits"}`.

`register()` makes both known to the variant that is set; `prepare(scene)` tells samplers how large their films are.
"""

from __future__ import annotations

import mitsuba as mi

from . import _fits, _sampler
from ._sampler import table

__all__ = ["prepare", "register", "table"]


def register() -> None:
    """Makes the plugins known to the variant that is set."""
    sampler = _sampler.kind()
    mi.register_sampler("noisefloor", lambda props: sampler(props))
    if mi.variant().startswith(("llvm", "cuda")):
        integrator = _fits.kind()
        mi.register_integrator("noisefloor_fits", lambda props: integrator(props))


def prepare(scene: mi.Scene) -> mi.Scene:
    """Tells the samplers of the scene's sensors how large their films are, and whether there is a lens; returns the
    scene."""
    for sensor in scene.sensors():
        film, sampler = sensor.film(), sensor.sampler()
        if hasattr(sampler, "size"):
            border = 2 * film.rfilter().border_size() if film.sample_border() else 0
            sampler.size = tuple(int(length) + border for length in film.crop_size())
            sampler.lens = sensor.needs_aperture_sample()
    return scene
