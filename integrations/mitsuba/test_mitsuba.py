"""Tests of noisefloor.mitsuba with the installed Mitsuba; $NOISEFLOOR_VARIANTS names others than the default, first a
recorded RGB one."""

import ctypes
import gc
import itertools
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import drjit as dr
import mitsuba as mi
import numpy as np

VARIANTS = os.environ.get("NOISEFLOOR_VARIANTS", "llvm_ad_rgb,llvm_ad_spectral").split(",")
mi.set_variant(VARIANTS[0])
mi.set_log_level(mi.LogLevel.Error)
import scenes

import noisefloor
import noisefloor.mitsuba as nf
from noisefloor import _c
from noisefloor.mitsuba import _fits, _known, _sampler

FOLDER = pathlib.Path(__file__).resolve().parent

# Of a z-test; there are fewer than twenty, on fixed seeds.
LIMIT = 4.5


def fill(keys, width, height, samples, frame=0, first=0, white=False, scramble=False):
    """nf_sampler_fill: [pixels, samples, 2 numbers for each key]."""
    source = noisefloor.Sampler(frame=frame, white=white, seed=int(scramble))
    u = [source.domain(key).image(width, height, samples, 2, first=first) for key in keys]
    return np.concatenate(u, -1).reshape(width * height, samples, 2 * len(keys))


def drawn(state, count):
    """nf_sampler_draw."""
    part, value = _c.u32(count), (ctypes.c_float * count)()
    status = _c.sampler_fill(_c.address(state), _c.address(part), 1, 1, 1, 1, _c.address(value), count)
    return list(value) if status == 0 else _c.message(status)


def sampler(width, height=0, **more):
    return mi.load_dict({"type": "noisefloor", "width": width, "height": height or width, **more})


def box(kind="noisefloor", width=32, height=32, rfilter="box", integrator="path", sample_border=False, **more):
    """The Cornell box that Mitsuba has."""
    scene = mi.cornell_box()
    film = scene["sensor"]["film"]
    film.update(width=width, height=height, rfilter={"type": rfilter}, sample_border=sample_border)
    scene["sensor"]["sampler"] = {"type": kind, "sample_count": 4}
    scene["integrator"] = {"type": integrator, "max_depth": 6, **more}
    return nf.prepare(mi.load_dict(scene))


def pictures(scene, frames, spp):
    return np.array([np.array(mi.render(scene, spp=spp, seed=7 + k)) for k in range(frames)])


def z_of_means(a, b):
    """Of two sets of independent numbers."""
    spread = np.var(a, ddof=1) / len(a) + np.var(b, ddof=1) / len(b)
    return (np.mean(a) - np.mean(b)) / np.sqrt(spread)


def show(page, *numbers):
    """The picture that these blocks of a page's code end with, run one after the other."""
    blocks, names = re.findall(r"^```python\n(.*?)^```$", (FOLDER / page).read_text(), re.DOTALL | re.MULTILINE), {}
    for number in numbers:
        exec(compile(blocks[number].replace("llvm_ad_rgb", VARIANTS[0]), page, "exec"), names)
    return np.array(names["picture"])


class Recorded(unittest.TestCase):
    """A variant of Dr.Jit."""

    def setUp(self):
        mi.set_variant(VARIANTS[0])
        nf.register()

    def test_the_librarys_bits(self):
        width, height = 150, 90
        for samples, frame, white, scramble in (
            (1, 0, False, False), (1, 3, True, False), (4, 0xFFFFFFFF, False, True), (64, 9, False, False),
        ):  # fmt: skip
            one = sampler(width, height, sample_count=samples, white=white, scramble=scramble)
            one.seed(frame, width * height * samples)
            drawn = np.array([np.array(one.next_2d()) for _ in range(5)])  # [request, number, wave]
            expected = fill([0, 2, 4, 6, 8], width, height, samples, frame, 0, white, scramble).reshape(-1, 5, 2)
            np.testing.assert_array_equal(drawn, expected.transpose(1, 2, 0))
            one.advance()
            expected = fill([0, 1], width, height, samples, frame, samples, white, scramble).reshape(-1, 2, 2)
            np.testing.assert_array_equal(np.array(one.next_1d()), expected[:, 0, 0])
            np.testing.assert_array_equal(np.array(one.next_2d()), expected[:, 1].T)

    def test_the_guides_code_runs(self):
        picture = show("README.md", 0)
        self.assertEqual(picture.shape, (256, 256, 3))
        # Up to the order in which threads add.
        np.testing.assert_allclose(show("../../docs/renderer.md", 0), picture, rtol=1e-4, atol=1e-6)
        self.assertGreater(np.abs(show("README.md", 0, 2) - picture).mean(), 0)

    def test_large_indices_and_the_root(self):
        every = np.random.default_rng(1).integers(0, 2**32, 2048, np.uint32)
        domain = np.random.default_rng(2).integers(0, 2**32, 2048, np.uint32)
        domain[:64] = 0
        for scrambled, few in itertools.product((False, True), repeat=2):
            index = every % 64 if few else every
            state = mi.UInt32(domain), mi.UInt32(17 | 40001 << 16), dr.brev(mi.UInt32(index))
            u = [*_sampler.draw(*state, False, scrambled, few), *_sampler.draw(*state, True, scrambled, few)]
            for k, (d, i) in enumerate(zip(domain, index)):
                expected = drawn(_c.Sampler(int(d), int(i), 17, 40001, int(scrambled)), 4)
                self.assertEqual([v[k] for v in u], expected)

    def test_more_samples_than_were_said(self):
        one = sampler(2, 1, sample_count=16)
        one.seed(0, 2 * 16)
        for _ in range(5):
            one.advance()
        expected = drawn(_c.sampler_domain(_c.sampler_pixel(1, 0, 0, 95), 0), 2)
        self.assertEqual([float(v[-1]) for v in np.array(one.next_2d())], expected)

    def test_film_and_lens_are_four_numbers_of_one_domain(self):
        one = sampler(9, 7, sample_count=16, lens=True)
        one.seed(5, 9 * 7 * 16)
        drawn = np.array([np.array(one.next_2d()) for _ in range(3)])
        both = noisefloor.Sampler(frame=5).domain(0).image(9, 7, 16, 4).reshape(-1, 4).T
        np.testing.assert_array_equal(drawn[:2].reshape(4, -1), both)
        np.testing.assert_array_equal(drawn[2], fill([4], 9, 7, 16, 5).reshape(-1, 2).T)

    def test_numbers_of_every_turn_of_a_recorded_loop_differ(self):
        one = sampler(16, sample_count=2)
        one.seed(5, 16 * 16 * 2)
        count, turns = 16 * 16 * 2, 6
        found = dr.zeros(mi.Float, turns * count)

        def turn(k, one):
            dr.scatter(found, one.next_1d(), k * count + dr.arange(mi.UInt32, count))
            return k + 1, one

        with dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, True):
            dr.while_loop((mi.UInt32(0), one), lambda k, one: k < turns, turn)
        expected = fill(range(turns), 16, 16, 2, 5).reshape(count, turns, 2)[:, :, 0].T
        np.testing.assert_array_equal(np.array(found).reshape(turns, count), expected)
        self.assertEqual(len(np.unique(expected, axis=0)), turns)

    def test_new_seeds_compile_nothing(self):
        scene = box()

        def kernels(seed):
            dr.kernel_history_clear()
            dr.eval(mi.render(scene, spp=4, seed=seed))
            return {entry["hash"] for entry in dr.kernel_history([dr.KernelType.JIT])}

        with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
            first = kernels(1)
            self.assertTrue(first)
            for seed in (0, 2, 3, 2**31):
                self.assertLessEqual(kernels(seed), first)

    def test_frozen_functions_draw_the_same(self):
        scene = box()
        frame = dr.freeze(lambda scene, seed: mi.render(scene, spp=4, seed=seed), state_fn=lambda *_: nf.table())
        for k in range(4):
            seed = mi.UInt32(k)
            dr.make_opaque(seed)
            expected = np.array(mi.render(scene, spp=4, seed=k))
            np.testing.assert_allclose(np.array(frame(scene, seed)), expected, rtol=1e-4, atol=1e-5)
        self.assertLess(frame.n_recordings, 3)

    def test_clones_share_nothing(self):
        one = sampler(8, sample_count=4)
        one.seed(3, 8 * 8 * 4)
        one.next_2d()
        other = one.clone()
        a = np.array([np.array(one.next_1d()) for _ in range(3)])
        b = np.array([np.array(other.next_1d()) for _ in range(3)])
        np.testing.assert_array_equal(a, b)
        indices = lambda it: {getattr(it, n).index for n in ("at", "index", "base")}
        dr.eval(one.at, one.index, one.base)
        other.advance()
        self.assertEqual((other.wavefront_size(), other.sample_count()), (one.wavefront_size(), 4))
        np.testing.assert_array_equal(np.array(one.next_1d()), fill([5], 8, 8, 4, 3).reshape(-1, 2)[:, 0])
        fork = one.fork()
        fork.seed(4, 8 * 8 * 4)
        np.testing.assert_array_equal(np.array(fork.next_1d()), fill([0], 8, 8, 4, 4).reshape(-1, 2)[:, 0])
        self.assertEqual(len(indices(one) - indices(fork)), 3)

    def test_memory_is_freed_by_a_seed_of_one_number(self):
        one = sampler(64, sample_count=4)
        one.seed(3, 64 * 64 * 4)
        one.seed(0, 1)
        self.assertEqual([len(a) for a in (one.at, one.index)], [1, 1])

    def test_a_film_of_one_pixel_has_seeds(self):
        drawn = []
        for seed in (1, 2):
            one = sampler(1, sample_count=1)
            one.seed(seed, 1)
            drawn.append(float(one.next_1d()[0]))
            np.testing.assert_array_equal(drawn[-1:], fill([0], 1, 1, 1, seed)[0, 0, :1])
        self.assertNotEqual(*drawn)

    def test_a_seed_alone_keeps_the_size(self):
        one = sampler(9, 7, sample_count=4)
        one.seed(1, 9 * 7 * 4)
        one.seed(5)
        np.testing.assert_array_equal(np.array(one.next_1d()), fill([0], 9, 7, 4, 5).reshape(-1, 2)[:, 0])

    def test_a_film_that_changes_is_followed(self):
        scene = box(width=16, height=8)
        one, parameters = scene.sensors()[0].sampler(), mi.traverse(scene)
        # Smaller by whole samples a pixel, of the same area, and larger.
        for width, height in ((8, 4), (4, 8), (20, 12)):
            parameters["sensor.film.size"] = [width, height]
            parameters.update()
            expected = fill([0], width, height, 4, 3).reshape(-1, 2)[:, 0]
            for it in (one.clone(), one.fork(), one):
                it.seed(3, width * height * 4)
                np.testing.assert_array_equal(np.array(it.next_1d()), expected)

    def sensors(self, *kinds, **more):
        """A scene with a sensor for each film and type, whose equal samplers are one."""
        scene = mi.cornell_box()
        scene["integrator"] = {"type": "path", "max_depth": 4}
        sensor = scene.pop("sensor") | {"sampler": {"type": "noisefloor"}}
        for k, (width, height, own) in enumerate(kinds):
            film = {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}}
            scene[f"sensor{k}"] = {**sensor, "film": film, **own}
        return nf.prepare(mi.load_dict(scene, **more))

    def test_sensors_that_share_a_sampler(self):
        kinds = (16, 16, {}), (24, 8, {}), (8, 8, {})
        scene, apart = self.sensors(*kinds), self.sensors(*kinds, optimize=False)
        self.assertIs(scene.sensors()[0].sampler(), scene.sensors()[1].sampler())
        for k in (0, 1, 2, 0):
            for spp in (1, 4, 6):
                ours, theirs = (np.array(mi.render(s, sensor=k, spp=spp, seed=3)) for s in (scene, apart))
                np.testing.assert_array_equal(ours, theirs)
        lens = {"type": "thinlens", "aperture_radius": 0.1, "focus_distance": 3.0}
        for kinds in (((16, 8, {}), (8, 16, {})), ((8, 8, {}), (8, 8, lens))):
            scene = self.sensors(*kinds)
            with self.assertRaises(RuntimeError) as refused:
                mi.render(scene, sensor=0, spp=4)
            self.assertIn("load the scene with `optimize=False`", str(refused.exception.__cause__))
            mi.render(self.sensors(*kinds, optimize=False), sensor=0, spp=4)
        # Alike, whatever the number.
        scene = self.sensors((8, 8, {}), (8, 8, {"near_clip": 0.5}))
        self.assertEqual(np.array(mi.render(scene, sensor=1, spp=4)).shape, (8, 8, 3))

    def test_crops_make_up_the_film(self):
        for border, rfilter in ((False, "box"), (True, "gaussian")):
            film = {"sample_border": border, "rfilter": {"type": rfilter}}
            crop = {"crop_offset_x": 5, "crop_offset_y": 3, "crop_width": 12, "crop_height": 9}
            films = [{"type": "hdrfilm", "width": 24, "height": 20, **film, **more} for more in ({}, crop)]
            whole, part = (np.array(mi.render(self.sensors((0, 0, {"film": f})), spp=4, seed=2)) for f in films)
            # A path whose ray touches an edge may go elsewhere.
            same = np.isclose(part, whole[3:12, 5:17], rtol=1e-3, atol=1e-4).all(-1).mean()
            self.assertGreater(same, 0.98)

    def test_a_seed_of_its_own_is_added(self):
        one = sampler(8, sample_count=4, seed=2**32 - 1)
        for it in (one, one.clone(), one.fork()):
            it.seed(6, 8 * 8 * 4)
            np.testing.assert_array_equal(np.array(it.next_1d()), fill([0], 8, 8, 4, 5).reshape(-1, 2)[:, 0])

    def test_options_of_other_types_are_refused(self):
        for more, why in (
            ({"white": "false"}, "white is 'false': a boolean is expected"),
            ({"lens": 1.0}, "lens is 1.0: a boolean"),
            ({"width": 8.5}, "width is 8.5: an integer"),
            ({"height": -1}, "height is -1: it must be 0 to"),
            ({"whit": True}, "whit"),
            ({"sample_count": 0}, "sample_count is 0: it must be 1 at least"),
        ):
            with self.assertRaisesRegex(RuntimeError, why):
                mi.load_dict({"type": "noisefloor", **more})

    def test_samplers_keep_no_film_alive(self):
        gc.collect()
        before, scene = len(_sampler._films), box()
        self.assertGreater(len(_sampler._films), before)
        del scene
        gc.collect()
        self.assertLessEqual(len(_sampler._films), before)

    def test_a_size_that_was_given_is_kept(self):
        one = sampler(8, sample_count=4)
        one.seed(3, 8 * 8 * 4)
        # Four times as many pixels would be four times as many samples of each.
        with self.assertRaisesRegex(ValueError, "for 8 x 8 pixels, and 1024 samples are no pass .* 4 samples a pixel"):
            one.seed(3, 16 * 16 * 4)
        one.seed(3, 8 * 8 * 4)
        one.size = 16, 16
        other = one.clone()
        other.seed(3, 16 * 16 * 4)
        np.testing.assert_array_equal(np.array(other.next_1d()), fill([0], 16, 16, 4, 3).reshape(-1, 2)[:, 0])

    def test_samples_of_no_film_are_refused(self):
        clone = box(width=16, height=16).sensors()[0].sampler().clone()
        with self.assertRaisesRegex(ValueError, "100000000 samples .* whole film .* use another, independ") as refused:
            clone.seed(0, 10**8)
        self.assertNotIn("prepare", str(refused.exception))

    def test_an_unknown_width_is_refused(self):
        for width in (0, 7):
            with self.assertRaisesRegex(ValueError, f"for {width} x 8 pixels, and 256 samples.*prepare"):
                sampler(width, 8, sample_count=4).seed(0, 64 * 4)
        scene = mi.cornell_box()
        scene["sensor"]["film"].update(width=32, height=32)
        scene["sensor"]["sampler"] = {"type": "noisefloor"}
        with self.assertRaises(RuntimeError) as refused:
            mi.render(mi.load_dict(scene), spp=4)
        self.assertIn("for 0 x 0 pixels, and 4096 samples", str(refused.exception.__cause__))

    def test_sensors_by_themselves_are_prepared(self):
        scene = mi.cornell_box()
        # Under a wider filter threads add to a pixel in any order.
        scene["sensor"]["film"].update(width=16, height=8, rfilter={"type": "box"})
        scene["sensor"]["sampler"] = {"type": "noisefloor"}
        sensor = mi.load_dict(scene["sensor"])
        self.assertIs(nf.prepare(sensor), sensor)
        loaded = mi.load_dict(scene)
        expected = np.array(mi.render(nf.prepare(loaded), spp=2, seed=1))
        np.testing.assert_array_equal(np.array(mi.render(loaded, sensor=sensor, spp=2, seed=1)), expected)
        with self.assertRaisesRegex(TypeError, "scene is {'type': 'scene'.*: a scene or a sensor as mi.load_dict"):
            nf.prepare(scene)

    def test_films_of_any_shape_and_filter(self):
        # What a pixel sees is what its own numbers say, so the picture must not depend on who draws them.
        for options in ({"width": 48, "height": 20}, {"width": 20, "height": 48, "rfilter": "gaussian"},
                        {"width": 24, "height": 24, "rfilter": "gaussian", "sample_border": True}):  # fmt: skip
            scene = box(**options)
            sensor = scene.sensors()[0]
            self.assertGreaterEqual(sensor.sampler().size[0], options["width"])
            ours, theirs = (pictures(s, 12, 4).mean((1, 2, 3)) for s in (scene, box("independent", **options)))
            self.assertLess(abs(z_of_means(ours, theirs)), LIMIT)

    def test_neighbours_errors_cancel(self):
        # Had a wrong width mixed the pixels up, errors would be white, and filtering would gain nothing more.
        scene, plain = box(width=48, height=40), box("independent", width=48, height=40)
        reference = pictures(plain, 8, 512).mean(0)

        def error(scene):
            frames = pictures(scene, 8, 4) - reference
            blocks = frames.reshape(8, 10, 4, 12, 4, 3).mean((2, 4))
            return (blocks**2).mean()

        self.assertLess(error(scene), 0.6 * error(plain))

    def test_passes_continue_the_sequence(self):
        whole = mi.render(box(), spp=16, seed=2)
        passes = mi.render(box(samples_per_pass=4), spp=16, seed=2)
        np.testing.assert_allclose(np.array(passes), np.array(whole), rtol=1e-4, atol=1e-5)

    def test_gradients_are_unbiased(self):
        keys = "white.reflectance.value", "light.emitter.radiance.value"
        sets = {}
        for kind, frames, spp in (("noisefloor", 48, 1), ("independent", 48, 16)):
            scene = box(kind, 24, 24, integrator="prb")
            parameters = mi.traverse(scene)
            found = []
            for frame in range(frames):
                for key in keys:
                    dr.enable_grad(parameters[key])
                parameters.update()
                dr.backward(dr.mean(mi.render(scene, parameters, spp=spp, seed=1 + frame), axis=None))
                found.append([np.array(dr.grad(parameters[key])).mean() for key in keys])
                for key in keys:
                    dr.disable_grad(parameters[key])
                    dr.set_grad(parameters[key], 0)
            sets[kind] = np.array(found)
        for k in range(len(keys)):
            self.assertGreater(abs(sets["independent"][:, k].mean()), 0)
            self.assertLess(abs(z_of_means(sets["noisefloor"][:, k], sets["independent"][:, k])), LIMIT)


class Fits(unittest.TestCase):
    """noisefloor_fits around Mitsuba's path tracer."""

    def setUp(self):
        mi.set_variant(VARIANTS[0])
        nf.register()

    def fits(self, depth=6, width=24, height=20, scene=None, inner="path", film=(), sampler=(), **more):
        scene = scene or mi.cornell_box()
        pixels = {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}}
        film = pixels | {"pixel_format": "luminance" if mi.is_monochromatic else "rgb"} | dict(film)
        scene["sensor"] = {**scene["sensor"], "film": film, "sampler": {"type": "noisefloor", **dict(sampler)}}
        scene["integrator"] = {"type": inner, "max_depth": depth} if isinstance(inner, str) else inner
        plain = nf.prepare(mi.load_dict(scene))
        scene["integrator"] = {"type": "noisefloor_fits", "inner": scene["integrator"], **more}
        return plain, nf.prepare(mi.load_dict(scene))

    def lens(self):
        scene = mi.cornell_box()
        scene["sensor"].update(type="thinlens", aperture_radius=0.1, focus_distance=3.0)
        return scene

    def fog(self):
        scene = mi.cornell_box()
        scene["sensor"]["medium"] = {"type": "homogeneous", "albedo": 0.5, "sigma_t": 0.2}
        return scene

    def test_order_0_is_the_plain_picture(self):
        # By `direct`, light from outside is no part of alpha, but of the picture.
        outside = mi.cornell_box() | {"light": {"type": "constant"}}
        for scene, inner in ((mi.cornell_box(), "path"), (self.lens(), "path"), (self.fog(), "volpath"),
                             (outside, {"type": "direct"})):  # fmt: skip
            plain, fitted = self.fits(scene=scene, inner=inner, order=0, known=False)
            for spp in (1, 4):
                expected = np.array(mi.render(plain, spp=spp, seed=3))
                np.testing.assert_allclose(np.array(mi.render(fitted, spp=spp, seed=3)), expected, rtol=1e-4, atol=1e-5)

    def test_films_of_any_format(self):
        scene = mi.cornell_box()
        del scene["back"]  # so that there is an alpha
        crop = {"crop_offset_x": 3, "crop_offset_y": 2, "crop_width": 9, "crop_height": 7}
        for channels, film in ((4, {"pixel_format": "rgba", **crop}), (3, {"pixel_format": "xyz"}),
                               (1, {"pixel_format": "luminance"})):  # fmt: skip
            plain, fitted = self.fits(scene=dict(scene), film=film, order=0, known=False)
            expected, found = (np.array(mi.render(s, seed=3)) for s in (plain, fitted))
            self.assertEqual(found.shape[2], channels)
            np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-5)
            ours, theirs = (np.array(s.sensors()[0].film().bitmap()) for s in (fitted, plain))
            np.testing.assert_allclose(ours, theirs, rtol=1e-4, atol=1e-5)
        self.assertEqual(fitted.integrator().render(fitted, develop=False).shape, (0,))
        self.assertGreater(np.array(fitted.sensors()[0].film().bitmap()).mean(), 0)

    def test_a_film_that_changes_is_followed(self):
        _, fitted = self.fits(width=16, height=16)
        _, expected = self.fits(width=8, height=8)
        parameters = mi.traverse(fitted)
        parameters["sensor.film.size"] = [8, 8]
        parameters.update()
        np.testing.assert_array_equal(*(np.array(mi.render(s, spp=4)) for s in (fitted, expected)))

    def test_samples_that_are_not_finite_count_as_0(self):
        class Spoilt(mi.SamplingIntegrator):
            def __init__(self, props):
                super().__init__(props)
                self.path, self.values = props["path"], props["values"].split()

            def sample(self, scene, sampler, ray, medium=None, active=True):
                radiance, valid, more = self.path.sample(scene, sampler, ray, medium, active)
                k = dr.arange(mi.UInt32, dr.width(radiance))
                for place, value in enumerate(self.values):
                    radiance = dr.select(k == 1000 + place, float(value), radiance)
                return radiance, valid, more

            def aov_names(self):
                return []

        mi.register_integrator("spoilt", lambda props: Spoilt(props))
        spoilt, clean = ({"type": "spoilt", "values": values, "path": {"type": "path"}}
                         for values in ("nan inf", "0 0"))  # fmt: skip
        _, fitted = self.fits(inner=spoilt)
        with unittest.mock.patch("mitsuba.Log") as log:
            found = np.array(mi.render(fitted, spp=4))
        said = [call.args for call in log.call_args_list if call.args[0] == mi.LogLevel.Warn]
        self.assertEqual(len(said), 1)
        self.assertIn(" 2 samples were not finite", said[0][1])
        np.testing.assert_array_equal(found, np.array(mi.render(self.fits(inner=clean)[1], spp=4)))

    def test_kept_numbers_of_a_crop_and_a_seed(self):
        film = {"crop_offset_x": 3, "crop_offset_y": 2, "crop_width": 9, "crop_height": 7}
        _, fitted = self.fits(film=film, sampler={"seed": 2})
        sensor, seen = fitted.sensors()[0], []
        with unittest.mock.patch.object(_fits, "image_estimate", side_effect=lambda u, *_, **__: seen.append(u)):
            with self.assertRaises(RuntimeError):
                mi.render(fitted, spp=4, seed=3)
        one = sensor.sampler().clone()
        one.seed(3, 9 * 7 * 4)
        _, drawn = one.next_2d(), np.array(one.next_2d()).T.reshape(7, 9, 4, 2)
        np.testing.assert_array_equal(seen[0], drawn)
        np.testing.assert_array_equal(drawn[0, 0], fill([2], 24, 20, 4, 5).reshape(20, 24, 4, 2)[2, 3])

    def test_kept_numbers_are_those_that_were_drawn(self):
        one = sampler(9, 7, sample_count=4)
        one.seed(5, 9 * 7 * 4)
        _, drawn = one.next_2d(), np.array(one.next_2d()).T.reshape(7, 9, 4, 2)
        sensor = mi.load_dict({"type": "perspective"})
        np.testing.assert_array_equal(_fits.kept(sensor, 1, 9, 7, 4, 5), drawn)
        three = _fits.kept(sensor, 16, 9, 7, 4, 5)
        np.testing.assert_array_equal(three[..., 2], drawn[..., 0])
        np.testing.assert_array_equal(three[..., 0], drawn[..., 0] * 16 % 1)

    def test_fits_lower_the_error_of_many_lights(self):
        plain, fitted = self.fits(2, 32, 32, scenes.lights())
        reference = np.mean([np.array(mi.render(plain, spp=512, seed=90 + k)) for k in range(2)], 0)
        # Relative, as the report's: lights that are seen directly have no noise of the numbers that fits see.
        scale = reference**2 + 0.01 * reference.mean() ** 2
        error = lambda scene: np.minimum((pictures(scene, 8, 1) - reference) ** 2 / scale, 25).mean()
        self.assertLess(error(fitted), 0.7 * error(plain))
        # The mean's own noise is .3 %; beside that of the same samples next to none.
        frames = pictures(fitted, 96, 4)
        self.assertLess(abs(frames.mean() / reference.mean() - 1), 0.01)
        self.assertLess(abs(frames[:24].mean() / pictures(plain, 24, 4).mean() - 1), 0.002)

    def test_known_light_is_the_exact_mean(self):
        plain, _ = self.fits()
        sensor = plain.sensors()[0]
        middle = plain.ray_intersect(_fits._rays(sensor, _fits._middles(sensor.film()))[0])
        (a, exact), why = _known.light(plain, middle, _fits.kept(sensor, 1, 24, 20, 1024, 0))
        self.assertEqual(why, "")
        lit = exact.sum(-1) > 0
        self.assertGreater(lit.mean(), 0.3)
        # The points are a net of 1,024.
        np.testing.assert_allclose(a.mean(2)[lit], exact[lit], rtol=2e-3, atol=1e-6)

    def test_known_light_of_a_lamp_that_is_mirrored(self):
        exact = []
        for x in (1, -1):
            scene = mi.cornell_box()
            scene["light"]["to_world"] = scene["light"]["to_world"] @ mi.ScalarTransform4f().scale([x, 1, 1])
            plain, _ = self.fits(scene=scene)
            sensor = plain.sensors()[0]
            middle = plain.ray_intersect(_fits._rays(sensor, _fits._middles(sensor.film()))[0])
            exact.append(_known.light(plain, middle, _fits.kept(sensor, 1, 24, 20, 1, 0))[0][1])
        np.testing.assert_allclose(*exact, rtol=1e-4, atol=1e-6)

    def test_one_channel(self):
        mi.set_variant("llvm_ad_mono")
        nf.register()
        plain, fitted = self.fits()
        expected, found = (pictures(scene, 8, 4).mean(0) for scene in (plain, fitted))
        self.assertEqual(found.shape[:2], (20, 24))
        self.assertEqual(fitted.integrator().unknown, "")
        self.assertLess(abs(found.mean() / expected.mean() - 1), 0.02)

    def test_lights_that_are_not_equally_likely(self):
        scene = scenes.lights()
        name = next(name for name, part in scene.items() if isinstance(part, dict) and "emitter" in part)
        scene[name]["emitter"]["sampling_weight"] = 2.0
        plain, fitted = self.fits(2, scene=scene)
        self.assertEqual(_fits.equally_likely(plain), 1)
        self.assertEqual(np.array(mi.render(fitted, spp=1)).shape, (20, 24, 3))

    def test_without_a_closed_form_it_is_said_why(self):
        scene = mi.cornell_box()
        scene["more"] = {"type": "constant"}
        _, fitted = self.fits(scene=scene)
        mi.render(fitted, spp=1)
        self.assertEqual(fitted.integrator().unknown, "several emitters")

    def test_what_it_cannot_do_is_refused(self):
        scene = mi.cornell_box()
        path = scene["integrator"]
        aov = {"type": "aov", "aovs": "depth:depth,n:sh_normal"}
        for rfilter, kind, inner, spp, why in (
            ("gaussian", "noisefloor", path, 1, "box filter"),
            ("box", "independent", path, 1, "sampler must be noisefloor, not IndependentSampler"),
            ("box", "noisefloor", aov, 1, "AOVIntegrator has further channels, depth.T, n.X, n.Y, n.Z"),
            ("box", "noisefloor", path, 2**26, "4294967296 samples; one frame has at most"),
        ):
            scene["sensor"]["film"].update(width=8, height=8, rfilter={"type": rfilter})
            scene["sensor"]["sampler"] = {"type": kind}
            scene["integrator"] = {"type": "noisefloor_fits", "inner": inner}
            with self.assertRaises((ValueError, RuntimeError)) as refused:
                mi.render(nf.prepare(mi.load_dict(scene)), spp=spp)
            self.assertIn(why, f"{refused.exception} {refused.exception.__cause__}")
        for inner, why in (({}, "holds one integrator, not 0"), ({"inner": {"type": "prb"}}, "such as path, not PRB"),
                           ({"inner": {"type": "ptracer"}}, "such as path, not"),
                           ({"inner": path, "ordr": 5}, "ordr"), ({"inner": path, "order": 8}, "order is 8: it must"),
                           ({"inner": path, "order": 2.7}, "order is 2.7: an integer is expected"),
                           ({"inner": path, "stride": 0}, "stride is 0: it must be 1 to 8"),
                           ({"inner": path, "known": "false"}, "known is 'false': a boolean")):  # fmt: skip
            with self.assertRaises((ValueError, RuntimeError)) as refused:
                mi.load_dict({**scene, "integrator": {"type": "noisefloor_fits", **inner}})
            self.assertIn(why, f"{refused.exception} {refused.exception.__cause__}")
        _, fitted = self.fits()
        frame = dr.freeze(lambda seed: mi.render(fitted, spp=1, seed=seed), state_fn=lambda *_: nf.table())
        with self.assertRaises(RuntimeError) as refused:
            frame(mi.UInt32(1))
        cause = refused.exception
        while cause.__cause__:
            cause = cause.__cause__
        self.assertIn("no function that makes them can be frozen", str(cause))
        scene["integrator"] = {**aov, "inner": {"type": "noisefloor_fits", "inner": path}}
        with self.assertRaises((ValueError, RuntimeError)) as refused:
            mi.render(nf.prepare(mi.load_dict(scene)), spp=1)
        self.assertIn("renders pictures alone", f"{refused.exception} {refused.exception.__cause__}")

    def test_surfaces_are_those_of_the_middle_of_the_exposure(self):
        sensor = mi.load_dict({"type": "perspective", "shutter_open": 1.0, "shutter_close": 3.0})
        ray, _ = _fits._rays(sensor, _fits._middles(sensor.film()))
        self.assertTrue(dr.all(ray.time == 2))


class OtherVariants(unittest.TestCase):
    def test_pictures_are_those_of_other_samplers(self):
        for variant in VARIANTS[1:]:
            mi.set_variant(variant)
            nf.register()
            scene, plain = (box(kind, 16, 12) for kind in ("noisefloor", "independent"))
            ours, theirs = (pictures(s, 12, 4).mean((1, 2, 3)) for s in (scene, plain))
            self.assertLess(abs(z_of_means(ours, theirs)), LIMIT)

    def test_in_scalar_variants_the_other_plugin_is_named(self):
        mi.set_variant("scalar_rgb")
        with self.assertRaisesRegex(ValueError, "scalar_rgb is set.*noisefloor_scalar"):
            nf.register()


class Scalar(unittest.TestCase):
    """The C++ plugin, built against the installed Mitsuba."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        source, build = FOLDER / "plugin", pathlib.Path(cls.folder.name) / "build"
        configure = ["cmake", "-S", source, "-B", build, f"-DPython_EXECUTABLE={sys.executable}"]
        for command in ([*configure, "-DCMAKE_BUILD_TYPE=Release"], ["cmake", "--build", build]):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise RuntimeError(f"the plugin is not built: {done.stdout}{done.stderr}")
        mi.file_resolver().append(str(build))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def scene(self, variant, lens=False, film=(), options=(), **more):
        """The Cornell box, by the plugin in scalar variants and by noisefloor.mitsuba in others."""
        mi.set_variant(variant)
        scene = mi.cornell_box()
        scene["sensor"]["film"].update({"width": 37, "height": 21, "rfilter": {"type": "box"}} | dict(film))
        if lens:
            scene["sensor"].update(type="thinlens", aperture_radius=0.05, focus_distance=4.0)
        scene["integrator"] = {"type": "path", "max_depth": 4}
        if variant.startswith("scalar"):
            scene["integrator"] = {"type": "noisefloor_scalar", "inner": scene["integrator"], **dict(options), **more}
        else:
            nf.register()
            scene["sensor"]["sampler"] = {"type": "noisefloor", **dict(options)}
        return nf.prepare(mi.load_dict(scene))

    def both(self, variant, spp, seed, **case):
        kinds = variant, variant.replace("scalar", VARIANTS[0].removesuffix("_rgb"))
        return [np.array(mi.render(self.scene(kind, **case), spp=spp, seed=seed)) for kind in kinds]

    def test_pictures_are_those_of_recorded_variants(self):
        crop = {"crop_offset_x": 5, "crop_offset_y": 3, "crop_width": 20, "crop_height": 11}
        cases = {}, {"lens": True}, {"film": crop}, {"options": {"white": True}}, {"options": {"scramble": True}}
        for variant in ("scalar_rgb", "scalar_spectral"):
            for case in cases:
                for spp, seed in ((1, 0), (4, 3)):
                    ours, theirs = self.both(variant, spp, seed, **case)
                    # A path whose ray touches an edge may go elsewhere.
                    same = np.isclose(ours, theirs, rtol=1e-3, atol=1e-4).all(-1).mean()
                    self.assertGreater(same, 0.98, f"{variant} {case} {spp}")

    def test_the_guides_code_runs(self):
        recorded, here = show("README.md", 0), os.getcwd()
        os.chdir(self.folder.name)
        try:
            scalar = show("README.md", 0, 1)
        finally:
            os.chdir(here)
        self.assertEqual(scalar.shape, recorded.shape)
        self.assertLess(abs(scalar.mean() / recorded.mean() - 1), 0.01)

    def test_films_with_borders(self):
        # Scalar and recorded variants weigh a filter differently, whatever the sampler.
        film = {"rfilter": {"type": "gaussian"}, "sample_border": True}
        ours, theirs = self.both("scalar_rgb", 4, 0, film=film)
        other = self.both("scalar_rgb", 4, 1, film=film)[1]
        self.assertLess(np.std(ours - theirs), 0.2 * np.std(other - theirs))

    def test_blocks_and_passes_change_nothing(self):
        whole = np.array(mi.render(self.scene("scalar_rgb", block_size=64), spp=4))
        for more in ({"block_size": 4}, {"samples_per_pass": 1, "block_size": 8}):
            parts = np.array(mi.render(self.scene("scalar_rgb", **more), spp=4))
            np.testing.assert_allclose(parts, whole, rtol=1e-5, atol=1e-6)

    def test_what_it_holds_is_checked(self):
        mi.set_variant("scalar_rgb")
        path = {"type": "path"}
        for more, message in (
            ({}, "holds no integrator"),
            ({"a": path, "b": path}, "holds one integrator"),
            ({"a": {"type": "ptracer"}}, "holds one integrator"),
        ):
            with self.assertRaises(Exception) as refused:
                mi.load_dict({"type": "noisefloor_scalar", **more})
            self.assertIn(message, f"{refused.exception} {refused.exception.__cause__}")


if __name__ == "__main__":
    unittest.main()
