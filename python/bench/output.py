"""How the programs of this folder are asked, and how they answer."""

import argparse
import pathlib


def arguments(text):
    """What was asked for."""
    parser = argparse.ArgumentParser(description=text.partition("\n")[0])
    parser.add_argument("--output", type=pathlib.Path, help="a folder for tables as CSV")
    parser.add_argument("--quick", action="store_true", help="few repetitions: whether it works, not the figures")
    parser.add_argument("--full", action="store_true", help="as without")
    return parser.parse_args()


def write(options, name, headings, rows):
    """Prints a table, and writes it where it was asked for; cells are text."""
    table = [headings, *rows]
    widths = [max(map(len, column)) for column in zip(*table)]
    print(f"\n{name}")
    for row in table:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip(), flush=True)
    if options.output:
        (options.output / f"{name}.csv").write_text("".join(";".join(row) + "\n" for row in table))
