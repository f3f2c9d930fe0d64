"""A home directory with real drones in it, which are gone when a test ends."""

import contextlib
import os
import queue
import shutil
import socket
import subprocess
import tempfile
import threading
import time
import unittest

import hive

PROGRAMS = os.environ["HIVE_TEST_PROGRAMS"]
TIMEOUT = 20.0  # of what only guards against hanging


def eventually(condition, timeout=TIMEOUT):
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.003)
    return True


class SlowLine:
    """What is said over it, either way, arrives so much later."""

    def __init__(self, address, seconds):
        host, port = address.removeprefix("tcp://").rsplit(":", 1)
        self._to, self._seconds = (host, int(port)), seconds
        self._server = socket.create_server(("127.0.0.1", 0))
        self._ends = [self._server]
        self.address = f"tcp://127.0.0.1:{self._server.getsockname()[1]}"
        self._in_thread(self._accept)

    def _in_thread(self, work, *arguments):
        threading.Thread(target=work, args=arguments, daemon=True).start()

    def _accept(self):
        with contextlib.suppress(OSError):  # closed
            while True:
                near, _ = self._server.accept()
                far = socket.create_connection(self._to)
                self._ends += near, far
                for one, other in ((near, far), (far, near)):
                    late = queue.Queue()
                    self._in_thread(self._hear, one, late)
                    self._in_thread(self._say, late, other)

    def _hear(self, end, late):
        with contextlib.suppress(OSError):
            while said := end.recv(65536):
                late.put((time.monotonic() + self._seconds, said))
        late.put((0, b""))

    @staticmethod
    def _say(late, end):
        with contextlib.suppress(OSError):
            while True:
                at, said = late.get()
                if not said:
                    return end.shutdown(socket.SHUT_WR)
                time.sleep(max(0, at - time.monotonic()))
                end.sendall(said)

    def close(self):
        for end in self._ends:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()


class World(unittest.TestCase):
    """Each test has a home of its own, and an application in it: self.swarm."""

    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="hv-", dir="/tmp")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)
        before = os.environ.get("HIVE_HOME")
        os.environ["HIVE_HOME"] = self.home
        self.addCleanup(lambda: os.environ.__setitem__("HIVE_HOME", before) if before else os.environ.pop("HIVE_HOME"))
        self.swarm = hive.Application(timeout=TIMEOUT)
        self.addCleanup(self.swarm.close)

    def process(self, *words, name, wait=True, **more):
        """A drone of any program; killed at the end."""
        log = open(os.path.join(self.home, name + ".log"), "ab")
        self.addCleanup(log.close)
        process = subprocess.Popen([*words, "--name", name], stdin=subprocess.DEVNULL, stdout=log, stderr=log, **more)
        self.addCleanup(lambda: (process.kill(), process.wait()))
        if wait:
            self.await_drone(name)
        return process

    def drone(self, kind, name, *settings, wait=True, more=()):
        """A drone in C++ of this build."""
        words = [word for setting in settings for word in ("--set", setting)]
        return self.process(os.path.join(PROGRAMS, "hive-" + kind), *words, *more, name=name, wait=wait)

    def await_drone(self, name):
        try:
            self.swarm.wait(name, timeout=TIMEOUT)
        except hive.Error as error:
            self.fail(f"{error}: {self.log(name)}")

    def log(self, name):
        with open(os.path.join(self.home, name + ".log"), encoding="utf-8", errors="replace") as file:
            return file.read()

    def run_embedded(self, drone):
        """Runs it in a thread until the test ends."""
        problems = []

        def run():
            try:
                drone.run()
            except BaseException as problem:
                problems.append(problem)

        thread = threading.Thread(target=run)

        def end():
            eventually(lambda: not thread.is_alive() or self._stops(drone))
            thread.join(TIMEOUT)
            self.assertFalse(thread.is_alive(), "the drone does not end")

        thread.start()
        self.addCleanup(end)
        self.await_drone(drone.name)
        return problems

    @staticmethod
    def _stops(drone):
        try:
            drone.stop()
            return True
        except hive.Error:
            return False

    def refused(self, code, function, *arguments, **more):
        """The error with which it must fail."""
        with self.assertRaises(hive.Error) as caught:
            function(*arguments, **more)
        self.assertEqual(caught.exception.code, code, caught.exception)
        return caught.exception


class Embedded(World):
    """Drones inside of the test."""

    def source(self, emit, lossless=True):
        """On demand: emit(output, number) is called for each event that is asked for."""
        drone = hive.Drone("source", "For tests.", embedded=True)
        output = drone.output("out", "application/octet-stream,image/raw", "events")
        made = [0]

        @drone.main
        def step():
            if not output.asked:
                return 3600
            made[0] += 1
            emit(output, made[0])
            return 0

        return drone

    def worker(self, work):
        drone = hive.Drone("worker", "For tests.", embedded=True)
        result = drone.output("result", "application/json", "results")

        @drone.on_event("in", "*/*", "anything")
        def deal(event):
            work(result, event)

        return drone
