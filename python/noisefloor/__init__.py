"""Less Monte Carlo noise: minibatches drawn by importance, and estimates of lower error from the same samples.

`Table` draws minibatches, `estimate`, `image_estimate` and `optimal_mis` integrate, `Sampler` and `QMCEngine` draw
points, `recommend` says which to use; `noisefloor.torch` has a batch sampler for data loaders. Arrays may be NumPy's,
PyTorch's, JAX's, or of anything that has a buffer or DLPack. `Basis`, `Estimator`, `ImageEstimator`, `MISSolver` and
`Solver` are types of options' names.
"""

from ._estimate import Basis, Estimate, Estimator, ImageEstimator, Solver, estimate, image_estimate
from ._mis import MISSolver, OptimalMIS, optimal_mis
from ._recommend import Recommendation, recommend
from ._sampler import QMCEngine, Sampler
from ._table import Table
from ._version import __version__

__all__ = [
    "Basis",
    "Estimate",
    "Estimator",
    "ImageEstimator",
    "MISSolver",
    "OptimalMIS",
    "QMCEngine",
    "Recommendation",
    "Sampler",
    "Solver",
    "Table",
    "__version__",
    "estimate",
    "image_estimate",
    "optimal_mis",
    "recommend",
]
