"""The wheel: what is in it, that it can be made again, and that it works where there is no compiler."""

import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import zipfile

import pytest

import noisefloor
from noisefloor import _c
from noisefloor.__main__ import PLACES

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TAGS = f"py3-none-manylinux_2_17_{platform.machine()}"
WHEEL = os.environ.get("NOISEFLOOR_WHEEL")
needs_wheel = pytest.mark.skipif(
    not WHEEL, reason="NOISEFLOOR_WHEEL does not name the wheel: `cargo xtask test python`"
)


def run(*command, **options):
    """What a command prints."""
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@needs_wheel
def test_it_is_small_and_has_all():
    assert os.path.getsize(WHEEL) <= 2_000_000
    assert os.path.basename(WHEEL) == f"noisefloor-{noisefloor.__version__}-{TAGS}.whl"
    names = set(zipfile.ZipFile(WHEEL).namelist())
    native = "noisefloor/native/"
    headers = "include/noisefloor.h", "include/noisefloor/cv.h", "include/noisefloor.hpp"
    for name in (*headers, "lib/cmake/noisefloor/noisefloorConfig.cmake"):
        assert native + name in names
    assert {"noisefloor/py.typed", "noisefloor/torch.py", "noisefloor/mitsuba/__init__.py"} <= names
    assert sum(".so" in name for name in names) == 1 and not any("tests" in name for name in names)
    (metadata,) = (name for name in names if name.endswith("dist-info/METADATA"))
    text = zipfile.ZipFile(WHEEL).read(metadata).decode()
    assert [line for line in text.splitlines() if line.startswith("Requires-Dist")] == ["Requires-Dist: numpy>=1.23"]


def test_it_does_not_say_where_it_was_built():
    """Else clones in other folders would give other bytes."""
    library = pathlib.Path(_c.LIBRARY).read_bytes()
    assert not any(str(path).encode() in library for path in (ROOT, pathlib.Path.home() / ".cargo"))


def test_any_linux_since_glibc_2_17_runs_it():
    """What manylinux_2_17 promises, and docs/python.md."""
    wanted = set(re.findall(rb"GLIBC_([0-9.]+)\0", pathlib.Path(_c.LIBRARY).read_bytes()))
    assert wanted and max(tuple(map(int, version.split(b"."))) for version in wanted) <= (2, 17)
    if shutil.which("readelf"):
        needed = re.findall(r"NEEDED.*\[(.*)\]", run("readelf", "--dynamic", _c.LIBRARY))
        assert needed == ["libc.so.6"]


@needs_wheel
def test_a_second_build_has_the_same_bytes(tmp_path):
    run(
        *(sys.executable, "-m", "pip", "wheel", ROOT / "python", "--no-deps", "--no-build-isolation", "-w", tmp_path),
        *("--config-settings", f"wheel.tags={TAGS}", "--config-settings", f"build-dir={tmp_path / 'build'}"),
        env={**os.environ, "SOURCE_DATE_EPOCH": "1700000000"},
    )
    (again,) = tmp_path.glob("*.whl")
    assert again.read_bytes() == pathlib.Path(WHEEL).read_bytes()


@needs_wheel
def test_it_works_without_a_compiler(tmp_path):
    run("/usr/bin/python3", "-m", "venv", "--system-site-packages", "--without-pip", tmp_path / "venv")
    (packages,) = tmp_path.glob("venv/lib/python3*/site-packages")
    run(sys.executable, "-m", "pip", "install", "--no-deps", "--target", packages, WHEEL)
    code = "import noisefloor; print(noisefloor.__file__); print(len(noisefloor.Table(10).draw(4)[0]))"
    said = run(tmp_path / "venv/bin/python", "-I", "-c", code, env={"PATH": "/nowhere"}, cwd=tmp_path)
    assert said.split() == [str(packages / "noisefloor/__init__.py"), "4"]


def test_c_projects_find_the_library_in_it(tmp_path):
    if not (shutil.which("cmake") and shutil.which("cc")):
        pytest.skip("there is no CMake or no C compiler")
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.21)\nproject(app LANGUAGES C)\nfind_package(noisefloor 0.1 CONFIG REQUIRED)\n"
        f"add_executable(app {ROOT}/examples_c/integrate.c)\ntarget_link_libraries(app noisefloor::noisefloor m)\n"
    )
    place = run(sys.executable, "-m", "noisefloor", "--cmake-dir").strip()
    run("cmake", "-S", tmp_path, "-B", tmp_path / "build", f"-Dnoisefloor_DIR={place}")
    run("cmake", "--build", tmp_path / "build")
    assert "noisefloor" in run(tmp_path / "build/app")


def test_places_are_there():
    options = list(PLACES)
    said = run(sys.executable, "-m", "noisefloor", *options).splitlines()
    assert len(said) == len(options) and all(map(os.path.exists, said))
    done = subprocess.run([sys.executable, "-m", "noisefloor"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "say what to print: --cmake-dir" in done.stderr


def test_the_example_learns():
    pytest.importorskip("torch")
    lines = run(sys.executable, ROOT / "examples_c/python/train_digits.py").splitlines()
    assert [line.split()[0] for line in lines] == ["uniform", "importance"] * 5
    assert all(float(line.split()[1].rstrip("%")) < 15 for line in lines)
