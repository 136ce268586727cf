"""The test of tests/embree: every scene that the harness lists, against its reference."""

import sys
from program import PathTracer, block, require, say

tracer = PathTracer(sys.argv[1])
scenes = block(tracer.run("--help"), "scenes")
require(len(scenes) >= 10, f"--help lists {len(scenes)} scenes")
for scene in scenes:
    say(scene)
    tracer.render("--scene", scene, "--spp", 64, "--reference")
    expected = tracer.brightness("reference")
    # Fifteen dimensions at order 2 are 136 terms: more than this short look is for. Of paths nothing is known.
    paths = scene in ["duck", "glass"]
    order = 1 if paths else 2
    estimators = ["mc", "robust", "shared"] + ([] if paths else ["shared_known"])
    for sampler in ["random", "sobol", "tile"]:
        options = ["--scene", scene, "--spp", 8, "--sampler", sampler, "--order", order]
        tracer.render(*options, "--estimators", ",".join(estimators))
        tracer.compare(f"{scene}, {sampler}", estimators, expected)
for scene in ["animation", "dining"]:
    frames = []
    for frame in [0, 17]:
        tracer.render("--scene", scene, "--spp", 1, "--frame", frame, "--reference")
        frames.append(tracer.brightness("reference"))
    require(frames[0] != frames[1], f"the animation of {scene} stands still")
tracer.render("--scene", "veach", "--spp", 64, "--reference")
expected = tracer.brightness("reference")
tracer.render("--scene", "veach", "--spp", 64, "--mis")
tracer.compare("veach, --mis", ["balance", "balance_regression", "optimal", "optimal_regression"], expected)
tracer.refuses_each("--scene nonsense", "--sampler nonsense")
