"""Pictures between the bodies of events and NumPy: what comes in is checked before it is used."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any, Optional

from ._errors import Error

if TYPE_CHECKING:
    import numpy

MOST_PIXELS = 40_000_000
MOST_SCANS, MOST_PIXEL_SCANS = 100, 640_000_000  # of one JPEG: what decoding a progressive one costs
_LONGEST_SIDE = 1 << 20
_LONGEST_ROW = 1 << 31
_CHANNELS = {"bgr8": 3, "gray8": 1}


def _malformed(text: str) -> Error:
    return Error("malformed", text)


def _numpy() -> Any:
    try:
        import numpy
    except ImportError:
        raise Error("unsupported", "pictures need NumPy", "install python3-numpy") from None
    return numpy


def _integer(header: dict[str, Any], field: str, least: int, most: int, fallback: Optional[int] = None) -> int:
    value = header.get(field, fallback)
    if type(value) is not int or not least <= value <= most:
        raise _malformed(f'image/raw: "{field}" is not a whole number from {least} to {most}')
    return value


def decode(kind: str, header: dict[str, Any], body: memoryview) -> numpy.ndarray:
    if kind == "image/raw":
        return raw_view(header, body)
    if kind in ("image/jpeg", "image/png"):
        return _decode_compressed(kind, bytes(body))  # a copy: nobody can change what was checked
    raise Error("unsupported", f"{kind} is no picture; there are image/raw, image/jpeg and image/png")


def raw_view(header: dict[str, Any], body: memoryview) -> numpy.ndarray:
    """Pixels as they lie in the body, which the header describes (SPEC.md, section 12)."""
    channels = _CHANNELS.get(str(header.get("pixel_format")))
    if channels is None:
        raise _malformed(f'image/raw: pixel_format is {header.get("pixel_format")!r}, neither bgr8 nor gray8')
    width = _integer(header, "width", 1, _LONGEST_SIDE)
    height = _integer(header, "height", 1, _LONGEST_SIDE)
    stride = _integer(header, "stride", width * channels, _LONGEST_ROW, width * channels)
    if width * height > MOST_PIXELS:
        raise Error("too_large", f"image/raw: {width}x{height} pixels are too many")
    if stride * height != len(body):
        raise _malformed(f"image/raw: the header asks for {stride * height} bytes, the body has {len(body)}")
    numpy = _numpy()
    shape = (height, width) if channels == 1 else (height, width, channels)
    strides = (stride, 1) if channels == 1 else (stride, channels, 1)
    return numpy.ndarray(shape, numpy.uint8, body, 0, strides)


def raw_header(picture: numpy.ndarray) -> dict[str, Any]:
    """What image/raw says of a picture whose rows lie without gaps."""
    if picture.dtype != "uint8" or picture.ndim not in (2, 3) or 0 in picture.shape:
        raise Error("invalid_argument", f"a picture is an array of uint8, not {picture.dtype} of shape {picture.shape}")
    channels = 1 if picture.ndim == 2 else picture.shape[2]
    if channels not in (1, 3):
        raise Error("invalid_argument", f"a picture has 1 or 3 channels, not {channels}")
    height, width = picture.shape[:2]
    pixel_format = "gray8" if channels == 1 else "bgr8"
    return {"width": width, "height": height, "pixel_format": pixel_format, "stride": width * channels}


def _png_size(data: bytes) -> Optional[tuple[int, int]]:
    if len(data) < 33 or not data.startswith(b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR") or b"IEND" not in data[-12:]:
        return None
    return struct.unpack(">II", data[16:24])


def _jpeg_size(data: bytes) -> Optional[tuple[int, int]]:
    """Of the frame header, on the way from one marker to the next; None when it is cut short."""
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


def _decode_compressed(kind: str, data: bytes) -> numpy.ndarray:
    numpy = _numpy()
    size = _png_size(data) if kind == "image/png" else _jpeg_size(data)
    if size is None or 0 in size:
        raise _malformed(f"{kind}: {len(data)} bytes that are no such picture, or one that is cut short")
    if size[0] * size[1] > MOST_PIXELS:
        raise Error("too_large", f"{kind}: {size[0]}x{size[1]} pixels are too many")
    scans = data.count(b"\xff\xda") if kind == "image/jpeg" else 0  # these bytes are nowhere else but in a thumbnail
    if scans > MOST_SCANS or size[0] * size[1] * scans > MOST_PIXEL_SCANS:
        raise Error("too_large", f"{kind}: {scans} scans of {size[0]}x{size[1]} pixels are too many")
    try:
        import cv2
    except ImportError:
        return _decode_by_pillow(kind, data, numpy)
    try:
        picture = cv2.imdecode(numpy.frombuffer(data, numpy.uint8), cv2.IMREAD_COLOR)
    except cv2.error as error:
        raise _malformed(f"{kind}: {error}") from None
    if picture is None:
        raise _malformed(f"{kind}: the picture is damaged")
    return picture


def _decode_by_pillow(kind: str, data: bytes, numpy: Any) -> numpy.ndarray:
    import io

    try:
        from PIL import Image, ImageOps
    except ImportError:
        raise Error("unsupported", f"{kind} needs OpenCV or Pillow", "install python3-opencv or python3-pil") from None
    try:
        with Image.open(io.BytesIO(data), formats=("JPEG", "PNG")) as picture:
            upright = ImageOps.exif_transpose(picture).convert("RGB")
        return numpy.ascontiguousarray(numpy.asarray(upright)[:, :, ::-1])
    except Exception as error:  # whatever it thinks of the bytes
        raise _malformed(f"{kind}: {error}") from None


def encode(kind: str, picture: numpy.ndarray, quality: int) -> bytes:
    """A grey or BGR picture as image/jpeg or image/png, by OpenCV or, where that is missing, Pillow."""
    try:
        import cv2
    except ImportError:
        return _encode_by_pillow(kind, picture, quality)
    if kind == "image/png":
        return cv2.imencode(".png", picture)[1].tobytes()
    return cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()


def _encode_by_pillow(kind: str, picture: numpy.ndarray, quality: int) -> bytes:
    import io

    try:
        from PIL import Image
    except ImportError:
        if kind == "image/png":
            return as_png(picture)
        raise Error("unsupported", f"{kind} needs OpenCV or Pillow", "install python3-opencv or python3-pil") from None
    file = io.BytesIO()
    Image.fromarray(picture if picture.ndim == 2 else picture[:, :, ::-1]).save(file, kind[6:].upper(), quality=quality)
    return file.getvalue()


def as_png(picture: numpy.ndarray) -> bytes:
    """A PNG of a grey or BGR picture, for notebooks."""
    height, width = picture.shape[:2]
    colour = picture.ndim == 3
    rows = picture[:, :, ::-1] if colour else picture
    lines = b"".join(b"\0" + rows[y].tobytes() for y in range(height))

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2 if colour else 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines, 1)) + chunk(b"IEND", b"")
