"""The test of tests/povray: POV-Ray's pictures as integrands, every estimator and sampler on them."""

import math
import pathlib
import statistics
import sys

from povray_stack import stack
from program import PathTracer, require, say

LENS, LIGHT, CHOICE, TIME = "lens", "light", "choice", "time"
# What the coordinates of a sample decide, and the cells of each.
SCENES = {
    "area": [(LIGHT, 16), (LIGHT, 16)],
    "focus": [(LENS, 16), (LENS, 16)],
    "focus_area": [(LENS, 4), (LENS, 4), (LIGHT, 4), (LIGHT, 4)],
    "lights": [(LIGHT, 6), (LIGHT, 6), (CHOICE, 8)],
    "motion": [(TIME, 6), (LIGHT, 6), (LIGHT, 6)],
}
# What is exactly unbiased from independent samples; seeds of its test, and the chance of all tests together to fail
# although nothing is biased.
UNBIASED = ["mc", "leave_one_out", "k_fold", "incremental"]
BIAS_SEEDS = 128
SIGNIFICANCE = 1e-3
# Each of so many blocks on a side of the image is tested alone, and the image.
BLOCKS = 4
TESTS = len(SCENES) * (len(UNBIASED) + 1) * (BLOCKS**2 + 1)
SHARP = ["mc", "robust", "leave_one_out", "k_fold", "incremental", "shared", "robust_luminance"]
# Least squares follows noise if it has fewer samples than terms.
NOISY = ["least_squares", "gradient_descent", "luminance"]
# The standard deviation of the Gaussian through which an image is seen, in pixels.
SIGMA = 2.1
# Relative errors beyond it count as this.
LIMIT = 5


def luminance(values):
    return [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in zip(*[iter(values)] * 3)]


class View:
    """A stack as an integrand, and its exact mean."""

    def __init__(self, tracer, name, axes, folder):
        self.tracer, self.name, self.size = tracer, name, tracer.SIZE
        self.path = stack(name, axes, self.size, folder)
        tracer.render("--scene", self.path, "--reference")
        self.exact = luminance(tracer.values("reference"))
        mean = sum(self.exact) / len(self.exact)
        self.scale = [math.sqrt(value**2 + 0.01 * mean**2) for value in self.exact]

    def errors(self, estimators, spp, seeds=1, sampler=("random",), model="cells"):
        """Of each estimator and seed the relative errors of all pixels."""
        options = ["--scene", self.path, "--model", model, "--spp", spp, "--order", 2, "--sampler", *sampler]
        self.tracer.render(*options, "--estimators", ",".join(estimators), "--seed", 1, "--seeds", seeds)
        names = [[name] if seeds == 1 else [f"{name}.{seed}" for seed in range(1, seeds + 1)] for name in estimators]
        return [[self.relative(name) for name in each] for each in names]

    def relative(self, name):
        pairs = zip(luminance(self.tracer.values(name)), self.exact, self.scale)
        return [(value - exact) / scale for value, exact, scale in pairs]

    def filtered(self, errors):
        """relMSE of what is seen: the errors, limited, filtered, then squared."""
        rows = along([max(-LIMIT, min(LIMIT, error)) for error in errors], self.size)
        return mean_square(along(rows, self.size))


def mean_square(errors):
    return sum(error * error for error in errors) / len(errors)


def along(values, size):
    """Filters rows, and returns columns. Near the border the kernel's part that is inside is normalised."""
    radius = math.ceil(4 * SIGMA)
    kernel = [math.exp(-0.5 * ((tap - radius) / SIGMA) ** 2) for tap in range(2 * radius + 1)]
    out = []
    for at in range(size):
        first, last = max(at - radius, 0), min(at + radius + 1, size)
        weights = kernel[first - at + radius:last - at + radius]
        total = sum(weights)
        for row in range(0, size * size, size):
            out.append(sum(map(float.__mul__, weights, values[row + first:row + last])) / total)
    return out


def deviate(values):
    """Student's t of "the mean is nought", as the normal deviate of the same probability (D. Wallace 1959)."""
    n, freedom, mean = len(values), len(values) - 1, statistics.fmean(values)
    variance = statistics.variance(values, mean)
    if variance == 0:
        return 0.0 if abs(mean) < 1e-9 else math.inf
    t = mean / math.sqrt(variance / n)
    return (8 * freedom + 1) / (8 * freedom + 3) * math.sqrt(freedom * math.log1p(t * t / freedom))


def ratio(ours, theirs):
    """The median of the ratios, seed by seed, and the ends of its 95 % interval, from order statistics."""
    ratios = sorted(a / b for a, b in zip(ours, theirs))
    n = len(ratios)
    tail, rank = 0.5**n, 0
    while tail + math.comb(n, rank + 1) * 0.5**n <= 0.025:
        rank += 1
        tail += math.comb(n, rank) * 0.5**n
    return statistics.median(ratios), ratios[rank], ratios[n - 1 - rank]


def unbiased(view):
    """Exactly unbiased estimators, and both models of what lies between cells, against the exact mean."""
    limit = statistics.NormalDist().inv_cdf(1 - 0.5 * SIGNIFICANCE / TESTS)
    side = view.size // BLOCKS
    for model, names in [("cells", UNBIASED), ("linear", ["mc"])]:
        for name, images in zip(names, view.errors(names, 16, BIAS_SEEDS, model=model)):
            sums = [[] for _ in range(BLOCKS**2)]
            for image in images:
                for block, values in enumerate(sums):
                    x, y = block % BLOCKS * side, block // BLOCKS * side
                    rows = range(y * view.size + x, (y + side) * view.size, view.size)
                    values.append(sum(sum(image[row:row + side]) for row in rows))
            found = max(map(deviate, [*sums, [sum(image) for image in zip(*sums)]]))
            what = f"{name} ({model}): {found:.2f} standard errors from the exact mean at most; limit {limit:.2f}"
            require(found <= limit, f"{view.name}: {what}")
            say(what)


def everything(view, axes):
    """Every estimator with every sampler: pictures of the exact mean's brightness."""
    names = SHARP + NOISY + ["slices"] * ((CHOICE, 8) in axes)
    for sampler in ["random", "sobol", "tile"]:
        for model in ["cells", "linear"]:
            for name, [image] in zip(names, view.errors(names, 8, sampler=(sampler,), model=model)):
                limit = 0.5 if name in NOISY else 0.05
                error = sum(image) / len(image)
                require(abs(error) <= limit, f"{view.name}, {sampler}, {model}, {name}: brightness is off by {error}")


def default_is_no_worse(view):
    for spp in [16, 64]:
        plain, default = ([mean_square(one) for one in each] for each in view.errors(["mc", "robust"], spp, 16))
        value, low, high = ratio(default, plain)
        say(f"{spp} spp: relMSE of the default over the mean's {value:.3f} [{low:.3f}, {high:.3f}]")
        require(high <= 1.01, f"{view.name}, {spp} spp: the default is worse than the plain mean")


def tile_is_blue(view, dims):
    for spp in [1, 4, 16]:
        # What depends on each other is best drawn together, from one tile.
        named = ["--tile", f"128_{spp}SPP_4D"] if dims > 2 and spp <= 4 else []
        [tile], [random] = (view.errors(["mc"], spp, 64, sampler) for sampler in [("tile", *named), ("random",)])
        value, low, high = ratio(*(list(map(view.filtered, images)) for images in (tile, random)))
        say(f"{spp} spp: filtered error of the tile over random's {value:.3f} [{low:.3f}, {high:.3f}]")
        require(high < 1, f"{view.name}, {spp} spp: the tile's filtered error is not below random's")


def damaged_stacks(tracer, whole):
    """Each kind of damage is refused, with words that say what it is."""
    middle = len(whole) // 2
    for words, data in [
        ("checksum", whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1:]),
        ("ends early", whole[:-1]),
        ("more after", whole + b"\0"),
        ("header ends early", whole[:30]),
        ("no stack of this version", b"P6\n32 32\n65535\n"),
        ("header ends early", b""),
        ("an axis `taste`", whole.replace(b"axis light", b"axis taste", 1)),
        ("impossible size", whole.replace(b"size 32", b"size 00", 1)),
        ("cannot read", None),
    ]:
        path = tracer.folder / "damaged.stack"
        path.unlink() if data is None else path.write_bytes(data)
        done = tracer.draw("--scene", path, "--spp", 1)
        require(done.returncode == 1 and words in done.stderr, f"of {words}: {done.returncode}, {done.stderr}")


tracer = PathTracer(sys.argv[1])
for name, axes in SCENES.items():
    say(name)
    view = View(tracer, name, axes, pathlib.Path(sys.argv[2]))
    if name == "area":
        damaged_stacks(tracer, view.path.read_bytes())
    unbiased(view)
    everything(view, axes)
    default_is_no_worse(view)
    tile_is_blue(view, len(axes))
