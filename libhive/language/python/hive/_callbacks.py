"""Between C and the callbacks of a drone: what they get, what they raise, and the parameters that both sides hold."""

from __future__ import annotations

import contextlib
import ctypes
import os
import weakref
from typing import Any, Callable, Optional

from . import _library
from ._errors import Error
from ._library import as_json, ask, ask_handle, code_of, encoded, lib, release
from .encoding import Encoding
from .event import Event
from .parameter import Parameter


def _own(trace: Any) -> Any:
    """A traceback from where it enters the code of the drone's author."""
    here = os.path.dirname(os.path.abspath(__file__))
    own = trace
    while own is not None and own.tb_frame.f_code.co_filename.startswith(here):
        own = own.tb_next
    return own or trace


def encode(known: dict[str, Encoding], handle: int, wanted: bytes, answer: int) -> None:
    """Answers with the event of a handle, which is lent, in the encoding that is wanted."""
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


class Callbacks:
    """A drone as C calls it."""

    def __init__(self) -> None:
        self._handle: Optional[ctypes.c_void_p] = None
        self._kept: list[Any] = []  # the callbacks that C knows
        self._parameters: dict[str, Parameter[Any]] = {}
        self._changed: Callable[[], Any] = lambda: None
        self._leave: Optional[BaseException] = None  # what a callback ends the program with

    def _call(self, function: Any, *arguments: Any) -> None:
        """Calls with a callback, which lives as long as the drone."""
        self._kept.extend(argument for argument in arguments if isinstance(argument, ctypes._CFuncPtr))
        function(self._handle, *arguments)

    def _guarded(self, function: Callable[..., Any]) -> Callable[..., int]:
        """Makes of what a function raises what C understands."""
        weak, kept = weakref.ref(self), self._kept

        def call(*arguments: Any) -> int:
            held = kept  # no callback of this drone goes while one runs, even if nobody knows the drone any more
            try:
                function(*arguments)
                return 0
            except Error as error:
                text = f"{error}; {error.advice}" if error.advice else str(error)
                return int(lib.hive_fail(code_of(error.code), encoded(text.replace("\0", "?"))))
            except Exception as error:
                import traceback  # here, for it takes longer to load than most of this package

                drone = weak()
                if drone is not None:
                    trace = traceback.format_exception(type(error), error, _own(error.__traceback__))
                    lines = "".join(trace).rstrip().replace("\0", "?")
                    lib.hive_drone_log_at(drone._handle, b"error", encoded(lines))
                text = "".join(traceback.format_exception_only(type(error), error)).strip()
                return int(lib.hive_fail(code_of("failed"), encoded(text.replace("\0", "?"))))
            except BaseException as leave:  # Ctrl-C or sys.exit() in a callback ends the drone, and then the program
                drone = weak()
                if drone is not None:
                    drone._leave = leave
                    with contextlib.suppress(Error):  # it may not have begun
                        lib.hive_drone_stop(drone._handle)
                return int(lib.hive_fail(code_of("stopped"), b"the drone was told to end"))

        return call

    @staticmethod
    def _deliver(function: Callable[..., Any], *handles: int) -> None:
        """Calls with the events of these handles, which are lent: each gets a reference of its own."""
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
        """Lets the function see the values that C holds, and C those that it leaves."""
        values = ask(lib.hive_drone_values, self._handle)
        for name, value in values.items():
            parameter = self._parameters[name]
            parameter.value = float(value) if isinstance(parameter.value, float) else value
        function()
        left = {name: parameter.value for name, parameter in self._parameters.items()}
        if left != values:
            lib.hive_drone_assign(self._handle, as_json(left))
