"""Every block of C in docs/ that includes the header is a whole piece of code: it compiles as it stands. A block of C++
in examples_c/README.md is what a function does with samples u and f."""

import subprocess
import sys
from program import ROOT, require, say

pieces = 0
for document in sorted((ROOT / "docs").glob("*.md")):
    blocks = [rest.split("\n```")[0] for rest in document.read_text(encoding="utf-8").split("\n```c\n")[1:]]
    for block in (block for block in blocks if '#include "noisefloor.h"' in block):
        strict = "-std=c99 -Wall -Wextra -pedantic -Werror -O2 -Iinclude -x c -c - -o /dev/null".split()
        done = subprocess.run([sys.argv[1], *strict], cwd=ROOT, input=f"{block}\n", text=True)
        require(done.returncode == 0, f"code in {document}")
        pieces += 1
for rest in (ROOT / "examples_c/README.md").read_text(encoding="utf-8").split("\n```cpp\n")[1:]:
    block = rest.split("\n```")[0]
    code = f"""#include "noisefloor.hpp"
#include <array>
#include <vector>
nf_estimate example(const std::vector<float> &u, const std::vector<float> &f)
{{
{block}
return estimate;
}}
"""
    strict = "-std=c++17 -Wall -Wextra -pedantic -Werror -O2 -Iinclude -x c++ -c - -o /dev/null".split()
    done = subprocess.run([sys.argv[2], *strict], cwd=ROOT, input=code, text=True)
    require(done.returncode == 0, "code in examples_c/README.md")
    pieces += 1
say(f"{pieces} pieces of code")
require(pieces > 0, "no document has a block of C that includes the header")
