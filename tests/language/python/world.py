"""A home directory with real drones in it, which are gone when a test ends."""

import os
import shutil
import subprocess
import tempfile
import threading
import time
import unittest

import hive

PROGRAMS = os.environ["HIVE_TEST_PROGRAMS"]
PATIENCE = 20.0  # of what only guards against hanging


def eventually(condition, patience=PATIENCE):
    end = time.monotonic() + patience
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.003)
    return True


class World(unittest.TestCase):
    """Each test has a home of its own, and an application in it: self.swarm."""

    def setUp(self):
        self.home = tempfile.mkdtemp(prefix="hv-", dir="/tmp")
        self.addCleanup(shutil.rmtree, self.home, ignore_errors=True)
        before = os.environ.get("HIVE_HOME")
        os.environ["HIVE_HOME"] = self.home
        self.addCleanup(lambda: os.environ.__setitem__("HIVE_HOME", before) if before else os.environ.pop("HIVE_HOME"))
        self.swarm = hive.Application(timeout=PATIENCE)
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
            self.swarm.wait(name, timeout=PATIENCE)
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
            thread.join(PATIENCE)
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
