"""How the programs of this folder are asked, and how they answer."""

import argparse
import pathlib
import sys
from importlib import metadata


def arguments(text, more=lambda add: None):
    """What was asked for; `more` adds options."""
    parser = argparse.ArgumentParser(description=text.partition("\n")[0])
    parser.add_argument("--output", type=pathlib.Path, help="a folder for tables as CSV")
    parser.add_argument("--quick", action="store_true", help="few repetitions: whether it works, not the figures")
    parser.add_argument("--full", action="store_true", help="as without")
    more(parser.add_argument)
    return parser.parse_args()


def write(options, name, headings, rows):
    """Prints a table, and writes it where it was asked for; cells are text."""
    table = [headings, *rows]
    assert rows and all(len(row) == len(headings) and all(row) for row in rows)
    assert all(";" not in cell for row in table for cell in row)
    widths = [max(map(len, column)) for column in zip(*table)]
    print(f"\n{name}")
    for row in table:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip(), flush=True)
    if options.output:
        (options.output / f"{name}.csv").write_text("".join(";".join(row) + "\n" for row in table))


def versions(options, *packages):
    """Writes the versions of packages; "-" for those that are not installed."""

    def version(package):
        try:
            return metadata.version(package)
        except metadata.PackageNotFoundError:
            return "-"

    python = ".".join(map(str, sys.version_info[:3]))
    write(options, "versions", ["package", "version"], [["Python", python], *([p, version(p)] for p in packages)])
