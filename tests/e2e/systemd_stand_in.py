#!/usr/bin/env python3
"""Stands in for `systemd-run --user` and `systemctl --user` where no systemd runs: runs transient units.

It supports what the engine systemd uses: systemd-run with a property or variable per option, and systemctl stop,
show, is-active and reset-failed. Its state of a unit is in $HIVE_TEST_SYSTEMD, while the unit is loaded: UNIT.json with
the properties, command and environment, and UNIT.state with how the unit is. A test may create UNIT.file, a unit file of
the user, and "hang": then systemctl does not answer once a unit has failed.
"""
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import threading
import time

STATE = pathlib.Path(os.environ["HIVE_TEST_SYSTEMD"])
LOCK = threading.Lock()
INACTIVE = {"active": "inactive", "pid": 0, "code": 0, "status": 0, "failed_start": False}


def write(unit, **changes):
    new = STATE / (unit + ".new")
    new.write_text(json.dumps({**read(unit), **changes}))
    new.rename(STATE / (unit + ".state"))


def read(unit):
    try:
        return json.loads((STATE / (unit + ".state")).read_text())
    except FileNotFoundError:
        return INACTIVE


def unload(unit):
    for kind in ".state", ".json", ".stop", ".notify":
        (STATE / (unit + kind)).unlink(missing_ok=True)


def receive_notifications(unit, notified):
    while True:
        if "READY=1" in notified.recv(4096).decode().split():
            with LOCK:
                write(unit, active="active")


def supervise(unit, settings):
    """Until the process ends, and again as the unit says."""
    properties = settings["properties"]
    assert properties["Type"] == "notify"
    notified = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    notified.bind(str(STATE / (unit + ".notify")))
    threading.Thread(target=receive_notifications, args=(unit, notified), daemon=True).start()
    environment = {"PATH": "/usr/bin:/bin", **settings["environment"], "NOTIFY_SOCKET": str(STATE / (unit + ".notify")),
                   "WATCHDOG_USEC": str(int(properties["WatchdogSec"]) * 1_000_000)}
    command = [word.replace("$$", "$") for word in settings["command"]]
    for _ in range(int(properties["StartLimitBurst"])):
        with LOCK, open(properties["StandardOutput"].removeprefix("append:"), "ab") as out:
            process = subprocess.Popen(command, env=environment, stdout=out, stderr=out, stdin=subprocess.DEVNULL)
            write(unit, active="activating", pid=process.pid, code=0, status=0)
        code = process.wait()
        clean = code in (0, -signal.SIGTERM)
        started = read(unit)["active"] == "active"
        write(unit, active="activating", pid=0, code=2 if code < 0 else 1, status=abs(code),
              failed_start=read(unit)["failed_start"] or not started)
        if clean or properties["Restart"] == "no" or (STATE / (unit + ".stop")).exists():
            break
        time.sleep(float(properties["RestartSec"]))
    if clean and started:
        unload(unit)
    else:
        write(unit, active="failed")


def detach(action, *arguments):
    if os.fork() == 0:
        os.setsid()
        null = os.open("/dev/null", os.O_RDWR)
        for descriptor in range(3):
            os.dup2(null, descriptor)
        action(*arguments)
        os._exit(0)


def run(words):
    settings = {"properties": {}, "environment": {}}
    unit = ""
    while (word := words.pop(0)) != "--":
        option, value = word.split("=", 1)
        if option in ("--property", "--setenv"):
            key, value = value.split("=", 1)
            settings["properties" if option == "--property" else "environment"][key] = value
        elif option == "--unit":
            unit = value
        else:
            settings[{"--description": "description"}[option]] = value
    settings["command"] = words
    if (STATE / (unit + ".json")).exists() or (STATE / (unit + ".file")).exists():
        sys.exit(f"Failed to start transient service unit: Unit {unit} was already loaded or has a fragment file.")
    (STATE / (unit + ".json")).write_text(json.dumps(settings))
    write(unit, active="activating")
    detach(supervise, unit, settings)
    while (state := read(unit))["active"] == "activating" and not state["failed_start"]:
        time.sleep(0.01)
    if state["active"] != "active":
        sys.exit(f"Job for {unit} failed.")


def stop(units):
    for unit in units:
        if (STATE / (unit + ".json")).exists():
            (STATE / (unit + ".stop")).write_text("")
        while (state := read(unit))["active"] in ("active", "activating"):
            try:
                if state["pid"]:
                    os.kill(state["pid"], signal.SIGTERM)
            except ProcessLookupError:
                pass
            time.sleep(0.02)


def reset_failed(units):
    for unit in units:
        if read(unit)["active"] == "failed":
            unload(unit)


def show(units):
    for unit in units:
        state, file = read(unit), STATE / (unit + ".json")
        if file.exists():
            print(f"FragmentPath=/run/user/1000/systemd/transient/{unit}")
        elif (STATE / (unit + ".file")).exists():
            print(f"FragmentPath={STATE / (unit + '.file')}")
        print(f"ExecMainCode={state['code']}\nExecMainStatus={state['status']}\nId={unit}")
        print("Description=" + (json.loads(file.read_text())["description"] if file.exists() else unit))
        print(f"ActiveState={state['active']}\n")


def is_active(units):
    print(read(units[0])["active"])


def main():
    if sys.argv[1] != "--user":
        sys.exit("only units of the user")
    if (STATE / "broken").exists():
        sys.exit("Failed to connect to bus: No medium found")
    if sys.argv[0].endswith("systemd-run"):
        return run(sys.argv[2:])
    states = [read(file.stem) for file in STATE.glob("*.state")]
    if (STATE / "hang").exists() and any(state["active"] == "failed" or state["failed_start"] for state in states):
        time.sleep(100)
    units = [word for word in sys.argv[3:] if not word.startswith("--")]
    {"stop": stop, "show": show, "is-active": is_active, "reset-failed": reset_failed}[sys.argv[2]](units)


main()
