"""The programs that measure, quickly: whether they work, not the figures."""

import pathlib
import subprocess
import sys

import pytest

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "bench"
TABLES = {
    "overhead": ("versions", "draws", "steps", "integrals"),
    "integration": ("versions", "integration"),
    "memory": ("memory",),
    "training": ("tasks", "training"),
}


@pytest.mark.parametrize("program", TABLES)
def test_it_writes_its_tables(program, tmp_path):
    pytest.importorskip("torch")
    command = [sys.executable, FOLDER / f"{program}.py", "--quick", "--output", tmp_path]
    subprocess.run(command, check=True, capture_output=True)
    for name in TABLES[program]:
        headings, *rows = (line.split(";") for line in (tmp_path / f"{name}.csv").read_text().splitlines())
        assert rows and all(len(row) == len(headings) and all(row) for row in rows)
