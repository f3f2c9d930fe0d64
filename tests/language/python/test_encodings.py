"""Outputs of drones in Python that give their events in other encodings."""

import threading
import unittest

import numpy

import hive
from hive import _images
from world import TIMEOUT, World

IMAGE = numpy.add.outer(numpy.arange(60, dtype=numpy.uint8), numpy.arange(80, dtype=numpy.uint8))
COLOUR = numpy.dstack((IMAGE, IMAGE + 20, IMAGE + 40))


class Encodings(World):
    def camera(self, types, encodings, emit):
        drone = hive.Drone("camera", embedded=True)
        output = drone.output("image", types, encodings=encodings)
        drone.main(lambda: emit(output) if output.asked else 3600)
        self.run_embedded(drone)
        return drone

    def images(self):
        self.camera(
            "image/raw,image/jpeg,image/png",
            hive.images(),
            lambda output: output.emit_captured_image(COLOUR, {"n": 1}, lossless=True),
        )

    def test_images_come_as_a_connection_asks_for_them(self):
        self.images()
        kinds = {"": "raw", "raw": "raw", "png": "png", "jpeg": "jpeg", "jpeg:10": "jpeg"}
        sizes = {}
        for encoding, word in kinds.items():
            with self.subTest(encoding), self.swarm.collect("camera", encoding=encoding) as images:
                event = images.next(TIMEOUT)
                self.assertEqual((event.type, event.header["n"], event.header["width"]), ("image/" + word, 1, 80))
                self.assertEqual("stride" in event.header, word == "raw")
                most = 40 if word == "jpeg" else 0
                self.assertLessEqual(numpy.abs(event.image().astype(int) - COLOUR).max(), most)
                sizes[encoding] = event.size
        self.assertLess(sizes["jpeg:10"], sizes["jpeg"])
        for wrong in ("jpeg:101", "png:1", "tiff"):
            error = self.refused("invalid_argument", self.swarm.collect, "camera", encoding=wrong)
            self.assertEqual(error.advice, "there are jpeg, jpeg:1 to jpeg:100, png, raw")

    def test_a_drone_that_takes_nothing_else_gets_what_it_takes(self):
        reader = hive.Drone("reader", embedded=True)
        result = reader.output("result", "application/json")

        @reader.on_event("in", "image/png")
        def read(event):
            result.emit({"type": event.type, "same": bool(numpy.array_equal(event.image(), COLOUR))})

        self.run_embedded(reader)
        results = self.swarm.collect("reader")
        self.images()
        self.swarm.connect("camera", "reader")
        self.assertEqual(results.next(TIMEOUT).header, {"type": "image/png", "same": True})
        edge = self.swarm.status("camera")["outputs"][0]["edges"][0]
        self.assertEqual(edge["encoding"], "png")

    def test_an_encoding_of_ones_own_gets_the_event_and_the_number_on_another_thread(self):
        threads = []

        def repeat(event, number):
            threads.append(threading.get_ident())
            if number == 9:
                raise ValueError("nine is too many")
            return {"times": number}, bytes(event.body) * (number or 1)

        own = [
            hive.Encoding("repeat", "text/repeated", repeat, 1, 9),
            hive.Encoding("same", "text/same", lambda event, _: event.body),
        ]
        types = "text/plain,text/repeated,text/same"
        self.camera(types, own, lambda output: output.emit_captured({}, b"ab", lossless=True))
        seen = {}
        for encoding in ("repeat", "repeat:3", "same"):
            with self.swarm.collect("camera", encoding=encoding) as events:
                event = events.next(TIMEOUT)
                seen[encoding] = (event.type, event.header, bytes(event.body))
        self.assertEqual(seen, {"repeat": ("text/repeated", {"times": None}, b"ab"),
                                "repeat:3": ("text/repeated", {"times": 3}, b"ababab"),
                                "same": ("text/same", {}, b"ab")})
        self.assertNotIn(threading.get_ident(), threads)
        exceptions = self.swarm.exceptions("camera")
        with self.swarm.collect("camera", encoding="repeat:9") as events:
            self.assertEqual(events.next(TIMEOUT).type, "text/plain")
        self.assertIn("ValueError: nine is too many", exceptions.next(TIMEOUT).header["text"])

    def test_what_cannot_be_declared_is_refused(self):
        drone = hive.Drone("camera", embedded=True)
        self.refused("invalid_argument", hive.images, "tiff")
        for word in ("", "a b", "x:1"):
            self.refused("invalid_argument", drone.output, "x", "a/b", encodings=[hive.Encoding(word, "a/b", bytes)])

    def test_pillow_encodes_and_decodes_where_there_is_no_opencv(self):
        for kind in ("image/png", "image/jpeg"):
            for image in (IMAGE, COLOUR):
                data = _images._encode_by_pillow(kind, image, 90)
                again = _images._decode_by_pillow(kind, data, numpy)
                expected = image if image.ndim == 3 else numpy.dstack([image] * 3)
                self.assertLessEqual(numpy.abs(again.astype(int) - expected).max(), 20 if kind == "image/jpeg" else 0)


if __name__ == "__main__":
    unittest.main()
