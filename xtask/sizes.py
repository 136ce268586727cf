"""How large the product, its tools and its documents are: printed by a step of `cargo xtask test`.

Usage: sizes.py LIBRARY, the C library, from the repository's root."""

import os
import re
import subprocess
import sys
import tempfile

FILES = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.split()
TEXTS = {}
for name in FILES:
    if name.endswith((".rs", ".md", ".c", ".h", ".hpp", ".cpp")) and os.path.exists(name):
        TEXTS[name] = open(name, encoding="utf-8").read()


def under(prefix, ending=""):
    return {name: text for name, text in TEXTS.items() if name.startswith(prefix) and name.endswith(ending)}


def lines(prefix, ending=".rs"):
    return sum(text.count("\n") for text in under(prefix, ending).values())


def count(prefix, word):
    return sum(text.count(word) for text in under(prefix, ".rs").values())


def say(what, figures):
    print(f"   {what:<34} {figures}")


# Circles of imports: a file reaches those whose items its `use` names, wherever they were taken from. Tests apart.


def paths_of(tree, prefix=()):
    """The paths of a `use`: a::{b, c::d} is a::b and a::c::d."""
    depth, part, parts = 0, "", []
    for letter in tree + ",":
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            parts.append(part.strip())
            part = ""
        else:
            part += letter
    for part in filter(None, parts):
        head, brace, inside = part.partition("{")
        words = tuple(word for word in re.split(r"::", re.sub(r"\s+as\s+\w+", "", head).strip()) if word)
        if brace:
            yield from paths_of(inside.rsplit("}", 1)[0], prefix + words)
        else:
            yield prefix + words


def uses_of(source):
    """A crate's modules with the paths that they use, from the crate's root, and those that they pass on."""
    modules = {}
    for name, text in under(source + "/", ".rs").items():
        words = name[len(source) + 1 : -3].split("/")
        is_folder = words[-1] in ("mod", "lib", "main")
        module = tuple(words[:-1] if is_folder else words)
        text = re.sub(r"//.*", "", text.split("#[cfg(test)]")[0])
        modules.setdefault(module, [name, [], {}])
        for passed_on, tree in re.findall(r"^\s*(pub(?:\([\w ]+\))? )?use ([^;]+);", text, re.M):
            for path in paths_of(tree):
                base = module
                while path and path[0] in ("self", "super"):
                    base, path = (base if path[0] == "self" else base[:-1]), path[1:]
                path = path[1:] if path[:1] == ("crate",) else base + path
                modules[module][1].append(path)
                if passed_on and path:
                    modules[module][2][path[-1]] = path
    return modules


def owner(modules, path, depth=0):
    """The file that has what a path names; none of another crate's."""
    for length in range(len(path), 0, -1):
        if path[:length] in modules:
            name, _, passed_on = modules[path[:length]]
            target = passed_on.get(path[length]) if length < len(path) else None
            return owner(modules, target, depth + 1) if target and depth < 9 else name
    return modules.get((), [None])[0] if len(path) == 1 else None


def circles(source):
    modules = uses_of(source)
    reach = {name: {owner(modules, path) for path in used} - {name, None} for name, used, _ in modules.values()}
    for middle in reach:
        for name in reach:
            if middle in reach[name]:
                reach[name] = reach[name] | reach[middle]
    return {frozenset(other for other in reach[name] if name in reach[other]) for name in reach if name in reach[name]}


def program(library, *options):
    """Bytes of examples_c/integrate.c, linked as README links and stripped."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["-O2", "-Iinclude", "examples_c/integrate.c", library, "-Wl,--gc-sections", "-s", "-lm", *options]
        subprocess.run([os.environ.get("CC") or "cc", *words, "-o", folder + "/program"], check=True)
        return os.path.getsize(folder + "/program")


def seen(text):
    """What a reader sees of a document's prose: no code, no comments, no targets of links."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    return re.sub(r"<!--.*?-->|\]\([^)]*\)", " ", text, flags=re.S)


rooms = ["core/src", "core/src/control_variate", "capi/src", "fsot", "tests", "bench", "release", "report", "xtask"]
say("lines of Rust", ", ".join(f"{room} {lines(room + '/')}" for room in rooms))
tree = [os.environ.get("CARGO", "cargo"), *"tree --package xtask --prefix none --edges normal,build".split()]
tree = subprocess.run(tree, capture_output=True, text=True, check=True).stdout
packages = {line.removesuffix(" (*)") for line in tree.splitlines()}
tools = sum(lines(room + "/") for room in ["bench", "release", "report", "xtask"])
say("tools over product", f"{tools / (lines('core/src/') + lines('capi/src/')):.2f}")
say("xtask", f"{len(under('xtask/', '.rs'))} files, {len(packages)} packages")
say("in core/src", ", ".join(f"{count('core/src/', word)} {word}" for word in ["unwrap_or", "inline(always)"]))
fence = re.compile(r"//[/!] ```.*\n((?:\s*//[/!](?! ```).*\n)*)\s*//[/!] ```")
doctests = "".join(part for text in under("core/src/", ".rs").values() for part in fence.findall(text))
say("lines of doctests in core/src", doctests.count("\n"))
headers = {name: text.count("\n") for name, text in under("include/noisefloor", ".h").items() if "_" not in name}
each = ", ".join(f"{os.path.basename(name)} {length}" for name, length in headers.items())
say("lines of headers", f"{sum(headers.values())}: {each}")
functions = re.findall(r"^function ", open("capi/abi.txt", encoding="utf-8").read(), re.M)
say("functions of the C ABI", len(functions))
found = [circle for room in ["core", "capi", "fsot", "bench", "report", "xtask"] for circle in circles(room + "/src")]
say("circles of imports", len(found))
for circle in found:
    print("      " + ", ".join(sorted(circle)))
readme = TEXTS["README.md"]
first = len(readme.split("nf_cv_image_estimate")[0].split()) + 1
numbers = len(re.findall(r"[0-9][0-9.]*|[.][0-9]+", seen(readme)))
say("README.md", f"{len(readme.split())} words, {numbers} numbers, {readme.count(chr(10))} lines")
say("first call of what is pictured", f"word {first} of README.md")
words = sum(len(text.split()) for name, text in under("docs/", ".md").items() if not name.startswith("docs/report/"))
say("words of guides", words)
report = sum(os.path.getsize(name) for name in FILES if name.startswith("docs/report/") and os.path.exists(name))
say("docs/report", f"{report / 1e6:.2f} MB")
walks = TEXTS["CONTRIBUTING.md"].split("## Walks")[1].split("\n## ")[0]
walks = re.findall(r"^- \*\*(.*?)\*\*:(.*?)(?=^- |\Z)", walks, re.S | re.M)
named = re.compile(r"[\w/]+[.](?:rs|c|nft|json|md)")
for name, walk in walks:
    say("files of a walk", f"{len(named.findall(walk))}: {' '.join(name.split())}")
say("integrate.c, stripped", f"{program(sys.argv[1]) / 1000:.0f} kB, with the default sampler "
    f"{program(sys.argv[1], '-Wl,--undefined=nf_sampler_draw') / 1000:.0f} kB")
if found:
    sys.exit("files import each other in circles: those above")
