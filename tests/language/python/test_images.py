"""Pictures through drones in Python: views, loans, notebooks, and what waits for its first receiver."""

import time
import unittest

import numpy

import hive
from world import TIMEOUT, Embedded, eventually


class Images(Embedded):
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
            event = collector.next(TIMEOUT)
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
                output.emit_image(loan[:4])
                sent.append(loan.flags.writeable)
                output.emit_image(loan)
                output.emit_image(loan)
            else:
                time.sleep(0.01)

        self.run_embedded(self.source(emit))
        collector = self.swarm.collect("source")
        shapes = [collector.next(TIMEOUT).image().shape for _ in range(4)]
        self.assertEqual(shapes, [(3, 3), (4, 10), (10, 10), (10, 10)])
        self.assertEqual(sent, [True])

    def test_pictures_made_of_a_source_on_demand_wait_whole_for_the_first_receiver(self):
        picture = numpy.full((30, 40), 7, numpy.uint8)
        worker = hive.Drone("worker", embedded=True)
        result = worker.output("result", "image/raw")
        begun = []

        @worker.on_event("in", "*/*")
        def work(event):
            begun.append(event.sequence)
            result.emit_image(picture, n=event.sequence)

        self.run_embedded(worker)
        self.run_embedded(self.source(lambda output, n: output.emit_captured({"n": n}, lossless=True)))
        self.swarm.connect("source", "worker")
        self.assertTrue(eventually(lambda: begun))
        results = self.swarm.collect("worker")
        for number in range(1, 4):
            event = results.next(TIMEOUT)
            self.assertEqual(event.header["n"], number)
            self.assertTrue(numpy.array_equal(event.image(), picture))

    def test_every_kind_of_pixels_goes_through_drones_and_a_loan_of_it(self):
        pictures = [
            numpy.random.default_rng(4).uniform(0, 250, shape).astype(kind)
            for kind in ("uint8", "uint16", "float32", ">u2")
            for shape in ((6, 5), (6, 5, 1), (6, 5, 3), (6, 5, 4))
        ]
        pictures.append(numpy.frombuffer(bytes(range(30)), numpy.uint8).reshape(5, 6))
        pictures.append(pictures[4][::2, ::-1])

        def emit(output, number):
            if number > 2 * len(pictures):
                return
            picture = pictures[(number - 1) // 2]
            if number % 2 == 0:
                loan = output.loan(picture.shape, picture.dtype)
                loan[:] = picture
                picture = loan
            output.emit_captured_image(picture, lossless=True)

        self.run_embedded(self.source(emit))
        collector = self.swarm.collect("source")
        for picture in pictures:
            for _ in range(2):
                image = collector.next(TIMEOUT).image()
                self.assertEqual(image.dtype, picture.dtype.newbyteorder("="))
                self.assertTrue(numpy.array_equal(image, picture.reshape(image.shape)))
                with self.assertRaises(ValueError):
                    image.flags.writeable = True

    def test_a_shape_that_is_none_or_too_large_is_refused(self):
        drone = hive.Drone("probe", embedded=True)
        output = drone.output("out", "image/raw")
        for shape in (-1, (-2, 3), 2.5, "ab", None, (2, None)):
            self.assertIn("a shape is", str(self.refused("invalid_argument", output.loan, shape)))
        for shape in ((1 << 40, 1 << 40), (1 << 14, 1 << 13), 1 << 64):
            self.refused("too_large", output.loan, shape)
        self.assertEqual(output.loan((0, 3)).shape, (0, 3))
        for body in ([1, 2], "text", 5):
            self.refused("invalid_argument", output.emit, {}, body)
        self.refused("invalid_argument", output.emit, "text")

    def test_a_notebook_shows_pictures_and_leaves_what_is_none(self):
        size = {"width": 2, "height": 1, "pixel_format": "gray8"}
        shown = [
            (size, b"xy", "image/raw"),
            (size, b"x", "image/raw"),
            ({}, b"", "image/raw"),
            ({}, b"{}", "application/json"),
            ({}, b"", "image/png"),
            ({}, b"", "image/jpeg"),
        ]

        def emit(output, number):
            if number <= len(shown):
                header, body, kind = shown[number - 1]
                output.emit_captured(header, body, kind, lossless=True)

        self.run_embedded(self.source(emit))
        events = self.swarm.collect("source")
        seen = [events.next(TIMEOUT) for _ in shown]
        self.assertEqual([event._repr_png_() is not None for event in seen], [True] + [False] * 5)
        self.assertEqual([event._repr_jpeg_() for event in seen], [None] * 6)
        self.assertIn("1 bytes", repr(seen[1]))


if __name__ == "__main__":
    unittest.main()
