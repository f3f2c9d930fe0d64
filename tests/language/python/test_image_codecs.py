"""Decoding and encoding of images, without drones."""

import io
import struct
import sys
import unittest
import unittest.mock
import zlib

import cv2
import numpy
import PIL.Image

import hive
from hive import _jpeg, _images


def raw(image):
    return _images.raw_header(image), memoryview(image.tobytes())


class Images(unittest.TestCase):
    def refused(self, code, *arguments):
        with self.assertRaises(hive.Error) as caught:
            _images.decode(*arguments)
        self.assertEqual(caught.exception.code, code, caught.exception)

    def setUp(self):
        self.colour = numpy.random.default_rng(1).integers(0, 256, (12, 17, 3), numpy.uint8)
        self.grey = self.colour[:, :, 0].copy()

    def test_raw_images_are_read_only_views(self):
        for image in (self.colour, self.grey):
            header, body = raw(image)
            seen = _images.decode("image/raw", header, body)
            self.assertTrue(numpy.array_equal(seen, image))
            self.assertFalse(seen.flags.writeable)
            self.assertTrue(numpy.shares_memory(seen, numpy.frombuffer(body, numpy.uint8)))

    def test_rows_may_lie_apart(self):
        body = memoryview(numpy.pad(self.grey, ((0, 0), (0, 3))).tobytes())
        header = {"width": 17, "height": 12, "pixel_format": "gray8", "stride": 20}
        self.assertTrue(numpy.array_equal(_images.decode("image/raw", header, body), self.grey))

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

    def test_compressed_images_are_those_of_opencv(self):
        for kind, ending in (("image/png", ".png"), ("image/jpeg", ".jpg")):
            data = cv2.imencode(ending, self.colour)[1].tobytes()
            expected = cv2.imdecode(numpy.frombuffer(data, numpy.uint8), cv2.IMREAD_COLOR)
            self.assertTrue(numpy.array_equal(_images.decode(kind, {}, memoryview(data)), expected))
            for bad in (b"", b"x", data[: len(data) // 2], data[:40], b"\xff" * 1000, b"\xff\xd8\xff\xd9"):
                self.refused("malformed", kind, {}, memoryview(bad))
        self.refused("unsupported", "image/gif", {}, memoryview(b"GIF89a"))

    def test_a_jpeg_for_print_is_that_of_opencv(self):
        inks = numpy.random.default_rng(4).integers(0, 256, (12, 17, 4), numpy.uint8)
        file = io.BytesIO()
        PIL.Image.fromarray(inks, "CMYK").save(file, "JPEG")
        data = file.getvalue()
        expected = cv2.imdecode(numpy.frombuffer(data, numpy.uint8), cv2.IMREAD_COLOR)
        self.assertTrue(numpy.array_equal(_images.decode("image/jpeg", {}, memoryview(data)), expected))
        self.refused("malformed", "image/jpeg", {}, memoryview(data[:-60] + b"\xff\xd9"))

    def test_an_image_that_declares_too_many_pixels_is_not_decoded(self):
        head = struct.pack(">IIBBBBB", 50_000, 50_000, 8, 2, 0, 0, 0)
        chunk = struct.pack(">I", 13) + b"IHDR" + head + struct.pack(">I", zlib.crc32(b"IHDR" + head))
        bomb = b"\x89PNG\r\n\x1a\n" + chunk + struct.pack(">I", 0) + b"IEND" + struct.pack(">I", zlib.crc32(b"IEND"))
        self.refused("too_large", "image/png", {}, memoryview(bomb))

    def test_a_jpeg_of_too_many_scans_is_not_decoded(self):
        data = cv2.imencode(".jpg", self.colour)[1].tobytes()
        scan = data[data.index(b"\xff\xda") : -2]
        self.refused("too_large", "image/jpeg", {}, memoryview(data[:-2] + 100 * scan + data[-2:]))

    def test_half_a_jpeg_is_an_error_as_in_cpp(self):
        image = numpy.random.default_rng(2).integers(0, 256, (200, 300, 3), numpy.uint8)
        data = cv2.imencode(".jpg", image)[1].tobytes()
        for bad in (data[: len(data) // 2] + b"\xff\xd9", data[:-60] + b"\xff\xd9"):
            self.refused("malformed", "image/jpeg", {}, memoryview(bad))
        png = cv2.imencode(".png", image)[1].tobytes()
        for bad in (png[: len(png) // 2] + png[-12:], png[:100] + b"?" + png[101:]):
            self.refused("malformed", "image/png", {}, memoryview(bad))

    def test_a_jpeg_is_turned_as_exif_says(self):
        data = cv2.imencode(".jpg", self.colour)[1].tobytes()
        directory = b"MM\0*\0\0\0\x08" + b"\0\x01" + struct.pack(">HHIHH", 0x112, 3, 1, 6, 0) + b"\0\0\0\0"
        exif = b"Exif\0\0" + directory
        turned = data[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + data[2:]
        self.assertEqual(_images.decode("image/jpeg", {}, memoryview(turned)).shape, (17, 12, 3))

    def test_a_jpeg_is_the_same_without_turbojpeg(self):
        data = memoryview(cv2.imencode(".jpg", self.colour)[1].tobytes())
        seen = _images.decode("image/jpeg", {}, data)
        with unittest.mock.patch.object(_jpeg, "_library", False):
            self.assertTrue(numpy.array_equal(_images.decode("image/jpeg", {}, data), seen))
            with unittest.mock.patch.dict(sys.modules, {"PIL.Image": None}):
                self.assertTrue(numpy.array_equal(_images.decode("image/jpeg", {}, data), seen))

    def test_every_kind_of_pixels_comes_as_it_went(self):
        for kind, depth in (("uint8", "8"), ("uint16", "16"), ("float32", "32f")):
            for shape, colour in (((4, 5), "gray"), ((4, 5, 1), "gray"), ((4, 5, 3), "bgr"), ((4, 5, 4), "bgra")):
                with self.subTest(colour + depth, shape=shape):
                    image = numpy.random.default_rng(3).uniform(0, 200, shape).astype(kind)
                    header, body = raw(image)
                    self.assertEqual(header["pixel_format"], colour + depth)
                    self.assertEqual(header["stride"] * header["height"], len(body))
                    seen = _images.decode("image/raw", header, body)
                    self.assertEqual(seen.dtype, kind)
                    self.assertTrue(numpy.array_equal(seen, image.reshape(seen.shape)))

    def test_a_view_of_a_body_cannot_be_made_writable(self):
        for image in (self.colour, self.grey.astype("float32")):
            seen = _images.decode("image/raw", *raw(image))
            with self.assertRaises(ValueError):
                seen.flags.writeable = True
            with self.assertRaises(ValueError):
                seen[0, 0] = 0

    def test_what_is_no_image_is_refused_with_one_sentence(self):
        for thing, text in (
            (None, "None is not an image"),
            ([[1, 2]], "an image is a NumPy array, not a list"),
            (b"x", "an image is a NumPy array, not a bytes"),
            (numpy.uint8(3), "an image is a NumPy array, not a uint8"),
            (numpy.zeros((0, 3), "uint8"), "an array of shape (0, 3) has no pixels"),
            (numpy.zeros(3, "uint8"), "an image has the shape (height, width)"),
            (numpy.zeros((3, 3, 2), "uint8"), "an image has the shape (height, width)"),
            (numpy.zeros((3, 3)), "an image has pixels of uint8, uint16 or float32, not float64"),
            (numpy.zeros((3, 3), "int64"), "an image has pixels of uint8, uint16 or float32, not int64"),
            (numpy.zeros((3, 3), bool), "an image has pixels of uint8, uint16 or float32, not bool"),
        ):
            with self.subTest(text), self.assertRaises(hive.Error) as caught:
                _images.raw_header(thing)
            self.assertEqual(caught.exception.code, "invalid_argument")
            self.assertTrue(str(caught.exception).startswith(text), caught.exception)
            self.assertNotIn("\n", str(caught.exception))

    def test_pixels_of_16_bits_are_encoded_by_their_upper_eight_and_floats_refused(self):
        wide = self.colour.astype("uint16") << 8
        for image in (wide, numpy.dstack((self.colour, self.grey))):
            data = _images.encode("image/png", image, 80)
            self.assertTrue(numpy.array_equal(_images.decode("image/png", {}, memoryview(data)), self.colour))
            self.assertTrue(numpy.array_equal(_images.as_eight_bits(image), self.colour))
        with self.assertRaisesRegex(hive.Error, "let its sender scale"):
            _images.as_eight_bits(self.grey.astype("float32"))
        with self.assertRaises(hive.Error) as caught:
            _images.encode("image/jpeg", self.grey.astype("float32"), 80)
        self.assertEqual(caught.exception.code, "unsupported")

    def test_a_notebook_gets_a_png(self):
        for image in (self.colour, self.grey):
            shown = cv2.imdecode(numpy.frombuffer(_images.as_png(image), numpy.uint8), cv2.IMREAD_UNCHANGED)
            self.assertTrue(numpy.array_equal(shown, image))


if __name__ == "__main__":
    unittest.main()
