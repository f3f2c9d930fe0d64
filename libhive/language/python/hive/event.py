"""Events as drones and applications get them."""

from __future__ import annotations

import ctypes
import json
from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Optional

from . import _images
from ._errors import Error
from ._library import ask, ask_flag, ask_handle, lib, release

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Hop(NamedTuple):
    """Time that an event spent at one drone."""

    drone: str
    wait_us: int  #: from arrival until its code began
    work_us: int  #: from then until it emitted


class Share(NamedTuple):
    """One job of shared work, which may have been dispatched more than once."""

    of: str  #: "camera.image#workers": output and group
    epoch: int
    turn: int  #: counts the events of the group, from 1
    attempt: int  #: counts how often this turn was given out
    part: int
    to: str  #: the input that got it


class _Memory:
    """A body or a loan, and where its bytes are: they live as long as this does."""

    __slots__ = ("handle", "address", "size")

    def __init__(self, handle: ctypes.c_void_p, where: Any) -> None:
        self.handle = handle
        address, size = ctypes.c_void_p(), ctypes.c_size_t()
        where(handle, ctypes.byref(address), ctypes.byref(size))
        self.address = address.value
        self.size = size.value

    def __del__(self) -> None:
        release(self.handle)

    def view(self) -> memoryview:
        """The bytes, without a copy; the view keeps the memory alive."""
        if not self.size or self.address is None:
            return memoryview(b"")
        array = (ctypes.c_ubyte * self.size).from_address(self.address)
        array._memory = self  # type: ignore[attr-defined]
        return memoryview(array).cast("B")


def _field(key: str, help: str, of: Callable[[Any], Any] = lambda value: value) -> Any:
    return property(lambda event: of(event._info[key]), doc=help)


def _seconds(us: int) -> float:
    return us / 1e6


class Event:
    """An event: a header, a body, and the time and source of its capture.

    While an event is *in use*, its sender holds back the next one.  It is in use until the callback returns, or until
    the next one is taken from a collector; :meth:`hold` makes that longer, :meth:`done` shorter.  Header, body and
    images stay valid as long as they are referenced; images keep memory of the sender, but not the event.
    """

    __slots__ = ("_handle", "_info_cache", "_header_cache", "_held", "__weakref__")

    def __init__(self, handle: ctypes.c_void_p) -> None:
        """Takes over a reference of the handle."""
        self._handle = handle
        self._info_cache: Optional[dict[str, Any]] = None
        self._header_cache: Optional[dict[str, Any]] = None
        self._held = False

    def __del__(self) -> None:
        release(self._handle)

    @property
    def _info(self) -> dict[str, Any]:
        if self._info_cache is None:
            self._info_cache = ask(lib.hive_event_info, self._handle)
        return self._info_cache

    @property
    def header(self) -> dict[str, Any]:
        """The sender's own header."""
        if self._header_cache is None:
            place, length = ctypes.c_void_p(), ctypes.c_size_t()
            lib.hive_event_header(self._handle, ctypes.byref(place), ctypes.byref(length))
            self._header_cache = json.loads(ctypes.string_at(place.value or 0, length.value))
        return self._header_cache

    @property
    def body(self) -> memoryview:
        """The bytes, read-only and without a copy; empty in a notification.

        If :attr:`foreign` is true, they are in memory of another process, which could still change them: copy them
        (``bytes(event.body)``) before you check and use them.
        """
        return _Memory(ask_handle(lib.hive_event_body, self._handle), lib.hive_body_bytes).view().toreadonly()

    @property
    def foreign(self) -> bool:
        """True if the body is in memory of another process."""
        body = ask_handle(lib.hive_event_body, self._handle)
        try:
            return ask_flag(lib.hive_body_foreign, body)
        finally:
            release(body)

    def image(self, bits: Optional[int] = None) -> NDArray[Any]:
        """The image in the body, as a NumPy array.

        ``image/raw`` gives a read-only view without a copy, of ``uint8``, ``uint16`` or ``float32``, and of shape
        (height, width) for grey, (height, width, 3) for colour in the order blue, green, red, and (height, width, 4)
        with alpha.  ``image/jpeg`` and ``image/png`` are copied, checked and decoded to ``uint8`` of (height, width,
        3); a truncated or damaged one is refused.

        :param bits: 8: for code that works on ``uint8`` of one or three channels: of 16 bits the upper eight, without
            alpha, and of ``float32`` "unsupported"; None: as it comes

        :raises hive.Error: "malformed" if header or bytes are invalid, "too_large" beyond 40 million pixels,
            "unsupported" if the body is of another type, or no decoder is installed
        """
        if bits not in (None, 8):
            raise Error("invalid_argument", f"image() converts to 8 bits, not to {bits!r}")
        image = _images.decode(self.type, self.header, self.body)
        return image if bits is None else _images.as_eight_bits(image)

    source: str = _field("source", "The drone that made the capture.")
    epoch: int = _field("epoch", "The run of the source: larger after each restart.")
    sequence: int = _field("sequence", "The number of the capture in that epoch, from 1.")
    captured: float = _field("captured_us", "The time of the capture, seconds since 1970; 0.0: unknown.", _seconds)
    age: float = _field(
        "age_us", "Seconds from the capture to the first read of this attribute; 0.0: unknown.", _seconds
    )
    lossless: bool = _field("lossless", "True if it is from a source on demand, so that no receiver skips it.")
    part: int = _field("part", "The number of the event among those emitted on one output for one input, from 0.")
    sender: str = _field("sender", "The drone that emitted it.")
    kind: str = _field("kind", 'The kind of the sender: "face".')
    output: str = _field("output", "The output of the sender.")
    input: str = _field("input", "The input where it arrived.")
    type: str = _field("type", 'The media type of the body: "image/jpeg".')
    size: Optional[int] = _field(
        "size",
        "Size of the body at the sender in bytes, also in a notification; None: no body was made.",
    )
    hops: list[Hop] = _field(
        "hops", "The drones that it passed, and the time that each took.", lambda hops: [Hop(**hop) for hop in hops]
    )
    shares: list[Share] = _field(
        "shares",
        "The shared work that it results from, outermost first.",
        lambda shares: [Share(**share) for share in shares],
    )

    def done(self) -> None:
        """Ends its use: its sender may send the next one."""
        self._held = False
        lib.hive_event_done(self._handle)

    def hold(self) -> Event:
        """Extends its use until :meth:`done`, or until it is no longer referenced."""
        self._held = True
        return self

    def _left(self) -> None:
        """Its user has moved on."""
        if not self._held:
            lib.hive_event_done(self._handle)

    def __repr__(self) -> str:
        size = self.size
        return (
            f"<hive.Event {self.sender}.{self.output} {self.sequence} {self.type}"
            f"{'' if size is None else f' {size} bytes'} {json.dumps(self.header)[:200]}>"
        )

    def _repr_png_(self) -> Optional[bytes]:
        """For notebooks; None: no image."""
        if self.type == "image/png":
            return bytes(self.body) or None
        try:
            return _images.as_png(self.image()) if self.type == "image/raw" else None
        except Error:
            return None  # the text is shown all the same

    def _repr_jpeg_(self) -> Optional[bytes]:
        """For notebooks; None: no image."""
        return bytes(self.body) or None if self.type == "image/jpeg" else None
