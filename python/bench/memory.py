"""Memory of a large table: made, drawn from, updated, saved and loaded in a process of its own.

    python python/bench/memory.py

Peaks of resident memory, beyond the interpreter's with NumPy.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy
import output

import noisefloor


def peak():
    """Bytes. Not getrusage's, which begins with that of the process that started this one."""
    (line,) = (line for line in pathlib.Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])


def use(items, file):
    """Peaks once there is a table, and at the end."""
    before = peak()
    table = noisefloor.Table(items)
    table.update(*table.draw(128))
    made = peak()
    state = table.state_dict()
    numpy.save(file, state["table"])
    del state["table"]
    table.load_state_dict({"table": numpy.load(file), **state})
    table.draw(128)
    return made - before, peak() - before


def main():
    """Writes the table."""
    options = output.arguments(__doc__)
    rows = []
    for items in (20_000_000,) if options.quick else (20_000_000, 100_000_000):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, __file__, "--use", str(items), f"{folder}/table.npy"]
            table, whole = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        cells = [f"{table / items:.2f}", f"{whole / items:.2f}", f"{(whole - 4.6 * items) / 1e9:.2f}"]
        rows.append([f"{items:,} items", *cells])
    headings = ["table of", "bytes an item", "with saving and loading", "GB beyond 4.6 bytes an item"]
    output.write(options, "memory", headings, rows)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--use"]:
        print(json.dumps(use(int(sys.argv[2]), sys.argv[3])))
    else:
        main()
