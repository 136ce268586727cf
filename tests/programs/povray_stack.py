"""Stacks of POV-Ray's pictures, rendered when they are needed, and kept: tests/povray/stack.hpp."""

import array
import hashlib
import math
import pathlib
import subprocess
import sys
import tempfile

from program import ROOT, require, say

SCENES = ROOT / "tests/povray/scenes"
# The largest value of a picture; POV-Ray writes it for all that is brighter too.
WHITE = 65535
# POV-Ray sleeps most of the time between two small frames: many processes share a core well.
PROCESSES = 32
# The longest sample vector that stack.inc knows.
AXES = 4
# Linear values of 16 bits, one ray through each pixel's centre, whatever the user's own settings are.
OPTIONS = "+FP16 File_Gamma=1.0 -A Dither=off Quality=9 Output_Alpha=off -D +WT1 +KFI1".split()
# A busy machine may start POV-Ray's threads so late that it gives up before it begins.
LATE = "Timed out waiting for worker thread startup"


def stack(scene, axes, size, folder):
    """The file of a scene's stack, whose axes are pairs of what they decide and their cells."""
    version = subprocess.run(["povray", "--version"], capture_output=True, text=True).stderr.splitlines()[0]
    files = [SCENES / f"{scene}.pov", SCENES / "stack.inc", pathlib.Path(__file__)]
    # Changes when anything does that the pictures depend on.
    key = hashlib.sha256(b"".join(file.read_bytes() for file in files) + f"{axes} {size} {version}".encode())
    path = folder / f"{scene}-{size}-{key.hexdigest()[:16]}.stack"
    if path.exists():
        return path
    folder.mkdir(parents=True, exist_ok=True)
    count = math.prod(cells for _, cells in axes)
    say(f"{scene}: {count} frames of {size} x {size} pixels")
    with tempfile.TemporaryDirectory(prefix=".frames-", dir=folder) as scratch:
        # The last two tell the surfaces apart.
        frames = render(scene, axes, count + 2, size, pathlib.Path(scratch))
        partial = pathlib.Path(scratch) / "stack"
        partial.write_bytes(text(axes, size, surfaces(*frames[count:]), gather(frames[:count], size)))
        partial.rename(path)
    return path


def render(scene, axes, count, size, folder):
    """The values of all frames, rows from the top down."""
    cells = [cells for _, cells in axes] + [1] * (AXES - len(axes))
    declared = [f"Declare=Cells_{axis}={cells}" for axis, cells in enumerate(cells)]
    common = ["povray", f"{scene}.pov", f"+W{size}", f"+H{size}", f"+KFF{count}", f"+O{folder}/frame"]
    common += OPTIONS + declared

    def start(process):
        first, last = (count * p // PROCESSES for p in (process, process + 1))
        log, null = open(folder / f"log{process}", "w+"), subprocess.DEVNULL
        command = [*common, f"+SF{first + 1}", f"+EF{last}"]
        return subprocess.Popen(command, cwd=SCENES, stdin=null, stdout=null, stderr=log), log

    running = [start(process) for process in range(min(PROCESSES, count))]
    for process, (child, log) in enumerate(running):
        for _ in range(3):
            said = "" if child.wait() == 0 else (log.seek(0) or log.read())
            if LATE not in said:
                break
            child, log = start(process)
        require(child.wait() == 0, f"povray {scene}.pov, exit status {child.returncode}:\n{said[-600:]}")
    digits = len(str(count))
    return [picture(folder / f"frame{number:0{digits}}.ppm", size) for number in range(1, count + 1)]


def picture(path, size):
    words, rest = [], path.read_bytes()
    # POV-Ray puts comments between the words of the header.
    while len(words) < 4:
        line, _, rest = rest.partition(b"\n")
        words += [] if line.startswith(b"#") else line.split()
    require(words == [b"P6", b"%d" % size, b"%d" % size, b"65535"], f"{path}: the header says {words}")
    require(len(rest) == 6 * size**2, f"{path} ends early or goes on")
    values = array.array("H", rest)
    if sys.byteorder == "little":
        values.byteswap()
    return values


def gather(frames, size):
    """Pixel by pixel, and in each frame by frame, what comes frame by frame."""
    values = array.array("H")
    for number, frame in enumerate(frames, 1):
        require(max(frame) < WHITE, f"frame {number} is clipped: dim the scene's lights")
    for pixel in range(size**2):
        for frame in frames:
            values += frame[3 * pixel:3 * pixel + 3]
    return values


def surfaces(materials, normals):
    """Numbers for what pixels show: the material, and which way, of six, the surface faces. 0: nothing."""
    numbers = array.array("H")
    for at in range(0, len(materials), 3):
        material = round(materials[at] / WHITE * 255)
        # Half of white is a normal at right angles to the axis.
        slopes = [value - WHITE // 2 for value in normals[at:at + 3]]
        axis = max(range(3), key=lambda axis: abs(slopes[axis]))
        numbers.append(1 + 6 * material + 2 * axis + (slopes[axis] > 0) if material else 0)
    return numbers


def text(axes, size, *numbers):
    data = array.array("H")
    for part in numbers:
        data += part
    if sys.byteorder == "big":
        data.byteswap()
    checksum = 0xCBF29CE484222325
    for byte in data.tobytes():
        checksum = (checksum ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    header = f"noisefloor-stack 1\nsize {size} {size}\n"
    header += "".join(f"axis {name} {cells}\n" for name, cells in axes)
    return f"{header}checksum {checksum:016x}\ndata\n".encode() + data.tobytes()
