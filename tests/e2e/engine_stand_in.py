#!/usr/bin/env python3
"""Stands in for the engines for which a swarm is written: reads the files of a form in a folder, and prints what the
engine would run, a list of objects in JSON:

words     the command line
variables the environment that the file says
host      by which name others reach the machine that is its own; empty if it shares one
files     what the engine puts onto that machine: the path there, and the file beside the written ones
probe     the command that asks whether it is well
then      of the form shell: what is run when all were started

Usage: engine_stand_in.py FORM FOLDER
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import yaml

# Stands in for a program that a script runs: notes its words, and ends.
NOTE = "#!/bin/sh\nprintf '%s\\0' \"$@\" > $(mktemp $NOTES/$(date +%s.%N).XXXXXX)\n"


def run_of(words, variables=(), host="", files=(), probe=()):
    return {"words": words, "variables": dict(variables), "host": host, "files": dict(files), "probe": list(probe)}


def systemd_words(line):
    """As systemd.syntax(7) and "Command lines" of systemd.service(5) have them."""
    words = []
    for quoted, plain in re.findall(r'"((?:[^"\\]|\\.)*)"|(\S+)', line):
        word = plain or re.sub(r"\\(.)", lambda found: {"n": "\n"}.get(found[1], found[1]), quoted)
        words.append(word.replace("%%", "%").replace("$$", "$"))
    return words


def systemd(folder):
    """What the target wants."""
    (target,) = folder.glob("*.target")
    for unit in re.findall(r"^Wants=(.*)$", target.read_text(), re.MULTILINE):
        text = (folder / unit).read_text()
        variables = systemd_words(" ".join(re.findall(r"^Environment=(.*)$", text, re.MULTILINE)))
        (command,) = re.findall(r"^ExecStart=(.*)$", text, re.MULTILINE)
        yield run_of(systemd_words(command), [word.split("=", 1) for word in variables])


def compose(folder):
    (file,) = folder.iterdir()
    content = yaml.safe_load(file.read_text())
    for host, service in content["services"].items():
        secrets = {f"/run/secrets/{name}": content["secrets"][name]["file"] for name in service.get("secrets", [])}
        assert service["healthcheck"]["test"][0] == "CMD"
        yield run_of([word.replace("$$", "$") for word in service["command"]], service.get("environment", {}), host,
                     secrets, service["healthcheck"]["test"][1:])


def kubernetes(folder):
    kustomization = yaml.safe_load((folder / "kustomization.yaml").read_text())
    made = {secret["name"]: secret["files"] for secret in kustomization.get("secretGenerator", [])}
    manifests = [one for name in kustomization["resources"] for one in yaml.safe_load_all((folder / name).read_text())]
    services = [one for one in manifests if one["kind"] == "Service"]
    for workload in manifests:
        if workload["kind"] == "Service":
            continue
        pod = workload["spec"]["template"]
        labels, spec = pod["metadata"]["labels"].items(), pod["spec"]
        (service,) = [one for one in services if one["spec"]["selector"].items() <= labels]
        (container,) = spec["containers"]
        ((port,), (open_port,)) = service["spec"]["ports"], container["ports"]
        assert port["targetPort"] == open_port["name"] and port["port"] == open_port["containerPort"]
        secrets = {volume["name"]: volume["secret"]["secretName"] for volume in spec.get("volumes", [])
                   if "secret" in volume}
        files = {f"{mount['mountPath']}/{file}": file for mount in container.get("volumeMounts", [])
                 if mount["name"] in secrets for file in made[secrets[mount["name"]]]}
        yield run_of([word.replace("$$", "$") for word in container["command"]],
                     [(one["name"], one["value"]) for one in container.get("env", [])], service["metadata"]["name"],
                     files, container["livenessProbe"]["exec"]["command"])


def noted(folder, program):
    """The words with which the script in the folder runs a program, each time."""
    (script,) = folder.iterdir()
    with tempfile.TemporaryDirectory() as place:
        bin_folder, notes = pathlib.Path(place, "bin"), pathlib.Path(place, "notes")
        bin_folder.mkdir()
        notes.mkdir()
        (bin_folder / program).write_text(NOTE)
        (bin_folder / program).chmod(0o700)
        subprocess.run([script], check=True, timeout=60,
                       env={"PATH": f"{bin_folder}:{os.environ['PATH']}", "NOTES": str(notes), "SLURM_JOB_ID": "1"})
        return [note.read_text().split("\0")[:-1] for note in sorted(notes.iterdir())]


def slurm(folder):
    for words in noted(folder, "srun"):
        while words[0].startswith("--"):
            words.pop(0)
        yield run_of(words)


def shell(folder):
    lines = noted(folder, "hivectl")
    starts = [line for line in lines if line[0] == "start"]
    for start in starts:
        yield {**run_of(["hivectl", *start]), "then": [["hivectl", *line] for line in lines if line not in starts]}


if __name__ == "__main__":
    forms = {"systemd": systemd, "compose": compose, "kubernetes": kubernetes, "slurm": slurm, "shell": shell}
    print(json.dumps(list(forms[sys.argv[1]](pathlib.Path(sys.argv[2])))))
