"""_c.py against the headers: a C compiler refuses structs, constants and functions that differ."""

import pathlib
import re
import shutil
import subprocess
from typing import get_args

import pytest

import noisefloor
from noisefloor import _c, _estimate, _mis
from noisefloor.__main__ import PLACES

COMPILER = shutil.which("cc")


def compile_c(source, tmp_path):
    """What the compiler says of declarations."""
    file = tmp_path / "declarations.c"
    file.write_text(source)
    command = [COMPILER, "-std=c11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", f"-I{PLACES['--include-dir'][1]}"]
    return subprocess.run([*command, str(file)], capture_output=True, text=True, check=False)


def declarations():
    """All of _c.py's, as C."""
    lines = ["#include <noisefloor.h>", "#include <stddef.h>", _c.FUNCTIONS]
    for struct in _c.STRUCTS:
        name = struct.C_NAME
        lines.append(f'_Static_assert(sizeof({name}) == {_c.ctypes.sizeof(struct)}, "{name}");')
        for field, *_ in struct._fields_:
            at = getattr(struct, field)
            lines.append(f'_Static_assert(offsetof({name}, {field}) == {at.offset}, "{name}.{field}");')
            lines.append(f'_Static_assert(sizeof((({name} *)0)->{field}) == {at.size}, "{name}.{field}");')
    lines += [f'_Static_assert({name} == {value}, "{name}");' for name, value in _c.CONSTANTS.items()]
    return "\n".join(lines)


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
def test_they_are_the_headers(tmp_path):
    assert compile_c(declarations(), tmp_path).stderr == ""


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
@pytest.mark.parametrize(
    "right, wrong",
    [
        ("nf_table *, nf_rng *, uint32_t,", "nf_table *, nf_rng *, uint64_t,"),
        ("sizeof(nf_cv_config) == 64", "sizeof(nf_cv_config) == 60"),
        ("offsetof(nf_sampler, y) == 10", "offsetof(nf_sampler, y) == 12"),
        ("NF_CV_K_FOLD == 3", "NF_CV_K_FOLD == 4"),
    ],
)
def test_others_are_refused(right, wrong, tmp_path):
    source = declarations()
    assert right in source
    assert compile_c(source.replace(right, wrong), tmp_path).returncode != 0


def test_choices_are_the_librarys():
    assert get_args(_estimate.Basis) == tuple(_c.BASES)
    assert get_args(_estimate.Solver) == tuple(_c.SOLVERS)
    assert get_args(_mis.MISSolver) == tuple(_c.OMIS_SOLVERS)
    assert sorted(get_args(_estimate.Estimator)) == sorted(_c.ESTIMATORS)


def test_every_function_is_used():
    package = pathlib.Path(noisefloor.__file__).parent
    code = "".join(file.read_text() for file in package.rglob("*.py"))
    names = re.findall(r"nf_(\w+)\(", _c.FUNCTIONS)
    # _c.py itself names those it uses without `_c.`, which its linter has to be told.
    used = r"(_c\.|library\.nf_){0}\b|\b{0}\b.*# noqa: F821"
    assert len(names) > 20 and [name for name in names if not re.search(used.format(name), code)] == []
