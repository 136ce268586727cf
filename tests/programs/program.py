"""What the tests of whole programs share: starting them, and reading what they write."""

import array
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def require(condition, message):
    if not condition:
        sys.exit(f"failed: {message}")


def say(text):
    print(text, flush=True)


class Program:
    """A compiled program, and a folder of its own for what it writes."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.name = self.path.name
        # New: what an earlier run wrote must not pass for what this one does, and others run beside it.
        self.scratch = tempfile.TemporaryDirectory(dir=self.path.parent)
        self.folder = pathlib.Path(self.scratch.name)

    def start(self, *arguments, stdout=subprocess.PIPE):
        command = [str(self.path), *map(str, arguments)]
        null, pipe = subprocess.DEVNULL, subprocess.PIPE
        return subprocess.run(command, cwd=ROOT, stdin=null, stdout=stdout, stderr=pipe, text=True, errors="replace")

    def run(self, *arguments):
        """Runs to the end; returns what the program writes to standard output."""
        done = self.start(*arguments)
        require(done.returncode == 0, f"{self.name} {arguments}: exit status {done.returncode}\n{done.stderr}")
        return done.stdout

    def refuses(self, word, *arguments):
        """Fails unless the program exits as programs do after an error, with a message that contains `word`."""
        self.refused(self.start(*arguments), word, arguments)

    def refused(self, done, word, arguments):
        last = (done.stderr.splitlines() or [""])[-1]
        refused = done.returncode == 1 and last.startswith(f"{self.name}: ") and word in last
        require(refused, f"{self.name} {arguments}: exit status {done.returncode}, and it says `{done.stderr.strip()}`")


def without_seconds(text):
    """All rows of a CSV, but the column of seconds."""
    rows = [line.split(",") for line in text.splitlines()]
    column = rows[0].index("seconds") if rows and "seconds" in rows[0] else None
    return [[cell for at, cell in enumerate(row) if at != column] for row in rows]


def value(text, start, place=0):
    """The number of the first line that begins so, in this place behind that."""
    rest = next((line[len(start):] for line in text.splitlines() if line.startswith(start)), None)
    require(rest is not None, f"the program wrote no `{start}`")
    number = float(rest.split(",")[place])
    require(math.isfinite(number), f"`{start}` is {number}")
    return number


def block(text, heading):
    """The names in a program's help that are listed, with descriptions, indented under a heading."""
    lines = iter(text.splitlines())
    names = []
    for line in lines:
        if line == f"{heading}:":
            break
    for line in lines:
        if not line.startswith(" "):
            break
        names += line.split()[:1]
    return names


class PathTracer(Program):
    """A program with the path tracer's command line, and its pictures."""

    SIZE = 32  # pixels on a side

    def draw(self, *options):
        # What an earlier run wrote must not pass for what this one does.
        for earlier in self.folder.glob("picture.*"):
            earlier.unlink()
        size = str(self.SIZE)
        return self.start("--width", size, "--height", size, *options, "--output", self.folder / "picture")

    def render(self, *options):
        done = self.draw(*options)
        require(done.returncode == 0, f"{self.name} {options}: exit status {done.returncode}\n{done.stderr}")

    def refuses_each(self, *wrong):
        for options in wrong:
            self.refused(self.draw(*options.split()), "", options)

    def picture(self, name):
        return self.folder / f"picture.{name}.pfm"

    def values(self, name):
        """The numbers of a picture, which must be finite."""
        pixels, header = self.picture(name).read_bytes(), f"PF\n{self.SIZE} {self.SIZE}\n-1.0\n".encode()
        require(pixels.startswith(header), f"{self.picture(name)} is no PFM of {self.SIZE} x {self.SIZE} pixels")
        values = array.array("f")
        require((len(pixels) - len(header)) == 12 * self.SIZE**2, f"{self.picture(name)} ends early or goes on")
        values.frombytes(pixels[len(header):])
        if sys.byteorder == "big":
            values.byteswap()
        require(all(map(math.isfinite, values)), f"{self.picture(name)} has a pixel that is not finite")
        return values

    def brightness(self, name):
        values = self.values(name)
        return sum(values) / len(values)

    def compare(self, what, names, expected, tolerance=0.1):
        """Fails unless the pictures of all these estimators are as bright as they should be."""
        for name in names:
            actual = self.brightness(name)
            # 8192 samples, noisy ones: a tenth of the brightness is far outside what they do by chance.
            require(
                abs(actual - expected) <= tolerance * expected,
                f"{what}, {name}: the picture's mean is {actual}, the reference's {expected}",
            )


def squared_error(a, b):
    return sum((p - q) ** 2 for p, q in zip(a, b)) / len(a)
