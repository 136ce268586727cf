"""The check of POV-Ray with noisefloor.patch, which `cargo xtask povray` starts: does the patched program make the
pictures that it should? Each check compares pictures, pixel by pixel, and fails if they differ by more than rounding.

povray_patched.py FOLDER: the folder that tests/povray/patched/build.sh has built in."""

import array
import os
import pathlib
import subprocess
import sys
import tempfile

from povray_stack import LATE, OPTIONS
from program import ROOT, require, say

BUILT = pathlib.Path(sys.argv[1]).resolve()
PATCHED = BUILT / "source/unix/povray"
EXAMPLES = BUILT / "source/distribution/scenes"
STOCK = "/usr/bin/povray"
# POV-Ray's examples: focal blur, an area light as a spotlight, area lights of three sizes, a point light.
SCENES = ["camera/focalblur.pov", "lights/soft.pov", "lights/arealit2.pov"]
RADIOSITY = "radiosity/cornell.pov"
SMALL, TINY = (80, 60), (48, 36)
# Point lights, each at the centre of a cell of 16 x 16.
LIGHTS = 256
scratch = tempfile.TemporaryDirectory(dir=BUILT)
folder = pathlib.Path(scratch.name)


def call(program, scene, size, options, settings):
    # One thread unless asked: stock POV-Ray's jitter and radiosity depend on which thread takes which block.
    shared = [option for option in OPTIONS if option != "+KFI1"]
    command = [str(program), f"+I{scene}", "+Opicture", f"+W{size[0]}", f"+H{size[1]}", *shared, *options]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NOISEFLOOR")}
    environment |= {f"NOISEFLOOR{name}": str(value) for name, value in settings.items()}
    for _ in range(4):
        null = subprocess.DEVNULL
        done = subprocess.run(command, cwd=folder, env=environment, stdin=null, stdout=null, stderr=subprocess.PIPE)
        said = done.stderr.decode(errors="replace")
        if done.returncode == 0 or LATE not in said:
            break
    require(done.returncode == 0, f"{command} {settings}: exit status {done.returncode}\n{said[-900:]}")


def read(name, size):
    words, rest = [], (folder / name).read_bytes()
    while len(words) < 4:
        line, _, rest = rest.partition(b"\n")
        words += [] if line.startswith(b"#") else line.split()
    require(words == [b"P6", b"%d" % size[0], b"%d" % size[1], b"65535"], f"{name}: the header says {words}")
    values = array.array("H", rest)
    if sys.byteorder == "little":
        values.byteswap()
    require(len(values) == 3 * size[0] * size[1], f"{name} ends early or goes on")
    return values


def picture(program, scene, size, options=(), settings={}):
    call(program, scene, size, options, settings)
    return read("picture.ppm", size)


def sampled(scene, size, settings, options=()):
    """By the patched program, with noisefloor's samples."""
    return picture(PATCHED, scene, size, options, {"": "samples"} | settings)


def difference(a, b):
    """The largest, in units of 1/65535."""
    return max(abs(p - q) for p, q in zip(a, b))


def off_is_stock():
    """With noisefloor off, the patched program makes Debian's pictures: with antialiasing, both of its kinds, focal
    blur, area lights and radiosity."""
    antialiased = [["+A0.3", "+AM2", "+J"], ["+A0.3", "+AM1", "-J"]]
    kinds = [(scene, options) for scene in SCENES for options in antialiased] + [(RADIOSITY, [])]
    for (scene, options), setting in zip(kinds, [{}, {"": "off"}] * len(kinds)):
        stock, off = (picture(p, provide(scene), TINY, options, s) for p, s in ((STOCK, {}), (PATCHED, setting)))
        worst = difference(off, stock)
        require(worst == 0, f"{scene} with {options}: with noisefloor off, the picture is {worst}/65535 off Debian's")
    say(f"off: {len(kinds)} pictures are Debian's, bit for bit")


def points_make_the_light():
    """An area light that is sampled at the centres of 16 x 16 cells is the mean of 256 point lights."""
    (folder / "grid.pov").write_bytes((ROOT / "tests/povray/patched/grid.pov").read_bytes())
    call(STOCK, "grid.pov", SMALL, ["+KFI0", f"+KFF{LIGHTS - 1}"], {})
    frames = [read(f"picture{frame:03}.ppm", SMALL) for frame in range(LIGHTS)]
    mean = [sum(values) / LIGHTS for values in zip(*frames)]
    area = ["Declare=Area=1"]
    cells = {"_SPP": LIGHTS, "_SAMPLER": "grid", "_PIXEL": "center", "_LIGHT": "whole"}
    worst = difference(sampled("grid.pov", SMALL, cells, area), mean)
    # Half a unit each for the picture and for the mean of 256 rounded ones, and single precision.
    require(worst <= 1.1, f"the area light is {worst}/65535 off the mean of {LIGHTS} point lights")
    # A comparison of black pictures would not fail.
    seen = sum(mean) / len(mean) > 0.05 * 65535 and difference(picture(PATCHED, "grid.pov", SMALL, area), mean) >= 10
    require(seen, "the pictures that were compared are black, or all alike: the check says nothing")
    say(f"area light against {LIGHTS} point lights: at most {worst:.2f}/65535 apart")


def threads_and_means():
    """The picture does not depend on threads, and the estimator `mc` is the mean."""
    for scene in SCENES:
        name, few = provide(scene), {"_SPP": 4}
        one, four = (sampled(name, SMALL, few | {"": "estimate"}, [threads]) for threads in ("+WT1", "+WT4"))
        require(one == four, f"{scene}: the picture depends on the number of threads")
        mean = sampled(name, SMALL, few, ["+WT2"])
        worst = difference(sampled(name, SMALL, few | {"": "estimate", "_ESTIMATOR": "mc"}, ["+WT2"]), mean)
        require(worst <= 1, f"{scene}: the estimator `mc` is {worst}/65535 off the mean")
    say("threads: 1 and 4 make the same pictures")


def radiosity_is_as_bright():
    """Radiosity from noisefloor's directions is as bright as from POV-Ray's, though no pixel is the same."""
    name = provide(RADIOSITY)
    stock = picture(STOCK, name, TINY)
    ours = sampled(name, TINY, {"_SPP": 16, "_PIXEL": "center", "_LIGHT": "shadow"})
    worst = max(abs(sum(ours[channel::3]) / sum(stock[channel::3]) - 1) for channel in range(3))
    # Both interpolate between a few hundred points, each where its own cache happens to have them.
    require(worst < 0.02 and ours != stock, f"{RADIOSITY}: a channel's mean is {100 * worst:.2f} % off stock POV-Ray's")
    say(f"radiosity: each channel as bright as stock POV-Ray's, within {100 * worst:.2f} %")


def provide(scene):
    """An example, where POV-Ray may read it."""
    name = pathlib.Path(scene).name
    for file in [scene, "camera/camera-context.inc"]:
        (folder / pathlib.Path(file).name).write_bytes((EXAMPLES / file).read_bytes())
    return name


off_is_stock()
points_make_the_light()
threads_and_means()
radiosity_is_as_bright()
