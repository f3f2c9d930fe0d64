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
for package in libhive0 libhive-dev hive hive-view python3-hive; do
    file=$(echo "$place/debs/${package}"_*.deb)
    [ -f "$file" ] || fail "there is no package $package"
    dpkg-deb --contents "$file" | awk '$1 !~ /^d/ { print $6 }' >> "$place/files"
    [ "$package" = hive-view ] || dpkg-deb -x "$file" "$root"  # added at the end
    dpkg-deb -f "$file" Depends > "$place/$package.depends"
done
[ -z "$(sort "$place/files" | uniq -d)" ] || fail "in two packages: $(sort "$place/files" | uniq -d)"
for file in libhive.so.0 libhive-c.so.0 libhive.so cmake/hive/hive-config.cmake pkgconfig/hive-c.pc \
    python3/dist-packages/hive/__init__.py; do
    [ -e "$root/usr/lib/$file" ] || fail "no package has lib/$file"
done
for word in libspdlog libssl libstdc++ elfutils; do
    grep -q "$word" "$place/libhive0.depends" || fail "libhive0 does not depend on $word: $(cat "$place/libhive0.depends")"
done
dpkg-deb -f "$place/debs"/libhive0_*.deb Recommends > "$place/recommended"
grep -q libavahi-client3 "$place/recommended" || fail "libhive0 does not recommend libavahi-client3"
for package in libhive-dev hive hive-view python3-hive; do
    grep -q 'libhive0 (= ' "$place/$package.depends" || fail "$package does not depend on its libhive0"
done
grep -q libopencv-core "$place/hive.depends" || fail "hive does not depend on OpenCV"
! grep -q libopencv "$place/libhive0.depends" || fail "libhive0 depends on OpenCV"
grep -q libopencv-highgui "$place/hive-view.depends" || fail "hive-view does not depend on highgui"
! grep -q imgcodecs "$place/hive-view.depends" || fail "hive-view depends on imgcodecs, which brings GDAL"
! grep -Eq 'highgui|[Qq]t5|libx11|microhttpd|hive-view' "$place/hive.depends" \
    || fail "hive depends on what only hive-view needs: $(cat "$place/hive.depends")"
dpkg-deb -f "$place/debs"/hive_*.deb Suggests | grep -q hive-view || fail "hive does not suggest hive-view"

export PATH=$root/usr/bin:/usr/bin:/bin HIVE_PYTHON=$python PYTHONPATH=$root/usr/lib/python3/dist-packages
unset LD_LIBRARY_PATH HIVE_DRONE_PATH HIVE_LIBRARY
hivectl start camera width=320 height=240 > "$place/out"
hivectl start edges > "$place/out"
hivectl connect camera edges > "$place/out"
hivectl results edges.edges -n 2 --json --timeout 30 > "$place/out" || fail "no results of edges"
[ "$(grep -c '"share"' "$place/out")" -eq 2 ] || fail "the results of edges are: $(cat "$place/out")"
! DISPLAY=:0 hivectl view camera > "$place/out" 2>&1 || fail "hivectl view works without its package"
grep -q 'apt install hive-view' "$place/out" || fail "hivectl view does not name its package: $(cat "$place/out")"
dpkg-deb -x "$place/debs"/hive-view_*.deb "$root"
hive-view --describe > "$place/out" || fail "hive-view does not run"
[ -s "$root/usr/share/man/man1/hive-view.1" ] || fail "hive-view has no man page"
hivectl stop --all > "$place/out"

# The wheel, without the packages.
wheel=$("$source/scripts/make-wheel" "$build" "$place")
"$python" -m venv "$place/venv"
"$place/venv/bin/pip" install --quiet --no-index --no-deps --disable-pip-version-check "$wheel"
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
