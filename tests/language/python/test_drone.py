"""Drones in Python: parameters, events, pictures, exceptions, the end."""

import logging
import os
import signal
import subprocess
import sys
import textwrap
import time
import unittest
import unittest.mock

import numpy

import hive
from hive import _library
from world import PATIENCE, PROGRAMS, World, eventually


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

    def test_parameters_of_all_types_are_declared_set_and_refused(self):
        drone = hive.Drone("probe", "For tests.", embedded=True, parameters={"scale": 2})
        radius = drone.parameter("radius", 3, least=0, most=50, unit="px", help="of the blur")
        scale = drone.parameter("scale", 1.5, least=1)
        invert = drone.parameter("invert", False)
        mode = drone.parameter("mode", "fast", choices=["fast", "slow"])
        seen = []
        self.assertEqual(drone.given("scale"), 2)
        self.assertIsNone(drone.given("radius"))

        @drone.on_start
        def start():
            seen.append(("start", scale.value))

        @drone.on_change
        def change():
            if radius.value == 13:
                raise ValueError("13 brings bad luck")
            if radius.value == 7:
                radius.value = 8
            seen.append(("change", radius.value))

        self.run_embedded(drone)
        self.assertEqual(seen, [("start", 2.0), ("change", 3)])
        described = self.swarm.describe("probe")["parameters"]
        self.assertEqual([(p["name"], p["type"]) for p in described],
                         [("radius", "integer"), ("scale", "number"), ("invert", "flag"), ("mode", "text")])
        self.assertEqual((described[0]["max"], described[0]["unit"], described[0]["help"]), (50, "px", "of the blur"))
        self.assertEqual(self.swarm.set("probe", radius=7, invert=True), {"radius": 8, "invert": True})
        self.assertEqual((radius.value, scale.value, invert.value, mode.value), (8, 2.0, True, "fast"))
        self.assertIsInstance(scale.value, float)
        self.assertIn("50", str(self.refused("refused", self.swarm.set, "probe", radius=51)))
        self.refused("refused", self.swarm.set, "probe", mode="lazy")
        self.refused("not_found", self.swarm.set, "probe", raduis=1)
        self.assertIn("ValueError: 13 brings bad luck", str(self.refused("refused", self.swarm.set, "probe", radius=13)))
        self.assertEqual(self.swarm.get("probe", "radius", "mode"), {"radius": 8, "mode": "fast"})
        self.assertEqual(radius.value, 8)

    def test_a_declaration_that_cannot_be_is_refused(self):
        drone = hive.Drone("probe", embedded=True)
        for default in (None, [1], 1 << 40):
            self.refused("invalid_argument", drone.parameter, "x", default)
        self.refused("invalid_argument", drone.parameter, "../x", 1)
        self.refused("refused", drone.parameter, "x", 60, most=50)
        self.refused("invalid_argument", hive.Drone, "../probe", embedded=True)
        self.refused("invalid_argument", hive.Drone, "probe", embedded=True, colour="red")
        self.refused("invalid_argument", hive.Drone, "probe", name="x")

    def test_events_keep_their_identity_and_what_a_callback_raises_is_an_exception(self):
        def work(result, event):
            if event.sequence == 2:
                raise ValueError("two is not to my taste")
            if event.sequence == 3:
                raise hive.Error("unsupported", "three neither")
            result.emit({"sequence": event.sequence, "first": event.body[0], "foreign": event.foreign})

        source = self.source(lambda output, n: output.emit_captured({"n": n}, bytes([n]) * 8192, lossless=True))
        with self.assertLogs("hive.worker", logging.INFO) as logs:
            self.run_embedded(self.worker(work))
            exceptions, results = self.swarm.exceptions("worker"), self.swarm.collect("worker")
            self.run_embedded(source)
            self.swarm.connect("source", "worker")
            for sequence in (1, 4, 5):
                event = results.next(PATIENCE)
                self.assertEqual((event.sequence, event.header["first"]), (sequence, sequence))
                self.assertEqual((event.source, event.sender, event.kind), ("source", "worker", "worker"))
                self.assertEqual((event.output, event.type, event.lossless), ("result", "application/json", True))
                self.assertEqual([hop.drone for hop in event.hops], ["worker"])
                self.assertEqual((event.size, len(event.body)), (0, 0))
                self.assertLess(abs(time.time() - event.captured), PATIENCE + 10)
            first, second = exceptions.next(PATIENCE), exceptions.next(PATIENCE)
            self.assertEqual((first.header["code"], first.sequence), ("failed", 2))
            self.assertEqual(first.header["text"], "ValueError: two is not to my taste")
            self.assertEqual((second.header["code"], second.header["text"]), ("unsupported", "three neither"))
        self.assertIn("Traceback", "\n".join(logs.output))
        self.assertIn("in work", "\n".join(logs.output))

    def test_pictures_are_not_copied_on_the_way(self):
        picture = numpy.arange(480 * 640 * 3, dtype=numpy.uint8).reshape(480, 640, 3)
        loans = []

        def emit(output, number):
            if number % 2:
                output.emit_image(picture, {"n": number}, copied=True)
            else:
                loan = output.loan(picture.shape)
                loan[:] = picture
                output.emit_image(loan, n=number)
                loans.append(loan.flags.writeable)

        self.run_embedded(self.source(emit))
        collector = self.swarm.collect("source", window=1)
        kept = []
        for number in range(1, 5):
            event = collector.next(PATIENCE)
            self.assertEqual(event.header["n"], number)
            self.assertEqual(event.header.get("copied", False), number % 2 == 1)
            image = event.image()
            self.assertEqual(image.shape, (480, 640, 3))
            self.assertFalse(image.flags.writeable)
            self.assertTrue(numpy.array_equal(image, picture))
            kept.append(image)
        self.assertTrue(eventually(lambda: len(loans) >= 2))
        self.assertEqual(loans[:2], [False, False])
        status = self.swarm.status("source")
        self.swarm.close()
        self.assertTrue(all(numpy.array_equal(image, picture) for image in kept))
        edge = status["outputs"][0]["edges"][0]
        self.assertGreaterEqual(edge.get("shared", 0), 4)
        self.assertEqual(edge.get("fallback", 0), 0)

    def test_a_part_of_a_loan_is_copied_and_a_loan_is_emitted_once_without_a_copy(self):
        sent = []

        def emit(output, number):
            if number == 1:
                loan = output.loan((10, 10))
                loan[:] = 7
                output.emit_image(loan[2:5, 2:5])
                sent.append(loan.flags.writeable)
                output.emit_image(loan)
                output.emit_image(loan)
            else:
                time.sleep(0.01)

        self.run_embedded(self.source(emit))
        collector = self.swarm.collect("source")
        shapes = [collector.next(PATIENCE).image().shape for _ in range(3)]
        self.assertEqual(shapes, [(3, 3), (10, 10), (10, 10)])
        self.assertEqual(sent, [True])

    def test_events_of_one_picture_are_brought_together(self):
        join = hive.Drone("join", embedded=True)
        output = join.output("set", "application/json")

        @join.on_matched(("x", "*/*"), ("y", "*/*", "again"))
        def matching(x, y):
            output.emit({"numbers": [x.header["n"], y.header["n"]], "inputs": [x.input, y.input]})

        self.assertIsInstance(matching, hive.Matching)
        self.assertTrue(join.describe()["stateful"])
        self.run_embedded(self.source(lambda output, n: output.emit_captured({"n": n}, lossless=True)))
        self.run_embedded(join)
        self.swarm.halt("source")
        for port in ("x", "y"):
            self.swarm.connect("source", "join." + port)
        with self.swarm.collect_matched("source", "join") as sets:
            self.swarm.resume("source")
            for number in range(1, 6):
                event, joined = sets.next(PATIENCE)
                self.assertEqual(event.header["n"], number)
                self.assertEqual(joined.header, {"numbers": [number, number], "inputs": ["x", "y"]})
            self.assertGreaterEqual(sets.counts()["sets"]["sets"], 5)

    def test_the_end_of_a_source_passes_through_a_drone_and_is_told_with_its_text(self):
        def emit(output, number):
            if number <= 3:
                output.emit_captured({"n": number}, lossless=True)
            elif number == 4:
                output.end("3 of 4 frames: the file is damaged")

        worker = self.worker(lambda result, event: result.emit(event.header))
        ends = []
        worker.on_end(ends.append)
        self.run_embedded(worker)
        source = self.source(emit)
        source.source_events(4)
        self.run_embedded(source)
        with self.swarm.collect("worker") as results:
            self.swarm.connect("source", "worker")
            self.assertEqual([event.header["n"] for event in results], [1, 2, 3])
            self.assertEqual(results.ended, "3 of 4 frames: the file is damaged")
        self.assertEqual(ends, ["3 of 4 frames: the file is damaged"])
        with self.assertRaises(hive.Error) as caught:
            list(self.swarm.results("worker", timeout=PATIENCE))
        self.assertEqual(str(caught.exception), "3 of 4 frames: the file is damaged")

    def test_a_drone_may_begin_halted_and_its_parameters_may_be_the_operators(self):
        drone = hive.Drone("probe", embedded=True, halted=True)
        drone.parameter("path", "", operator=True, help="where the file is")
        self.run_embedded(drone)
        self.assertEqual(self.swarm.status("probe")["state"], "halted")
        self.assertTrue(self.swarm.describe("probe")["parameters"][0]["operator"])
        self.swarm.resume("probe")
        self.swarm.wait("probe", "idle")

    def test_an_embedded_drone_listens_as_safely_as_any(self):
        missing = os.path.join(self.home, "missing.key")
        self.refused("not_found", hive.Drone, "probe", embedded=True, listen=["tcp://127.0.0.1"], key=missing)
        with unittest.mock.patch.dict(os.environ, HIVE_KEY=missing):
            self.refused("not_permitted", hive.Drone, "probe", embedded=True, listen=["tcp://127.0.0.1"])
        self.refused("invalid_argument", hive.Drone, "probe", embedded=True, advertise=["tcp://127.0.0.1"])
        drone = hive.Drone("probe", embedded=True, listen=["tcp://127.0.0.1"], insecure=True)
        self.run_embedded(drone)
        self.assertEqual(len(self.swarm.status("probe")["places"]), 2)

    def test_what_a_source_cannot_give_has_its_number(self):
        def emit(output, number):
            if number == 2:
                output.fail("a damaged file", lossless=True)
            output.emit_captured({"n": number}, lossless=True)

        self.run_embedded(self.source(emit))
        exceptions, events = self.swarm.exceptions("source"), self.swarm.collect("source")
        self.assertEqual([events.next(PATIENCE).sequence for _ in range(2)], [1, 3])
        problem = exceptions.next(PATIENCE)
        self.assertEqual((problem.sequence, problem.header["code"], problem.header["text"]), (2, "io", "a damaged file"))

    def test_a_header_that_json_cannot_hold_is_an_exception_and_numpy_numbers_travel(self):
        def emit(output, number):
            output.emit_captured({"n": numpy.int64(number), "x": numpy.float32(0.5), "a": numpy.arange(2)}, lossless=True)
            if number == 1:
                output.emit({"bad": object()})

        self.run_embedded(self.source(emit))
        exceptions = self.swarm.exceptions("source")
        event = self.swarm.collect("source").next(PATIENCE)
        self.assertEqual(event.header, {"n": 1, "x": 0.5, "a": [0, 1]})
        self.assertIn("object cannot travel as JSON", exceptions.next(PATIENCE).header["text"])

    def test_emitting_on_another_thread_is_refused_and_stop_and_condition_are_not(self):
        drone = hive.Drone("probe", embedded=True)
        output = drone.output("out", "a/b")
        self.run_embedded(drone)
        self.assertIn("thread", str(self.refused("invalid_argument", output.emit)))
        drone.condition("stalled", "source_ended")
        self.refused("invalid_argument", drone.condition, "x", "no such reason")
        self.assertEqual(self.swarm.status("probe")["condition"], "stalled")
        drone.report("a report")
        self.assertTrue(eventually(lambda: self.swarm.status("probe").get("last_exception", {}).get("text") == "a report"))
        self.assertFalse(drone.stopping)

    def test_many_events_leave_no_handle_and_no_memory(self):
        def emit(output, number):
            output.emit_captured({"n": number}, b"x" * 5000, lossless=True)

        self.run_embedded(self.source(emit))
        self.run_embedded(self.worker(lambda result, event: result.emit({"n": event.header["n"], "s": len(event.body)})))
        results = self.swarm.collect("worker")
        self.swarm.connect("source", "worker")
        for _ in range(200):
            results.next(PATIENCE)
        event = None
        before = _library.lib.hive_handle_count()
        for number in range(201, 2001):
            event = results.next(PATIENCE)
            self.assertEqual(event.header, {"n": number, "s": 5000})
        self.assertLessEqual(_library.lib.hive_handle_count(), before + 8)  # what is under way just now
        del event

    def test_steps_on_the_own_thread_and_once_only(self):
        drone = hive.Drone("probe", embedded=True)
        self.refused("invalid_argument", drone.step, 0.001)
        self.refused("invalid_argument", drone.stop)
        drone.start()
        self.refused("invalid_argument", drone.start)
        self.assertTrue(drone.step(0.01))
        self.assertEqual(drone.status()["name"], "probe")
        drone.end()
        drone.end()
        self.assertEqual(self.swarm.drones(), [])

    def test_a_name_that_is_taken_is_said(self):
        first, second = hive.Drone("probe", embedded=True), hive.Drone("probe", embedded=True)
        self.run_embedded(first)
        self.refused("name_taken", second.run)

    def test_sys_exit_in_a_callback_ends_run(self):
        def leave(result, event):
            sys.exit(5)

        drone = self.worker(leave)
        problems = self.run_embedded(drone)
        self.swarm.put("worker", b"x")
        self.assertTrue(eventually(lambda: problems))
        self.assertEqual(problems[0].code, 5)


class Programs(World):
    """Drones that are programs of their own."""

    BODY = """
        import time, hive
        drone = hive.Drone("thing", "Does things.")
        work_ms = drone.parameter("work_ms", 0, least=0, help="how long each event takes")
        result = drone.output("result", "application/json", "results")

        @drone.on_event("in", "*/*")
        def work(event):
            "anything"
            time.sleep(work_ms.value / 1000)
            if event.header.get("raise"):
                raise KeyError("missing")
            while event.header.get("spin"):
                pass
            result.emit({"n": event.header.get("index", 0)})

        drone.run()
        print("ran to its end")
        """

    def script(self, body=BODY):
        path = os.path.join(self.home, "thing.py")
        with open(path, "w", encoding="utf-8") as file:
            file.write(textwrap.dedent(body))
        return path

    def thing(self, name="thing", *more, wait=True):
        return self.process(sys.executable, "-u", self.script(), *more, name=name, wait=wait)

    def run_thing(self, *words):
        return subprocess.run([sys.executable, self.script(), *words], capture_output=True, text=True, timeout=60)

    def test_the_command_line_is_that_of_every_drone(self):
        told = self.run_thing("--describe")
        self.assertEqual(told.returncode, 0, told.stderr)
        described = _library.json.loads(told.stdout.replace("ran to its end\n", ""))
        self.assertEqual(described["inputs"], [{"name": "in", "type": "*/*", "help": "anything"}])
        self.assertEqual(self.run_thing("--help").returncode, 0)
        self.assertIn("Does things.", self.run_thing("--help").stdout)
        self.assertTrue(self.run_thing("--version").stdout.startswith(hive.__version__))
        self.assertNotEqual(self.run_thing("--no-such-flag").returncode, 0)
        wrong = self.run_thing("--set", "work_ms=-1")
        self.assertEqual((wrong.returncode, wrong.stderr.count("Traceback")), (5, 0), wrong.stderr)
        self.assertIn("hive-thing: ", wrong.stderr)

    def test_hivectl_starts_a_file_with_parameters(self):
        hivectl = os.path.join(PROGRAMS, "hivectl")
        done = subprocess.run([hivectl, "start", self.script(), "work_ms=3"], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout), (0, "thing\n"), done.stderr)
        self.addCleanup(lambda: subprocess.run([hivectl, "stop", "--all"], env={**os.environ, "HIVE_HOME": self.home}))
        self.assertEqual(self.swarm.get("thing"), {"work_ms": 3})
        self.swarm.stop("thing")
        missing = subprocess.run([hivectl, "start", "missing.py"], capture_output=True, text=True, timeout=60)
        self.assertEqual(missing.returncode, 3)
        self.assertIn("missing.py", missing.stderr)

    def test_signals_and_stop_end_it_well(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            process = self.thing()
            process.send_signal(number)
            self.assertEqual(process.wait(PATIENCE), 0)
        process = self.thing()
        self.swarm.stop("thing")
        self.assertEqual(process.wait(PATIENCE), 0)
        self.assertEqual(self.log("thing").count("ran to its end"), 3)

    def test_a_callback_that_never_returns_does_not_keep_it_alive(self):
        process = self.thing()
        self.swarm.put("thing", b"", header={"spin": True})
        self.assertTrue(eventually(lambda: self.swarm.status("thing").get("busy_for_us", 0) > 0))
        self.assertEqual(self.swarm.describe("thing")["kind"], "thing")
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(PATIENCE), 0)

    def test_an_exception_halts_when_it_is_told_to_and_the_log_has_the_traceback(self):
        self.thing("thing", "--on-exception", "halt")
        exceptions = self.swarm.exceptions("thing")
        self.swarm.put("thing", b"", header={"raise": True})
        self.assertEqual(exceptions.next(PATIENCE).header["text"], "KeyError: 'missing'")
        self.swarm.wait("thing", "halted")
        self.assertIn('raise KeyError("missing")', self.log("thing"))

    def test_a_worker_that_is_killed_loses_nothing_of_shared_work(self):
        source = self.drone("ticker", "source", "pace=demand", "count=60", "bytes=5000")
        workers = [self.thing(name, "--set", "work_ms=5") for name in ("one", "two")]
        self.drone("sleeper", "three", "work_ms=5")
        results = self.swarm.collect("one", "two", "three", ordered=True)
        self.swarm.halt("source")
        for name in ("one", "two", "three"):
            self.swarm.connect("source", name, group="workers")
        self.swarm.resume("source")
        numbers = []
        for number in range(60):
            if number == 20:
                workers[0].kill()
            event = results.next(PATIENCE)
            self.assertIsNotNone(event, f"no result {number + 1}")
            numbers.append(event.sequence)
        self.assertEqual(numbers, list(range(1, 61)))
        self.assertIsNone(source.poll())


if __name__ == "__main__":
    unittest.main()
