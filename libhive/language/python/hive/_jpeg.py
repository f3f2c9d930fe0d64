"""Decodes JPEG as strictly as drones in C++: libturbojpeg, with warnings as errors."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Optional

from ._errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SONAME = "libturbojpeg.so.0"
_BGR, _INKS = 1, 11
_STOP_ON_WARNING = 8192  # missing or extra data, for which pixels would be invented
_CMYK, _YCCK = 3, 4
_library: Any = None


def _loaded() -> Any:
    """The library; False if it is not installed."""
    global _library
    if _library is None:
        try:
            _library = ctypes.CDLL(_SONAME)
            _declare(_library)
        except (OSError, AttributeError):
            _library = False
    return _library


def _declare(library: Any) -> None:
    integer = ctypes.POINTER(ctypes.c_int)
    library.tjInitDecompress.restype = ctypes.c_void_p
    library.tjDestroy.argtypes = [ctypes.c_void_p]
    library.tjGetErrorStr2.argtypes = [ctypes.c_void_p]
    library.tjGetErrorStr2.restype = ctypes.c_char_p
    source = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_ulong]
    library.tjDecompressHeader3.argtypes = [*source, integer, integer, integer, integer]
    library.tjDecompress2.argtypes = [*source, ctypes.c_void_p, *[ctypes.c_int] * 5]


def decode(data: bytes) -> Optional[NDArray[Any]]:
    """The stored pixels (blue, green, red), without EXIF orientation; None if the library is not installed.

    :raises hive.Error: "malformed" for truncated or damaged data
    """
    library = _loaded()
    if not library:
        return None
    decoder = library.tjInitDecompress()
    if not decoder:
        raise Error("failed", "the JPEG decoder could not be created")
    try:
        return _pixels(library, decoder, data)
    finally:
        library.tjDestroy(decoder)


def _pixels(library: Any, decoder: int, data: bytes) -> NDArray[Any]:
    import numpy

    def require(result: int) -> None:
        if result != 0:
            text = (library.tjGetErrorStr2(decoder) or b"").decode(errors="replace")
            raise Error("malformed", f"image/jpeg: {text}")

    width, height, subsampling, colours = (ctypes.c_int() for _ in range(4))
    places = (ctypes.byref(value) for value in (width, height, subsampling, colours))
    require(library.tjDecompressHeader3(decoder, data, len(data), *places))
    printed = colours.value in (_CMYK, _YCCK)
    pixels = numpy.empty((height.value, width.value, 4 if printed else 3), numpy.uint8)
    size = (width.value, pixels.strides[0], height.value)
    kind = _INKS if printed else _BGR
    require(library.tjDecompress2(decoder, data, len(data), pixels.ctypes.data, *size, kind, _STOP_ON_WARNING))
    return _in_colour(pixels) if printed else pixels


def _in_colour(inks: NDArray[Any]) -> NDArray[Any]:
    """Converts CMYK to BGR as OpenCV does: the values are assumed inverted, as all programs write them."""
    black, colours = inks[:, :, 3:].astype("uint16"), inks[:, :, 2::-1].astype("uint16")
    light: NDArray[Any] = (black - ((255 - colours) * black >> 8)).astype("uint8")
    return light
