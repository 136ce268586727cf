#!/bin/sh
# usage: one_object.sh ARCHIVE OBJECT
#
# Makes one relocatable object of cargo's static library: only nf_* is visible, what no nf_* needs is dropped.
# Cargo's own archive also exports compiler-builtins (fmodf, cbrt, ...), which would shadow the C library's.
# LD, NM and OBJCOPY name other tools than ld, nm and objcopy: GNU's or LLVM's, whose ld drops .eh_frame here.
set -eu
archive=$1
object=$2

# Some objects have bitcode beside them, of a newer LLVM than nm's: Debian's GNU nm, with a plugin of LLVM's, then says
# "no symbols", and LLVM's own fails.
bitcode=--no-llvm-bc
case $("${NM:-nm}" --version) in "GNU nm"*) bitcode=--plugin=/none ;; esac
symbols=$("${NM:-nm}" $bitcode --defined-only --extern-only "$archive")
symbols=$(printf '%s\n' "$symbols" | sed -n 's/.* [A-Z] \(nf_[a-z0-9_]*\)$/-u \1/p')
if [ -z "$symbols" ]; then
    echo "error: $archive defines no nf_*: is it the static library of noisefloor-capi?" >&2
    exit 1
fi
# Words of $symbols are arguments; the file names may hold spaces.
# shellcheck disable=SC2086
"${LD:-ld}" -r --gc-sections $symbols -o "$object.new" "$archive"
"${OBJCOPY:-objcopy}" --wildcard --keep-global-symbol='nf_*' --strip-debug -R .llvmbc "$object.new"
mv "$object.new" "$object"
