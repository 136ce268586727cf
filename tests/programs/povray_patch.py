"""The test of tests/povray/patched: the patch, its notice, and what our side of it refuses. POV-Ray is not needed."""

import os
import subprocess
import sys

from program import ROOT, Program, require, say

folder = ROOT / "tests/povray/patched"
patch, notice = ((folder / name).read_text() for name in ("noisefloor.patch", "README.md"))
# Reads all of it: a hunk that is not as long as it says is an error.
files = subprocess.run(["git", "apply", "--numstat"], input=patch, capture_output=True, text=True)
require(files.returncode == 0 and files.stdout, f"the patch is not well formed: {files.stderr}")
require("SPDX-License-Identifier: AGPL-3.0-or-later\n" in patch, "the patch does not say POV-Ray's licence")
for claim in ["AGPL-3.0-or-later", "nothing built from it is distributed", "noisefloor.patch"]:
    require(claim in " ".join(notice.split()), f"the notice beside the patch does not say `{claim}`")
say(f"{len(files.stdout.splitlines())} files of POV-Ray are changed")

# Settings by the rest of their names, and words of what is said of them.
REFUSED = [
    ("_ORDER=7 _ESTIMATOR=robust", ["dims 4, order 7", "NOISEFLOOR_ORDER"]),
    ("_ORDER=7 _ESTIMATOR=accumulator", ["dims 4, order 7", "NOISEFLOOR_ORDER"]),
    ("_ORDER=8", ["NOISEFLOOR_ORDER=8", "0 to 7"]),
    ("_ESTIMATOR=slices", ["NOISEFLOOR_ESTIMATOR=slices", "recommended, accumulator, mc, robust"]),
    ("_SAMPLER=table", ["NOISEFLOOR_SAMPLER=table", "tile, sobol, random, grid"]),
    ("_TILE=nonsense", ["`nonsense`", "128_16SPP_2D"]),
    ("_SEED=4096", ["NOISEFLOOR_SEED=4096", "0 to 4095"]),
    ("_SPP=many", ["NOISEFLOOR_SPP=many", "1 to 65536"]),
    ("_TILES=128_1SPP_2D", ["NOISEFLOOR_TILES", "README.md"]),
]
begin = Program(sys.argv[1])
os.environ["NOISEFLOOR"] = "estimate"
begin.run()
for settings, words in REFUSED:
    named = dict(setting.split("=") for setting in settings.split())
    os.environ.update({f"NOISEFLOOR{name}": value for name, value in named.items()})
    done = begin.start()
    # The path tracer's command line is not POV-Ray's.
    told = "--" not in done.stderr and all(word in done.stderr for word in words)
    require(done.returncode != 0 and told, f"with {settings} the bridge says `{done.stderr}`, {done.returncode}")
    for name in named:
        del os.environ[f"NOISEFLOOR{name}"]
say(f"{len(REFUSED)} settings are refused by their names")
