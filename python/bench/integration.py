"""Errors of integration over Genz's families and options, over the plain mean's of as many random samples: geometric
means of the ratios of root mean squared errors over independent repetitions.

    python python/bench/integration.py      needs scipy; with vegas installed, that too
"""

import itertools
import math
import warnings

import numpy
import output
from scipy import special, stats

import noisefloor

SAMPLES = 64, 256, 1024, 4096
#: The difficulty of each family: the sum of its parameters (Genz 1984).
DIFFICULTY = dict(oscillatory=9.0, product=7.25, corner=1.85, gaussian=7.03, continuous=20.4, discontinuous=4.3)


def genz(family, dims, seed):
    """A function of the family, and its integral."""
    generator = numpy.random.default_rng(seed)
    a, u = generator.random(dims) + 0.1, generator.random(dims)
    a *= DIFFICULTY[family] / a.sum()
    if family == "oscillatory":
        exact = (numpy.exp(2j * math.pi * u[0]) * numpy.prod((numpy.exp(1j * a) - 1) / (1j * a))).real
        return lambda x: numpy.cos(2 * math.pi * u[0] + x @ a), exact
    if family == "product":
        exact = numpy.prod(a * (numpy.arctan(a * (1 - u)) + numpy.arctan(a * u)))
        return lambda x: 1 / numpy.prod(a**-2.0 + (x - u) ** 2, -1), exact
    if family == "corner":
        corners = numpy.array(list(itertools.product((0, 1), repeat=dims)))
        exact = ((-1.0) ** corners.sum(1) / (1 + corners @ a)).sum() / (math.factorial(dims) * a.prod())
        return lambda x: (1 + x @ a) ** -(dims + 1.0), exact
    if family == "gaussian":
        exact = numpy.prod(math.sqrt(math.pi) / (2 * a) * (special.erf(a * (1 - u)) + special.erf(a * u)))
        return lambda x: numpy.exp(-((x - u) ** 2 @ a**2)), exact
    if family == "continuous":
        exact = numpy.prod((2 - numpy.exp(-a * u) - numpy.exp(-a * (1 - u))) / a)
        return lambda x: numpy.exp(-(abs(x - u) @ a)), exact
    end = numpy.where(numpy.arange(dims) < 2, u, 1)
    exact = numpy.prod((numpy.exp(a * end) - 1) / a)
    return lambda x: numpy.exp(x @ a) * (x[..., :2] <= u[:2]).all(-1), exact


def basket(dims):
    """A call on the mean of some stocks."""
    root = numpy.linalg.cholesky(0.5 + 0.5 * numpy.eye(dims))

    def payoff(x):
        z = special.ndtri(numpy.clip(x, 1e-9, 1 - 1e-9)) @ root.T
        return numpy.maximum(numpy.exp(-0.02 + 0.2 * z).mean(-1) - 1, 0)

    return payoff


def asian(dims):
    """A call on the mean of a stock over time, its path made by principal components."""
    times = numpy.arange(1, dims + 1) / dims
    values, vectors = numpy.linalg.eigh(numpy.minimum.outer(times, times))
    root = (vectors * numpy.sqrt(values))[:, ::-1]

    def payoff(x):
        z = special.ndtri(numpy.clip(x, 1e-9, 1 - 1e-9)) @ root.T
        return numpy.maximum(numpy.exp(-0.02 * times + 0.2 * z).mean(-1) - 1, 0)

    return payoff


def problems():
    """Name, dims, function and integral."""
    for dims, family in itertools.product((2, 4, 6), DIFFICULTY):
        yield (f"{family} {dims}", dims, *genz(family, dims, 10 * dims))
    for name, dims, payoff in (("basket 4", 4, basket(4)), ("asian 4", 4, asian(4)), ("asian 8", 8, asian(8))):
        exact = numpy.mean([payoff(stats.qmc.Sobol(dims, seed=1000 + k).random(1 << 16)).mean() for k in range(32)])
        yield name, dims, payoff, exact


def fits_over_sobol(samples, repetitions):
    """Errors of least squares over those of Sobol's mean on the same points: three functions of each family in 2 to 6
    dims. For each number of samples the ratios."""
    ratios = {}
    for dims, n in itertools.product(range(2, 7), samples):
        u = numpy.stack([stats.qmc.Sobol(dims, seed=seed).random(n) for seed in range(repetitions)])
        for family, seed in itertools.product(DIFFICULTY, range(3)):
            function, exact = genz(family, dims, 10 * dims + 1000 * seed)
            f = numpy.stack([function(points) for points in u])
            fitted = noisefloor.estimate(u, f, order=3, estimator="least_squares", stratified=True).mean
            errors = [((mean - exact) ** 2).mean() for mean in (fitted.astype(float), f.mean(1))]
            ratios.setdefault(n, []).append(math.sqrt(errors[0] / errors[1]))
    return ratios


def vegas_estimate(function, dims, n, seed):
    """Five passes, the first two to adapt the map alone; n evaluations in all, or a few fewer."""
    import gvar
    import vegas

    gvar.ranseed([seed + 1])
    integrator = vegas.Integrator([[0, 1]] * dims)
    batch = vegas.batchintegrand(function)
    integrator(batch, nitn=2, neval=n // 5)
    return integrator(batch, nitn=3, neval=n // 5).mean


def methods():
    """Estimates from function, dims, n and repetition; None for dims that a method has not."""

    def of(points, estimator=None, only=None):
        def estimate(function, dims, n, seed):
            u = points(dims, n, seed)
            if estimator is None:
                return function(u).mean()
            order = 3 if dims <= 6 else 2
            return noisefloor.estimate(u, function(u), order=order, estimator=estimator).mean

        return lambda function, dims, n, seed: estimate(function, dims, n, seed) if only in (None, dims) else math.nan

    random = lambda dims, n, seed: numpy.random.default_rng(seed).random((n, dims))
    sobol = lambda dims, n, seed: stats.qmc.Sobol(dims, seed=seed).random(n)
    halton = lambda dims, n, seed: stats.qmc.Halton(dims, seed=seed).random(n)
    engine = lambda dims, n, seed: noisefloor.QMCEngine(dims, seed=seed).random(n)
    named = {
        "random": of(random),
        "random, robust": of(random, "robust"),
        "Halton": of(halton),
        "Sobol, mean": of(sobol),
        "Sobol, least squares": of(sobol, "least_squares"),
    }
    for dims in (2, 4):
        named[f"QMCEngine, {dims} dims"] = of(engine, None, dims)
    try:
        import vegas  # noqa: F401

        named["vegas"] = vegas_estimate
    except ImportError:
        print("without vegas, which is not installed")
    return named


def main():
    """Writes the geometric means, and how the fit does beside Sobol's mean."""
    options = output.arguments(__doc__)
    repetitions, samples = (4, SAMPLES[:2]) if options.quick else (256, SAMPLES)
    warnings.filterwarnings("ignore")
    output.versions(options, "numpy", "scipy", "vegas")
    named, ratios = methods(), {}
    for problem, dims, function, exact in problems():
        for n in samples:
            errors = {}
            for name, estimate in named.items():
                runs = range(repetitions if name != "vegas" else min(repetitions, 32))
                found = numpy.array([estimate(function, dims, n, seed) for seed in runs]) - exact
                errors[name] = math.sqrt((found**2).mean())
            for name, error in errors.items():
                ratios.setdefault((name, n), {})[problem] = error / errors["random"]
    rows = []

    def add(name, cells):
        means = (numpy.exp(numpy.log([ratio for ratio in cell if not math.isnan(ratio)]).mean()) for cell in cells)
        rows.append([name, *(f"{mean:.3f}" for mean in means)])

    for name in named:
        add(name, [ratios[name, n].values() for n in samples])
    for dims in (2, 4):
        cells = [[value for at, value in ratios["Sobol, mean", n].items() if at.endswith(str(dims))] for n in samples]
        add(f"Sobol, {dims} dims", cells)
    fits = fits_over_sobol(samples, 4 if options.quick else 64)
    rows.append(["least squares over Sobol, mean", *(f"{stats.gmean(fits[n]):.3f}" for n in samples)])
    rows.append(["least squares over Sobol, worst", *(f"{max(fits[n]):.3f}" for n in samples)])
    output.write(options, "integration", ["points and estimate", *map(str, samples)], rows)


if __name__ == "__main__":
    main()
