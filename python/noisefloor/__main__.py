"""Where the C library in this package is: `python -m noisefloor --cmake-dir`."""

import argparse
import os

from . import _c

PLACES = {
    "--cmake-dir": ("the CMake package: -Dnoisefloor_DIR=", os.path.join(_c.FOLDER, "lib", "cmake", "noisefloor")),
    "--include-dir": ("the folder of noisefloor.h", os.path.join(_c.FOLDER, "include")),
    "--library": ("the shared library", _c.LIBRARY),
}


def main():
    """Prints what was asked for, each on a line of its own."""
    parser = argparse.ArgumentParser(prog="python -m noisefloor", description=__doc__)
    for option, (text, _) in PLACES.items():
        parser.add_argument(option, action="append_const", dest="wanted", const=option, help=f"print {text}")
    wanted = parser.parse_args().wanted
    if not wanted:
        parser.error(f"say what to print: {', '.join(PLACES)}")
    for option in wanted:
        print(PLACES[option][1])


if __name__ == "__main__":
    main()
