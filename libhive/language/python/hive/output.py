"""Outputs: emit events, and lend memory for images."""

from __future__ import annotations

import ctypes
import operator
import sys
import time
from typing import TYPE_CHECKING, Any, Callable, Mapping, NoReturn, Optional, Sequence, Union

from . import _images
from ._errors import Error
from ._library import Owner, as_json, ask_flag, ask_handle, body_callback, code_of, encoded, lib, release
from .event import Event, _Memory

if TYPE_CHECKING:
    from numpy.typing import NDArray

Bytes = Union[bytes, bytearray, memoryview]


def _header(header: Any, fields: Mapping[str, Any] = {}) -> bytes:
    if header is not None and not hasattr(header, "keys"):
        raise Error("invalid_argument", f"a header is a dict, not {header!r}"[:200])
    return as_json({**(header or {}), **fields})


def view_of(body: Any) -> memoryview:
    try:
        view = memoryview(body)
        return view.cast("B") if view.nbytes else memoryview(b"")
    except TypeError:
        raise Error(
            "invalid_argument", f"a body is bytes, not a {type(body).__name__}", "emit_image() takes arrays of pixels"
        ) from None


def _sides(shape: Any) -> tuple[int, ...]:
    try:
        sides = tuple(operator.index(side) for side in (shape if hasattr(shape, "__iter__") else (shape,)))
    except TypeError:
        sides = (-1,)
    if any(side < 0 for side in sides):
        raise Error("invalid_argument", f"a shape is one whole number from 0 on, or several, not {shape!r}")
    return sides


class _Maker:
    """Makes bodies when the library asks for them; what that raises is for the caller of the library."""

    def __init__(self) -> None:
        self._make: Callable[[], _Memory] = lambda: NotImplemented
        self._problem: Optional[BaseException] = None
        self._callback = body_callback(self._called)

    def _called(self, _: Any, place: Any) -> int:
        try:
            memory = self._make()
            place[0] = ask_handle(lib.hive_loan_body, memory.handle, memory.size).value
            return 0
        except BaseException as problem:
            self._problem = problem
            return code_of("failed")

    def __call__(self, make: Callable[[], _Memory], emit: Any, *arguments: Any) -> None:
        """Calls a function of the library with what makes the body."""
        before, self._make = self._make, make
        try:
            emit(*arguments[:-1], self._callback, None, arguments[-1])
        except Error:
            problem, self._problem = self._problem, None
            if problem is None:
                raise
            raise problem from None
        finally:
            self._make = before


class Output(Owner):
    """One of a drone's outputs.  For the thread that runs the drone, except :meth:`loan`."""

    def __init__(self, handle: ctypes.c_void_p, name: str) -> None:
        self._handle = handle
        self._made = _Maker()
        self.name = name

    def __del__(self) -> None:
        release(self._kept)

    @property
    def wanted(self) -> bool:
        """True if any receiver takes bodies.  If not, you need not make one."""
        return ask_flag(lib.hive_output_wanted, self._handle)

    @property
    def received(self) -> bool:
        """True if it has receivers, even of headers."""
        return ask_flag(lib.hive_output_received, self._handle)

    @property
    def asked(self) -> bool:
        """For sources on demand: True if there are receivers, and all have requested another event."""
        return ask_flag(lib.hive_output_asked, self._handle)

    def emit(
        self,
        header: Optional[Mapping[str, Any]] = None,
        body: Union[Bytes, Callable[[], Bytes]] = b"",
        type: Optional[str] = None,
    ) -> None:
        """Sends an event to the receivers; never waits for one.

        Inside a callback it inherits identity and time of the input, elsewhere it starts a new identity.

        :param header: anything that JSON can hold, at most about 60 KiB
        :param body: copied; a function that makes one is called only if it is needed: it is :attr:`wanted`, or it is
            from a source on demand and waits for the first receiver
        :param type: media type of the body; None: the first that the output was declared with
        :raises hive.Error: "too_large", "invalid_argument"
        """
        text = _header(header)
        if callable(body):
            make = body
            self._made(
                lambda: self._filled(make()), lib.hive_output_emit_made, self._handle, text, len(text), encoded(type)
            )
            return
        if not len(view_of(body)):
            lib.hive_output_emit(self._handle, text, len(text), None, 0, encoded(type))
            return
        memory = self._filled(body)
        self._emit_memory(text, memory, memory.size, type)

    def loan(self, shape: Union[int, Sequence[int]], dtype: Any = "uint8") -> NDArray[Any]:
        """An array to fill and :meth:`emit_image`: receivers on this machine read its memory, so nothing is copied.

        Never waits.  Its content is undefined; do not write to it after it was emitted.  From any thread.

        :raises hive.Error: "too_large" beyond the 64 MiB that an event holds, "invalid_argument" for what is not a
            shape
        """
        numpy = _images._numpy()
        kind = numpy.dtype(dtype)
        sides = _sides(shape)
        size = kind.itemsize
        for side in sides:
            size *= side
        view = self._loan(min(size, sys.maxsize)).view()
        array: NDArray[Any] = numpy.frombuffer(view, kind).reshape(sides)
        return array

    def emit_image(self, image: NDArray[Any], header: Optional[Mapping[str, Any]] = None, **fields: Any) -> None:
        """Sends an image as ``image/raw``, with ``fields`` in its header.

        :param image: ``uint8``, ``uint16`` or ``float32``, of shape (height, width) or (height, width, 1) for grey,
            (height, width, 3) for colour in the order blue, green, red, or (height, width, 4) with alpha.  Most drones
            work on ``uint8``.  It is copied once if it has receivers; an array of :meth:`loan` is not copied.
        """
        text = _header(header, {**fields, **_images.raw_header(image)})
        self._made(
            lambda: self._image(image), lib.hive_output_emit_made, self._handle, text, len(text), b"image/raw"
        )

    def emit_captured(
        self,
        header: Optional[Mapping[str, Any]] = None,
        body: Union[Bytes, Callable[[], Bytes]] = b"",
        type: Optional[str] = None,
        *,
        captured: Optional[float] = None,
        lossless: bool = False,
    ) -> None:
        """Starts a new identity, captured at that time (seconds since 1970; None: now).

        :param lossless: of a source on demand: no receiver skips it
        """
        text = _header(header)
        when = (_microseconds(captured), lossless, text, len(text))
        if not callable(body) and not len(view_of(body)):
            lib.hive_output_emit_captured(self._handle, *when, None, encoded(type))
            return
        self._made(
            lambda: self._filled(body() if callable(body) else body),
            lib.hive_output_emit_captured_made,
            self._handle,
            *when,
            encoded(type),
        )

    def emit_captured_image(
        self,
        image: NDArray[Any],
        header: Optional[Mapping[str, Any]] = None,
        *,
        captured: Optional[float] = None,
        lossless: bool = False,
    ) -> None:
        """An image as in :meth:`emit_image`, with an identity as in :meth:`emit_captured`: for cameras."""
        text = _header(header, _images.raw_header(image))
        self._made(
            lambda: self._image(image),
            lib.hive_output_emit_captured_made,
            self._handle,
            _microseconds(captured),
            lossless,
            text,
            len(text),
            b"image/raw",
        )

    def fail(
        self, text: str, code: str = "io", *, captured: Optional[float] = None, lossless: bool = False
    ) -> NoReturn:
        """For main: reports a capture without an event, such as a damaged file; it uses up its number.  Raises
        :class:`hive.Error`; let main pass it on."""
        lib.hive_output_fail(self._handle, _microseconds(captured), lossless, code_of(code), encoded(text))
        raise AssertionError("hive_output_fail always fails")

    def repeat(self, event: Event) -> None:
        """Sends an event again, unchanged and with its identity."""
        lib.hive_output_repeat(self._handle, event._handle)

    def end(self, text: str = "") -> None:
        """Ends the source: nothing more will come, unless something is emitted after all.  Drones pass it on, so that
        collectors know that they have everything.

        :param text: what is missing: "87 of 196 frames: the file is damaged"; "": nothing
        """
        lib.hive_output_end(self._handle, encoded(text))

    def begin_source(self) -> None:
        """Starts another source: captures are numbered from 1.  After an end this is implied; called anyway, it revokes
        the end at once, before the first event."""
        lib.hive_output_begin_source(self._handle)

    def _loan(self, size: int) -> _Memory:
        return _Memory(ask_handle(lib.hive_output_loan, self._handle, size), lib.hive_loan_bytes)

    def _filled(self, body: Bytes) -> _Memory:
        """The bytes in a loan."""
        view = view_of(body)
        memory = self._loan(len(view))
        if len(view):
            memory.view()[:] = view
        return memory

    def _image(self, image: NDArray[Any]) -> _Memory:
        """The pixels in a loan: the one that they lie in, or a new one."""
        memory = _loan_of(image)
        if memory is not None:
            image.flags.writeable = False
            return memory
        memory = self._loan(image.nbytes)
        numpy = _images._numpy()
        kind = image.dtype.newbyteorder("<")
        numpy.copyto(numpy.frombuffer(memory.view(), kind).reshape(image.shape), image)
        return memory

    def _emit_memory(self, header: bytes, memory: _Memory, size: int, type: Optional[str]) -> None:
        body = ask_handle(lib.hive_loan_body, memory.handle, size)
        try:
            lib.hive_output_emit_body(self._handle, header, len(header), body, encoded(type))
        finally:
            release(body)


def _loan_of(image: NDArray[Any]) -> Optional[_Memory]:
    """The loan that an array is the whole of, if it is one."""
    base: Any = image
    while base is not None and not isinstance(base, memoryview):
        base = getattr(base, "base", None)
    memory = getattr(base.obj, "_memory", None) if base is not None else None
    if base is None or memory is None or image.nbytes != memory.size:
        return None
    whole = image.flags.c_contiguous and image.__array_interface__["data"][0] == memory.address
    native = image.dtype.isnative and sys.byteorder == "little"
    return memory if whole and native and not base.readonly and image.flags.writeable else None


def _microseconds(seconds: Optional[float]) -> int:
    return int((time.time() if seconds is None else seconds) * 1e6)
