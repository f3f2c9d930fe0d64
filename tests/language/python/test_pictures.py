"""Pictures out of bodies and into them, without drones."""

import struct
import unittest
import zlib

import cv2
import numpy

import hive
from hive import _pictures


def raw(picture):
    return _pictures.raw_header(picture), memoryview(picture.tobytes())


class Pictures(unittest.TestCase):
    def refused(self, code, *arguments):
        with self.assertRaises(hive.Error) as caught:
            _pictures.decode(*arguments)
        self.assertEqual(caught.exception.code, code, caught.exception)

    def setUp(self):
        self.colour = numpy.random.default_rng(1).integers(0, 256, (12, 17, 3), numpy.uint8)
        self.grey = self.colour[:, :, 0].copy()

    def test_raw_pictures_are_read_only_views(self):
        for picture in (self.colour, self.grey):
            header, body = raw(picture)
            seen = _pictures.decode("image/raw", header, body)
            self.assertTrue(numpy.array_equal(seen, picture))
            self.assertFalse(seen.flags.writeable)
            self.assertTrue(numpy.shares_memory(seen, numpy.frombuffer(body, numpy.uint8)))

    def test_rows_may_lie_apart(self):
        body = memoryview(numpy.pad(self.grey, ((0, 0), (0, 3))).tobytes())
        header = {"width": 17, "height": 12, "pixel_format": "gray8", "stride": 20}
        self.assertTrue(numpy.array_equal(_pictures.decode("image/raw", header, body), self.grey))

    def test_a_header_that_does_not_fit_the_bytes_is_malformed(self):
        header, body = raw(self.colour)
        for change in (
            {"width": 18},
            {"width": 0},
            {"width": 17.0},
            {"width": "17"},
            {"width": True},
            {"height": -12},
            {"height": 1 << 40},
            {"stride": 50},
            {"stride": 1 << 60},
            {"pixel_format": "rgb8"},
            {"pixel_format": None},
        ):
            self.refused("malformed", "image/raw", {**header, **change}, body)
        self.refused("malformed", "image/raw", {}, body)
        self.refused("malformed", "image/raw", header, body[:-1])
        self.refused("too_large", "image/raw", {**header, "width": 1 << 20, "height": 1 << 20, "stride": 3 << 20}, body)

    def test_compressed_pictures_are_those_of_opencv(self):
        for kind, ending in (("image/png", ".png"), ("image/jpeg", ".jpg")):
            data = cv2.imencode(ending, self.colour)[1].tobytes()
            expected = cv2.imdecode(numpy.frombuffer(data, numpy.uint8), cv2.IMREAD_COLOR)
            self.assertTrue(numpy.array_equal(_pictures.decode(kind, {}, memoryview(data)), expected))
            for bad in (b"", b"x", data[: len(data) // 2], data[:40], b"\xff" * 1000, b"\xff\xd8\xff\xd9"):
                self.refused("malformed", kind, {}, memoryview(bad))
        self.refused("unsupported", "image/gif", {}, memoryview(b"GIF89a"))

    def test_a_picture_that_declares_too_many_pixels_is_not_decoded(self):
        head = struct.pack(">IIBBBBB", 50_000, 50_000, 8, 2, 0, 0, 0)
        chunk = struct.pack(">I", 13) + b"IHDR" + head + struct.pack(">I", zlib.crc32(b"IHDR" + head))
        bomb = b"\x89PNG\r\n\x1a\n" + chunk + struct.pack(">I", 0) + b"IEND" + struct.pack(">I", zlib.crc32(b"IEND"))
        self.refused("too_large", "image/png", {}, memoryview(bomb))

    def test_a_jpeg_of_too_many_scans_is_not_decoded(self):
        data = cv2.imencode(".jpg", self.colour)[1].tobytes()
        scan = data[data.index(b"\xff\xda") : -2]
        self.refused("too_large", "image/jpeg", {}, memoryview(data[:-2] + 100 * scan + data[-2:]))

    def test_what_is_no_picture_cannot_be_emitted(self):
        for shape, kind in (((3, 3), "float32"), ((3,), "uint8"), ((3, 3, 4), "uint8"), ((0, 3), "uint8")):
            with self.assertRaises(hive.Error) as caught:
                _pictures.raw_header(numpy.zeros(shape, kind))
            self.assertEqual(caught.exception.code, "invalid_argument")

    def test_a_notebook_gets_a_png(self):
        for picture in (self.colour, self.grey):
            shown = cv2.imdecode(numpy.frombuffer(_pictures.as_png(picture), numpy.uint8), cv2.IMREAD_UNCHANGED)
            self.assertTrue(numpy.array_equal(shown, picture))


if __name__ == "__main__":
    unittest.main()
