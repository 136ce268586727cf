#!/bin/sh
# usage: installed.sh projects|examples FOLDER CARGO CARGO_TARGET_DIR
#
# Installs the library, and uses it as projects outside the tree would: by CMake and by pkg-config, in C and C++, shared
# and static. What it makes goes into FOLDER.
set -eu
what=$1 work=$2/$1 cargo=$3 target=$4
root=$(cd "$(dirname "$0")/../.." && pwd)
package=$root/tests/package
rm -rf "$work"
mkdir -p "$work"

fail() {
    echo "failed: $*" >&2
    exit 1
}

# Says nothing unless the command fails.
quiet() {
    "$@" > "$work/log" 2>&1 || { cat "$work/log"; fail "$*"; }
}

# configure BUILD PREFIX LIBDIR OPTION...
configure() {
    build=$1 prefix=$2 libdir=$3
    shift 3
    quiet cmake -S "$root/capi" -B "$build" -DCMAKE_BUILD_TYPE=Release "-DCMAKE_INSTALL_PREFIX=$prefix" \
        "-DCMAKE_INSTALL_LIBDIR=$libdir" "-DNOISEFLOOR_CARGO=$cargo" "-DNOISEFLOOR_CARGO_TARGET_DIR=$target" "$@"
    quiet cmake --build "$build" --parallel 2
}

# project SOURCE BUILD OPTION...: configures a project, builds it and runs its tests.
project() {
    source=$1 build=$2
    shift 2
    quiet cmake -S "$source" -B "$build" "$@"
    quiet cmake --build "$build" --parallel 2
    quiet ctest --test-dir "$build" --output-on-failure --no-tests=error
    echo "${build##*/}: $(grep 'tests passed' "$work/log")"
}

# What is called static does not need the shared library, what is called shared does.
linked_as_named() {
    kind=static
    readelf --dynamic --wide "$1" | grep -q 'Shared library: \[libnoisefloor\.so\.' && kind=shared
    case $1 in *_$kind) ;; *) fail "$1 is linked with the $kind library" ;; esac
}

# pkg_config LIB COMPILER SOURCE PROGRAM BEFORE AFTER: compiles with what pkg-config says, and runs.
pkg_config() {
    flags=$(PKG_CONFIG_PATH=$1/pkgconfig pkg-config --cflags --libs noisefloor)
    # pkg-config escapes the spaces of paths for a shell, which `eval` is.
    eval "$2 -Wall -Wextra -pedantic -Werror \"\$package/$3\" $5 $flags $6 -o \"\$4\""
    linked_as_named "$4"
    LD_LIBRARY_PATH=$1 "$4" > "$work/log" || fail "$4"
    echo "${4##*/}: by pkg-config"
}

# An installation that no longer is where it was made for, in folders with spaces in their names.
made="$work/made here" moved="$work/moved here" own="$work/install build"
configure "$own" "$made" lib
quiet cmake --install "$own"
mv "$made" "$moved"
if [ "$what" = examples ]; then
    # As its reader would, outside the tree; those that are quick are run.
    project "$root/examples_c" "$work/an examples build" "-DCMAKE_PREFIX_PATH=$moved"
    exit
fi

# The shared library exports what the ABI has and no more, and its soname has the ABI's version.
shared=$moved/lib/libnoisefloor.so
version=$(sed -n 's/^version //p' "$root/capi/abi.txt")
sed -n 's/^function [^(]*[ *]\(nf_[a-z0-9_]*\)(.*/\1/p; s/^object .* //p' "$root/capi/abi.txt" |
    sed "s/\$/@@NOISEFLOOR_$version/" | sort > "$work/wanted"
nm --plugin=/none --dynamic --defined-only "$shared" | sed 's/.* //' |
    grep -vx "NOISEFLOOR_$version" | sort > "$work/found"
diff "$work/wanted" "$work/found" || fail "$shared exports (>) what the ABI has not, or lacks (<) what it has"
readelf --dynamic --wide "$shared" | grep -q "Library soname: \[libnoisefloor\.so\.$version\]" ||
    fail "$shared has not the soname libnoisefloor.so.$version"
echo "$(wc -l < "$work/found") symbols exported"
[ "$(readelf --debug-dump=frames "$shared" | grep -c FDE)" -gt 100 ] || fail "$shared has no tables to unwind by"

project "$package" "$work/a package build" "-DCMAKE_PREFIX_PATH=$moved"
for program in c_shared c_static cpp_shared cpp_static; do
    linked_as_named "$work/a package build/$program"
done
for kind in shared static; do
    before='' after=''
    if [ $kind = static ]; then before=-Wl,-Bstatic after=-Wl,-Bdynamic; fi
    pkg_config "$moved/lib" "${CC:-cc} -std=c99" app.c "$work/pkg_config_c_$kind" "$before" "$after"
    pkg_config "$moved/lib" "${CXX:-c++} -std=c++17" app.cpp "$work/pkg_config_cpp_$kind" "$before" "$after"
    # The common name is of the one that alone is asked for.
    project "$package" "$work/$kind asked for" "-DCMAKE_PREFIX_PATH=$moved" -DKIND=$kind -DBOTH=ON
    linked_as_named "$work/$kind asked for/app_$kind"
done

# Debian's way: the prefix is /usr, libraries are in a folder of the architecture, and $DESTDIR stands before all.
configure "$own" /usr /usr/lib/x86_64-linux-gnu
DESTDIR="$work/a staged install" quiet cmake --install "$own"
lib="$work/a staged install/usr/lib/x86_64-linux-gnu"
# Of the system's own folders the compiler must not be told.
flags=$(PKG_CONFIG_PATH=$lib/pkgconfig pkg-config --cflags noisefloor)
[ -z "$flags" ] || fail "noisefloor.pc in $lib tells the compiler $flags"
doc=../../share/doc/noisefloor
for name in libnoisefloor.a libnoisefloor.so cmake/noisefloor/noisefloorConfig.cmake ../../include/noisefloor.h \
    $doc/LICENSE-MIT $doc/LICENSE-APACHE $doc/THIRD_PARTY.md; do
    [ -f "$lib/$name" ] || fail "$lib/$name was not installed"
done
echo "a staged install"
# As some distributions divide packages: folders are outside the prefix, or the prefix itself.
apart="$work/headers apart"
configure "$own" "$work/a prefix" "$work/apart" "-DCMAKE_INSTALL_INCLUDEDIR=$apart"
quiet cmake --install "$own"
[ -f "$apart/noisefloor.h" ] || fail "$apart/noisefloor.h was not installed"
pkg_config "$work/apart" "${CC:-cc}" app.c "$work/pkg_config_apart_shared" '' ''
configure "$own" "$work/flat" "$work/flat" "-DCMAKE_INSTALL_INCLUDEDIR=$work/flat"
quiet cmake --install "$own"
pkg_config "$work/flat" "${CC:-cc}" app.c "$work/pkg_config_flat_shared" '' ''

# Some distributions remove Cargo.lock, for cargo to take their own packages.
mkdir "$work/unlocked"
tar -C "$root" --exclude=target --exclude=.git --exclude=./Cargo.lock -cf - . | tar -C "$work/unlocked" -xf -
quiet cmake -S "$work/unlocked/capi" -B "$work/unlocked build" "-DNOISEFLOOR_CARGO=$cargo"
! grep -rq -e --locked "$work/unlocked build" --include=*.make || fail "cargo is told --locked without a Cargo.lock"
# cargo's configuration is the source's, which names vendored packages: a broken one is read, and refused.
echo '[' >> "$work/unlocked/.cargo/config.toml"
! cmake --build "$work/unlocked build" > "$work/log" 2>&1 || fail "the source's .cargo/config.toml is not read"
grep -q unlocked/.cargo/config.toml "$work/log" || { cat "$work/log"; fail "cargo's configuration is not refused"; }

# Where only one of the libraries is there, projects find nothing of the other, and under the common name that one.
for kind in static shared; do
    off=NOISEFLOOR_SHARED there=libnoisefloor.a absent=libnoisefloor.so
    if [ $kind = shared ]; then off=NOISEFLOOR_STATIC there=libnoisefloor.so absent=libnoisefloor.a; fi
    prefix="$work/only $kind"
    configure "$prefix build" "$prefix" lib -D$off=OFF
    quiet cmake --install "$prefix build"
    [ -e "$prefix/lib/$there" ] || fail "an installation of the $kind library alone has no $there"
    [ ! -e "$prefix/lib/$absent" ] || fail "an installation of the $kind library alone has $absent"
    project "$package" "$prefix project" "-DCMAKE_PREFIX_PATH=$prefix" -DKIND=$kind
    linked_as_named "$prefix project/app_$kind"
    # The file is the same for both, and the linker takes what there is.
    pkg_config "$prefix/lib" "${CC:-cc}" app.c "$work/pkg_config_only_$kind" '' ''
done

# As a part of another project, by add_subdirectory and by FetchContent.
for fetch in OFF ON; do
    project "$package/subproject" "$work/a subproject with FETCH $fetch" "-DNOISEFLOOR_SOURCE=$root" -DFETCH=$fetch \
        "-DNOISEFLOOR_CARGO=$cargo" "-DNOISEFLOOR_CARGO_TARGET_DIR=$target"
done
