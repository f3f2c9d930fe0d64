#!/usr/bin/env python3
"""Stands in for `systemctl --user` where no systemd runs: it runs the ExecStart of a unit with its Environment alone.

It knows start, stop, show and daemon-reload, as far as the engine systemd says them. What it knows of a unit is in
$HIVE_TEST_SYSTEMD: UNIT.pid, UNIT.told with what the unit said of itself, and UNIT.ended with how it ended.
"""
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import threading
import time

STATE = pathlib.Path(os.environ["HIVE_TEST_SYSTEMD"])
UNITS = pathlib.Path(os.environ["XDG_CONFIG_HOME"]) / "systemd" / "user"


def words_of(line, of_command):
    """The quoted words of a setting, as systemd.syntax(7) has them."""
    words = []
    for quoted in re.findall(r'"((?:[^"\\]|\\.)*)"', line):
        word = re.sub(r"\\(.)", lambda found: {"n": "\n"}.get(found[1], found[1]), quoted)
        word = word.replace("%%", "%")
        words.append(word.replace("$$", "$") if of_command else word)
    return words


def settings_of(unit):
    settings = {"Environment": []}
    for line in (UNITS / unit).read_text().splitlines():
        if "=" in line:
            key, value = line.split("=", 1)
            if key == "Environment":
                settings[key] += words_of(value, False)
            else:
                settings[key] = value
    return settings


def hear(unit, told):
    """Writes down what the processes of a unit say of themselves."""
    while True:
        news = told.recv(4096).decode()
        with open(STATE / (unit + ".told"), "a", encoding="utf-8") as file:
            file.write(news + "\n")


def notify_socket(unit):
    path = STATE / (unit + ".notify")
    path.unlink(missing_ok=True)
    told = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    told.bind(str(path))
    threading.Thread(target=hear, args=(unit, told), daemon=True).start()
    return str(path)


def supervise(unit):
    """Until the process ends, and again as the unit says."""
    settings = settings_of(unit)
    environment = {"PATH": "/usr/bin:/bin", **dict(word.split("=", 1) for word in settings["Environment"])}
    if settings["Type"] == "notify":
        environment |= {"NOTIFY_SOCKET": notify_socket(unit),
                        "WATCHDOG_USEC": str(int(settings["WatchdogSec"]) * 1_000_000)}
    log = settings["StandardOutput"].removeprefix("append:").replace("%%", "%")
    for _ in range(int(settings["StartLimitBurst"])):
        (STATE / (unit + ".told")).write_text("")
        with open(log, "ab") as out:
            process = subprocess.Popen(words_of(settings["ExecStart"], True), env=environment, stdout=out, stderr=out,
                                       stdin=subprocess.DEVNULL)
        (STATE / (unit + ".pid")).write_text(str(process.pid))
        code = process.wait()
        if settings["Restart"] == "no" or code in (0, -signal.SIGTERM):
            break
    ended = STATE / (unit + ".ended.new")
    ended.write_text(f"{2 if code < 0 else 1} {abs(code)}")
    ended.rename(STATE / (unit + ".ended"))


def start(units):
    for unit in units:
        pid, ended = STATE / (unit + ".pid"), STATE / (unit + ".ended")
        if pid.exists() and not ended.exists():
            continue
        settings_of(unit)
        ended.unlink(missing_ok=True)
        if os.fork() == 0:
            os.setsid()
            null = os.open("/dev/null", os.O_RDWR)
            for descriptor in range(3):
                os.dup2(null, descriptor)
            supervise(unit)
            os._exit(0)


def stop(units):
    for unit in units:
        pid, ended = STATE / (unit + ".pid"), STATE / (unit + ".ended")
        while pid.exists() and not ended.exists():
            number = pid.read_text()
            try:
                if number:
                    os.kill(int(number), signal.SIGTERM)
            except ProcessLookupError:
                pass
            time.sleep(0.02)


def end_of(unit):
    ended = STATE / (unit + ".ended")
    return ended.read_text().split() if ended.exists() else ("0", "0")


def state_of(unit):
    pid, ended = STATE / (unit + ".pid"), STATE / (unit + ".ended")
    if tuple(end_of(unit)) not in (("0", "0"), ("1", "0")):
        return "failed"
    if ended.exists() or not pid.exists():
        return "inactive"
    ready = "READY=1" in (STATE / (unit + ".told")).read_text().split()
    return "active" if ready or settings_of(unit)["Type"] != "notify" else "activating"


def is_active(units):
    print(state_of(units[0]))


def show(units):
    for unit in units:
        code, status = end_of(unit)
        state = state_of(unit)
        print(f"Id={unit}\nActiveState={state}\nExecMainCode={code}\nExecMainStatus={status}\n")


def main():
    if sys.argv[1] != "--user":
        sys.exit("systemctl: only units of the user")
    verb, units = sys.argv[2], [word for word in sys.argv[3:] if not word.startswith("--")]
    if (STATE / "broken").exists():
        sys.exit("Failed to connect to bus: No medium found")
    if verb != "daemon-reload":
        {"start": start, "stop": stop, "show": show, "is-active": is_active}[verb](units)


main()
