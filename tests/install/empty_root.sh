#!/usr/bin/env bash
# An empty Debian, and in it the packages of a build and nothing else of Hive: README's drone built with libhive-dev, g++ and cmake alone,
# then a swarm of what is installed, drones built there in C++, C and Python, the commands of the pages, the wheel in a fresh environment.
# Needs root, debootstrap and a network, and downloads some 500 MB, so it is run by hand:
# tests/install/empty_root.sh SOURCE BUILD [ROOT]
set -euo pipefail
source=$(cd "$1" && pwd) build=$(cd "$2" && pwd)
place=$(mktemp -d /tmp/hive-empty-XXXXXX)
root=${3:-$place/root}
finish() {
    umount "$root/proc" 2> "$place/ignored" || true
    rm -rf "$place"
}
trap finish EXIT

# shellcheck source=page.sh
source "$source/tests/install/page.sh"
[ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root" > "$place/log" || { tail "$place/log" >&2; exit 1; }
mkdir -p "$root/try"
(cd "$place" && cpack --config "$build/CPackConfig.cmake" -G DEB -B "$place/made" -D CPACK_OUTPUT_FILE_PREFIX="$root/try" > "$place/log")
"$source/scripts/make-wheel" "$build" "$root/try" > "$place/log"
write_drones "$source" "$root/try"
block "$source/README.md" shell "swarm.collect" > "$root/try/image.sh"
for page in README.md hivectl/README.md libhive/docs/swarm-file.md libhive/docs/is-it-working.md; do
    awk '/^```sh$/ { inside = 1; next } /^```/ { inside = 0 } inside' "$source/$page" > "$root/try/$(tr / - <<< "$page").sh"
done
mkdir -p "$root/try/source/libhive/language/python"
cp "$source"/libhive/language/python/*.md "$root/try/source/libhive/language/python"
cp "$source"/tests/support/reader.sh "$source"/tests/language/python/{world,test_pages}.py "$root/try"
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"

cat > "$root/try/in_there.sh" << 'END'
set -euo pipefail
cd /try
export DEBIAN_FRONTEND=noninteractive HIVE_HOME=/tmp/home LC_ALL=C.UTF-8
fail() { echo "empty_root: $1" >&2; exit 1; }
apt-get update -qq
apt-get install -y -qq --no-install-recommends ./libhive0_*.deb ./libhive-dev_*.deb g++ cmake make > log 2>&1 \
    || { tail -n 5 log; fail "libhive-dev does not install"; }
{ cmake -S blur -B blur/build && cmake --build blur/build; } > log 2>&1 || { cat log; fail "README's drone does not build"; }
blur/build/hive-blur --describe > log || fail "hive-blur --describe fails"
grep -q '"blur"' log || fail "hive-blur --describe prints: $(cat log)"
echo "empty_root: README's drone builds with libhive-dev, $(ldd blur/build/hive-blur | wc -l) libraries"
apt-get install -y -qq --no-install-recommends ./*.deb > log 2>&1 || { tail -n 5 log; fail "the packages do not install"; }
trap 'hivectl stop --all > log 2>&1 || true' EXIT
hivectl start camera > log
hivectl start face > log
hivectl connect camera face
[ "$(hivectl results face -n 3 --json --timeout 60 | wc -l)" -eq 3 ] || fail "no results of face"
echo "empty_root: hivectl start camera face: the swarm runs, from the packages alone"
apt-get install -y -qq --no-install-recommends pkg-config python3-numpy python3-venv > log 2>&1
{ cmake -S cpp -B cpp/build && cmake --build cpp/build; } > log 2>&1 || { cat log; fail "no drone in C++"; }
mkdir -p c/build
# shellcheck disable=SC2046
cc -std=c11 -Wall -Werror c/main.c -o c/build/hive-brightness $(pkg-config --cflags --libs hive-c) || fail "no drone in C"
hivectl start camera --as pixels width=320 height=240 > log
HIVE_DRONE_PATH=/try/cpp/build hivectl start brightness --as in-cpp
HIVE_DRONE_PATH=/try/c/build hivectl start brightness --as in-c
hivectl start py/brightness.py --as in-python
for drone in in-cpp in-c in-python; do
    hivectl connect pixels "$drone"
    [ "$(hivectl results "$drone" -n 2 --json --timeout 30 | grep -c '"mean"')" -eq 2 ] || fail "no results of $drone"
done
hivectl stop --all > log
apt-get install -y -qq --no-install-recommends python3-opencv jq > log 2>&1
for page in *.md.sh; do
    mkdir -p "read/$page"
    (cd "read/$page" && program=/usr/bin/hivectl timeout=3 && . /try/reader.sh && . "/try/$page") > log 2>&1 \
        || { tail -n 20 log; fail "the commands of ${page%.sh} do not run"; }
    hivectl stop --all > log 2>&1 || true
done
pages=(the_tutorial images two_cameras a_video a_tracker a_source a_sweep asyncio a_notebook processes)
HIVE_TEST_PROGRAMS=/usr/bin HIVE_SOURCE_DIR=/try/source python3 -m unittest "${pages[@]/#/test_pages.Pages.test_}" > log 2>&1 \
    || { tail -n 30 log; fail "the pages of Python do not run"; }
! grep -q skipped log || fail "of the pages of Python: $(tail -n 1 log)"
echo "empty_root: the commands of the pages run, from the packages alone"
hivectl start camera --as pixels > log
python3 -m venv venv
mkdir -p build/release/packages
mv ./*.whl ./*.deb build/release/packages/
. venv/bin/activate
sudo() { "$@" -y; }
{ . ./image.sh; } > log 2>&1 || { cat log; fail "no image from the wheel"; }
[ "$(head -c 3 image.jpg | od -An -tx1)" = " ff d8 ff" ] || fail "image.jpg is no JPEG"
python -c 'import hive; print("empty_root: an image by the wheel, which sees", hive.Application().drones())'
END
chroot "$root" bash /try/in_there.sh
echo "empty_root: nothing of the repository is needed"
