"""The test of examples_c/fit_image.cpp: short runs, and what it says to bad options and bad pictures."""

import sys
from program import Program, require, value, without_seconds

PHOTOGRAPH = "examples_c/data/house_cat.ppm"
METHODS = ["uniform", "is", "balance3", "omis3", "balance6", "omis6"]
SMALL = "--batch 16 --width 4 --seeds 1 --methods omis6".split()


def results(program):
    pictures = program.folder / "short"
    short = ["--image", PHOTOGRAPH, "--methods", ",".join(METHODS), *"--width 32 --steps 300 --records 2".split()]
    for strata in [[], ["--stratified"]]:
        arguments = [*short, *strata, "--seeds", "1", "--output", pictures]
        csv = program.run(*arguments)
        require(without_seconds(program.run(*arguments)) == without_seconds(csv), "the same seed gave other numbers")
        for method in METHODS:
            loss = value(csv, f"{method},1,300,", 1)
            # Measured: .0035 to .0036. One colour for the whole picture is .016.
            require(loss <= 0.008, f"{method}: a mean squared error of {loss}")
            for kind in ["ppm", "error.ppm"]:
                picture = pictures.with_name(f"short.{method}.{kind}")
                data = picture.read_bytes()
                is_picture = len(data) == 15 + 3 * 192 * 192 and data.startswith(b"P6\n192 192\n255\n")
                require(is_picture, f"{picture} is no picture")
    few = "--methods is,omis6 --width 16 --steps 300 --batches 40 --seeds 1".split()
    csv = program.run("--image", PHOTOGRAPH, "--variance", *few)
    for method in ["is", "omis6"]:
        error = value(csv, f"300,{method},fresh,")
        # Measured: .58 and .53, of forty batches.
        require(0.3 <= error < 0.95, f"{method}: an error of {error} times uniform sampling's")
    small(program)


def write(program, header, length):
    path = program.folder / "small.ppm"
    path.write_bytes(header.encode() + bytes(index * 37 % 251 for index in range(length)))
    return ["--image", path, *SMALL]


def small(program):
    """A small picture that is right."""
    arguments = write(program, "P6\n# a comment\n17 16\n255\n", 3 * 17 * 16)
    program.run(*arguments, *"--steps 40 --stratified".split())
    program.run(*arguments, *"--steps 40 --variance --batches 3".split())


def refusals(program):
    """Pictures and options that are wrong: an error that says why."""
    arguments = write(program, "P6\n# a comment\n17 16\n255\n", 3 * 17 * 16)
    program.refuses("--batch: 512 is more than the picture's 272 pixels", *arguments, "--batch", "512")
    program.refuses("above 17, not 17", *arguments, "--variance", "--steps", "17")
    program.refuses("nowhere/nothing", *arguments, "--steps", "2", "--output", "nowhere/nothing")
    for header, length, word in [
        ("", 0, "P6"),
        ("P5\n16 16\n255\n", 256, "P6"),
        ("P6\n16 x\n255\n", 768, "header"),
        ("P6\n16 16\n255\n", 767, "ends early"),
        ("P6\n16 16\n65535\n", 1536, "8 bits"),
        ("P6\n8 16\n255\n", 384, "8 x 16 pixels"),
    ]:
        program.refuses(word, *write(program, header, length))
    for word, options in [
        ("nowhere/nothing.ppm", ["--image", "nowhere/nothing.ppm"]),
        ("--nonsense", ["--nonsense", "1"]),
        ("--steps", ["--steps"]),
        ("--steps: `0` is not a number from 1 to 1e+07", ["--steps", "0"]),
        ("--batch", ["--batch", "40"]),
        ("nonsense", ["--methods", "is,nonsense"]),
        ("twice", ["--methods", "is,is"]),
        ("--methods", ["--methods", ""]),
        ("--rate", ["--rate", "nan"]),
    ]:
        program.refuses(word, *options)


globals()[sys.argv[2]](Program(sys.argv[1]))
