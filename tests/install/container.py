#!/usr/bin/env python3
"""scripts/container/Containerfile against what it is made of and what uses it: the packages of a build, and what is
written for compose and Kubernetes. No container engine is needed.

With ROOT, a folder that is or becomes an empty Debian, the steps are run in there, and then drones with the command
lines, variables, keys and probes of both forms. That needs root, debootstrap and a network, and downloads some 300 MB,
so it is run by hand.

Usage: container.py SOURCE BUILD CPACK [ROOT]
"""
import fnmatch
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

SOURCE, BUILD = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
CPACK, ROOT = sys.argv[3], sys.argv[4] if len(sys.argv) > 4 else ""
sys.path.insert(0, str(SOURCE / "tests/e2e"))
sys.dont_write_bytecode = True
import engine_stand_in  # noqa: E402


def require(good, text):
    if not good:
        sys.exit(f"container: {text}")


def output_of(*words, **options):
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True, timeout=600, **options).stdout


def instructions(text):
    """Pairs of a word and the rest of its line."""
    lines = "\n".join(line for line in text.splitlines() if not line.startswith("#")).replace("\\\n", " ")
    return [tuple(line.split(None, 1)) for line in lines.splitlines() if line.strip()]


def packages(place):
    """By the name of the file: what the package puts into /usr/bin."""
    output_of(CPACK, "--config", BUILD / "CPackConfig.cmake", "-G", "DEB", "-B", place / "made", "-D",
              f"CPACK_OUTPUT_FILE_PREFIX={place}/debs", cwd=place, stderr=subprocess.DEVNULL)
    return {deb.name: set(re.findall(r"\./usr/bin/(\S+)$", output_of("dpkg-deb", "-c", deb), re.MULTILINE))
            for deb in (place / "debs").glob("*.deb")}


def written(place, form):
    """What is written for each ready-made swarm, and its text."""
    runs, text = {}, ""
    for swarm in (SOURCE / "scripts/swarms").glob("*.json"):
        folder = place / form / swarm.stem
        output_of(BUILD / "bin/hivectl", "export", "--from", swarm, "--as", form, "--to", folder)
        runs[swarm.stem] = list(getattr(engine_stand_in, form)(folder))
        text += "".join(file.read_text() for file in folder.iterdir())
    return runs, text


def check(text, made, runs, written_text):
    words = [word for word, _ in instructions(text)]
    require(sorted(words) == ["ARG", "CMD", "EXPOSE", "FROM", "RUN"], f"there are other instructions: {words}")
    said = dict(instructions(text))
    codename = re.search(r"^VERSION_CODENAME=(.*)$", pathlib.Path("/etc/os-release").read_text(), re.MULTILINE)[1]
    require(said["FROM"] == f"debian:{codename}-slim", f"the packages were made on {codename}, not {said['FROM']}")
    for pattern in re.findall(r"/packages/(\S+\.deb)", text):
        require(fnmatch.filter(made, pattern), f"{pattern} is not one of {sorted(made)}")
    for name in re.search(r'MORE="(.+)"', text)[1].split()[1:]:
        known = subprocess.run(["apt-cache", "show", name], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        require(known.returncode == 0, f"Debian has no package {name}")
    there = set().union(*(made[name] for pattern in re.findall(r"/packages/(\S+\.deb)", said["RUN"])
                          for name in fnmatch.filter(made, pattern)))
    for run in (run for swarm in runs.values() for run in swarm):
        for program in (run["words"][0], run["probe"][0]):
            require(program in there, f"{program} is not in the image")
        require(run["variables"]["HIVE_KEY"] in run["files"], f"the key of {run['words']} is not there")
        require(f"tcp://0.0.0.0:{said['EXPOSE']}" in run["words"], f"{run['words']} does not listen at {said['EXPOSE']}")
    require(set(re.findall(r"image: (.*)", written_text)) == {f'"{re.search("-t ([^ ]+)", text)[1]}"'},
            "the image has another name in what is written")


def in_root(*words, **options):
    return subprocess.Popen(["unshare", "--net", "chroot", ROOT, "/usr/bin/env", "-i", "PATH=/usr/bin:/bin", *words],
                            **options)


def build(text, place):
    """Runs the steps in ROOT."""
    if not pathlib.Path(ROOT, "etc/debian_version").exists():
        output_of("debootstrap", "--variant=minbase", "bookworm", ROOT)
    bound = pathlib.Path(ROOT, "packages")
    bound.mkdir(exist_ok=True)
    step = re.sub(r"^--mount=\S+", "", dict(instructions(text))["RUN"])
    subprocess.run(["mount", "--bind", place / "debs", bound], check=True)
    try:
        output_of("chroot", ROOT, "/usr/bin/env", "-i", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "MORE=", "sh", "-c", step,
                  stderr=subprocess.DEVNULL)
    finally:
        subprocess.run(["umount", bound], check=True)


def try_drone(run, key):
    for path in run["files"]:
        file = pathlib.Path(ROOT, path[1:])
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch(0o400)
        file.write_text(key)
    variables = [f"{name}={value}" for name, value in run["variables"].items()]
    drone = in_root(*variables, *run["words"])
    try:
        deadline = time.monotonic() + 60
        while in_root(*variables, *run["probe"], stderr=subprocess.DEVNULL).wait(timeout=60) != 0:
            require(drone.poll() is None and time.monotonic() < deadline, f"{run['words']} does not get well")
    finally:
        drone.terminate()
        require(drone.wait(timeout=60) == 0, f"{run['words'][0]} does not end as it should")


def main():
    with tempfile.TemporaryDirectory(prefix="hive-container-") as folder:
        place = pathlib.Path(folder)
        text, made = (SOURCE / "scripts/container/Containerfile").read_text(), packages(place)
        if ROOT:
            build(text, place)
            environment = {**os.environ, "XDG_CONFIG_HOME": folder, "HIVE_KEY": ""}
            output_of(BUILD / "bin/hivectl", "key", "new", env=environment)
        for form in ("compose", "kubernetes"):
            runs, written_text = written(place, form)
            check(text, made, runs, written_text)
            for run in runs["gesture"] if ROOT else []:
                try_drone(run, (place / "hive/swarm.key").read_text())
                print("container: runs from the packages alone:", " ".join(run["words"]))
        print("container: the image has what compose and Kubernetes expect")


main()
