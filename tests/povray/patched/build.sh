#!/bin/sh
# Builds POV-Ray from Debian's source package with noisefloor.patch: build.sh FOLDER LIBRARY
#
# FOLDER/source/unix/povray is the program, which links the archive LIBRARY. What is there already stays, so that later
# builds take seconds. apt's configuration and lists are left alone.
set -eu
ours=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$ours/../../.." && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
library=$(realpath "$2")
source=$folder/source

fail() {
    echo "$*" >&2
    exit 1
}

if [ ! -e "$source" ]; then
    [ -e /etc/debian_version ] || fail "POV-Ray is built from Debian's source package: run this in a Debian container"
    echo "fetching POV-Ray's source (53 MB)"
    mkdir -p "$folder/apt/lists"
    keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    [ -e $keyring ] && signed="[signed-by=$keyring] " || signed=
    # Binary and source packages of those archives of Debian that the machine uses already.
    apt-get indextargets --format '$(ORIGIN)|$(CREATED_BY)|$(REPO_URI) $(RELEASE) $(COMPONENT)' |
        awk -F'|' -v signed="$signed" '$1 == "Debian" && $2 == "Packages" { for (n = 0; n < 2; ++n)
            print (n ? "deb-src " : "deb ") signed $3 }' | sort -u > "$folder/apt/sources.list"
    [ -s "$folder/apt/sources.list" ] ||
        fail "apt-get knows no archive of Debian: run \`apt-get update\` once, then try again"
    apt() {
        # Without the last option apt warns that its own user cannot write into the folder.
        DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dir::Etc::sourcelist="$folder/apt/sources.list" \
            -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists="$folder/apt/lists" -o APT::Sandbox::User=root "$@"
    }
    apt update || fail "the package lists could not be fetched: is the network there?"
    if apt --simulate build-dep povray | grep -q '^Inst '; then
        [ "$(id -u)" = 0 ] || fail "what POV-Ray is built with is missing. As root: apt-get build-dep povray"
        apt -y --no-install-recommends build-dep povray
    fi
    rm -rf "$folder/unpacked"
    mkdir "$folder/unpacked"
    (cd "$folder/unpacked" && apt source povray)
    cd "$folder"/unpacked/*/
    grep -q '^povray (1:3\.7\.0\.10-' debian/changelog || fail "the patch is for 1:3.7.0.10, and this is $(pwd)"
    mv "$(pwd)" "$source"
    rm -rf "$folder/unpacked"
fi

# Whether a patch fits is known before anything is changed.
put() {
    for dry in --dry-run ''; do
        patch --strip=1 --fuzz=0 --batch --silent $dry "$1" --input "$2" ||
            fail "$2 does not fit $source: remove that folder, and it is fetched anew"
    done
}
cd "$source"
if ! cmp -s noisefloor.patch "$ours/noisefloor.patch"; then
    if [ -e noisefloor.patch ]; then
        put --reverse noisefloor.patch
        rm noisefloor.patch
    fi
    put --forward "$ours/noisefloor.patch"
    cp "$ours/noisefloor.patch" .
fi

# As debian/rules does, so that the same compiler options make the same pictures.
if [ ! -e unix/Makefile ]; then
    echo "configuring POV-Ray"
    [ ! -e libraries ] || mv libraries libraries.donotuse
    flags() {
        DEB_BUILD_MAINT_OPTIONS=hardening=+all dpkg-buildflags --get "$1"
    }
    (cd unix && sh prebuild.sh) > "$folder/configure.log" 2>&1 || fail "prebuild.sh failed: $folder/configure.log"
    ./configure --quiet --prefix=/usr --sysconfdir=/etc --disable-optimiz --disable-strip \
        --with-boost-thread=boost_thread CXXFLAGS="$(flags CXXFLAGS) -O3 -g0" LDFLAGS="$(flags LDFLAGS)" \
        CPPFLAGS="$(flags CPPFLAGS) -I$ours" \
        COMPILED_BY="noisefloor, with changes, not for distribution <nobody@localhost>" \
        >> "$folder/configure.log" 2>&1 || fail "configure failed: $source/config.log; without $source it starts anew"
fi

# Our side, compiled as strictly as everything else of ours.
"${CXX:-c++}" -std=c++17 -O2 -Wall -Wextra -pedantic -Werror -fPIE -I"$root/include" \
    -I"$root/examples_c/pathtracer" -c "$ours/bridge.cpp" -o "$folder/bridge.o"
# make does not know of our objects, and would leave it as it is.
rm -f unix/povray
echo "building POV-Ray (the first time takes minutes)"
nice -n 10 make -j"$(nproc)" NOISEFLOOR="$folder/bridge.o $library" > "$folder/make.log" 2>&1 ||
    fail "POV-Ray did not compile: $folder/make.log"
