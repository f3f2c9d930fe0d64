"""Encodings: how an output sends events to receivers that request another form, or are on another machine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Mapping, NamedTuple, Optional, Union

from . import _images
from ._errors import Error

if TYPE_CHECKING:
    from .event import Event

Encoded = Union[bytes, bytearray, memoryview, "tuple[Mapping[str, Any], Union[bytes, bytearray, memoryview]]"]


class Encoding(NamedTuple):
    """One encoding of the events of an output; see :meth:`hive.Drone.output`."""

    word: str  #: what a connection asks for: "jpeg"
    type: str  #: the media type that comes of it: "image/jpeg"
    #: Turns an event into bytes, or into (header, bytes) where the header changes too: ``encode(event, number)``.
    encode: Callable[[Event, Optional[int]], Encoded]
    #: With ``most``: a whole number may stand behind the word, "jpeg:80"; ``encode`` gets it, or None.
    least: Optional[int] = None
    most: Optional[int] = None

    def _declared(self) -> dict[str, Any]:
        declared = {"word": self.word, "type": self.type, "least": self.least, "most": self.most}
        return {name: value for name, value in declared.items() if value is not None}


def images(*words: str) -> list[Encoding]:
    """The image encodings, for outputs whose events are emitted by ``emit_image``::

        drone.output("image", "image/raw,image/jpeg,image/png", encodings=hive.images())

    :param words: of "jpeg" (quality 80, or "jpeg:1" to "jpeg:100"), "png" and "raw", the preferred one first: it is
        used for other machines unless a connection requests another.  None: all, in this order.
    """
    known = {
        "jpeg": Encoding("jpeg", "image/jpeg", _as("image/jpeg"), 1, 100),
        "png": Encoding("png", "image/png", _as("image/png")),
        "raw": Encoding("raw", "image/raw", _as("image/raw")),
    }
    for word in words:
        if word not in known:
            raise Error("invalid_argument", f"there is no encoding {word!r} of images", "there are jpeg, png and raw")
    return [known[word] for word in words or known]


def _as(kind: str) -> Callable[[Event, Optional[int]], Encoded]:
    def encode(event: Event, number: Optional[int]) -> Encoded:
        image = event.image()
        header = {name: value for name, value in event.header.items() if name not in ("pixel_format", "stride")}
        if kind == "image/raw":
            return {**header, **_images.raw_header(image)}, image.tobytes()
        size = {"width": image.shape[1], "height": image.shape[0]}
        return {**header, **size}, _images.encode(kind, image, 80 if number is None else number)

    return encode
