"""Events through drones in Python: identity, exceptions, matching, ends, bodies that are made when they are wanted."""

import logging
import time
import unittest

import numpy

import hive
from hive import _library
from world import TIMEOUT, Embedded


class Events(Embedded):
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
                event = results.next(TIMEOUT)
                self.assertEqual((event.sequence, event.header["first"]), (sequence, sequence))
                self.assertEqual((event.source, event.sender, event.kind), ("source", "worker", "worker"))
                self.assertEqual((event.output, event.type, event.lossless), ("result", "application/json", True))
                self.assertEqual([hop.drone for hop in event.hops], ["worker"])
                self.assertEqual((event.size, len(event.body)), (0, 0))
                self.assertLess(abs(time.time() - event.captured), TIMEOUT + 10)
            first, second = exceptions.next(TIMEOUT), exceptions.next(TIMEOUT)
            self.assertEqual((first.header["code"], first.sequence), ("failed", 2))
            self.assertEqual(first.header["text"], "ValueError: two is not to my taste")
            self.assertEqual((second.header["code"], second.header["text"]), ("unsupported", "three neither"))
        self.assertIn("Traceback", "\n".join(logs.output))
        self.assertIn("in work", "\n".join(logs.output))

    def test_a_body_is_made_only_for_somebody(self):
        made, problems = [], []

        def body(number):
            made.append(number)
            if number == 3:
                raise LookupError("three is missing")
            return b"x" * number

        def emit(output, number):
            try:
                output.emit_captured({"n": number}, lambda: body(number), captured=1.7e9, lossless=True)
            except LookupError as problem:
                problems.append(str(problem))
            output.emit_captured({"n": 0}, lambda: b"", lossless=True)
            output.emit_captured_image(numpy.zeros((2, 2), numpy.uint8), {"n": -1}, captured=1.8e9, lossless=True)

        drone = self.source(emit)
        unwanted = drone.output("unwanted", "text/plain")
        drone.on_start(lambda: unwanted.emit(body=lambda: body(0)))
        self.run_embedded(drone)
        events = self.swarm.collect("source.out", window=1)
        seen = [events.next(TIMEOUT) for _ in range(8)]
        self.assertEqual([(event.header["n"], event.size) for event in seen],
                         [(1, 1), (0, 0), (-1, 4), (2, 2), (0, 0), (-1, 4), (0, 0), (-1, 4)])
        self.assertEqual([seen[0].captured, seen[2].captured], [1.7e9, 1.8e9])
        self.assertEqual((made[:3], problems), ([1, 2, 3], ["three is missing"]))

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
                event, joined = sets.next(TIMEOUT)
                self.assertEqual(event.header["n"], number)
                self.assertEqual(joined.header, {"numbers": [number, number], "inputs": ["x", "y"]})
            self.assertGreaterEqual(sets.counts()["sets"]["sets"], 5)
            self.assertEqual([end["from"] for end in sets.inputs()], ["source.out", "join.set"])

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
            list(self.swarm.results("worker", timeout=TIMEOUT))
        self.assertEqual(str(caught.exception), "3 of 4 frames: the file is damaged")

    def test_what_a_source_cannot_give_has_its_number(self):
        def emit(output, number):
            if number == 2:
                output.fail("a damaged file", lossless=True)
            output.emit_captured({"n": number}, lossless=True)

        self.run_embedded(self.source(emit))
        exceptions, events = self.swarm.exceptions("source"), self.swarm.collect("source")
        self.assertEqual([events.next(TIMEOUT).sequence for _ in range(2)], [1, 3])
        problem = exceptions.next(TIMEOUT)
        said = (problem.sequence, problem.header["code"], problem.header["text"])
        self.assertEqual(said, (2, "io", "a damaged file"))

    def test_a_header_that_json_cannot_hold_is_an_exception_and_numpy_numbers_travel(self):
        def emit(output, number):
            header = {"n": numpy.int64(number), "x": numpy.float32(0.5), "a": numpy.arange(2)}
            output.emit_captured(header, lossless=True)
            if number == 1:
                output.emit({"bad": object()})

        self.run_embedded(self.source(emit))
        exceptions = self.swarm.exceptions("source")
        event = self.swarm.collect("source").next(TIMEOUT)
        self.assertEqual(event.header, {"n": 1, "x": 0.5, "a": [0, 1]})
        self.assertIn("this cannot travel as JSON: a value of type object", exceptions.next(TIMEOUT).header["text"])

    def test_many_events_leave_no_handle_and_no_memory(self):
        def emit(output, number):
            output.emit_captured({"n": number}, b"x" * 5000, lossless=True)

        self.run_embedded(self.source(emit))
        work = lambda result, event: result.emit({"n": event.header["n"], "s": len(event.body)})
        self.run_embedded(self.worker(work))
        results = self.swarm.collect("worker")
        self.swarm.connect("source", "worker")
        for _ in range(200):
            results.next(TIMEOUT)
        event = None
        before = _library.lib.hive_handle_count()
        for number in range(201, 2001):
            event = results.next(TIMEOUT)
            self.assertEqual(event.header, {"n": number, "s": 5000})
        self.assertLessEqual(_library.lib.hive_handle_count(), before + 8)  # what is under way just now
        del event


if __name__ == "__main__":
    unittest.main()
