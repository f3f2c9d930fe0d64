"""Drones: processes with a clear interface."""

from __future__ import annotations

import ctypes
import faulthandler
import json
import os
import sys
from typing import Any, Callable, Iterable, Optional, Sequence, TypeVar

from . import _library
from ._callbacks import Callbacks, encode, require_plain
from ._errors import Error, require_list, require_text
from ._library import as_json, ask_flag, ask_handle, ask_object, ask_text, code_of, encoded, lib, release
from .encoding import Encoding
from .event import Event
from .output import Output
from .parameter import Matching, Parameter, Seconds, Value, match_of, type_of

Callback = TypeVar("Callback", bound=Callable[..., Any])
_STEP_MS = 100  # how soon Ctrl-C is seen by a drone inside of a program


def _types(port: str, value: Any) -> str:
    """One text of media types."""
    if not isinstance(value, str):
        raise Error("invalid_argument", f"the type of {port} is a text, not {value!r}", 'write "image/raw,image/jpeg"')
    return value


def _port(each: Any) -> dict[str, str]:
    """What on_matched() gets of one input."""
    if isinstance(each, str) or not 2 <= len(each) <= 3:
        raise Error("invalid_argument", f"an input to match is (name, type) or (name, type, help), not {each!r}")
    name, kind, *text = each
    named = require_text("the name of an input", name)
    return {"name": named, "type": _types(named, kind), "help": require_text("help", text[0] if text else "")}


def _trace_crashes() -> None:
    """In a crash the log has the stack of Python as well."""
    if not faulthandler.is_enabled():
        faulthandler.enable(lib.hive_stack_descriptor())


def _first_line(function: Any) -> str:
    """Of its docstring: what an input is good for, when nothing else says so."""
    return (function.__doc__ or "").strip().split("\n")[0].rstrip(".")


class Drone(Callbacks):
    """A process with a clear interface: declare, then :meth:`run`.

    Callbacks come on the thread that runs the drone, one at a time.  What they raise becomes an exception of the drone:
    the input is left out, or the drone halts (``--on-exception``); the traceback is in the log, its last line in the
    text.

    :param kind: which program it is: "edges"
    :param summary: what it does, in one sentence
    :param stateful: does it remember events, so that its work cannot be shared?
    :param arguments: a command line (without the program) instead of that of the process
    :param embedded: a drone inside of a program that is more than a drone, as a notebook or a test: it reads no command
        line and takes neither signals nor the end of the process, and its log goes to ``logging``, as "hive.NAME".
        Then there are ``name`` (default: the kind), ``parameters`` to begin with, ``connect`` (what it receives, as
        --connect of a program has it: ["image=camera.image,window=2"]), ``on_exception`` ("skip" or "halt"),
        ``halted`` (from the start), ``listen`` and ``advertise`` (lists of addresses), ``key`` (the swarm's key file),
        ``insecure``, ``no_announce`` and ``remote_operator``.
    :raises SystemExit: after --help or a wrong command line
    :raises hive.Error: "invalid_argument"
    """

    def __init__(
        self,
        kind: str,
        summary: str = "",
        *,
        stateful: bool = False,
        arguments: Optional[Sequence[str]] = None,
        embedded: bool = False,
        **options: Any,
    ) -> None:
        super().__init__()
        self.kind = kind
        self._program = not embedded
        for option in ("connect", "listen", "advertise"):
            require_list(option, options.get(option, ()), f'["{options.get(option)}"]')
        if embedded:
            self._open(kind, summary, {"stateful": stateful, **options})
        elif options:
            raise Error("invalid_argument", f"only an embedded drone has {', '.join(options)}")
        else:
            self._open_program(kind, summary, stateful, sys.argv[1:] if arguments is None else arguments)
        self._call(lib.hive_drone_on_change, _library.callback(self._guarded(self._on_change)), None)
        self.on_start(lambda: None)
        _library.ends_at_exit(self)

    def _open(self, kind: str, summary: str, options: dict[str, Any]) -> None:
        import logging

        self._handle = ask_handle(lib.hive_drone_new, encoded(kind), encoded(summary), as_json(options))
        logger = logging.getLogger("hive." + self.name)

        def write(_: Any, level: bytes, line: bytes) -> None:
            logger.log(getattr(logging, level.decode().upper()), "%s", _library.text_of(line))

        self._call(lib.hive_drone_on_leveled_log, _library.leveled_log_callback(write), None)

    def _open_program(self, kind: str, summary: str, stateful: bool, arguments: Sequence[str]) -> None:
        words = [os.fsencode(word) for word in ["hive-" + kind, *arguments]]
        argv = (ctypes.c_char_p * len(words))(*words)
        place, code = ctypes.c_void_p(), ctypes.c_int()
        sys.stdout.flush()
        lib.hive_drone_from_arguments(
            encoded(kind),
            encoded(summary),
            as_json({"stateful": stateful}),
            len(words),
            argv,
            ctypes.byref(place),
            ctypes.byref(code),
        )
        if not place.value and code.value and hasattr(sys, "ps1"):  # of an interpreter that somebody types into
            text = "the command line of this interpreter is not that of a drone"
            raise Error("invalid_argument", text, "in a notebook or a session: hive.Drone(..., embedded=True)")
        if not place.value:
            raise SystemExit(code.value)
        self._handle = place

    def __del__(self) -> None:
        self._at_exit()

    def _at_exit(self) -> None:
        handle, self._handle = self._kept, None
        release(handle)

    # --- declarations ---

    @property
    def name(self) -> str:
        """In the swarm."""
        return ask_text(lib.hive_drone_name, self._handle) or ""

    def parameter(
        self,
        name: str,
        default: Value,
        *,
        least: Optional[float] = None,
        most: Optional[float] = None,
        choices: Optional[Iterable[str]] = None,
        unit: str = "",
        operator: bool = False,
        help: str = "",
    ) -> Parameter[Value]:
        """Declares a parameter of the type of its default: int, float, bool or str.

        :param least: inclusive, as is ``most``
        :param choices: what a str may be
        :param unit: shown beside the value: "px", "fps", "%"
        :param operator: it concerns the drone's machine, as a path or a login: over the network it can be set only if
            the drone was started with --remote-operator
        """
        require_list("choices", () if choices is None else choices, '["fast", "slow"]')
        declared: dict[str, Any] = {"name": require_text("the name of a parameter", name), "type": type_of(default), "default": default, "help": help}
        declared.update(least=least, most=most, unit=unit, operator=operator)
        declared.update(choices=None if choices is None else list(choices))
        lib.hive_drone_parameter(self._handle, as_json({k: v for k, v in declared.items() if v is not None}))
        parameter = Parameter(name, default)
        self._parameters[name] = parameter
        return parameter

    def given(self, parameter: str) -> Any:
        """The value that a parameter will begin with, by --set or by what the drone was told before a crash; None: its
        default.  For drones whose ports depend on it."""
        return self._begins_with(parameter)[0]

    def remembered(self, parameter: str) -> bool:
        """Is that what the drone was told before a crash?  Also when it is given the same value now, as by an engine
        that starts it again."""
        return self._begins_with(parameter)[1]

    def _begins_with(self, parameter: str) -> tuple[Any, bool]:
        remembered = ctypes.c_bool()
        place = ctypes.c_void_p()
        lib.hive_drone_given(self._handle, encoded(parameter), ctypes.byref(place), ctypes.byref(remembered))
        text = _library.take_text(place)
        return (None if text is None else json.loads(text)), remembered.value

    def output(self, name: str, type: str, help: str = "", encodings: Sequence[Encoding] = ()) -> Output:
        """Declares an output.

        :param type: one media type or several: "application/json", "image/jpeg,image/png"
        :param encodings: how it can give its events otherwise, the preferred one first, which is what travels to other
            machines unless a connection asks for another; ``type`` names their types too.  Events are emitted as they
            are at hand, and encoded when somebody wants it, once for all who do, on a thread beside the one that runs
            the drone.  What an encoding raises is an exception of the drone, and the event travels as it was emitted.
            Of images: :func:`hive.images`.
        """
        _types("output " + require_text("the name of an output", name), type)
        require_list("encodings", encodings, "hive.images()")
        if not encodings:
            return Output(
                ask_handle(lib.hive_drone_output, self._handle, encoded(name), encoded(type), encoded(require_text("help", help))), name
            )
        known = {encoding.word: encoding for encoding in encodings}
        call = self._guarded(lambda event, wanted, answer: encode(known, event, wanted, answer))
        place = ask_handle(
            self._call,
            lib.hive_drone_encoded_output,
            encoded(name),
            encoded(type),
            encoded(help),
            as_json([encoding._declared() for encoding in encodings]),
            _library.encode_callback(lambda _, *arguments: call(*arguments)),
            None,
        )
        return Output(place, name)

    def on_event(self, input: str, type: str, help: str = "") -> Callable[[Callback], Callback]:
        """Declares an input with the callback of its events: decorates ``function(event)``.

        :param type: media types that it accepts: "image/raw", "image/*"
        :param help: description; "": the first line of the function's docstring
        """

        _types("input " + require_text("the name of an input", input), type)
        if callable(help):
            raise Error("invalid_argument", "on_event decorates a function", "write @drone.on_event(...) above it")
        require_text("help", help)

        def declare(function: Callback) -> Callback:
            require_plain("on_event", function)
            call = self._guarded(lambda handle: self._deliver(function, handle))
            self._call(
                lib.hive_drone_on_event,
                encoded(input),
                encoded(type),
                encoded(help or _first_line(function)),
                _library.event_callback(lambda user, handle: call(handle)),
                None,
            )
            return function

        return declare

    def on_matched(
        self,
        *inputs: Sequence[str],
        within: Optional[Seconds] = None,
        check: Optional[Callable[[Event], Any]] = None,
    ) -> Callable[[Callable[..., Any]], Matching]:
        """Declares two or more inputs whose events are matched: decorates ``function(event, event, ...)``, which
        gets one event of each, in the order of the inputs.  Returns a :class:`Matching` in its place.

        :param inputs: (name, type, help) of each
        :param within: None: events of one capture; otherwise the nearest in time, at most this many seconds apart
        :param check: validates each event when it arrives; if it raises, that event is abandoned
        """
        declared = as_json([_port(each) for each in inputs])
        if check is not None:
            require_plain("check", check)

        def declare(function: Callable[..., Any]) -> Matching:
            require_plain("on_matched", function)
            deliver = self._guarded(lambda *handles: self._deliver(function, *handles))
            return Matching(
                ask_handle(
                    self._call,
                    lib.hive_drone_on_matched,
                    declared,
                    match_of(within),
                    _library.set_callback(lambda user, handles, count: deliver(*handles[:count])),
                    self._look(check) if check else _library.no_event_callback,
                    None,
                )
            )

        return declare

    def _look(self, check: Callable[[Event], Any]) -> Any:
        call = self._guarded(lambda handle: self._deliver(check, handle))
        return _library.event_callback(lambda user, handle: call(handle))

    def on_change(self, function: Callback) -> Callback:
        """Decorates a function that is called after the parameters of one set were assigned, and once before the first
        event.  If it raises, the old values are restored, it is called again, and the set is refused with its text."""
        require_plain("on_change", function)
        self._changed = function
        return function

    def on_start(self, function: Callback) -> Callback:
        """Decorates a function that is called once, when the drone runs: open devices and load models there.  If it
        raises, the drone does not run."""
        require_plain("on_start", function)
        self._call(
            lib.hive_drone_on_start,
            _library.callback(self._guarded(lambda *_: self._with_values(function))),
            None,
        )
        return function

    def on_end(self, function: Callback) -> Callback:
        """Decorates ``function(text)``, which is called when all inputs have ended and every event is processed, before
        the outputs end too.  ``text``: what is missing, or "".  Called again if more events arrived after all."""
        require_plain("on_end", function)
        call = self._guarded(lambda text: function(_library.text_of(text)))
        self._call(lib.hive_drone_on_end, _library.end_callback(lambda _, text: call(text)), None)
        return function

    def main(self, function: Callback) -> Callback:
        """Decorates a function that is called repeatedly between callbacks, for sources: it returns the seconds to wait
        before the next call (None: none).  It is called earlier if the demand for an output changes, a parameter was
        set, or by :meth:`wake`, so a source with a rate checks the clock; not while the drone is halted."""

        require_plain("main", function)

        def step(_: Any, wait_us: Any) -> None:
            wait_us[0] = int((function() or 0) * 1e6)

        self._call(lib.hive_drone_main, _library.main_callback(self._guarded(step)), None)
        return function

    def describe(self) -> dict[str, Any]:
        """The declarations, as --describe prints them."""
        return ask_object(lib.hive_drone_describe, self._handle)

    # --- running ---

    def run(self) -> None:
        """Runs until the drone is stopped.  For --describe: prints the interface and returns.

        :raises SystemExit: in a program, when the drone cannot run
        :raises hive.Error: "name_taken", "io", and what on_start raised
        """
        try:
            if self._program:
                sys.stdout.flush()
                _trace_crashes()
                lib.hive_drone_run(self._handle)
            else:
                self.start()
                while self.step(_STEP_MS / 1000):
                    pass
                self.end()
        except Error as error:
            if self._leave is None and self._program:
                print(f"hive-{self.kind}: {error}", file=sys.stderr)
                raise SystemExit(lib.hive_code_exit_code(code_of(error.code))) from None
            if self._leave is None:
                raise
        finally:
            if not self._program:
                self.end()
        if self._leave is not None:
            raise self._leave

    def start(self) -> None:
        """Joins the swarm; call :meth:`step` repeatedly then, and :meth:`end`."""
        lib.hive_drone_start(self._handle)

    def step(self, seconds: float) -> bool:
        """Works for about this long, at least a millisecond.  False: it was stopped."""
        place = ctypes.c_bool()
        lib.hive_drone_step(self._handle, int(seconds * 1000), ctypes.byref(place))
        return place.value

    def end(self) -> None:
        """Stops as by the request ``stop``, and discards its saved state.  Idempotent."""
        lib.hive_drone_end(self._handle)

    def wake(self) -> None:
        """Calls main as soon as possible.  From any thread."""
        lib.hive_drone_wake(self._handle)

    def stop(self) -> None:
        """Stops the drone: the current event is finished, and :meth:`run` returns.  From any thread."""
        lib.hive_drone_stop(self._handle)

    def condition(self, text: str = "", reason: str = "") -> None:
        """Sets the condition of its source, shown by ``ps``: "stalled"; "": none.  From any thread.

        :param reason: the stall reason, one of those in SPEC.md: "source_ended"
        """
        lib.hive_drone_condition(self._handle, encoded(text), encoded(reason))

    def source_events(self, events: int) -> None:
        """Sets the number of events of the current source; 0: unknown or unlimited.  From any thread."""
        lib.hive_drone_source_events(self._handle, events)

    def report(self, text: str, code: str = "failed") -> None:
        """Reports an exception without raising one.  From any thread."""
        lib.hive_drone_report(self._handle, code_of(code), encoded(text))

    def log(self, text: str, level: str = "info") -> None:
        """Writes a line to the drone's log, unless its --log-level is above this one.  From any thread.

        :param level: "debug", "info", "warning" or "error"
        """
        lib.hive_drone_log_at(self._handle, encoded(level), encoded(text))

    @property
    def stopping(self) -> bool:
        """True if the drone is to stop.  For loops in threads of your own.  From any thread."""
        return ask_flag(lib.hive_drone_stopping, self._handle)

    def status(self) -> dict[str, Any]:
        """The status that an application would get now; after run(), the last one."""
        return ask_object(lib.hive_drone_status, self._handle)
