"""Applications that run a whole swarm: start, connect with lists and globs, stop, and why nothing comes."""

import asyncio
import os
import re
import signal
import subprocess
import tempfile
import textwrap
import threading
import time
import unittest
import unittest.mock

import numpy

import hive
from hive import collector as collecting
from world import TIMEOUT, PROGRAMS, World, eventually


class Starting(World):
    def setUp(self):
        super().setUp()
        environment = unittest.mock.patch.dict(os.environ, HIVE_DRONE_PATH=PROGRAMS)
        environment.start()
        self.addCleanup(environment.stop)

    def start(self, kind, *arguments, **more):
        """Stopped at the end of the test."""
        name = self.swarm.start(kind, *arguments, ready=TIMEOUT, **more)
        self.addCleanup(self.stop, name)
        return name

    def stop(self, name):
        if name in self.swarm.drones():
            self.swarm.stop(name)

    def test_a_drone_is_started_with_parameters_and_stopped(self):
        self.assertEqual(self.start("sleeper", work_ms=3), "sleeper")
        self.assertEqual(self.start("sleeper", name="second", parameters={"work_ms": 4}, halted=True), "second")
        self.assertEqual(self.swarm.get("sleeper", "work_ms"), {"work_ms": 3})
        self.assertEqual(self.swarm.get("second", "work_ms"), {"work_ms": 4})
        self.assertEqual(self.swarm.status("second")["state"], "halted")
        self.assertIn("second-2", str(self.refused("name_taken", self.swarm.start, "sleeper", "second")))
        self.swarm.stop(["sleeper", "second"])
        self.assertEqual(self.swarm.drones(), [])

    def test_what_does_not_start_leaves_nothing_and_says_why(self):
        self.refused("not_found", self.swarm.start, "no-such-kind")
        self.refused("invalid_argument", self.swarm.start, "sleeper", "../x")
        self.assertIn("work_ms", str(self.refused("refused", self.swarm.start, "sleeper", work_ms=-1)))
        broken = os.path.join(self.home, "broken.py")
        with open(broken, "w", encoding="utf-8") as file:
            file.write("import nothing_of_this_name")
        missing = str(self.refused("not_found", self.swarm.start, broken))
        self.assertIn("cannot import nothing_of_this_name; ", missing)
        self.assertIn("$HIVE_PYTHON", missing)
        with open(broken, "w", encoding="utf-8") as file:
            file.write("import sys\nsys.exit('no camera here')")
        says = str(self.refused("failed", self.swarm.start, broken))
        self.assertRegex(says, r"(?s)exit code 1 before it was ready; its log says:\nno camera here\n\w")
        waits = os.path.join(self.home, "waits.py")
        with open(waits, "w", encoding="utf-8") as file:
            file.write("import time; time.sleep(60)")
        self.refused("timeout", self.swarm.start, waits, ready=0.2)
        self.assertEqual(self.swarm.drones(), [])

    def test_a_cell_that_is_run_again_keeps_the_drone_that_runs(self):
        self.start("sleeper", work_ms=3)
        self.assertIn("if_missing", str(self.refused("name_taken", self.swarm.start, "sleeper")))
        before = self.swarm.status("sleeper")["pid"]
        self.assertEqual(self.start("sleeper", if_missing=True, work_ms=4), "sleeper")
        self.assertEqual(self.swarm.status("sleeper")["pid"], before)
        self.assertEqual(self.swarm.get("sleeper", "work_ms"), {"work_ms": 3})
        self.refused("name_taken", self.swarm.start, "ticker", "sleeper", if_missing=True)
        self.start("sleeper", "other", if_missing=True)
        self.assertEqual(self.swarm.drones(), ["other", "sleeper"])

    def test_who_waits_in_vain_hears_how_to_start_it(self):
        with self.assertRaises(hive.Error) as late:
            self.swarm.wait("camera-2", timeout=0.05)
        text = "camera-2 is not running in the time allowed; start it: hivectl start camera --as camera-2"
        self.assertEqual(str(late.exception), text)

    def test_an_application_shows_its_name_and_a_closed_one_what_to_do(self):
        swarm = hive.Application("desk")
        self.assertEqual(repr(swarm), "<hive.Application desk>")
        swarm.close()
        with self.assertRaisesRegex(hive.Error, "^the application is closed; make a new one$"):
            swarm.drones()

    def test_arguments_of_a_wrong_type_are_refused_with_one_sentence(self):
        refusals = {
            "a time is a number of seconds, not '3'": lambda: self.swarm.timeout("3"),
            "a time is a number of seconds, not None": lambda: self.swarm.collect("a", reorder_timeout=None),
            "a name is a text, not ['a']": lambda: self.swarm.describe(["a"]),
            "on is a text, not 3": lambda: self.swarm.start("face", on=3),
            "count is a whole number, not '3'": lambda: self.swarm.results("a", count="3"),
            "a time is a number of seconds, not 'x'": lambda: self.swarm.results("a", timeout="x"),
            "a body is bytes, not an array of shape (2, 3)": lambda: self.swarm.put("a", numpy.zeros((2, 3))),
            "a body is bytes, not a str": lambda: self.swarm.put("a", "text"),
            "a body is bytes, not a int": lambda: self.swarm.put("a", 5),
        }
        for sentence, call in refusals.items():
            with self.subTest(sentence):
                self.assertTrue(str(self.refused("invalid_argument", call)).startswith(sentence))

    def test_ctrl_c_ends_a_start_and_leaves_nothing(self):
        waits = os.path.join(self.home, "waits.py")
        with open(waits, "w", encoding="utf-8") as file:
            file.write("import time; print('up', flush=True); time.sleep(600)")
        log = os.path.join(self.home, "waits.log")

        def press():
            eventually(lambda: os.path.exists(log) and os.path.getsize(log))
            os.kill(os.getpid(), signal.SIGINT)

        ctrl_c = threading.Thread(target=press)
        ctrl_c.start()
        with self.assertRaises(KeyboardInterrupt):
            self.swarm.start(waits, ready=600)
        ctrl_c.join()
        self.assertNotIn(waits.encode(), subprocess.run(["ps", "-eo", "args"], capture_output=True, check=True).stdout)

    def test_names_that_are_none_are_refused(self):
        for names in (None, 5, ["source", None], b"x"):
            self.assertIn("called by its name", str(self.refused("invalid_argument", self.swarm.stop, names)))
        drone = hive.Drone("probe", embedded=True)
        self.refused("invalid_argument", self.swarm.connect, drone, "worker")

    def test_a_drone_is_started_on_another_machine(self):
        there, programs = tempfile.mkdtemp(prefix="hv-", dir="/tmp"), os.path.join(self.home, "ssh")
        os.mkdir(programs)
        with open(os.path.join(programs, "ssh"), "w", encoding="utf-8") as file:
            file.write(textwrap.dedent(f"""\
                #!/bin/sh
                if [ "$1" = -G ]; then echo hostname 127.0.0.1; exit; fi
                while [ "$1" != -- ]; do shift; done
                HIVE_HOME={there} PATH={PROGRAMS}:$PATH exec sh -c "$3"
                """))
        os.chmod(os.path.join(programs, "ssh"), 0o755)
        with unittest.mock.patch.dict(os.environ, PATH=programs + os.pathsep + os.environ["PATH"]):
            self.assertEqual(self.start("sleeper", on="me@gpu1", insecure=True, work_ms=3), "sleeper")
        self.assertEqual(self.swarm.place("sleeper")["host"], "gpu1")
        with hive.Application(home=there) as elsewhere:
            self.assertEqual(elsewhere.get("sleeper", "work_ms"), {"work_ms": 3})
            self.swarm.stop("sleeper")
            self.assertTrue(eventually(lambda: elsewhere.drones() == []))

    def test_lists_and_globs_are_connected_and_share(self):
        self.drone("ticker", "source", "pace=demand", "count=30")
        self.swarm.halt("source")
        names = ["worker-1", "worker-2"]
        for name in names:
            self.drone("sleeper", name)
        made = self.swarm.connect("source", "worker-*", share=True, window=2)
        self.assertEqual(made, [("source.tick", name + ".image") for name in names])
        options = [self.swarm.status(name)["inputs"][0]["options"] for name in names]
        self.assertEqual([(each["group"], each["window"]) for each in options], [("source", 2)] * 2)
        self.assertEqual(self.swarm.connect(["source"], "worker-1", group="g"), [("source.tick", "worker-1.image")])
        error = self.refused("not_found", self.swarm.connect, "source", ["worker-2.image", "gone", "lost"])
        self.assertIn("source to gone: ", str(error))
        self.assertIn("source to lost: ", str(error))
        self.refused("not_found", self.swarm.connect, "source", "nobody-*")
        self.swarm.disconnect("source.tick", "worker-*.image")
        edges = self.swarm.status("source")["outputs"][0]["edges"]
        self.assertEqual([edge for edge in edges if edge.get("connected")], [])

    def test_results_of_globs_and_lists(self):
        self.drone("ticker", "source", "pace=demand", "count=20")
        self.swarm.halt("source")
        for name in ("worker-1", "worker-2"):
            self.drone("sleeper", name)
        self.swarm.connect("source", "worker-*", share=True)
        results = self.swarm.results(["worker-*"], timeout=TIMEOUT, ordered=True)
        self.swarm.resume("source")
        self.assertEqual([event.sequence for event in results], list(range(1, 21)))
        self.assertEqual(list(results), [])

    def test_results_with_asyncio(self):
        self.drone("ticker", "source", "pace=demand", "count=6")
        self.drone("sleeper", "worker")
        self.swarm.halt("source")
        self.swarm.connect("source", "worker")

        async def collect():
            async with hive.Application(timeout=TIMEOUT) as swarm:
                with self.assertRaises(hive.Error) as late:
                    async for _ in swarm.results("worker", timeout=0.05):
                        self.fail("the source is halted")
                self.assertEqual(late.exception.code, "timeout")
                async with swarm.results("worker", timeout=TIMEOUT) as results:
                    self.swarm.resume("source")
                    numbers = [event.sequence async for event in results]
                async with swarm.collect("source") as rest:
                    self.assertIsInstance(rest, hive.Collector)
            self.refused("stopped", swarm.drones)
            return numbers

        self.assertEqual(asyncio.run(asyncio.wait_for(collect(), TIMEOUT)), [1, 2, 3, 4, 5, 6])

    def test_counters_are_attributes(self):
        self.drone("ticker", "source", "pace=demand", "count=5")
        with self.swarm.collect("source") as collector:
            events = list(collector)
            self.assertEqual(collector.counters, hive.Counts(received=5, duplicates=0, missing=0, failed=0, dropped=0))
        self.assertGreaterEqual(events[0].age, 0)
        results = self.swarm.results("source", count=0)
        self.assertEqual(results.counters, hive.Counts(0, 0, 0, 0, 0))

    def test_counters_of_sets_are_attributes(self):
        self.drone("ticker", "left", "pace=demand", "count=5", more=["--halted"])
        self.drone("sleeper", "right")
        self.swarm.connect("left", "right")
        with self.swarm.collect_matched("left", "right") as sets:
            self.swarm.resume("left")
            for number in range(5):
                self.assertIsNotNone(sets.next(TIMEOUT), number)
            counters = sets.counters
        self.assertEqual(counters, hive.SetCounts(10, 0, 0, 0, 0, sets=5, waiting=0, unmatched=0))

    def test_the_results_of_another_source_come_at_once_after_it_was_set(self):
        self.drone("ticker", "source", "pace=demand", "count=3")
        self.drone("sleeper", "worker", "work_ms=1")
        self.swarm.connect("source", "worker")
        self.assertEqual(len(list(self.swarm.results("worker"))), 3)
        self.assertEqual(len(list(self.swarm.results("worker"))), 0)
        for count in range(4, 14):  # the worker may not have heard of it yet
            self.swarm.set("source", count=count)
            self.assertEqual(len(list(self.swarm.results("worker"))), 1)

        async def read():
            return [event async for event in self.swarm.results("worker")]

        with self.swarm.collect("worker") as collector:
            for count in range(14, 20):
                self.swarm.set("source", count=count)
                self.assertEqual(len(list(collector)), 1)
        self.swarm.set("source", count=20)
        self.assertEqual(len(asyncio.run(read())), 1)

    def test_a_source_whose_first_event_takes_long_is_waited_for_and_an_end_is_not(self):
        self.drone("ticker", "source", "pace=demand", "count=3", "decode_ms=2500")
        self.drone("sleeper", "worker", "work_ms=1")
        self.swarm.connect("source", "worker")
        self.assertEqual(len(list(self.swarm.results("worker"))), 3)
        self.swarm.set("source", count=4)
        self.assertEqual(len(list(self.swarm.results("worker"))), 1)
        self.swarm.set("source", count=5)
        with self.swarm.collect("worker") as collector:
            self.assertEqual(len(list(collector)), 1)
            begun = time.monotonic()
            self.assertIsNone(collector.next())
            self.assertEqual(collector.ended, "")
        self.assertEqual(len(list(self.swarm.results("worker"))), 0)
        self.assertLess(time.monotonic() - begun, 2)  # a drone that does not answer would have taken longer

    def silent(self):
        self.drone("ticker", "source", "pace=demand")
        self.swarm.halt("source")
        self.drone("sleeper", "worker")
        self.swarm.connect("source", "worker")

    def test_who_waits_for_results_hears_why_nothing_comes_as_hivectl_says_it(self):
        self.silent()
        with self.assertRaises(hive.Error) as late:
            next(self.swarm.results("worker", timeout=0.1))
        words = [os.path.join(PROGRAMS, "hivectl"), "results", "worker", "--timeout", "0.1"]
        said = subprocess.run(words, capture_output=True, text=True, timeout=60).stderr
        why = said.strip().partition("; ")[2]
        self.assertIn("source has halted", why)
        without_ages = [re.sub(r"[\d.]+ m?s ago", "", text) for text in (str(late.exception), why)]
        self.assertTrue(without_ages[0].endswith(without_ages[1]), f"{late.exception} is not {said}")

    def test_a_long_wait_says_once_in_the_log_why_nothing_comes(self):
        self.silent()
        with unittest.mock.patch.object(collecting, "SILENCE", 0.2), self.assertLogs("hive", "WARNING") as logs:
            with self.swarm.collect("worker") as collector:
                self.assertIsNone(collector.next(1.0))

                async def wait():
                    return await collector._next_async(1.0)

                self.assertIsNone(asyncio.run(wait()))
        self.assertEqual(len(logs.output), 2, logs.output)
        for line in logs.output:
            self.assertRegex(line, "^WARNING:hive:no events: .*source has halted")


if __name__ == "__main__":
    unittest.main()
