"""The code in docs/python.md, run from top to bottom as a reader would."""

import doctest
import pathlib
import re

import pytest

PAGE = pathlib.Path(__file__).resolve().parent.parent.parent / "docs/python.md"


def test_docs_python_md():
    pytest.importorskip("torch")
    text, names, examples = PAGE.read_text(), {}, 0
    runner = doctest.DocTestRunner()
    for block in re.finditer(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
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
    assert names["sampler"].epoch == 2
    assert abs(names["fitted"] - 1.317902) < abs(names["mean"] - 1.317902) < 1e-3
