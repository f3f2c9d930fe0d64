"""Applications in Python, against the drones that the C++ tests have too."""

import os
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest

import hive
from world import TIMEOUT, PROGRAMS, SlowLine, World, eventually


class Applications(World):
    def numbers(self, collector, count):
        return [collector.next(TIMEOUT).sequence for _ in range(count)]

    def test_drones_are_found_described_and_awaited(self):
        self.assertEqual(self.swarm.drones(), [])
        self.refused("timeout", self.swarm.wait, "source", timeout=0.02)
        self.swarm.wait("source", "gone")
        self.refused("invalid_argument", self.swarm.wait, "source", "happy")
        self.drone("ticker", "source")
        self.assertEqual(self.swarm.drones(), ["source"])
        self.assertEqual(self.swarm.find("s*"), ["source"])
        error = self.refused("not_found", self.swarm.find, "sourec")
        self.assertIn("source", str(error) + error.advice)
        described = self.swarm.describe("source")
        self.assertEqual((described["kind"], described["outputs"][0]["name"]), ("ticker", "tick"))
        self.assertEqual(self.swarm.status("source")["name"], "source")
        self.assertTrue(self.swarm.name.startswith("app-"))
        self.assertEqual(hive.default_home(), self.home)

    def test_connect_infers_the_ports_and_says_what_does_not_fit(self):
        self.drone("ticker", "source")
        self.drone("sleeper", "worker")
        self.assertEqual(self.swarm.connect("source", "worker"), ("source.tick", "worker.image"))
        self.assertEqual(self.swarm.connect("source", "worker", window=4, lease=5), ("source.tick", "worker.image"))
        self.refused("not_found", self.swarm.connect, "source.tock", "worker")
        self.refused("invalid_argument", self.swarm.connect, "source", "worker", window=99)
        self.refused("invalid_argument", self.swarm.connect, "source", "worker", group="g", stream=True)
        self.swarm.disconnect("source", "worker")
        self.refused("not_found", self.swarm.disconnect, "source", "worker")

    def test_set_and_get_on_one_and_on_many_all_or_none(self):
        for name in ("worker-1", "worker-2"):
            self.drone("sleeper", name)
        self.assertEqual(self.swarm.set("worker-1", work_ms=5), {"work_ms": 5})
        self.assertEqual(self.swarm.set("worker-1", {"work_ms": "6"}), {"work_ms": 6})
        self.assertEqual(self.swarm.get("worker-1", "work_ms"), {"work_ms": 6})
        both = {"worker-1": {"work_ms": 7}, "worker-2": {"work_ms": 7}}
        self.assertEqual(self.swarm.set("worker-*", work_ms=7), both)
        self.swarm.set("worker-2", most_ms=10)
        with self.assertRaises(hive.SetError) as caught:
            self.swarm.set(["worker-1", "worker-2"], work_ms=20)
        self.assertEqual((caught.exception.code, caught.exception.changed), ("refused", "none"))
        self.assertIn("work_ms 20 is more than 10", str(caught.exception))
        self.assertEqual([values["work_ms"] for values in self.swarm.get("worker-*").values()], [7, 7])
        answers = self.swarm.get(["worker-1", "nobody"], "work_ms")
        self.assertEqual(answers["worker-1"], {"work_ms": 7})
        self.assertIsInstance(answers["nobody"], hive.Error)

    def test_a_source_on_demand_gives_every_event_once_and_in_order(self):
        self.drone("ticker", "source", "pace=demand", "count=40", "bytes=5000")
        with self.swarm.collect("source") as collector:
            for number, event in zip(range(1, 41), collector):
                self.assertEqual(event.sequence, number)
                self.assertEqual(event.header["sum"], sum(event.body))
            self.assertIsNone(collector.next())
            self.assertEqual(collector.ended, "")
            self.assertEqual(collector.counts()["received"], 40)
            (end,) = collector.inputs()
            self.assertEqual((end["from"], end["connected"], end["received"]), ("source.tick", True, 40))
        self.refused("stopped", collector.next, 0)

    def test_an_event_is_done_when_the_next_is_asked_for_unless_it_is_held(self):
        self.drone("ticker", "source", "pace=demand", "count=9")
        collector = self.swarm.collect("source", window=1)
        kept = [collector.next(TIMEOUT) for _ in range(3)]
        self.assertEqual([event.sequence for event in kept], [1, 2, 3])
        held = collector.next(TIMEOUT).hold()
        self.assertIsNone(collector.next(0.2))
        held.done()
        self.assertEqual(collector.next(TIMEOUT).sequence, 5)
        self.assertEqual([len(event.body) for event in kept], [1000] * 3)

    def test_results_take_the_output_with_results(self):
        self.drone("ticker", "source", "pace=demand", "count=5")
        self.drone("sleeper", "worker")
        self.swarm.halt("source")
        self.swarm.connect("source", "worker")
        self.assertEqual(list(self.swarm.results("worker", count=0)), [])
        self.refused("timeout", next, self.swarm.results("worker.result", timeout=0.05))
        results = self.swarm.results("worker", timeout=TIMEOUT)
        resumed = threading.Timer(0.05, self.swarm.resume, ["source"])
        resumed.start()
        self.assertEqual([event.header["index"] for event in results], [1, 2, 3, 4, 5])
        resumed.join()
        self.assertEqual(list(self.swarm.results("worker", timeout=TIMEOUT)), [])

    def test_exceptions_come_with_the_identity_and_a_halted_drone_goes_on_when_it_is_resumed(self):
        self.drone("ticker", "source", "fps=200")
        self.drone("sleeper", "worker", "throw_at=5", more=("--on-exception", "halt"))
        exceptions = self.swarm.exceptions("worker")
        self.swarm.connect("source", "worker")
        event = exceptions.next(TIMEOUT)
        self.assertGreaterEqual(event.sequence, 5)
        self.assertEqual((event.source, event.header["policy"], event.header["input"]), ("source", "halt", "image"))
        self.assertIn("not to my taste", event.header["text"])
        self.swarm.wait("worker", "halted")
        self.refused("halted", self.swarm.put, "worker", b"x", "text/plain")
        self.swarm.exception_policy("worker", "skip")
        self.refused("invalid_argument", self.swarm.exception_policy, "worker", "never")
        self.swarm.resume("worker")
        self.assertIsNotNone(self.swarm.collect("worker").next(TIMEOUT))

    def test_what_a_drone_failed_at_is_given_to_a_fresh_one(self):
        os.environ["HIVE_DRONE_PATH"] = PROGRAMS
        self.addCleanup(os.environ.pop, "HIVE_DRONE_PATH")
        self.drone("sleeper", "worker", "throw_every=1")
        self.assertEqual(self.swarm.failures("worker"), [])
        exceptions = self.swarm.exceptions("worker")
        self.swarm.put("worker", b"x", "text/plain", header={"page": 3})
        exceptions.next(TIMEOUT)
        (failure,) = self.swarm.failures("worker")
        self.assertEqual((failure["number"], failure["code"]), (1, "failed"))
        self.assertEqual((failure["inputs"][0]["input"], failure["inputs"][0]["size"]), ("image", 1))
        again = self.swarm.rerun("worker", timeout=TIMEOUT)
        self.assertEqual((again["outcome"], again["text"]), ("threw", failure["text"]))
        passed = self.swarm.rerun("worker", 1, throw_every=0, timeout=TIMEOUT)
        self.assertEqual((passed["outcome"], passed["emitted"]), ("passed", 1))
        self.refused("not_found", self.swarm.rerun, "worker", 2)
        file = os.path.join(self.home, "saved.failure")
        hivectl = os.path.join(PROGRAMS, "hivectl")
        subprocess.run([hivectl, "rerun", "worker", "--save", file], check=True, capture_output=True,
                       env={**os.environ, "HIVE_HOME": self.home})
        self.swarm.stop("worker")
        again = self.swarm.rerun(file, timeout=TIMEOUT)
        self.assertEqual((again["outcome"], again["text"], again["unfit"]), ("threw", failure["text"], []))
        self.refused("io", self.swarm.rerun, "./missing.failure")
        self.refused("invalid_argument", self.swarm.rerun, "worker", on="-oProxyCommand=x")
        self.assertEqual(self.swarm.drones(), [])

    def test_shared_work_in_order_also_when_a_worker_dies(self):
        self.drone("ticker", "source", "pace=demand", "count=60")
        workers = [self.drone("sleeper", f"worker-{i}", f"work_ms={3 * i}") for i in (1, 2, 3)]
        self.swarm.halt("source")
        for i in (1, 2, 3):
            self.swarm.connect("source", f"worker-{i}", group="workers")
        results = self.swarm.collect("worker-1", "worker-2", "worker-3", ordered=True)
        self.swarm.resume("source")
        numbers = self.numbers(results, 20)
        workers[1].kill()
        numbers += self.numbers(results, 40)
        self.assertEqual(numbers, list(range(1, 61)))
        counts = results.counts()
        self.assertEqual((counts["missing"], counts["received"]), (0, 60))

    def test_advice_names_the_bottleneck_and_a_command(self):
        self.drone("ticker", "source")
        self.drone("sleeper", "worker", "work_ms=80")
        self.swarm.connect("source", "worker")
        (line,) = self.swarm.advise("source", "worker", time=1)["lines"]
        self.assertEqual((line["limits"][0]["what"], line["limits"][0]["at"]), ("work", "worker"))
        self.assertIn("hivectl start sleeper --as worker-2 work_ms=80", line["proposals"][0]["command"])
        self.assertEqual(self.swarm.advise(goal="latency", time=0.3)["goal"], "latency")
        self.refused("not_found", self.swarm.advise, "nobody")
        self.refused("invalid_argument", self.swarm.advise, goal="colour")

    def test_the_counters_of_a_swarm_are_values(self):
        self.drone("ticker", "source", "fps=50")
        self.drone("sleeper", "worker")
        self.swarm.connect("source", "worker")
        self.assertIsNotNone(self.swarm.collect("worker").next(TIMEOUT))
        families = {family["name"]: family for family in self.swarm.metrics()}
        up = [(each["labels"], each["value"]) for each in families["hive_drone_up"]["samples"]]
        self.assertEqual(up, [({"drone": name, "host": "local"}, 1) for name in ("source", "worker")])
        (emitted,) = [each for each in families["hive_output_emitted_events"]["samples"] if each["labels"]["drone"] == "source"]
        self.assertEqual((emitted["labels"]["output"], families["hive_output_emitted_events"]["type"]), ("tick", "counter"))
        self.assertGreater(emitted["value"], 0)
        self.assertGreater(emitted["created_us"], 0)

    def test_events_between_two_drones_are_explained(self):
        self.drone("ticker", "source")
        self.drone("sleeper", "worker")
        what = lambda **pair: [cause["what"] for cause in self.swarm.explain(**pair)["causes"]]  # noqa: E731
        self.assertIn("not_connected", what(sender="source", receiver="worker"))
        self.swarm.connect("source", "worker")
        self.assertIn("wrong_way", what(sender="worker", receiver="source"))
        self.refused("invalid_argument", self.swarm.explain, sender="worker")

    def test_a_stopped_drone_is_gone_and_one_that_was_killed_is_remembered(self):
        self.drone("sleeper", "worker")
        self.swarm.set("worker", work_ms=9)
        self.swarm.stop("worker")
        self.assertEqual((self.swarm.drones(), self.swarm.remembered()), ([], []))
        process = self.drone("sleeper", "worker")
        self.swarm.set("worker", work_ms=9)
        process.kill()
        process.wait()
        self.assertEqual((self.swarm.drones(), self.swarm.remembered()), ([], ["worker"]))
        self.drone("sleeper", "worker")
        self.assertEqual(self.swarm.get("worker", "work_ms"), {"work_ms": 9})

    def test_what_is_notified_has_no_body_but_a_size(self):
        self.drone("ticker", "source", "fps=100")
        event = self.swarm.collect("source", notify=True).next(TIMEOUT)
        self.assertEqual(len(event.body), 0)
        self.assertIn("index", event.header)
        self.assertIn("source.tick", repr(event))

    def test_waiting_leaves_the_interpreter_to_other_threads(self):
        self.drone("ticker", "source", "fps=0.1", "pace=demand", "count=0")
        self.swarm.halt("source")
        collector = self.swarm.collect("source")
        waiter = threading.Thread(target=collector.next, args=(TIMEOUT,))
        waiter.start()
        rounds = 0
        while waiter.is_alive() and rounds < 20:
            rounds += 1
            time.sleep(0.001)
        self.assertTrue(waiter.is_alive())
        self.swarm.resume("source")
        waiter.join()

    def test_ctrl_c_ends_a_wait_for_ever(self):
        self.drone("ticker", "source", "pace=demand")
        self.swarm.halt("source")
        script = """
            import hive
            with hive.Application() as swarm:
                collector = swarm.collect("source")
                try:
                    print("waiting", flush=True)
                    next(collector)
                except KeyboardInterrupt:
                    print("interrupted")
            """
        process = subprocess.Popen(
            [sys.executable, "-c", textwrap.dedent(script)], stdout=subprocess.PIPE, text=True
        )
        self.addCleanup(lambda: (process.kill(), process.wait(), process.stdout.close()))
        self.assertEqual(process.stdout.readline(), "waiting\n")
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.stdout.readline(), "interrupted\n")
        self.assertEqual(process.wait(TIMEOUT), 0)

    def interrupted(self, call):
        """It must wait until Ctrl-C comes, and no longer."""
        ctrl_c = threading.Timer(0.1, os.kill, [os.getpid(), signal.SIGINT])
        failed, begun = None, time.monotonic()
        try:
            ctrl_c.start()
            try:
                call()
            except hive.Error as error:
                failed = error
            time.sleep(600)
        except KeyboardInterrupt:
            pass
        ctrl_c.join()
        self.assertIsNone(failed)
        self.assertLess(time.monotonic() - begun, 60)

    def test_ctrl_c_ends_every_call_that_waits_for_a_drone(self):
        self.drone("ticker", "source", "pace=demand")
        self.swarm.halt("source")
        worker = self.drone("sleeper", "worker")
        collector = self.swarm.collect("source")
        worker.send_signal(signal.SIGSTOP)
        self.addCleanup(worker.send_signal, signal.SIGCONT)
        calls = {
            "describe": lambda swarm: swarm.describe("worker"),
            "status": lambda swarm: swarm.status("worker"),
            "status of many": lambda swarm: swarm.status(["worker", "source"]),
            "set": lambda swarm: swarm.set("worker", work_ms=1),
            "set on many": lambda swarm: swarm.set(["worker"], work_ms=1),
            "get": lambda swarm: swarm.get("worker"),
            "get of many": lambda swarm: swarm.get(["worker"]),
            "connect": lambda swarm: swarm.connect("source.tick", "worker.image"),
            "disconnect": lambda swarm: swarm.disconnect("source.tick", "worker.image"),
            "collect": lambda swarm: swarm.collect("worker.result"),
            "exceptions": lambda swarm: swarm.exceptions("worker"),
            "put": lambda swarm: swarm.put("worker.image", b"x"),
            "halt": lambda swarm: swarm.halt("worker"),
            "resume": lambda swarm: swarm.resume("worker"),
            "policy": lambda swarm: swarm.exception_policy("worker", "skip"),
            "wait": lambda swarm: swarm.wait("worker", "halted", timeout=600),
            "stop": lambda swarm: swarm.stop("worker"),
            "next": lambda _: collector.next(600),
        }
        for name, call in calls.items():  # each with a connection of its own: who does not say hello has 2 s
            with self.subTest(name), hive.Application(timeout=600) as swarm:
                self.interrupted(lambda: call(swarm))
                self.assertEqual(swarm.describe("source")["kind"], "ticker")
        with hive.Application(timeout=600) as swarm:
            other = threading.Thread(target=self.refused, args=("timeout", swarm.get, "worker"))
            other.start()
            time.sleep(0.05)  # it should be in by then; if not, this asks nothing of it
            self.interrupted(swarm.drones)
            other.join()

    def test_a_drone_behind_a_slow_line_is_waited_for(self):
        self.drone("sleeper", "far", more=("--listen", "tcp://127.0.0.1", "--insecure"))
        address = next(place for place in self.swarm.status("far")["places"] if place.startswith("tcp:"))
        line = SlowLine(address, seconds=0.15)
        self.addCleanup(line.close)
        with tempfile.TemporaryDirectory(prefix="hv-", dir="/tmp") as home, hive.Application(home=home) as elsewhere:
            elsewhere.add_place("far", line.address)
            elsewhere.wait("far", "idle", timeout=TIMEOUT)
            self.refused("timeout", elsewhere.wait, "far", "halted", timeout=0.5)

    def test_what_a_handler_of_a_signal_raises_ends_a_call_and_one_that_returns_does_not(self):
        worker = self.drone("sleeper", "worker")
        worker.send_signal(signal.SIGSTOP)
        self.addCleanup(worker.send_signal, signal.SIGCONT)
        seen = []

        def handler(number, frame):
            seen.append(number)
            if len(seen) == 1:
                signal.setitimer(signal.ITIMER_REAL, 0.1)
            else:
                raise TimeoutError("ten minutes are too long")

        before = signal.signal(signal.SIGALRM, handler)
        self.addCleanup(signal.signal, signal.SIGALRM, before)
        self.swarm.timeout(600)
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        with self.assertRaises(TimeoutError):
            self.swarm.describe("worker")
        self.assertEqual(len(seen), 2)

    def test_a_program_that_closes_nothing_ends_well(self):
        self.drone("ticker", "source", "fps=100")
        script = """
            import hive
            swarm = hive.Application()
            collector = swarm.collect("source")
            event = collector.next()
            kept = event.body
            drone = hive.Drone("inner", embedded=True)
            drone.start()
            """
        words = [sys.executable, "-c", textwrap.dedent(script)]
        done = subprocess.run(words, timeout=60, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue(eventually(lambda: "inner" not in self.swarm.drones()))

    def test_a_closed_application_says_so(self):
        self.drone("ticker", "source", "fps=100")
        swarm = hive.Application("viewer", home=self.home)
        self.assertEqual(swarm.name, "viewer")
        collector = swarm.collect("source")
        event = collector.next(TIMEOUT)
        swarm.close()
        swarm.close()
        self.refused("stopped", swarm.drones)
        self.refused("stopped", collector.next)
        self.assertEqual(len(event.body), 1000)
        self.refused("invalid_argument", hive.Application, "../x")

    def test_who_waits_while_it_is_closed_is_told(self):
        self.drone("ticker", "source", "pace=demand")
        self.swarm.halt("source")
        collector, second = self.swarm.collect("source"), self.swarm.collect("source")
        told = []

        def wait(waiting):
            try:
                waiting.next()
            except hive.Error as error:
                told.append(error.text)

        for waiting, close in ((collector, collector.close), (second, self.swarm.close)):
            thread = threading.Thread(target=wait, args=(waiting,), daemon=True)
            thread.start()
            time.sleep(0.1)  # it should wait by then; if not, it is told all the same
            close()
            thread.join(TIMEOUT)
            self.assertFalse(thread.is_alive())
        self.assertEqual(told, ["the collector is closed", "the application is closed"])

    def test_calls_of_several_threads_do_not_disturb_each_other(self):
        self.drone("ticker", "source", "fps=200")
        collector = self.swarm.collect("source")
        problems = []

        def ask():
            try:
                for _ in range(10):
                    self.assertEqual(self.swarm.describe("source")["kind"], "ticker")
            except BaseException as problem:
                problems.append(problem)

        threads = [threading.Thread(target=ask) for _ in range(3)]
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads):
            self.assertIsNotNone(collector.next(TIMEOUT))
        self.assertEqual(problems, [])

    def test_statuses_of_many_and_places_on_other_machines(self):
        self.drone("sleeper", "worker")
        self.assertEqual(self.swarm.place("worker")["host"], "local")
        statuses = self.swarm.status(["worker", "nobody"])
        self.assertEqual(statuses["worker"]["state"], "idle")
        self.assertEqual(statuses["nobody"].code, "not_found")
        self.assertEqual(self.swarm.places(), [])
        self.swarm.add_place("far", "tcp://127.0.0.1:1")
        listed = self.swarm.places()
        self.assertEqual([(place["drone"], place["host"]) for place in listed], [("far", "127.0.0.1")])
        self.assertIn("far", self.swarm.drones())
        self.swarm.forget_place(listed[0])
        self.refused("not_found", self.swarm.forget_place, listed[0])
        self.refused("not_found", self.swarm.place, "far")
        self.refused("invalid_argument", self.swarm.add_place, "far", "unix:/tmp/x")

    def test_a_drone_with_a_key_takes_those_who_have_it(self):
        keys = {name: os.path.join(self.home, name + ".key") for name in ("swarm", "other")}
        hivectl = os.path.join(PROGRAMS, "hivectl")
        for file in keys.values():
            subprocess.run([hivectl, "key", "new", "--file", file], check=True, capture_output=True, timeout=60)
        keys["viewer"] = os.path.join(self.home, "viewer.key")
        view = [hivectl, "key", "view", "--file", keys["swarm"], "--output", keys["viewer"]]
        subprocess.run(view, check=True, capture_output=True, timeout=60)
        self.drone("sleeper", "worker", more=("--listen", "tcp://127.0.0.1", "--key", keys["swarm"]))
        address = next(place for place in self.swarm.status("worker")["places"] if place.startswith("tcp:"))
        for name in ("swarm", "viewer", "other"):
            with self.subTest(name), tempfile.TemporaryDirectory(prefix="hv-", dir="/tmp") as home:
                with hive.Application(home=home, key=keys[name], timeout=TIMEOUT) as there:
                    there.add_place("worker", address)
                    if name == "other":
                        self.refused("not_permitted", there.status, "worker")
                        continue
                    self.assertEqual(there.status("worker")["state"], "idle")
                    if name == "swarm":
                        self.assertEqual(there.set("worker", work_ms=3), {"work_ms": 3})
                    else:
                        self.refused("not_permitted", there.set, "worker", work_ms=4)

    def test_put_sends_an_event_and_says_what_does_not_fit(self):
        self.drone("sleeper", "worker")
        results = self.swarm.collect("worker")
        self.swarm.put("worker", b"x" * 10, "text/plain", {"index": 7})
        self.assertEqual(results.next(TIMEOUT).header["index"], 7)
        self.refused("not_found", self.swarm.put, "worker.nothing", b"x")
        self.drone("counter", "counter")
        self.refused("type_mismatch", self.swarm.put, "counter.tick", b"x", "text/plain")


if __name__ == "__main__":
    unittest.main()
