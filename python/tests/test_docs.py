"""The code in docs/python.md, run from top to bottom as a reader would, and its types."""

import doctest
import pathlib
import re
import subprocess
import sys

import pytest

PAGE = pathlib.Path(__file__).resolve().parent.parent.parent / "docs/python.md"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def blocks():
    """The page's code, but for JAX's, which test_jax.py runs where there is JAX."""
    return [block for block in BLOCK.finditer(PAGE.read_text()) if "import jax\n" not in block[1]]


def test_docs_python_md(tmp_path, monkeypatch):
    pytest.importorskip("torch")
    monkeypatch.chdir(tmp_path)
    text, names, examples = PAGE.read_text(), {}, 0
    runner = doctest.DocTestRunner()
    for block in blocks():
        line = text[: block.start(1)].count("\n")
        if ">>>" in block[1]:
            test = doctest.DocTestParser().get_doctest(block[1], names, PAGE.name, str(PAGE), line)
            runner.run(test, clear_globs=False)
            names.update(test.globs)
            examples += len(test.examples)
        else:
            exec(compile("\n" * line + block[1], PAGE, "exec"), names)
            examples += 1
    assert runner.summarize().failed == 0
    assert examples > 20
    assert names["sampler"].epoch == 2 and (tmp_path / "checkpoint").exists()
    assert abs(names["better"].mean - 1.317902) < abs(names["mean"] - 1.317902) < 1e-3


def check_types(tmp_path, *sources):
    """What mypy says of programs, by the package's types as they are installed."""
    files = [tmp_path / f"example{k}.py" for k in range(len(sources))]
    for file, source in zip(files, sources):
        file.write_text(source)
    # Without what PyTorch says of itself, which takes a minute to read.
    (tmp_path / "mypy.ini").write_text(
        "[mypy]\nstrict = True\nfollow_imports = silent\nignore_missing_imports = True\n"
        "[mypy-torch.*]\nfollow_imports = skip\n"
    )
    command = [sys.executable, "-m", "mypy", *files]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    return done.stdout + done.stderr


def test_its_types_are_the_packages(tmp_path):
    pytest.importorskip("mypy")
    sources, loop = [], ""
    for block in blocks():
        source = block[1]
        if ">>>" in source:
            source = "".join(example.source for example in doctest.DocTestParser().get_examples(source))
        elif "sampler.load_state_dict" in source:
            # It goes on with what stands before it.
            source = loop + source
        loop = source
        sources.append("import numpy as np\nimport noisefloor\n" + source)
    sources.append("import noisefloor.mitsuba as nf\nnf.register()\nnf.prepare(None)\n")
    sources.append("import numpy as np\nimport noisefloor\nnoisefloor.Table(10).draw(np.int64(3))\n")
    wrong = "import noisefloor\nnoisefloor.Table(10).draw('10')\nnoisefloor.estimate([], []).variance\n"
    # Options' names are types, too.
    wrong += "noisefloor.Table(10).draw(4, 'idd')\nnoisefloor.image_estimate(0, 0, estimator='least_squares')\n"
    wrong += "noisefloor.estimate([], [], basis='sin')\nnoisefloor.recommend(2, 1).method == 'pixel'\n"
    wrong += "from noisefloor.torch import ImportanceBatchSampler\nImportanceBatchSampler(10, 2, warmup='no')\n"
    said = check_types(tmp_path, *sources, wrong)
    assert 'has incompatible type "str"' in said and 'has no attribute "variance"' in said
    assert f"Found 7 errors in 1 file (checked {len(sources) + 1} source files)" in said, said
