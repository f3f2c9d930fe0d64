"""Drones in Python inside of a program: declared, run, stepped, ended."""

import os
import sys
import threading
import unittest
import unittest.mock

import hive
from world import PATIENCE, Embedded, eventually


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
        self.assertTrue(taken.wait(PATIENCE))

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
