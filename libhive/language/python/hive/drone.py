"""Drones: processes with a clear interface."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import time
import traceback
import weakref
from typing import TYPE_CHECKING, Any, Callable, Generic, Iterable, Mapping, NoReturn, Optional, Sequence, TypeVar, Union

from . import _library, _pictures
from ._errors import Error
from ._library import as_json, ask, ask_flag, ask_handle, ask_text, code_of, encoded, lib, release
from .event import Event, _Memory

if TYPE_CHECKING:
    import numpy

Value = TypeVar("Value", int, float, bool, str)
Callback = TypeVar("Callback", bound=Callable[..., Any])
Bytes = Union[bytes, bytearray, memoryview]
Seconds = float
_STEP_MS = 100  # how soon Ctrl-C is seen by a drone inside of a program


class Parameter(Generic[Value]):
    """A value that applications may set while the drone runs; between two callbacks it does not change."""

    def __init__(self, name: str, default: Value) -> None:
        self.name = name
        #: What it is now.  In on_start and on_change it may be changed; what it is when they return is what applications
        #: are told.
        self.value: Value = default

    def __repr__(self) -> str:
        return f"<hive.Parameter {self.name}={self.value!r}>"


class Matching:
    """The matching of some inputs; see :meth:`Drone.on_matched`."""

    def __init__(self, handle: ctypes.c_void_p) -> None:
        self._handle = handle

    def __del__(self) -> None:
        release(self._handle)

    def rule(self, within: Optional[Seconds] = None) -> None:
        """Changes the rule, also for the events that wait; None: events of one capture."""
        lib.hive_matching_rule(self._handle, _match(within))


class Output:
    """One of a drone's outputs.  For the thread that runs the drone, except :meth:`loan`."""

    def __init__(self, handle: ctypes.c_void_p, name: str) -> None:
        self._handle = handle
        self.name = name

    def __del__(self) -> None:
        release(self._handle)

    @property
    def wanted(self) -> bool:
        """Does anybody receive the bodies?  If not, there is no need to make one."""
        return ask_flag(lib.hive_output_wanted, self._handle)

    @property
    def received(self) -> bool:
        """Does anybody receive it, be it headers alone?"""
        return ask_flag(lib.hive_output_received, self._handle)

    @property
    def asked(self) -> bool:
        """For sources on demand: has every receiver asked for another event, and is there one?"""
        return ask_flag(lib.hive_output_asked, self._handle)

    def emit(self, header: Optional[Mapping[str, Any]] = None, body: Bytes = b"", type: Optional[str] = None) -> None:
        """Sends an event to whoever wants it; never waits for a receiver.

        Inside a callback it inherits identity and time of the input, elsewhere it begins a new identity.

        :param header: what JSON can hold, at most about 60 KiB
        :param body: is copied
        :param type: media type of the body; None: the first that the output was declared with
        :raises hive.Error: "too_large", "invalid_argument"
        """
        text = as_json(dict(header or {}))
        if not memoryview(body).nbytes:
            lib.hive_output_emit(self._handle, text, len(text), None, 0, encoded(type))
            return
        memory = self._filled(body)
        self._emit_memory(text, memory, memory.size, type)

    def loan(self, shape: Union[int, Sequence[int]], dtype: Any = "uint8") -> numpy.ndarray:
        """An array to fill and :meth:`emit_image`: receivers on this machine read its memory, so nothing is copied.

        Never waits.  Its content is undefined; do not write to it any more once it was emitted.  From any thread.
        """
        numpy = _pictures._numpy()
        kind = numpy.dtype(dtype)
        sides = (shape,) if isinstance(shape, int) else tuple(shape)
        count = 1
        for side in sides:
            count *= int(side)
        return numpy.frombuffer(self._loan(count * kind.itemsize).view(), kind).reshape(sides)

    def emit_image(self, image: numpy.ndarray, header: Optional[Mapping[str, Any]] = None, **fields: Any) -> None:
        """Sends a picture as ``image/raw``, with ``fields`` in its header.

        :param image: ``uint8``, of shape (height, width) for grey or (height, width, 3) for colour, in the order blue,
            green, red.  It is copied once if anybody wants it; an array of :meth:`loan` not at all.
        """
        described = {**(header or {}), **fields, **_pictures.raw_header(image)}
        text = as_json(described)
        if not self.wanted:
            lib.hive_output_emit_body(self._handle, text, len(text), None, b"image/raw")
            return
        memory = _loan_of(image)
        if memory is None:
            memory = self._loan(image.nbytes)
            numpy = _pictures._numpy()
            numpy.copyto(numpy.frombuffer(memory.view(), numpy.uint8).reshape(image.shape), image)
        else:
            image.flags.writeable = False
        self._emit_memory(text, memory, image.nbytes, "image/raw")

    def emit_captured(
        self,
        header: Optional[Mapping[str, Any]] = None,
        body: Bytes = b"",
        type: Optional[str] = None,
        *,
        captured: Optional[float] = None,
        lossless: bool = False,
    ) -> None:
        """Begins a new identity, captured at that time (seconds since 1970; None: now).

        :param lossless: of a source on demand: nobody on the way may skip it
        """
        text = as_json(dict(header or {}))
        body_handle = None
        if memoryview(body).nbytes and self.wanted:
            memory = self._filled(body)
            body_handle = ask_handle(lib.hive_loan_body, memory.handle, memory.size)
        try:
            lib.hive_output_emit_captured(
                self._handle, _microseconds(captured), lossless, text, len(text), body_handle, encoded(type)
            )
        finally:
            release(body_handle)

    def fail(
        self, text: str, code: str = "io", *, captured: Optional[float] = None, lossless: bool = False
    ) -> NoReturn:
        """For main, about something that was taken and cannot be given, as a damaged file: it has its number in the
        sequence all the same.  Raises :class:`hive.Error`; let main pass it on."""
        lib.hive_output_fail(self._handle, _microseconds(captured), lossless, code_of(code), encoded(text))
        raise AssertionError("hive_output_fail always fails")

    def repeat(self, event: Event) -> None:
        """Sends an event again as it once was, with its own identity."""
        lib.hive_output_repeat(self._handle, event._handle)

    def end(self, text: str = "") -> None:
        """The source has come to its end: nothing more will come, unless something is emitted all the same.  Drones
        pass it on, so that whoever collects at the other end knows that it has everything.

        :param text: what is to be said about it: "87 of 196 frames: the file is damaged"; "": its regular end
        """
        lib.hive_output_end(self._handle, encoded(text))

    def begin_source(self) -> None:
        """What is captured from now on is of another source, numbered from 1.  After an end that is so by itself."""
        lib.hive_output_begin_source(self._handle)

    def _loan(self, size: int) -> _Memory:
        return _Memory(ask_handle(lib.hive_output_loan, self._handle, size), lib.hive_loan_bytes)

    def _filled(self, body: Bytes) -> _Memory:
        """The bytes in a loan."""
        view = memoryview(body).cast("B")
        memory = self._loan(len(view))
        memory.view()[:] = view
        return memory

    def _emit_memory(self, header: bytes, memory: _Memory, size: int, type: Optional[str]) -> None:
        body = ask_handle(lib.hive_loan_body, memory.handle, size)
        try:
            lib.hive_output_emit_body(self._handle, header, len(header), body, encoded(type))
        finally:
            release(body)


def _loan_of(image: numpy.ndarray) -> Optional[_Memory]:
    """The loan that an array is the whole of, if it is one."""
    base: Any = image
    while base is not None and not isinstance(base, memoryview):
        base = getattr(base, "base", None)
    memory = getattr(base.obj, "_memory", None) if base is not None else None
    whole = memory is not None and image.flags.c_contiguous and image.__array_interface__["data"][0] == memory.address
    return memory if whole and not base.readonly and image.flags.writeable else None


def _microseconds(seconds: Optional[float]) -> int:
    return int((time.time() if seconds is None else seconds) * 1e6)


def _match(within: Optional[Seconds]) -> Optional[bytes]:
    return None if within is None else as_json({"tolerance_us": int(within * 1e6)})


def _type_of(default: Any) -> str:
    """bool first: it is an int as well."""
    for kind, name in ((bool, "flag"), (int, "integer"), (float, "number"), (str, "text")):
        if isinstance(default, kind):
            return name
    raise Error("invalid_argument", f"a parameter is an int, a float, a bool or a str, not {default!r}")


def _first_line(function: Any) -> str:
    """Of its docstring: what an input is good for, when nothing else says so."""
    return (function.__doc__ or "").strip().split("\n")[0].rstrip(".")


class Drone:
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
        Then there are ``name`` (default: the kind), ``parameters`` to begin with, ``on_exception`` ("skip" or "halt"),
        ``halted`` (from the start), ``listen`` and ``advertise`` (lists of addresses), ``key`` (the swarm's key file),
        ``insecure`` and ``remote_operator``.
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
        self._handle: Optional[ctypes.c_void_p] = None
        self._kept: list[Any] = []  # the callbacks that C knows
        self._parameters: dict[str, Parameter[Any]] = {}
        self._changed: Callable[[], Any] = lambda: None
        self._leave: Optional[BaseException] = None  # what a callback ends the program with
        self.kind = kind
        self._program = not embedded
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
        self._call(
            lib.hive_drone_on_log,
            _library.log_callback(lambda _, line: logger.info("%s", _library.text_of(line))),
            None,
        )

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
        if not place.value:
            raise SystemExit(code.value)
        self._handle = place

    def __del__(self) -> None:
        self._at_exit()

    def _at_exit(self) -> None:
        handle, self._handle = self._handle, None
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
        declared: dict[str, Any] = {"name": name, "type": _type_of(default), "default": default, "help": help}
        declared.update(least=least, most=most, unit=unit, operator=operator)
        declared.update(choices=None if choices is None else list(choices))
        lib.hive_drone_parameter(self._handle, as_json({k: v for k, v in declared.items() if v is not None}))
        parameter = Parameter(name, default)
        self._parameters[name] = parameter
        return parameter

    def given(self, parameter: str) -> Any:
        """The value that a parameter will begin with, by --set or by what the drone was told before a crash; None: its
        default.  For drones whose ports depend on it."""
        remembered = ctypes.c_bool()
        place = ctypes.c_void_p()
        lib.hive_drone_given(self._handle, encoded(parameter), ctypes.byref(place), ctypes.byref(remembered))
        text = _library.take_text(place)
        return None if text is None else _library.json.loads(text)

    def output(self, name: str, type: str, help: str = "") -> Output:
        """Declares an output.

        :param type: one media type or several: "application/json", "image/jpeg,image/png"
        """
        place = ask_handle(lib.hive_drone_output, self._handle, encoded(name), encoded(type), encoded(help))
        return Output(place, name)

    def on_event(self, input: str, type: str, help: str = "") -> Callable[[Callback], Callback]:
        """Declares an input, and what to do with its events: decorates ``function(event)``.

        :param type: media types that it takes: "image/raw", "image/*"
        :param help: what it is for; "": the first line of the function's docstring
        """

        def declare(function: Callback) -> Callback:
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
        """Declares two or more inputs whose events belong together: decorates ``function(event, event, ...)``, which
        gets one event of each, in the order of the inputs.  Gives a :class:`Matching` in its place.

        :param inputs: (name, type, help) of each
        :param within: None: events of one capture; otherwise those nearest in time, at most so many seconds apart
        :param check: looks at each event when it arrives; what it raises abandons that event
        """
        declared = as_json([dict(zip(("name", "type", "help"), (*each, "", "")[:3])) for each in inputs])

        def declare(function: Callable[..., Any]) -> Matching:
            deliver = self._guarded(lambda *handles: self._deliver(function, *handles))
            look = self._guarded(lambda handle: self._deliver(check, handle)) if check else None
            return Matching(
                ask_handle(
                    self._call,
                    lib.hive_drone_on_matched,
                    declared,
                    _match(within),
                    _library.set_callback(lambda user, handles, count: deliver(*handles[:count])),
                    _library.event_callback(lambda user, handle: look(handle)) if look else _library.event_callback(),
                    None,
                )
            )

        return declare

    def on_change(self, function: Callback) -> Callback:
        """Decorates what is called after the parameters of one set were assigned, and once before the first event.
        If it raises, all are put back, it is called again, and the set is refused with its text."""
        self._changed = function
        return function

    def on_start(self, function: Callback) -> Callback:
        """Decorates what is called once when the drone runs for real: the place to open devices and load models.  If it
        raises, the drone does not run."""
        self._call(
            lib.hive_drone_on_start,
            _library.callback(self._guarded(lambda *_: self._with_values(function))),
            None,
        )
        return function

    def on_end(self, function: Callback) -> Callback:
        """Decorates ``function(text)``, which is called when everything that the inputs receive has come to its end and
        has been worked on, before the outputs end too.  ``text`` is what is said about it, "" for a regular end.  Once
        more when something came after all."""
        call = self._guarded(lambda text: function(_library.text_of(text)))
        self._call(lib.hive_drone_on_end, _library.end_callback(lambda _, text: call(text)), None)
        return function

    def main(self, function: Callback) -> Callback:
        """Decorates what a source does, again and again between callbacks: it returns how many seconds to wait before
        the next call (None: none).  It is called earlier when the demand for an output changes, a parameter was set, or
        by :meth:`wake`; not while the drone is halted."""

        def step(_: Any, wait_us: Any) -> None:
            wait_us[0] = int((function() or 0) * 1e6)

        self._call(lib.hive_drone_main, _library.main_callback(self._guarded(step)), None)
        return function

    def describe(self) -> dict[str, Any]:
        """What has been declared, as --describe prints it."""
        return ask(lib.hive_drone_describe, self._handle)

    # --- running ---

    def run(self) -> None:
        """Runs until the drone is told to stop.  For --describe: prints the interface and returns.

        :raises SystemExit: in a program, when the drone cannot run
        :raises hive.Error: "name_taken", "io", and what on_start raised
        """
        try:
            if self._program:
                sys.stdout.flush()
                lib.hive_drone_run(self._handle)
            else:
                self.start()
                while self.step(_STEP_MS / 1000):
                    pass
                self.end()
        except Error as error:
            if self._leave is None and self._program:
                advice = f"; {error.advice}" if error.advice else ""
                print(f"hive-{self.kind}: {error}{advice}", file=sys.stderr)
                raise SystemExit(lib.hive_code_exit_code(code_of(error.code))) from None
            if self._leave is None:
                raise
        finally:
            if not self._program:
                self.end()
        if self._leave is not None:
            raise self._leave

    def start(self) -> None:
        """Meets the swarm; then :meth:`step` as often as wanted, and :meth:`end`."""
        lib.hive_drone_start(self._handle)

    def step(self, seconds: float) -> bool:
        """Works for about so long, at least a millisecond.  False: it was told to stop."""
        place = ctypes.c_bool()
        lib.hive_drone_step(self._handle, int(seconds * 1000), ctypes.byref(place))
        return place.value

    def end(self) -> None:
        """Ends as the request ``stop`` would, and forgets what it was told.  Once more: nothing."""
        lib.hive_drone_end(self._handle)

    def wake(self) -> None:
        """Calls main as soon as possible.  From any thread."""
        lib.hive_drone_wake(self._handle)

    def stop(self) -> None:
        """Ends the drone: what is being worked on comes to its end, and :meth:`run` returns.  From any thread."""
        lib.hive_drone_stop(self._handle)

    def condition(self, text: str = "", reason: str = "") -> None:
        """Says what state its world is in, shown by ``ps``: "stalled"; "": all is well.  From any thread.

        :param reason: why nothing moves, one of the words of SPEC.md: "source_ended"
        """
        lib.hive_drone_condition(self._handle, encoded(text), encoded(reason))

    def source_events(self, events: int) -> None:
        """Says how many events the present source has in all; 0: unknown, or without end.  From any thread."""
        lib.hive_drone_source_events(self._handle, events)

    def report(self, text: str, code: str = "failed") -> None:
        """Reports an exception without raising one.  From any thread."""
        lib.hive_drone_report(self._handle, code_of(code), encoded(text))

    def log(self, text: str) -> None:
        """Writes a line to the drone's log.  From any thread."""
        lib.hive_drone_log(self._handle, encoded(text))

    @property
    def stopping(self) -> bool:
        """Should the drone end?  For loops in threads of your own.  From any thread."""
        return ask_flag(lib.hive_drone_stopping, self._handle)

    def status(self) -> dict[str, Any]:
        """What an application would be told now; after it ran, how it was at the end."""
        return ask(lib.hive_drone_status, self._handle)

    # --- between C and Python ---

    def _call(self, function: Any, *arguments: Any) -> None:
        """Calls with a callback, which lives as long as the drone."""
        self._kept.extend(argument for argument in arguments if isinstance(argument, ctypes._CFuncPtr))
        function(self._handle, *arguments)

    def _guarded(self, function: Callable[..., Any]) -> Callable[..., int]:
        """Makes of what a function raises what C understands."""
        weak = weakref.ref(self)

        def call(*arguments: Any) -> int:
            try:
                function(*arguments)
                return 0
            except Error as error:
                return int(lib.hive_fail(code_of(error.code), encoded(str(error).replace("\0", "?"))))
            except Exception as error:
                drone = weak()
                if drone is not None:
                    drone.log("".join(traceback.format_exception(type(error), error, error.__traceback__)).rstrip())
                text = "".join(traceback.format_exception_only(type(error), error)).strip()
                return int(lib.hive_fail(code_of("failed"), encoded(text.replace("\0", "?"))))
            except BaseException as leave:  # Ctrl-C or sys.exit() in a callback ends the drone, and then the program
                drone = weak()
                if drone is not None:
                    drone._leave = leave
                    with contextlib.suppress(Error):  # it may not have begun
                        drone.stop()
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
