"""Less Monte Carlo noise: minibatches drawn by importance, and estimates of lower error from the same samples.

`Table` draws minibatches, `estimate` and `image_estimate` integrate, `Sampler` and `QMCEngine` draw points, `recommend`
says which to use; `noisefloor.torch` has a batch sampler for data loaders. Arrays may be NumPy's, PyTorch's, JAX's, or
of anything that has a buffer or DLPack. `Basis`, `Estimator` and `ImageEstimator` are types of options' names.
"""

from ._estimate import Basis, Estimate, Estimator, ImageEstimator, estimate, image_estimate
from ._recommend import Recommendation, recommend
from ._sampler import QMCEngine, Sampler
from ._table import Table
from ._version import __version__

__all__ = [
    "Basis",
    "Estimate",
    "Estimator",
    "ImageEstimator",
    "QMCEngine",
    "Recommendation",
    "Sampler",
    "Table",
    "__version__",
    "estimate",
    "image_estimate",
    "recommend",
]
