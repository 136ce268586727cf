"""What the report's chapter is made of: times.csv, gradients.csv, fits.csv, errors.csv and pictures.png in a folder,
and run.json: when, how long and on what each was measured. With all parts in it, NOISEFLOOR_MITSUBA=FOLDER gives it to
`cargo xtask report --only mitsuba`.

python3 measure.py FOLDER [--parts times,gradients,fits,errors] [--scenes cornell,...] [--size 128] [--seeds 32]
    [--reference 4096] [--frames 4096] [--rounds 15] [--scalar build]
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import time

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
mi.set_log_level(mi.LogLevel.Error)
import mitsuba_oidn
import scenes

import noisefloor.mitsuba

SAMPLERS = {
    name: {"type": name} for name in ("independent", "stratified", "multijitter", "orthogonal", "ldsampler")
} | {"noisefloor": {"type": "noisefloor"}, "noisefloor, white": {"type": "noisefloor", "white": True}}
# Without those that are `independent` at 1 sample and biased beyond.
OF_GRADIENTS = {name: SAMPLERS[name] for name in SAMPLERS if name not in ("stratified", "orthogonal")} | {
    "noisefloor, scrambled": {"type": "noisefloor", "scramble": True}
}
FITS = {"plain": None, "fits": {"known": False}, "fits, known light": {"known": True}}
SPP = 1, 4, 16, 64
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
SIGMA, LIMIT = 2.1, 5.0
# Seeds of pictures count from here, those of references from 0.
FIRST = 1000


def described(make, sampler, size):
    """A scene, seen by this sampler."""
    scene = make()
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    scene["sensor"] = {**scene["sensor"], "film": film, "sampler": sampler}
    return scene


def load(make, sampler, size, **integrator):
    scene = described(make, sampler, size)
    scene["integrator"] = {**scene["integrator"], **integrator}
    return noisefloor.mitsuba.prepare(mi.load_dict(scene))


def render(scene, spp, seed):
    return np.array(mi.render(scene, spp=spp, seed=seed), np.float64)


def takes(scene, spp):
    """Some samplers round up, and others' samples would then not be as many."""
    sampler = scene.sensors()[0].sampler().clone()
    sampler.set_sample_count(spp)
    return sampler.sample_count() == spp


def features(make, size):
    """Albedo and normals without noise, the same for all."""
    scene = described(make, {"type": "multijitter"}, size)
    scene["integrator"] = {"type": "aov", "aovs": "albedo:albedo,normal:sh_normal", "inner": scene["integrator"]}
    found = np.array(mi.render(mi.load_dict(scene), spp=256), np.float32)
    return found[:, :, 3:6].copy(), found[:, :, 6:9].copy()


def gaussian(image):
    radius = int(4 * SIGMA)
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / SIGMA) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        pad = [(radius, radius) if a == axis else (0, 0) for a in range(2)]
        image = np.apply_along_axis(np.convolve, axis, np.pad(image, pad, "symmetric"), kernel, "valid")
    return image


def errors(image, denoised, halves):
    """relMSE, as embree.md has it: raw, filtered, denoised."""
    a, b = (half @ LUMINANCE for half in halves)
    mean = (a + b) / 2
    scale = np.sqrt(mean**2 + 0.01 * mean.mean() ** 2)

    def limited(one):
        return np.clip(one / scale, -LIMIT, LIMIT)

    def error(to_a, to_b):
        return (to_a * to_b).mean()

    raw = [limited(image @ LUMINANCE - half) for half in (a, b)]
    clean = [limited(denoised @ LUMINANCE - half) for half in (a, b)]
    return error(*raw), error(*map(gaussian, raw)), error(*clean)


def references(make, options):
    """Two halves, of unrelated samples."""
    plain = load(make, {"type": "independent"}, options.size)
    count = max(options.reference // 512, 1)
    return [np.mean([render(plain, 256, 1 + half * 10000 + k) for k in range(count)], 0) for half in range(2)]


def measure_errors(options, out, pictures):
    out.write("scene;spp;sampler;seed;raw;filtered;denoised\n")
    for name, make in options.chosen.items():
        halves = references(make, options)
        albedo, normal = features(make, options.size)
        # One pixel of an environment may have no normal.
        albedo, normal = (np.ascontiguousarray(np.nan_to_num(a), np.float32) for a in (albedo, normal))
        loaded = {sampler: load(make, dict(plugin), options.size) for sampler, plugin in SAMPLERS.items()}
        row = [np.mean(halves, 0)]
        for spp in SPP:
            for sampler, scene in loaded.items():
                if not takes(scene, spp):
                    continue
                for seed in range(options.seeds):
                    image = render(scene, spp, FIRST + seed)
                    colour = np.ascontiguousarray(image, np.float32)
                    clean = mitsuba_oidn.denoise(colour, albedo=albedo, normal=normal, hdr=True, clean_aux=True)
                    clean = np.array(clean)
                    figures = errors(image, clean.reshape(image.shape), halves)
                    cells = [name, spp, sampler, seed, *(f"{f:.6g}" for f in figures)]
                    out.write(";".join(map(str, cells)) + "\n")
                    if spp == 4 and seed == 0 and sampler in ("independent", "multijitter", "noisefloor"):
                        row += [image, clean.reshape(image.shape)]
        pictures.append(np.concatenate(row, 1))
        print(name, "measured", flush=True)


def measure_fits(options, out, seeds=16):
    """By turns, so that other work on the machine is shared alike."""
    out.write("scene;spp;kind;seed;raw;filtered;seconds\n")
    for name, make in options.chosen.items():
        halves, loaded = references(make, options), {}
        for kind, fits in FITS.items():
            scene = described(make, {"type": "noisefloor"}, options.size)
            if fits is not None:
                scene["integrator"] = {"type": "noisefloor_fits", "inner": scene["integrator"], **fits}
            loaded[kind] = noisefloor.mitsuba.prepare(mi.load_dict(scene))
        for spp in SPP[:3]:
            for seed in range(-1, min(options.seeds, seeds)):
                for kind, scene in loaded.items():
                    start = time.perf_counter()
                    image = render(scene, spp, FIRST + seed)
                    seconds = time.perf_counter() - start
                    # The first compiles; where there is no closed form, `known` is the same as without.
                    if seed >= 0 and not getattr(scene.integrator(), "unknown", ""):
                        figures = errors(image, image, halves)[:2]
                        out.write(";".join(map(str, (name, spp, kind, seed, *figures, seconds))) + "\n")
        print(name, "fitted", flush=True)


def measure_gradients(options, out):
    """Derivatives by two parameters of a weighted mean of the picture, as an optimiser's step has them."""
    out.write("parameter;spp;sampler;frame;gradient\n")
    size, keys = 64, ("red.reflectance.value", "white.reflectance.value", "light.emitter.radiance.value")
    y, x = np.mgrid[0:size, 0:size] / size
    weight = mi.TensorXf((1 + np.sin(9 * x + 5 * y) * np.cos(7 * y))[:, :, None].repeat(3, 2).astype(np.float32))
    jobs = [(s, n, max(options.frames // n, 8)) for n in (1, 4, 16) for s in OF_GRADIENTS]
    for sampler, spp, frames in [*jobs, ("reference", 256, max(options.frames // 32, 8))]:
        plugin = OF_GRADIENTS["independent" if sampler == "reference" else sampler]
        scene = load(scenes.cornell, dict(plugin), size, type="prb", max_depth=6)
        if not takes(scene, spp):
            continue
        parameters = mi.traverse(scene)
        for frame in range(frames):
            for key in keys:
                dr.enable_grad(parameters[key])
            picture = mi.render(scene, parameters, spp=spp, seed=FIRST + frame + 100000 * (sampler == "reference"))
            dr.backward(dr.mean(picture * weight, axis=None))
            for key in keys:
                value = float(np.array(dr.grad(parameters[key])).mean())
                out.write(f"{key.split('.')[0]};{spp};{sampler};{frame};{value:.9g}\n")
                dr.disable_grad(parameters[key])
                dr.set_grad(parameters[key], 0)


def measure_times(options, out, spp=16):
    """By turns, so that other work on the machine is shared alike."""
    out.write("variant;scene;sampler;round;seconds\n")

    def measure(name, loaded, render):
        loaded = {sampler: scene for sampler, scene in loaded.items() if takes(scene, spp)}
        for turn in range(-1, options.rounds):
            for sampler, scene in loaded.items():
                start = time.perf_counter()
                render(scene, turn + 1)
                if turn >= 0:  # the first compiles
                    out.write(f"{mi.variant()};{name};{sampler};{turn};{time.perf_counter() - start:.6g}\n")

    def recorded(scene, seed):
        dr.eval(mi.render(scene, spp=spp, seed=seed))
        dr.sync_thread()

    for name, make in options.chosen.items():
        measure(name, {s: load(make, dict(plugin), options.size) for s, plugin in SAMPLERS.items()}, recorded)
    if options.scalar is None:
        return
    variant = mi.variant()
    mi.set_variant("scalar_rgb")
    mi.file_resolver().append(options.scalar)
    for name, make in options.chosen.items():
        others = {s: described(make, dict(p), options.size) for s, p in SAMPLERS.items() if not s.startswith("noise")}
        ours = described(make, {"type": "independent"}, options.size)
        ours["integrator"] = {"type": "noisefloor_scalar", "inner": ours["integrator"]}
        loaded = {s: mi.load_dict(scene) for s, scene in (others | {"noisefloor": ours}).items()}
        measure(name, loaded, lambda scene, seed: mi.render(scene, spp=spp, seed=seed))
    mi.set_variant(variant)


def machine():
    """As the report's index tells them apart."""
    lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
    models = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    kernel = f"{platform.system().lower()} {platform.release()}"
    return {"processor": next(models, platform.machine()), "cores": len(os.sched_getaffinity(0)), "kernel": kernel}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--parts", default="times,gradients,fits,errors")
    parser.add_argument("--scenes", default=",".join(scenes.SCENES))
    parser.add_argument("--scalar", metavar="FOLDER", help="where noisefloor_scalar was built: times it, too")
    defaults = {"size": 128, "seeds": 32, "reference": 4096, "frames": 4096, "rounds": 15}
    for option, default in defaults.items():
        parser.add_argument(f"--{option}", type=int, default=default)
    options = parser.parse_args()
    options.chosen = {name: scenes.SCENES[name] for name in options.scenes.split(",")}
    noisefloor.mitsuba.register()
    pictures = []
    measures = {
        "times": measure_times,
        "gradients": measure_gradients,
        "fits": measure_fits,
        "errors": lambda options, out: measure_errors(options, out, pictures),
    }
    told = pathlib.Path(options.folder, "run.json")
    run = json.loads(told.read_text()) if told.exists() else {}
    for part in options.parts.split(","):
        # What is cut off has not been measured.
        run.pop(part, None)
        told.write_text(json.dumps(run))
        date, start, busy = datetime.datetime.now(datetime.timezone.utc), time.perf_counter(), time.process_time()
        with open(f"{options.folder}/{part}.csv", "w") as out:
            measures[part](options, out)
        seconds = {"seconds": time.perf_counter() - start, "processor_seconds": time.process_time() - busy}
        run[part] = {"date": f"{date:%Y-%m-%d}", **seconds, "machine": machine()}
        told.write_text(json.dumps(run, indent=1) + "\n")
    if pictures:
        mi.util.write_bitmap(f"{options.folder}/pictures.png", np.concatenate(pictures, 0).astype(np.float32))


main()
