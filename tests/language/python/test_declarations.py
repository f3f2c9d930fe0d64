"""Drones in Python inside of a program: declared, run, stepped, ended."""

import os
import sys
import threading
import unittest
import unittest.mock

import numpy

import hive
from hive import _library
from world import TIMEOUT, Embedded, eventually


class Declarations(Embedded):
    def test_parameters_of_all_types_are_declared_set_and_refused(self):
        drone = hive.Drone("probe", "For tests.", embedded=True, parameters={"scale": 2})
        radius = drone.parameter("radius", 3, least=0, most=50, unit="px", help="of the blur")
        scale = drone.parameter("scale", 1.5, least=1)
        invert = drone.parameter("invert", False)
        mode = drone.parameter("mode", "fast", choices=["fast", "slow"])
        seen = []
        self.assertEqual(drone.given("scale"), 2)
        self.assertIsNone(drone.given("radius"))
        self.assertFalse(drone.remembered("scale"))

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
        error = self.refused("refused", self.swarm.set, "probe", radius=13)
        self.assertIn("ValueError: 13 brings bad luck", str(error))
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

    def test_ports_and_types_that_cannot_be_are_refused_at_the_declaration(self):
        drone = hive.Drone("probe", embedded=True)
        drone.output("out", "image/raw")
        drone.on_event("in", "image/*,*/*")(lambda event: None)
        drone.parameter("low", 1)
        pair = drone.on_matched
        for text, declare in {
            "output out is declared twice": lambda: drone.output("out", "image/raw"),
            "input in is declared twice": lambda: drone.on_event("in", "image/raw")(print),
            "input left is declared twice": lambda: pair(("left", "a/b"), ("left", "a/b"))(print),
            "parameter low is declared twice": lambda: drone.parameter("low", 2),
            'output x: "raw" is not a media type': lambda: drone.output("x", "raw"),
            'output x: "" is not a media type': lambda: drone.output("x", "image/raw,"),
            'output x: " image/png" is not a media type': lambda: drone.output("x", "image/raw, image/png"),
            'input x: "raw" is not a media type': lambda: drone.on_event("x", "raw")(print),
            "the type of output x is a text, not ['image/raw']": lambda: drone.output("x", ["image/raw"]),
            "the type of input x is a text, not None": lambda: drone.on_event("x", None),
            "the name of an output is a text, not 3": lambda: drone.output(3, "a/b"),
            "choices is a list, not the text 'fast'": lambda: drone.parameter("mode", "fast", choices="fast"),
            "encodings is a list, not the text 'jpeg'": lambda: drone.output("x", "a/b", encodings="jpeg"),
            "an input to match is (name, type) or (name, type, help), not 'left'": lambda: pair("left", "right"),
            "connect is a list, not the text 'in=a.b'": lambda: hive.Drone("x", embedded=True, connect="in=a.b"),
            "listen is a list, not the text 'tcp://a'": lambda: hive.Drone("x", embedded=True, listen="tcp://a"),
        }.items():
            with self.subTest(text):
                error = self.refused("invalid_argument", declare)
                self.assertTrue(str(error).startswith(text), error)
                self.assertNotIn("\n", str(error))

    def test_a_function_that_is_no_decorated_one_is_refused(self):
        drone = hive.Drone("probe", embedded=True)
        refused = self.refused("invalid_argument", drone.on_event, "in", "image/raw", print)
        self.assertEqual(str(refused), "on_event decorates a function; write @drone.on_event(...) above it")
        self.refused("invalid_argument", drone.on_event, "in", "image/raw", 3)

    def test_callbacks_that_would_never_run_are_refused_at_once(self):
        drone = hive.Drone("probe", embedded=True)

        async def later(event):
            pass

        async def many(event):
            yield event

        def each(event):
            yield event

        declare = {
            "on_event": drone.on_event("in", "a/b"),
            "on_matched": drone.on_matched(("left", "a/b"), ("right", "a/b")),
            "on_change": drone.on_change,
            "on_start": drone.on_start,
            "on_end": drone.on_end,
            "main": drone.main,
        }
        for what, decorate in declare.items():
            with self.subTest(what):
                told = f"{what}: later is async, and callbacks of a drone are not awaited; write def"
                self.assertEqual(str(self.refused("invalid_argument", decorate, later)), told)
                self.assertIn("many is async", str(self.refused("invalid_argument", decorate, many)))
                self.assertIn("each is a generator", str(self.refused("invalid_argument", decorate, each)))
                self.assertIn("not 5", str(self.refused("invalid_argument", decorate, 5)))

    def test_a_parameter_behaves_as_its_value(self):
        drone = hive.Drone("probe", embedded=True)
        low, scale = drone.parameter("low", 50), drone.parameter("scale", 1.5)
        invert, mode = drone.parameter("invert", False), drone.parameter("mode", "fast")
        self.assertEqual((int(low), float(scale), bool(invert), str(mode)), (50, 1.5, False, "fast"))
        self.assertEqual((f"{scale:.2f}", f"{low:>4}", f"{mode}"), ("1.50", "  50", "fast"))
        self.assertTrue(low == 50 and low != 49 and low < 51 and low <= 50 and low > 49 and 50 >= low and low > scale)
        self.assertTrue(not invert and mode == "fast" and "as" in mode and len(mode) == 4)
        self.assertEqual((2 * low, low + 1, 100 - low, low / 4, 7 // low, low % 7, 2**scale), (100, 51, 50, 12.5, 0, 1, 2**1.5))
        self.assertEqual((-low, abs(low), round(scale), round(scale, 1), [*range(low)][-1]), (-50, 50, 2, 1.5, 49))
        numbers = numpy.array([49, 50, 51])
        self.assertEqual((numbers > low).tolist(), [False, False, True])
        self.assertEqual((low * numbers).tolist(), [2450, 2500, 2550])
        self.assertEqual(numpy.full(2, low).tolist(), [50, 50])
        self.assertEqual(numpy.clip(numbers, 0, low).tolist(), [49, 50, 50])
        self.assertEqual(_library.as_json({"low": low}), b'{"low": 50}')
        with self.assertRaisesRegex(AttributeError, "has no 'upper'; its value is mode.value"):
            mode.upper()
        with self.assertRaisesRegex(AttributeError, "has no 'vlaue'; its value is low.value"):
            low.vlaue = 3
        with self.assertRaises(TypeError):
            {low: 1}
        with self.assertRaises(TypeError):
            range(scale)

    def test_a_drone_may_begin_halted_and_its_parameters_may_be_the_operators(self):
        drone = hive.Drone("probe", embedded=True, halted=True)
        drone.parameter("path", "", operator=True, help="where the file is")
        self.run_embedded(drone)
        self.assertEqual(self.swarm.status("probe")["state"], "halted")
        self.assertTrue(self.swarm.describe("probe")["parameters"][0]["operator"])
        self.swarm.resume("probe")
        self.swarm.wait("probe", "idle")

    def test_what_a_drone_receives_may_be_said_before_the_sender_is_there(self):
        self.refused("invalid_argument", hive.Drone, "worker", embedded=True, connect=["source"])
        taken = threading.Event()
        worker = hive.Drone("worker", embedded=True, connect=["source.out,window=2"])

        @worker.on_event("in", "*/*", "anything")
        def take(event):
            taken.set()

        self.run_embedded(worker)
        self.assertEqual(self.swarm.status("worker")["inputs"][0]["from"], "source.out")
        self.run_embedded(self.source(lambda output, number: output.emit({"number": number})))
        self.assertTrue(taken.wait(TIMEOUT))

    def test_an_embedded_drone_listens_as_safely_as_any(self):
        missing = os.path.join(self.home, "missing.key")
        self.refused("not_found", hive.Drone, "probe", embedded=True, listen=["tcp://127.0.0.1"], key=missing)
        with unittest.mock.patch.dict(os.environ, HIVE_KEY=missing):
            self.refused("not_permitted", hive.Drone, "probe", embedded=True, listen=["tcp://127.0.0.1"])
        self.refused("invalid_argument", hive.Drone, "probe", embedded=True, advertise=["tcp://127.0.0.1"])
        drone = hive.Drone("probe", embedded=True, listen=["tcp://127.0.0.1"], insecure=True)
        self.run_embedded(drone)
        self.assertEqual(len(self.swarm.status("probe")["places"]), 2)

    def test_log_lines_of_an_embedded_drone_have_their_level_in_logging(self):
        drone = hive.Drone("probe", embedded=True)
        self.run_embedded(drone)
        with self.assertLogs("hive.probe", "DEBUG") as logs:
            drone.log("plain")
            for level in ("debug", "info", "warning", "error"):
                drone.log("of " + level, level)
            self.refused("invalid_argument", drone.log, "text", "loud")
            drone.report("a report")
        said = [(record.levelname, record.getMessage()) for record in logs.records]
        for line in (("INFO", "plain"), ("DEBUG", "of debug"), ("INFO", "of info"), ("WARNING", "of warning"),
                     ("ERROR", "of error"), ("ERROR", "exception: failed: a report")):
            self.assertIn(line, said)

    def test_emitting_on_another_thread_is_refused_and_stop_and_condition_are_not(self):
        drone = hive.Drone("probe", embedded=True)
        output = drone.output("out", "a/b")
        self.run_embedded(drone)
        self.assertIn("thread", str(self.refused("invalid_argument", output.emit)))
        drone.condition("stalled", "source_ended")
        self.refused("invalid_argument", drone.condition, "x", "no such reason")
        self.assertEqual(self.swarm.status("probe")["condition"], "stalled")
        drone.report("a report")
        last = lambda: self.swarm.status("probe").get("last_exception", {})
        self.assertTrue(eventually(lambda: last().get("text") == "a report"))
        self.assertFalse(drone.stopping)

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


if __name__ == "__main__":
    unittest.main()
