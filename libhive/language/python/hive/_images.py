"""Converts images between event bodies and NumPy, and checks them first."""

from __future__ import annotations

import importlib
import io
import struct
import zlib
from typing import TYPE_CHECKING, Any, Optional

from . import _jpeg
from ._errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_PIXELS = 40_000_000
MOST_SCANS, MOST_PIXEL_SCANS = 100, 640_000_000  # of one JPEG: the cost of decoding a progressive one
_LONGEST_SIDE = 1 << 20
_LONGEST_ROW = 1 << 31
_CHANNELS = {"gray": 1, "bgr": 3, "bgra": 4}
_DEPTHS = {"8": "u1", "16": "<u2", "32f": "<f4"}
_FORMATS = {colour + depth: (colour, depth) for colour in _CHANNELS for depth in _DEPTHS}


def _malformed(text: str) -> Error:
    return Error("malformed", text)


def _module(name: str) -> Any:
    """An optional module; None if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def _numpy() -> Any:
    numpy = _module("numpy")
    if numpy is None:
        raise Error("unsupported", "images need NumPy", "install python3-numpy")
    return numpy


def _integer(header: dict[str, Any], field: str, least: int, most: int, fallback: Optional[int] = None) -> int:
    value = header.get(field, fallback)
    if type(value) is not int or not least <= value <= most:
        raise _malformed(f'image/raw: "{field}" is not a whole number from {least} to {most}')
    return value


def decode(kind: str, header: dict[str, Any], body: memoryview) -> NDArray[Any]:
    if kind == "image/raw":
        return raw_view(header, body)
    if kind in ("image/jpeg", "image/png"):
        return _decode_compressed(kind, bytes(body))  # a copy, which cannot change after the check
    raise Error("unsupported", f"{kind} is not an image type; use image/raw, image/jpeg or image/png")


def raw_view(header: dict[str, Any], body: memoryview) -> NDArray[Any]:
    """A view of the pixels in the body; the header has their layout (SPEC.md, section 12)."""
    colour, depth = _FORMATS.get(str(header.get("pixel_format")), (None, None))
    if colour is None or depth is None:
        known = ", ".join(_FORMATS)
        raise _malformed(f'image/raw: pixel_format is {header.get("pixel_format")!r}, not one of {known}')
    numpy = _numpy()
    channels, kind = _CHANNELS[colour], numpy.dtype(_DEPTHS[depth])
    pixel = channels * kind.itemsize
    width = _integer(header, "width", 1, _LONGEST_SIDE)
    height = _integer(header, "height", 1, _LONGEST_SIDE)
    stride = _integer(header, "stride", width * pixel, _LONGEST_ROW, width * pixel)
    if width * height > MOST_PIXELS:
        raise Error("too_large", f"image/raw: {width}x{height} pixels are too many")
    if stride * height != len(body):
        raise _malformed(f"image/raw: the header asks for {stride * height} bytes, the body has {len(body)}")
    shape = (height, width) if channels == 1 else (height, width, channels)
    strides = (stride, pixel) if channels == 1 else (stride, pixel, kind.itemsize)
    pixels = numpy.frombuffer(body, "u1")  # its base is `body`, so it cannot be made writable
    view: NDArray[Any] = numpy.ndarray(shape, kind, pixels, 0, strides)
    return view


def _require_array(image: Any) -> None:
    if image is None:
        raise Error("invalid_argument", "None is not an image", "check whether reading or capturing it failed")
    if not isinstance(image, _numpy().ndarray):
        kind = type(image).__name__
        raise Error("invalid_argument", f"an image is a NumPy array, not a {kind}", "convert it: numpy.asarray()")
    if 0 in image.shape:
        raise Error("invalid_argument", f"an array of shape {image.shape} has no pixels")


def raw_header(image: NDArray[Any]) -> dict[str, Any]:
    """The header fields of image/raw for an image without gaps between rows."""
    _require_array(image)
    channels = image.shape[2] if image.ndim == 3 else 1
    colour = {1: "gray", 3: "bgr", 4: "bgra"}.get(channels)
    if image.ndim not in (2, 3) or colour is None:
        text = f"an image has the shape (height, width) or (height, width, 1, 3 or 4), not {image.shape}"
        raise Error("invalid_argument", text)
    depth = {"u1": "8", "u2": "16", "f4": "32f"}.get(f"{image.dtype.kind}{image.dtype.itemsize}")
    if depth is None:
        text = f"an image has pixels of uint8, uint16 or float32, not {image.dtype}"
        raise Error("invalid_argument", text, _conversion(image.dtype.kind))
    height, width = image.shape[:2]
    stride = width * channels * image.dtype.itemsize
    return {"width": width, "height": height, "pixel_format": colour + depth, "stride": stride}


def _conversion(kind: str) -> str:
    """A hint for converting an array of another type to an image."""
    return {"b": "write image.astype('uint8') * 255", "f": "write image.astype('float32')"}.get(
        kind, "write image.clip(0, 255).astype('uint8')"
    )


def _png_size(data: bytes) -> Optional[tuple[int, int]]:
    """From the first chunk; None unless every chunk is complete and has a valid checksum."""
    if len(data) < 33 or not data.startswith(b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"):
        return None
    at, name = 8, b""
    while name != b"IEND":
        if at + 12 > len(data):
            return None
        length, name = struct.unpack(">I4s", data[at : at + 8])
        end = at + 8 + length
        if data[end : end + 4] != struct.pack(">I", zlib.crc32(data[at + 4 : end])):
            return None
        at = end + 4
    width, height = struct.unpack(">II", data[16:24])
    return width, height


def _jpeg_size(data: bytes) -> Optional[tuple[int, int]]:
    """From the frame header, which is found marker by marker; None if the file is truncated."""
    if not data.startswith(b"\xff\xd8") or b"\xff\xd9" not in data[-1024:]:
        return None
    at = 2
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker = data[at + 1]
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            height, width = struct.unpack(">HH", data[at + 5 : at + 9])
            return width, height
        at += 1 if marker == 0xFF else 2 + struct.unpack(">H", data[at + 2 : at + 4])[0]
    return None


def _decode_compressed(kind: str, data: bytes) -> NDArray[Any]:
    size = _png_size(data) if kind == "image/png" else _jpeg_size(data)
    if size is None or 0 in size:
        raise _malformed(f"{kind}: {len(data)} bytes that are not a complete image of this type")
    if size[0] * size[1] > MOST_PIXELS:
        raise Error("too_large", f"{kind}: {size[0]}x{size[1]} pixels are too many")
    if kind == "image/png":
        return _decode_by_opencv(kind, data)
    scans = data.count(b"\xff\xda")  # besides scans, only a thumbnail has these bytes
    if scans > MOST_SCANS or size[0] * size[1] * scans > MOST_PIXEL_SCANS:
        raise Error("too_large", f"{kind}: {scans} scans of {size[0]}x{size[1]} pixels are too many")
    pixels = _jpeg.decode(data)
    if pixels is None and _module("PIL.Image"):  # it detects missing data; OpenCV does not
        return _decode_by_pillow(kind, data, _numpy())
    # The strict decoder ignores the orientation of EXIF; OpenCV applies it.
    return _decode_by_opencv(kind, data) if pixels is None or b"Exif\0\0" in data[:65536] else pixels


def _decode_by_opencv(kind: str, data: bytes) -> NDArray[Any]:
    numpy, cv2 = _numpy(), _module("cv2")
    if cv2 is None:
        return _decode_by_pillow(kind, data, numpy)
    try:
        image: Optional[NDArray[Any]] = cv2.imdecode(numpy.frombuffer(data, numpy.uint8), cv2.IMREAD_COLOR)
    except cv2.error as error:
        raise _malformed(f"{kind}: {error}") from None
    if image is None:
        raise _malformed(f"{kind}: damaged image")
    return image


def _decode_by_pillow(kind: str, data: bytes, numpy: Any) -> NDArray[Any]:
    pillow, operations = _module("PIL.Image"), _module("PIL.ImageOps")
    if pillow is None:
        raise Error("unsupported", f"{kind} needs OpenCV or Pillow", "install python3-opencv or python3-pil")
    try:
        with pillow.open(io.BytesIO(data), formats=("JPEG", "PNG")) as image:
            upright = operations.exif_transpose(image).convert("RGB")
        pixels: NDArray[Any] = numpy.ascontiguousarray(numpy.asarray(upright)[:, :, ::-1])
        return pixels
    except Exception as error:  # Pillow raises many types for damaged data
        raise _malformed(f"{kind}: {error}") from None


def encode(kind: str, image: NDArray[Any], quality: int) -> bytes:
    """Encodes an image as image/jpeg or image/png, with OpenCV or else Pillow."""
    if image.dtype.kind == "f":
        raise Error("unsupported", f"{kind} does not support float32", 'connect with encoding="raw"')
    image, cv2 = as_eight_bits(image), _module("cv2")
    if cv2 is None:
        return _encode_by_pillow(kind, image, quality)
    if kind == "image/png":
        return bytes(cv2.imencode(".png", image)[1].tobytes())
    return bytes(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes())


def as_eight_bits(image: NDArray[Any]) -> NDArray[Any]:
    """Drops alpha, and the lower eight of 16 bits."""
    if image.dtype.kind == "f":
        text = "this drone accepts only 8 bit images, not float32"
        raise Error("unsupported", text, "let its sender scale the values to 0 to 255 and emit them as uint8")
    if image.dtype.itemsize == 2:
        image = (image >> 8).astype("uint8")
    return image[:, :, :3].copy() if image.ndim == 3 and image.shape[2] == 4 else image


def _encode_by_pillow(kind: str, image: NDArray[Any], quality: int) -> bytes:
    pillow = _module("PIL.Image")
    if pillow is None and kind == "image/png":
        return as_png(image)
    if pillow is None:
        raise Error("unsupported", f"{kind} needs OpenCV or Pillow", "install python3-opencv or python3-pil")
    file = io.BytesIO()
    rows = image if image.ndim == 2 else image[:, :, ::-1]
    pillow.fromarray(rows).save(file, kind[6:].upper(), quality=quality)
    return file.getvalue()


def as_png(image: NDArray[Any]) -> bytes:
    """Encodes an image as PNG, for notebooks."""
    image = as_eight_bits(image)
    height, width = image.shape[:2]
    colour = image.ndim == 3
    rows = image[:, :, ::-1] if colour else image
    lines = b"".join(b"\0" + rows[y].tobytes() for y in range(height))

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2 if colour else 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines, 1)) + chunk(b"IEND", b"")
