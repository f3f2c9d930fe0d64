#!/usr/bin/env bash
# Makes the Debian packages and the wheel of a build. The packages, unpacked into one folder, are whole and disjoint, and a swarm
# of C++ and Python runs from them alone; the wheel works in a fresh virtual environment.
# Usage: packages.sh SOURCE BUILD CPACK PYTHON
set -euo pipefail
source=$1 build=$2 cpack=$3 python=$4

place=$(mktemp -d /tmp/hive-packages-XXXXXX)
root=$place/root
export HIVE_HOME=$place/home
finish() {
    "$root/usr/bin/hivectl" stop --all > "$place/stopped" 2>&1 || true
    rm -rf "$place"
}
trap finish EXIT
fail() {
    echo "packages: $1" >&2
    exit 1
}

(cd "$place" && "$cpack" --config "$build/CPackConfig.cmake" -G DEB -B "$place/made" -D CPACK_OUTPUT_FILE_PREFIX="$place/debs") \
    > "$place/log" 2>&1 || { tail -n 10 "$place/log" >&2; fail "cpack failed"; }
packages=()
for file in "$place"/debs/*.deb; do
    package=$(dpkg-deb -f "$file" Package)
    packages+=("$package")
    dpkg-deb --contents "$file" | awk '$1 !~ /^d/ { print $6 }' >> "$place/files"
    [[ $package = hive-* ]] || dpkg-deb -x "$file" "$root"  # drones are added when hivectl has asked for them
    dpkg-deb -f "$file" Depends > "$place/$package.depends"
    [ "$package" = libhive0 ] || grep -q 'libhive0 (= ' "$place/$package.depends" || fail "$package does not depend on its libhive0"
done
mapfile -t drones < <(cd "$source/drones" && ls ./*/main.cpp | sed 's#./\(.*\)/main.cpp#hive-\1#')
[ "$(printf '%s\n' "${packages[@]}" | sort)" = "$(printf '%s\n' libhive0 libhive-dev hivectl hive python3-hive "${drones[@]}" | sort)" ] \
    || fail "the packages are ${packages[*]}"
[ -z "$(sort "$place/files" | uniq -d)" ] || fail "in two packages: $(sort "$place/files" | uniq -d)"
architecture=$("$python" -c 'import sys; print(sys.implementation._multiarch)')
for file in "$architecture"/{libhive.so.0,libhive-c.so.0,libhive.so,cmake/hive/hive-config.cmake,pkgconfig/hive-c.pc} \
    python3/dist-packages/hive/__init__.py; do
    [ -e "$root/usr/lib/$file" ] || fail "no package has lib/$file"
done
for file in share/hive/{hive.rules.yml,grafana.json} lib/systemd/user/hive-metrics.service; do
    [ -e "$root/usr/$file" ] || fail "no package has $file"
done
[ -z "$(grep -E 'bin/(hive-)?(ticker|sleeper|counter|crasher|breaker|fork|join)$' "$place/files")" ] || fail "drones of the tests are in a package"
for word in libssl libstdc++ elfutils; do
    grep -q "$word" "$place/libhive0.depends" || fail "libhive0 does not depend on $word: $(cat "$place/libhive0.depends")"
done
! grep -Eq 'spdlog|libfmt' "$place/libhive0.depends" || fail "libhive0 needs more than other distributions have: $(cat "$place/libhive0.depends")"
dpkg-deb -f "$place/debs"/libhive0_*.deb Recommends > "$place/recommended"
grep -q libavahi-client3 "$place/recommended" || fail "libhive0 does not recommend libavahi-client3"
for package in libhive0 hivectl; do
    ! grep -Eq 'opencv|libav|curl' "$place/$package.depends" || fail "$package depends on what drones need: $(cat "$place/$package.depends")"
done
[ "$(grep -lE 'highgui|[Qq]t5|libx11|hive-view' "$place"/*.depends)" = "$place/hive-view.depends" ] \
    || fail "these depend on what hive-view needs: $(grep -lE 'highgui|[Qq]t5|libx11|hive-view' "$place"/*.depends)"
size=$(dpkg-deb -f "$place/debs"/hivectl_*.deb Installed-Size)
[ "$size" -lt 2048 ] || fail "hivectl alone takes $size KiB"
for drone in annotate record replay track zones; do
    ! grep -Eq 'opencv-(dnn|video|imgcodecs|highgui)|libav' "$place/hive-$drone.depends" || fail "hive-$drone depends on more than it needs"
done
grep -q libopencv-highgui "$place/hive-view.depends" || fail "hive-view does not depend on highgui"
! grep -q imgcodecs "$place/hive-view.depends" || fail "hive-view depends on imgcodecs, which brings GDAL"
for drone in "${drones[@]}"; do
    [ "$drone" = hive-view ] || grep -q "$drone (= " "$place/hive.depends" || fail "hive does not bring $drone"
done
dpkg-deb -f "$place/debs"/hive_*.deb Suggests | grep -q hive-view || fail "hive does not suggest hive-view"

export PATH=$root/usr/bin:/usr/bin:/bin HIVE_PYTHON=$python PYTHONPATH=$root/usr/lib/python3/dist-packages
unset LD_LIBRARY_PATH HIVE_DRONE_PATH HIVE_LIBRARY
# Each drone alone: refused with the name of its package, then installed.
for drone in "${drones[@]}"; do
    ! hivectl start "${drone#hive-}" > "$place/out" 2>&1 || fail "$drone starts without its package"
    grep -q "apt install $drone" "$place/out" || fail "hivectl start does not name the package $drone: $(cat "$place/out")"
    dpkg-deb -x "$place/debs/${drone}"_*.deb "$root"
    "$drone" --describe > "$place/out" || fail "$drone does not run"
    [ -s "$root/usr/share/man/man1/$drone.1.gz" ] || fail "$drone has no man page"
done
hivectl start camera width=320 height=240 > "$place/out"
hivectl start edges > "$place/out"
hivectl connect camera edges > "$place/out"
hivectl results edges.edges -n 2 --json --timeout 30 > "$place/out" || fail "no results of edges"
[ "$(grep -c '"share"' "$place/out")" -eq 2 ] || fail "the results of edges are: $(cat "$place/out")"
hivectl stop --all > "$place/out"

# The wheel, without the packages.
wheel=$("$source/scripts/make-wheel" "$build" "$place")
"$python" -m venv "$place/venv"
"$place/venv/bin/pip" install --quiet --no-index --no-deps --disable-pip-version-check "$wheel"
"$place/venv/bin/pip" show --disable-pip-version-check hive-vision > "$place/out"
! "$place/venv/bin/pip" show --disable-pip-version-check hive > "$place/ignored" 2>&1 || fail "on PyPI, hive is another project"
grep -q '^Summary: .*without hivectl' "$place/out" || fail "the wheel does not say that hivectl is not in it"
for library in "$place"/venv/lib/python3*/site-packages/hive/*.so.*; do  # what other distributions have as well
    others=$(readelf -d "$library" | grep -oP 'NEEDED.*\[\K[^]]*' | grep -vE '^(libhive|libssl|libcrypto|libstdc\+\+|libgcc_s|libm|libc|ld-linux)[-.]' || true)
    [ -z "$others" ] || fail "$(basename "$library") of the wheel needs $others"
    newest=$(readelf -V "$library" | grep -oP 'GLIBC_\K2\.[0-9]+' | sort -V | tail -n 1)
    [ "$(printf '%s\n' "$newest" 2.34 | sort -V | tail -n 1)" = 2.34 ] || fail "$(basename "$library") of the wheel needs glibc $newest"
done
unset PYTHONPATH
cat > "$place/try.py" << 'END_OF_PYTHON'
import threading
import hive
from hive import _library

drone = hive.Drone("echo", embedded=True)
output = drone.output("out", "application/json")

@drone.on_event("in", "text/plain")
def answer(event):
    output.emit({"length": len(event.body)})

thread = threading.Thread(target=drone.run)
thread.start()
with hive.Application() as swarm:
    swarm.wait("echo")
    with swarm.collect("echo") as results:
        swarm.put("echo", b"abc", "text/plain")
        print(results.next(30).header["length"], _library._library._name)
    swarm.stop("echo")
thread.join()
END_OF_PYTHON
"$place/venv/bin/python" -W error "$place/try.py" > "$place/out" || fail "the wheel does not work"
[[ $(cat "$place/out") == "3 $place/venv/"* ]] || fail "with the wheel: $(cat "$place/out")"
echo "packages: whole, disjoint, and in use; the wheel works in a fresh environment"
