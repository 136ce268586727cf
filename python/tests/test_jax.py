"""JAX: docs/python.md's loop, and its arrays in and out, in an environment that has JAX from the index."""

import os
import pathlib
import subprocess
import sys

import pytest
from test_docs import BLOCK, PAGE

WHEEL = os.environ.get("NOISEFLOOR_WHEEL")

ARRAYS = """
import jax, numpy, noisefloor
from jax import numpy as jnp

jax.config.update("jax_enable_x64", True)
plain = noisefloor.Table(100, importance=numpy.arange(100), seed=7)
index, weight = plain.draw(64)
state = plain.state_dict()
plain.update(index, weight)
for kind in jnp.int32, jnp.int64, jnp.uint32:
    for real in jnp.float32, jnp.float64, jnp.bfloat16:
        table = noisefloor.Table(100, importance=jnp.arange(100, dtype=real))
        table.load_state_dict(state)
        table.update(jnp.asarray(index, kind), jnp.asarray(weight, real))
        close = 1e-2 if real == jnp.bfloat16 else 0
        assert numpy.allclose(table.probabilities(), plain.probabilities(), close, 0)
for out in index, weight, noisefloor.Sampler().image(8, 8, 1):
    again = jnp.from_dlpack(out)
    assert again.dtype == out.dtype and again.shape == out.shape and (numpy.asarray(again) == out).all()
u = jax.random.uniform(jax.random.key(1), (5, 64, 2), jnp.float32)
f = jnp.exp(u.sum(-1))
found = noisefloor.estimate(u, f)
expected = noisefloor.estimate(numpy.asarray(u), numpy.asarray(f))
assert all(numpy.array_equal(a, b) for a, b in zip(found, expected))
assert noisefloor.estimate(u, f.astype(jnp.bfloat16)).mean.shape == (5,)
for call in (lambda x: plain.update(index, x), lambda x: plain.draw(x), lambda x: plain.update(0, 1, momentum=x)):
    try:
        jax.jit(call)(3)
    except TypeError as error:
        assert "is traced by JAX" in str(error), error
    else:
        raise AssertionError("a traced number was taken")
print("all of it")
"""


@pytest.fixture(scope="module")
def python():
    """An interpreter with JAX and the wheel; JAX is fetched once."""
    if not WHEEL:
        pytest.skip("NOISEFLOOR_WHEEL does not name the wheel: `cargo xtask test python`")
    folder = pathlib.Path(WHEEL).parent.parent / "jax"
    pip = folder / "bin/python", "-m", "pip", "--quiet", "--disable-pip-version-check", "install"
    if not list(folder.glob("lib/python3*/site-packages/jaxlib")):
        subprocess.run([sys.executable, "-m", "venv", "--clear", folder], check=True)
        fetched = subprocess.run([*pip, "jax"], capture_output=True, text=True, check=False)
        if fetched.returncode:
            pytest.skip(f"JAX is not to be had: {fetched.stderr.strip().splitlines()[-1]}")
    subprocess.run([*pip, "--no-deps", "--force-reinstall", WHEEL], check=True)
    return pip[0]


def run(python, program):
    """What it prints."""
    done = subprocess.run([python, "-I", "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_arrays_in_and_out(python):
    assert run(python, ARRAYS) == "all of it\n"


def test_the_loop_of_the_guide_learns(python):
    (loop,) = (block[1] for block in BLOCK.finditer(PAGE.read_text()) if "import jax\n" in block[1])
    right = "print(float(((x @ w).argmax(1) == y).mean()), table.probabilities().max() * len(x))"
    accuracy, most = map(float, run(python, loop + right).split())
    assert accuracy > 0.95 and most > 2
