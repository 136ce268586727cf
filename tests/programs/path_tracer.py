"""The test of examples_c/pathtracer.cpp: what it lists, what it promises of its options, and what it refuses."""

import array
import shutil
import sys
from program import ROOT, PathTracer, block, require, say, squared_error

tracer = PathTracer(sys.argv[1])
table = tracer.folder / "table.points"


def main():
    text = tracer.run("--help")
    samplers, tiles, filters = (listed(text, name) for name in ["samplers", "tiles", "filters"])
    scenes, estimators = block(text, "scenes"), block(text, "estimators")
    require(
        len(scenes) >= 5 and len(estimators) >= 2 and len(samplers) >= 3 and tiles and len(filters) >= 3,
        "--help lists too few scenes, estimators, samplers, tiles or filters",
    )
    write_table()
    for scene in scenes:
        check_scene(scene, estimators, samplers)
    for name in filters:
        check_filter(name)
    check_samplers(samplers)
    check_tiles(tiles)
    for check in [check_seeds, check_table, check_outputs, check_accumulation, check_two_techniques]:
        check()
    tracer.refuses_each(
        "--estimators nonsense",
        "--scene nonsense",
        "--spp 0",
        "--sampler nonsense",
        "--filter nonsense",
        "--basis nonsense",
        "--seeds 0",
        "--seed 1099511627776",
        "--seed 1099511627775 --seeds 2",
        "--sampler default --seed 1048576",
        "--sampler default --seed 1048575 --seeds 2",
        "--sampler default --frame 4096",
        "--sampler tile --tile 128_1SPP_2D --spp 1 --frame 4096",
        "--sampler table",
        "--sampler sobol --independent",
        "--sampler table --table README.md",
        f"--sampler table --table {table} --spp 17",
        "--accumulate 8 --estimators shared",
        "--accumulate 8 --estimators leave_one_out",
        "--accumulate 8 --estimators known",
        "--scene global --estimators known",
        "--scene direct --bounces 1 --estimators shared_known",
        "--mis --spp 7",
        "--mis --scene lens",
        "--mis --estimators robust",
        "--mis --bounces 2",
        "--mis --regressed 2",
        "--regressed 17",
        "--statistics README.md",
        "--statistics README.md,README.md",
        "--scene direct --estimators slices",
        "--sampler tile --tile nonsense",
        "--sampler tile --tile README.md",
    )


def listed(text, name):
    line = next((line for line in text.splitlines() if line.startswith(f"{name}:")), None)
    require(line is not None, f"--help lists no {name}")
    return line.split(":", 1)[1].split()


def check_scene(scene, estimators, samplers):
    """Every estimator and every sampler."""
    # What slices need, a choice of lights, only those scenes have; of paths nothing is known.
    paths = scene == "global"
    names = [name for name in estimators if name != "slices" or scene == "lights" or paths]
    names = [name for name in names if "known" not in name or not paths]
    say(f"{scene}: {', '.join(names)}; {', '.join(samplers)}")
    tracer.render("--scene", scene, "--spp", 64, "--reference")
    expected = tracer.brightness("reference")
    # Fifteen dimensions at order 2 are 136 terms: more than this short look is for.
    options = ["--scene", scene, "--spp", 8, "--order", 1 if scene == "global" else 2]
    tracer.render(*options, "--estimators", ",".join(names))
    tracer.compare(f"{scene}, random", names, expected)
    for sampler in samplers:
        more = ["--frame", 3, "--sampler", sampler, "--table", table, "--estimators", "mc,shared,robust"]
        tracer.render(*options, *more)
        tracer.compare(f"{scene}, {sampler}", ["mc", "shared", "robust"], expected)


def check_samplers(samplers):
    """Each draws as `--sampler` says: pictures of its own, and but for random ones of clearly less error."""
    say(f"errors of samplers: {', '.join(samplers)}")
    tracer.render(*"--scene direct --spp 256 --reference".split())
    reference, pictures = tracer.values("reference"), {}
    for sampler in samplers:
        options = "--scene direct --spp 16 --estimators mc --sampler".split()
        tracer.render(*options, sampler, "--table", table)
        pictures[sampler] = tracer.values("mc")
    require(len(set(map(tuple, pictures.values()))) == len(samplers), "two samplers make the same picture")
    errors = {sampler: squared_error(picture, reference) for sampler, picture in pictures.items()}
    say(", ".join(f"{sampler} {error / errors['random']:.3f}" for sampler, error in errors.items()))
    for sampler in samplers:
        ratio = errors[sampler] / errors["random"]
        require(sampler == "random" or ratio <= 0.2, f"{sampler}: the squared error is {ratio} times random samples'")


def check_filter(name):
    say(f"filter {name}")
    options = ["--scene", "direct", "--filter", name]
    tracer.render(*options, "--spp", 64, "--reference")
    expected = tracer.brightness("reference")
    tracer.render(*options, "--spp", 8, "--estimators", "mc,robust,shared")
    tracer.compare(f"filter {name}", ["mc", "robust", "shared"], expected)


def check_tiles(tiles):
    """Every tile by its name and by its file: the same picture, which no other tile makes."""
    say(f"tiles: {', '.join(tiles)}")
    pictures = set()
    for tile in tiles:
        options = "--scene lens --spp 2 --estimators mc --sampler tile --tile".split()
        tracer.render(*options, tile)
        expected = tracer.values("mc")
        file = ROOT / f"core/tiles/{tile}.nft"
        require(file.exists(), f"the library carries {tile}, but there is no {file}")
        tracer.render(*options, file)
        require(tracer.values("mc") == expected, f"{tile} and {file} draw different samples")
        pictures.add(tuple(expected))
    require(len(pictures) == len(tiles), f"{len(tiles)} tiles make {len(pictures)} pictures")


def write_table():
    """Points for the sampler `table`: in each of 2 x 3 pixels the midpoints of 4 x 4 cells, in another order."""
    values = array.array("f")
    for pixel in range(6):
        for sample in range(16):
            cell = (sample * 5 + pixel) % 16
            values.extend([(cell % 4 + 0.5) / 4, (cell // 4 + 0.5) / 4])
    if sys.byteorder == "big":
        values.byteswap()
    table.write_bytes(b"noisefloor-points 2 3 16 2\n" + values.tobytes())


def check_table():
    """A picture from all points of a grid is that of the midpoint rule, the same in each pixel whatever the order."""
    say("table")
    tracer.render(*"--scene direct --sampler table --spp 16 --estimators mc --table".split(), table)
    grid = tracer.values("mc")
    tracer.render(*"--scene direct --spp 256 --reference".split())
    reference = tracer.values("reference")
    tracer.render(*"--scene direct --spp 16 --estimators mc".split())
    error, other = squared_error(grid, reference), squared_error(tracer.values("mc"), reference)
    require(
        error <= 0.3 * other,
        f"the squared error of a grid of points is {error}, that of random points {other}: the table is not used as it "
        "is",
    )
    # Of stratified points `robust` is the plain mean.
    for more, is_mean in [("", True), ("--independent", False)]:
        options = "--scene direct --sampler table --spp 16 --estimators mc,robust --table".split()
        tracer.render(*options, table, *more.split())
        same = tracer.values("mc") == tracer.values("robust")
        require(same == is_mean, f"table {more}: that `robust` is the plain mean is {same}")


def check_outputs():
    """What cannot get its name costs nothing that has."""
    say("outputs")
    blocked = tracer.folder / "outputs.robust.pfm"
    blocked.mkdir()
    arguments = "--width 8 --height 8 --spp 4 --estimators mc,robust,shared --output".split()
    done = tracer.start(*arguments, tracer.folder / "outputs")
    for word in [f"cannot create {blocked}: ", "outputs.mc.pfm"]:
        tracer.refused(done, word, arguments)
    left = sorted(path.name for path in tracer.folder.glob("outputs.*"))
    require(left == ["outputs.mc.pfm", "outputs.robust.pfm"], f"a name that is taken leaves {left}")


def check_accumulation():
    """However many threads accumulate passes, of however many samples, the picture is the same; the plain mean's is
    that of a run without."""
    say("accumulation")
    names = ["mc", "robust", "least_squares", "k_fold"]
    far = lambda a, b: any(abs(p - q) > 1e-5 * (1 + abs(p)) for p, q in zip(a, b))
    for sampler in ["random", "sobol", "tile"]:
        def pictures(more):
            options = ["--scene", "lights", "--spp", 36, "--sampler", sampler, "--estimators", ",".join(names)]
            tracer.render(*options, *more.split())
            return [tracer.values(name) for name in names]

        one, three = pictures("--accumulate 8 --threads 1"), pictures("--accumulate 8 --threads 3")
        whole, pixels = pictures("--accumulate 36 --threads 2"), pictures("")
        odd = pictures("--accumulate 7 --threads 2")
        for i, name in enumerate(names):
            same = not any(far(one[i], other[i]) for other in [three, odd, whole])
            require(same, f"{sampler}, {name}: the picture depends on the threads or on the passes")
        require(not far(one[0], pixels[0]), f"{sampler}: the plain mean of passes is not that of whole pixels")


def check_two_techniques():
    """Every estimator of --mis makes the picture that the other ones make."""
    say("two techniques")
    for scene in ["direct", "lights"]:
        tracer.render("--scene", scene, "--spp", 64, "--reference")
        expected = tracer.brightness("reference")
        tracer.render("--scene", scene, "--mis", "--spp", 32)
        names = ["balance", "balance_regression", "optimal", "optimal_regression"]
        tracer.compare(scene, names, expected, 0.05)


def check_seeds():
    """Several seeds in one run are what single runs make, and statistics are those of the pictures."""
    say("seeds, statistics")
    options, half = "--scene lights --spp 2 --estimators mc,shared".split(), tracer.folder / "half.pfm"
    for sampler in ["random", "sobol", "tile"]:
        several = [*options, "--seed", 7, "--sampler", sampler, "--seeds", 3]
        tracer.render(*several)
        pictures = [[tracer.values(f"{name}.{seed}") for seed in [7, 8, 9]] for name in ["mc", "shared"]]
        shutil.copy(tracer.picture("mc.8"), half)
        for seed, picture in zip([7, 8, 9], pictures[1]):
            tracer.render(*options, "--sampler", sampler, "--seed", seed)
            same = tracer.values("shared").tobytes() == picture.tobytes()
            require(same, f"{sampler}: seed {seed} alone and among others make different pictures")
        brightness = [sum(picture) / len(picture) for picture in pictures[1]]
        require(brightness[0] != brightness[1], f"{sampler}: seeds 7 and 8 make the same picture")
        tracer.render(*several, "--statistics", f"{half},{half}")
        mean, expected = tracer.brightness("shared.mean"), sum(brightness) / 3
        require(
            abs(mean - expected) <= 1e-5 * expected,
            f"{sampler}: the mean picture's mean is {mean}, that of the three pictures {expected}",
        )
        a, b, c = pictures[0]
        measured, expected = tracer.brightness("mc.mse"), (squared_error(a, b) + squared_error(c, b)) / 3
        require(
            abs(measured - expected) <= 1e-4 * expected,
            f"{sampler}: the mean squared error is said to be {measured}, and is {expected}",
        )


main()
