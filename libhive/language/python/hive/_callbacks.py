"""Connects C with the callbacks of a drone: arguments, exceptions, and the parameters of both sides."""

from __future__ import annotations

import contextlib
import ctypes
import weakref
from typing import Any, Callable, Optional

from . import _library
from ._errors import Error
from ._library import Owner, as_json, ask, ask_handle, code_of, encoded, lib, release
from .encoding import Encoding
from ._tracebacks import ends_in_package, without_package
from .event import Event
from .parameter import Parameter


_FUNCTION: Any = getattr(ctypes, "_CFuncPtr")  # what every callback of C is
_GENERATOR, _COROUTINE, _ASYNC_GENERATOR = 0x20, 0x80, 0x200  # of co_flags, as the module inspect has them


def require_plain(what: str, function: Any) -> None:
    """Refuses functions that cannot be callbacks: their body would never run."""
    if not callable(function):
        raise Error("invalid_argument", f"{what} decorates a function, not {function!r}")
    inner = getattr(function, "func", function)  # of functools.partial
    code = getattr(inner, "__code__", None) or getattr(getattr(type(inner), "__call__", None), "__code__", None)
    flags = code.co_flags if code else 0
    name = getattr(inner, "__qualname__", repr(inner)).rpartition(".")[2]
    if flags & (_COROUTINE | _ASYNC_GENERATOR):
        raise Error("invalid_argument", f"{what}: {name} is async, and callbacks of a drone are not awaited", "write def")
    if flags & _GENERATOR:
        raise Error("invalid_argument", f"{what}: {name} is a generator, which would not run", "write no yield in it")


def encode(known: dict[str, Encoding], handle: int, wanted: bytes, answer: int) -> None:
    """Returns the event of a lent handle in the requested encoding."""
    lib.hive_retain(handle)
    word, _, number = _library.text_of(wanted).partition(":")
    made = known[word].encode(Event(ctypes.c_void_p(handle)), int(number) if number else None)
    header, body = made if isinstance(made, tuple) else (None, made)
    text = None if header is None else as_json(dict(header))
    view = memoryview(body).cast("B")
    place = ask_handle(lib.hive_body_new, bytes(view), len(view))
    try:
        lib.hive_encoded_give(answer, text, len(text or b""), place)
    finally:
        release(place)


def _last_line(error: BaseException) -> str:
    import traceback

    return "".join(traceback.format_exception_only(type(error), error)).strip()


class Callbacks(Owner):
    """A drone as C calls it."""

    def __init__(self) -> None:
        self._handle = None
        self._called: list[Any] = []  # the callbacks that C knows
        self._parameters: dict[str, Parameter[Any]] = {}
        self._changed: Callable[[], Any] = lambda: None
        self._leave: Optional[BaseException] = None  # what a callback ends the program with

    def _call(self, function: Any, *arguments: Any) -> None:
        """Calls with a callback, which lives as long as the drone."""
        self._called.extend(argument for argument in arguments if isinstance(argument, _FUNCTION))
        function(self._handle, *arguments)

    def _guarded(self, function: Callable[..., Any]) -> Callable[..., int]:
        """Translates what a function raises into a code for C."""
        weak, kept = weakref.ref(self), self._called

        def call(*arguments: Any) -> int:
            held = kept  # no callback of this drone goes while one runs, even if nobody knows the drone any more
            try:
                function(*arguments)
                return 0
            except Error as error:
                drone = weak()
                wrong_call = error.code == "invalid_argument" and ends_in_package(error.__traceback__)
                if drone is not None and wrong_call:  # of which the text does not say where it is
                    drone._log_traceback(error)
                return int(lib.hive_fail(code_of(error.code), encoded(str(error).replace("\0", "?"))))
            except Exception as error:
                drone = weak()
                if drone is not None:
                    drone._log_traceback(error)
                return int(lib.hive_fail(code_of("failed"), encoded(_last_line(error).replace("\0", "?"))))
            except BaseException as leave:  # Ctrl-C or sys.exit() in a callback ends the drone, and then the program
                drone = weak()
                if drone is not None:
                    drone._leave = leave
                    with contextlib.suppress(Error):  # it may not have begun
                        lib.hive_drone_stop(drone._handle)
                return int(lib.hive_fail(code_of("stopped"), b"the drone was told to end"))

        return call

    def _log_traceback(self, error: BaseException) -> None:
        """Logs each of its lines."""
        import traceback  # here, for it takes longer to load than most of this package

        lines = traceback.format_exception(type(error), error, without_package(error.__traceback__))
        for line in "".join(lines).rstrip().split("\n"):
            lib.hive_drone_log_at(self._handle, b"error", encoded(line.replace("\0", "?")))

    @staticmethod
    def _deliver(function: Callable[..., Any], *handles: int) -> None:
        """Calls with the events of these lent handles: each gets a reference of its own."""
        events = []
        for handle in handles:
            lib.hive_retain(handle)
            events.append(Event(ctypes.c_void_p(handle)))
        try:
            function(*events)
        finally:
            for event in events:
                event._left()

    def _on_change(self, *_: Any) -> None:
        self._with_values(self._changed)

    def _with_values(self, function: Callable[[], Any]) -> None:
        """Passes the values of C to the function, and its changes to C."""
        values = ask(lib.hive_drone_values, self._handle)
        for name, value in values.items():
            parameter = self._parameters[name]
            parameter.value = float(value) if isinstance(parameter.value, float) else value
        function()
        left = {name: parameter.value for name, parameter in self._parameters.items()}
        if left != values:
            lib.hive_drone_assign(self._handle, as_json(left))
