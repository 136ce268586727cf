"""Operations of a draw in SPIR-V, and noisefloor_sampler.h in Metal: spirv.py GLSLANG INCLUDE SHADER SCRATCH

A draw of the root has at most 38 integer operations, one of its child 75, and each two fetches; none is of 64 bits.
"""

import re
import subprocess
import sys
from pathlib import Path

INTEGER = re.compile(
    r"= Op(I(Add|Sub|Mul|Equal|NotEqual)|Bitwise\w+|Shift\w+|Not|BitReverse|BitField\w+"
    r"|Select|[US](Div|Mod|LessThan|GreaterThan)\w*)\b"
)
# With the root's domain, 0: what no device does, and later versions of spirv-opt leave out.
NOTHING = re.compile(r"= OpBitwiseXor %uint %\w+ %uint_0\b")


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, (command, done.stdout, done.stderr)
    return done.stdout


def main():
    glslang, include, shader, scratch = sys.argv[1:]
    folder = Path(scratch)
    folder.mkdir(parents=True, exist_ok=True)
    for name, options, most in (("root", [], 38), ("child", ["-DCHILD"], 75)):
        module, optimised = str(folder / f"{name}.spv"), str(folder / f"{name}.opt.spv")
        run(glslang, "-V", *options, f"-I{include}", "-o", module, shader)
        run("spirv-opt", "-O", "-O", module, "-o", optimised)
        run("spirv-val", optimised)
        text = run("spirv-dis", optimised)
        operations = len(INTEGER.findall(text)) - len(NOTHING.findall(text))
        # The first member of the table's block: 0, then the index.
        table = re.search(r"OpName (%\w+) \"\"[\s\S]*?OpDecorate (%\w+) Binding 0", text).group(2)
        fetches = len(re.findall(rf"OpAccessChain \S+ {table} ", text))
        assert "OpTypeInt 64" not in text and "OpTypeFloat 64" not in text, "64 bits"
        print(f"{name}: {operations} integer operations, {fetches} fetches")
        assert 10 < operations <= most and fetches == 2, f"more than {most} operations, or not 2 fetches"
        metal = run("spirv-cross", "--msl", module)
        assert "kernel void" in metal and "reverse_bits" in metal, metal[:300]


main()
