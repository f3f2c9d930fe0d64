#!/usr/bin/env bash
# Installs a build into an empty prefix, then uses nothing else: builds the drones of libhive/language/README.md and README.md
# in C++ by find_package and in C by pkg-config, and runs them, and the one in Python, in a swarm with the drones that were
# installed.
# Usage: run.sh SOURCE BUILD CMAKE CXX CC PYTHON
set -euo pipefail
source=$1 build=$2 cmake=$3 cxx=$4 cc=$5 python=$6

place=$(mktemp -d /tmp/hive-install-XXXXXX)
prefix=$place/prefix
finish() {
    [ ! -x "$prefix/bin/hivectl" ] || "$prefix/bin/hivectl" stop --all > "$place/stopped" 2>&1 || true
    rm -rf "$place"
}
trap finish EXIT
fail() {
    echo "install: $1" >&2
    exit 1
}

"$cmake" --install "$build" --prefix "$prefix" > "$place/log" || { tail -n 5 "$place/log"; fail "cmake --install failed"; }

# Whole, and without a trace of where it was built.
for file in bin/hivectl bin/hive-camera bin/hive-edges include/hive.h include/hive_swarm.h include/hive/drone.hpp include/hive/embedded_drone.hpp \
    include/hive/application.hpp include/hive/vision/image.hpp share/man/man1/hivectl.1.gz share/man/man1/hivectl-connect.1.gz \
    share/man/man1/hive-camera.1.gz share/bash-completion/completions/hivectl lib/python3/dist-packages/hive/drone.py; do
    [ -s "$prefix/$file" ] || fail "there is no $file"
done
[ ! -e "$prefix/include/hive/event/module.hpp" ] && [ ! -e "$prefix/include/hive/protocol" ] || fail "private headers are installed"
if grep -rlIF -e "$source/" -e "$build/" "$prefix"; then
    fail "these name the place of the build"
fi
for binary in "$prefix"/bin/* "$prefix"/lib*/*.so "$prefix"/lib/*/*.so; do
    if readelf -d "$binary" 2> "$place/ignored" | grep -E 'RPATH|RUNPATH' | grep -F -e "$build" -e "$source"; then
        fail "$binary looks for libraries in the build"
    fi
done
[ "$(find "$prefix/share/man/man1" -name 'hivectl-*.1.gz' | wc -l)" -ge 15 ] || fail "there are verbs without a man page"
bash -n "$prefix/share/bash-completion/completions/hivectl"

# The drones of the page, in folders of their own.
# shellcheck source=page.sh
source "$source/tests/install/page.sh"
libraries=$(dirname "$(find "$prefix" -name libhive.so)")
export PKG_CONFIG_PATH=$libraries/pkgconfig
write_drones "$source" "$place"
for drone in cpp blur; do
    {
        "$cmake" -S "$place/$drone" -B "$place/$drone/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$cxx"
        "$cmake" --build "$place/$drone/build"
    } > "$place/log" 2>&1 || { tail -n 20 "$place/log" >&2; fail "the drone $drone does not build by find_package(hive)"; }
done
modules=$(ldd "$place/blur/build/hive-blur" | grep -o 'libopencv_[a-z0-9]*' | sort -u | xargs)
[ "$modules" = "libopencv_core libopencv_imgproc" ] || fail "hive-blur loads these modules of OpenCV: $modules"
# shellcheck disable=SC2046
"$cc" -std=c11 -Wall -Werror "$place/c/main.c" -o "$place/c/hive-brightness" $(pkg-config --cflags --libs hive-c) \
    -Wl,-rpath,"$libraries" -Wl,-rpath-link,"$libraries" || fail "a drone in C does not build by pkg-config"

# A swarm of what is installed and what was built.
export HIVE_HOME=$place/home PATH=$prefix/bin:/usr/bin:/bin HIVE_PYTHON=$python
unset PYTHONPATH LD_LIBRARY_PATH HIVE_DRONE_PATH
[[ $(hivectl --version) =~ ^hivectl\ [0-9.]+\ \(protocol\ [0-9]+\)$ ]] || fail "hivectl --version says $(hivectl --version)"
hivectl start camera width=320 height=240 > "$place/out"
HIVE_DRONE_PATH=$place/cpp/build hivectl start brightness --as in-cpp > "$place/out"
HIVE_DRONE_PATH=$place/c hivectl start brightness --as in-c > "$place/out"
drones=(in-cpp in-c)
if [ -n "$python" ]; then
    hivectl start "$place/py/brightness.py" --as in-python > "$place/out"
    drones+=(in-python)
fi
for drone in "${drones[@]}"; do
    hivectl connect camera "$drone" > "$place/out"
    hivectl results "$drone" -n 2 --json --timeout 30 > "$place/out" || fail "no results of $drone"
    [ "$(grep -c '"mean"' "$place/out")" -eq 2 ] || fail "the results of $drone are: $(cat "$place/out")"
done
"$place/blur/build/hive-blur" --describe > "$place/out" || fail "hive-blur --describe fails"
HIVE_DRONE_PATH=$place/blur/build hivectl start blur radius=5 > "$place/out"
hivectl connect camera blur > "$place/out"
hivectl snap blur "$place/blurred.jpg" > "$place/out" || fail "README's drone sends no picture"
[ -s "$place/blurred.jpg" ] || fail "README's drone sends no picture"
drones+=(blur)
hivectl stop --all > "$place/out"

# The page tells how to remove it again.
# shellcheck disable=SC2016
sed -n '/^prefix=/,/^```/{/^```/d;p}' "$source/libhive/docs/installing.md" \
    | sed -e "s#^prefix=.*#prefix=$prefix#" -e "s#build/release#$build#" > "$place/uninstall"
[ -s "$place/uninstall" ] || fail "the page does not say how to uninstall"
bash -e "$place/uninstall"
[ -z "$(find "$prefix" ! -type d)" ] || fail "uninstalling leaves $(find "$prefix" ! -type d | head -n 5 | xargs)"
echo "install: whole, and ${drones[*]} work outside of the repository"
