"""Applications: find drones, connect, configure, collect."""

from __future__ import annotations

import ctypes
import os
import time
from typing import Any, AsyncIterator, Iterator, Mapping, Optional, Sequence, Union

from . import _library
from ._errors import Error, SetError
from ._library import as_json, ask, ask_handle, ask_text, encoded, lib, release
from .event import Event

Names = Union[str, Sequence[str]]
Seconds = float
_SLICE = 0.1  # how soon Ctrl-C is seen while nothing comes
_MOST_IN_SET = 64


def _milliseconds(seconds: float) -> int:
    return max(0, min(int(seconds * 1000 + 0.999), 24 * 3600 * 1000))


def _is_many(drone: Names) -> bool:
    return not isinstance(drone, str) or "*" in drone or "?" in drone


def _connection(
    stream: bool = False,
    notify: bool = False,
    window: Optional[int] = None,
    group: str = "",
    first_frame: bool = False,
    lease: Optional[Seconds] = None,
    encoding: str = "",
) -> dict[str, Any]:
    options: dict[str, Any] = {}
    if stream:
        options["transfer"] = "stream"
    if notify:
        options["delivery"] = "notify"
    if window is not None:
        options["window"] = window
    if group:
        options["group"] = group
    if first_frame:
        options["first_frame"] = True
    if lease is not None:
        options["lease_ms"] = _milliseconds(lease)
    if encoding:
        options["encoding"] = encoding
    return options


class _Collecting:
    """What both kinds of collectors have: waiting in slices, so that Ctrl-C is seen, and asyncio."""

    def __init__(self, handle: ctypes.c_void_p) -> None:
        self._handle: Optional[ctypes.c_void_p] = handle
        self._executor: Any = None
        self._pending: Any = None  # of an asyncio wait that was cancelled
        self._last: Sequence[Event] = ()

    def __del__(self) -> None:
        release(self._handle)

    def _take(self, seconds: float) -> Any:
        raise NotImplementedError

    def _hand_out(self, taken: Any) -> Any:
        self._last = () if taken is None else (taken,) if isinstance(taken, Event) else taken
        return taken

    def _go_on(self) -> None:
        """Whoever asks for the next one is done with the last."""
        for event in self._last:
            event._left()
        self._last = ()

    def _next(self, timeout: Optional[Seconds]) -> Any:
        self._go_on()
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            left = _SLICE if end is None else min(_SLICE, max(0.0, end - time.monotonic()))
            taken = self._take(left)
            if taken is not None or (end is not None and time.monotonic() >= end) or self.ended is not None:
                return self._hand_out(taken)

    async def _next_async(self) -> Any:
        import asyncio
        from concurrent.futures import ThreadPoolExecutor

        self._go_on()
        if self._executor is None:
            self._executor = ThreadPoolExecutor(1, "hive-collector")
        loop = asyncio.get_running_loop()
        while True:
            if self._pending is None:
                self._pending = loop.run_in_executor(self._executor, self._take, _SLICE)
            taken = await asyncio.shield(self._pending)
            self._pending = None
            if taken is not None or self.ended is not None:
                return self._hand_out(taken)

    @property
    def ended(self) -> Optional[str]:
        """When all that it receives has come to its end and everything was taken: what is said about that, "" for a
        regular end.  None as long as something may come; so it is again when something comes after all."""
        over, text = ctypes.c_bool(), ctypes.c_void_p()
        lib.hive_collector_ended(self._handle, ctypes.byref(over), ctypes.byref(text))
        return _library.take_text(text) if over.value else None

    def counts(self) -> dict[str, Any]:
        """What has been counted so far: "received", "duplicates" (second answers, refused), "missing", "failed",
        "dropped" (not taken in time); of sets also "sets": {"sets", "waiting", "unmatched", "missing"}."""
        return ask(lib.hive_collector_counts, self._handle)

    def close(self) -> None:
        """Ends receiving.  Once more: nothing."""
        self._go_on()
        lib.hive_collector_close(self._handle)
        if self._executor is not None:
            self._executor.shutdown(wait=False)

    def __exit__(self, *_: Any) -> None:
        self.close()


class Collector(_Collecting):
    """Receives events; connections that end are made again by themselves.  Iterate, with ``for`` or ``async for``:
    the event of one round is done when the next one is asked for (see :meth:`Event.hold`)."""

    def __enter__(self) -> Collector:
        return self

    def next(self, timeout: Optional[Seconds] = None) -> Optional[Event]:
        """The next event; None when none came within ``timeout`` (None: waits for ever), or all has ended."""
        event: Optional[Event] = self._next(timeout)
        return event

    def __iter__(self) -> Iterator[Event]:
        return self

    def __next__(self) -> Event:
        event: Optional[Event] = self._next(None)
        if event is None:
            raise StopIteration
        return event

    def __aiter__(self) -> AsyncIterator[Event]:
        return self

    async def __anext__(self) -> Event:
        event: Optional[Event] = await self._next_async()
        if event is None:
            raise StopAsyncIteration
        return event

    def _take(self, seconds: float) -> Optional[Event]:
        place = ctypes.c_void_p()
        lib.hive_collector_next(self._handle, _milliseconds(seconds), ctypes.byref(place))
        return Event(place) if place.value else None


class MatchedCollector(_Collecting):
    """Receives sets of events that belong together: tuples of one event of each output, in their order."""

    def __enter__(self) -> MatchedCollector:
        return self

    def next(self, timeout: Optional[Seconds] = None) -> Optional[tuple[Event, ...]]:
        """The next set; None when none was complete within ``timeout`` (None: waits for ever), or all has ended."""
        events: Optional[tuple[Event, ...]] = self._next(timeout)
        return events

    def __iter__(self) -> Iterator[tuple[Event, ...]]:
        return self

    def __next__(self) -> tuple[Event, ...]:
        events: Optional[tuple[Event, ...]] = self._next(None)
        if events is None:
            raise StopIteration
        return events

    def __aiter__(self) -> AsyncIterator[tuple[Event, ...]]:
        return self

    async def __anext__(self) -> tuple[Event, ...]:
        events: Optional[tuple[Event, ...]] = await self._next_async()
        if events is None:
            raise StopAsyncIteration
        return events

    def _take(self, seconds: float) -> Optional[tuple[Event, ...]]:
        places = (ctypes.c_void_p * _MOST_IN_SET)()
        count = ctypes.c_size_t()
        lib.hive_collector_next_set(
            self._handle, _milliseconds(seconds), places, _MOST_IN_SET, ctypes.byref(count)
        )
        events = tuple(Event(ctypes.c_void_p(places[i])) for i in range(count.value))
        return events or None


class Application:
    """An application in the swarm.  Calls return when they are confirmed; after ``timeout`` seconds they raise
    :class:`hive.Error` "timeout".  A drone and its port are written "camera.image", or "camera" where only one port
    fits.  From any thread; a closed application raises "stopped".

    :param name: what drones call it; "": "app-PID"
    :param home: where the drones of this machine meet; None: $HIVE_HOME, or what every program takes without it
    :param timeout: of every call, seconds
    :param key: the swarm's key file, for drones on other machines; None: $HIVE_KEY, or ~/.config/hive/swarm.key
    """

    def __init__(
        self,
        name: str = "",
        *,
        home: Union[str, os.PathLike[str], None] = None,
        timeout: Seconds = 5.0,
        key: Union[str, os.PathLike[str], None] = None,
    ) -> None:
        self._handle: Optional[ctypes.c_void_p] = None
        options = {"name": name, "timeout_ms": _milliseconds(timeout)}
        if home is not None:
            options["home"] = os.fspath(home)
        if key is not None:
            options["key"] = os.fspath(key)
        self._handle = ask_handle(lib.hive_application_new, as_json(options))
        _library.ends_at_exit(self)

    def __del__(self) -> None:
        self._at_exit()

    def _at_exit(self) -> None:
        if self._handle:
            try:
                self.close()
            except Error:
                pass
            handle, self._handle = self._handle, None
            release(handle)

    def __enter__(self) -> Application:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        """Leaves the swarm, and ends its collectors.  Once more: nothing."""
        if self._handle:
            lib.hive_application_close(self._handle)

    @property
    def name(self) -> str:
        """What drones call it."""
        return ask_text(lib.hive_application_name, self._handle) or ""

    def timeout(self, seconds: Seconds) -> None:
        """Changes the deadline of the calls that follow."""
        lib.hive_application_timeout(self._handle, _milliseconds(seconds))

    # --- find ---

    def drones(self) -> list[str]:
        """The drones that run on this machine, and those on other machines that are known; sorted."""
        return ask(lib.hive_application_drones, self._handle)

    def remembered(self) -> list[str]:
        """Drones that crashed, and get back what they were told when they are started again."""
        return ask(lib.hive_application_remembered, self._handle)

    def find(self, pattern: str) -> list[str]:
        """The drones that a glob or a name means.  :raises hive.Error: "not_found" when there is none"""
        return ask(lib.hive_application_find, self._handle, encoded(pattern))

    def describe(self, drone: str) -> dict[str, Any]:
        """Its interface: "kind", "summary", "version", "stateful", "inputs", "outputs", "parameters"."""
        return ask(lib.hive_application_describe, self._handle, encoded(drone))

    def status(self, drone: Names) -> dict[str, Any]:
        """What it is doing: "state", "events", "inputs", "outputs", ... (SPEC.md, section 6.4).  With a glob or several
        drones: that by drone, where one that does not answer has an :class:`Error` instead."""
        if not _is_many(drone):
            return ask(lib.hive_application_status, self._handle, encoded(str(drone)))
        answers = ask(lib.hive_application_status_all, self._handle, as_json(self._named(drone)))
        return {answer["drone"]: _answer(answer, "status") for answer in answers}

    def place(self, drone: str) -> dict[str, Any]:
        """Where it is met: "drone", "host" ("local": this machine), "address", "ssh", "answered_us".

        :raises hive.Error: "not_found"; "invalid_argument" when several have the name: call it "NAME@HOST"
        """
        return ask(lib.hive_application_place, self._handle, encoded(drone))

    def places(self) -> list[dict[str, Any]]:
        """The list of places: drones on other machines that this home was told of."""
        return ask(lib.hive_application_places, self._handle)

    def add_place(self, drone: str, address: str, host: str = "") -> None:
        """Writes into the list of places that a drone is met at an address, "tcp://HOST:PORT".

        :param host: what its machine is called; "": as in the address
        """
        host = host or address.partition("://")[2].rpartition(":")[0].strip("[]")
        lib.hive_application_add_place(self._handle, as_json({"drone": drone, "host": host, "address": address}))

    def forget_place(self, place: Mapping[str, Any]) -> None:
        """Strikes one of :meth:`places` off the list.  :raises hive.Error: "not_found" when it was not there"""
        lib.hive_application_forget_place(self._handle, as_json(dict(place)))

    def wait(self, drone: str, state: str = "running", timeout: Seconds = 10.0) -> None:
        """Returns when the drone is "running" (it answers, and its start is over), "idle", "halted" or "gone".

        :raises hive.Error: "timeout"
        """
        end = time.monotonic() + timeout
        while True:
            left = end - time.monotonic()
            try:
                lib.hive_application_wait(
                    self._handle, encoded(drone), encoded(state), _milliseconds(min(left, _SLICE))
                )
                return
            except Error as error:
                if error.code != "timeout" or left <= _SLICE:
                    raise

    # --- wire ---

    def connect(
        self,
        sender: str,
        receiver: str,
        *,
        stream: bool = False,
        notify: bool = False,
        window: Optional[int] = None,
        group: str = "",
        first_frame: bool = False,
        lease: Optional[Seconds] = None,
        encoding: str = "",
    ) -> tuple[str, str]:
        """Connects an output to an input, confirmed by both.  Gives the ends that were used.

        :param stream: every event is sent; without it the receiver gets the newest when it asks
        :param notify: headers alone
        :param window: events asked for ahead, 1 to 64
        :param group: receivers of the same group share the events, one each
        :param first_frame: begin with the newest event that exists already
        :param lease: how long a member of a group may work on one event before another gets it
        :param encoding: of the bodies: "raw", "png", "jpeg", "jpeg:80"
        :raises hive.Error: "type_mismatch", "not_found", "invalid_argument" when several ports fit, "refused"
        """
        options = _connection(stream, notify, window, group, first_frame, lease, encoding)
        ends = _library.json.loads(
            ask_text(
                lib.hive_application_connect, self._handle, encoded(sender), encoded(receiver), as_json(options)
            )
            or "{}"
        )
        return ends["sender"], ends["receiver"]

    def disconnect(self, sender: str, receiver: str) -> None:
        """Undoes it.  A receiver that does not run is forgotten by its sender."""
        lib.hive_application_disconnect(self._handle, encoded(sender), encoded(receiver))

    # --- configure ---

    def set(self, drone: Names, values: Optional[Mapping[str, Any]] = None, **parameters: Any) -> dict[str, Any]:
        """Sets parameters, all together or none: ``swarm.set("face", scale=1.05)``.  Gives what the drone applied.

        With a glob or several names, on all of these drones or on none: gives that by drone.

        :raises hive.Error: "refused" with the reason, "not_found"; on several drones :class:`hive.SetError`
        """
        wanted = as_json({**(values or {}), **parameters})
        if not _is_many(drone):
            place = ask_text(lib.hive_application_set, self._handle, encoded(str(drone)), wanted)
            return _library.json.loads(place or "{}")
        place = ask_text(
            lib.hive_application_set_all,
            self._handle,
            as_json(self._named(drone)),
            wanted,
            _library.callback(),
            None,
        )
        result = _library.json.loads(place or "{}")
        answers = {answer["drone"]: _answer(answer) for answer in result["answers"]}
        errors = [answer for answer in answers.values() if isinstance(answer, Error)]
        if errors:
            # Those that were left as they were are "refused"; what went wrong may be something else.
            first = next((error for error in errors if error.code != "refused"), errors[0])
            raise SetError(first.code, "; ".join(map(str, errors)), first.advice, result["changed"], answers) from None
        return answers

    def get(self, drone: Names, *names: str) -> dict[str, Any]:
        """The present values, of all parameters or of those named.  With a glob or several drones: by drone, where one
        that does not answer has an :class:`Error` instead."""
        wanted = as_json(list(names)) if names else None
        if not _is_many(drone):
            place = ask_text(lib.hive_application_get, self._handle, encoded(str(drone)), wanted)
            return _library.json.loads(place or "{}")
        place = ask_text(lib.hive_application_get_all, self._handle, as_json(self._named(drone)), wanted)
        return {answer["drone"]: _answer(answer) for answer in _library.json.loads(place or "[]")}

    # --- collect ---

    def collect(
        self,
        *outputs: str,
        ordered: bool = False,
        patience: Seconds = 30.0,
        stream: bool = False,
        notify: bool = False,
        window: int = 64,
        first_frame: bool = False,
        encoding: str = "",
    ) -> Collector:
        """Receives from outputs.  Returns when every drone has acknowledged.

        :param ordered: results of one source in the order of its captures, however many workers made them
        :param patience: ordered: how long a missing result holds up those after it
        """
        connection = _connection(stream, notify, None if stream else window, "", first_frame, None, encoding)
        options = {"connection": connection, "ordered": ordered, "patience_ms": _milliseconds(patience)}
        return Collector(
            ask_handle(lib.hive_application_collect, self._handle, as_json(list(outputs)), as_json(options))
        )

    def collect_matched(
        self,
        *outputs: str,
        within: Optional[Seconds] = None,
        notify: bool = False,
        window: int = 64,
        encoding: str = "",
    ) -> MatchedCollector:
        """Receives sets of events that belong together, one of each of two or more outputs.

        :param within: None: events of one capture; otherwise those nearest in time, at most so many seconds apart
        """
        options = {"connection": _connection(notify=notify, window=window, encoding=encoding)}
        match = None if within is None else as_json({"tolerance_us": int(within * 1e6)})
        return MatchedCollector(
            ask_handle(
                lib.hive_application_collect_matched,
                self._handle,
                as_json(list(outputs)),
                match,
                as_json(options),
            )
        )

    def results(
        self, *drones: str, count: Optional[int] = None, timeout: Optional[Seconds] = None, ordered: bool = False
    ) -> Iterator[Event]:
        """The results of drones, one after the other: of the output that is named ("face.faces"), or of the only one
        with results in the header.

        :param count: how many; None: no end
        :param timeout: how long to wait for each; then :class:`hive.Error` "timeout" is raised

        The loop ends when everything has ended.  If that was no regular end, what was said about it is raised as a
        :class:`hive.Error` "abandoned".
        """
        outputs = [name for drone in drones for name in self._result_outputs(drone)]
        with self.collect(*outputs, ordered=ordered) as collector:
            left = count
            while left is None or left > 0:
                event = collector.next(timeout)
                if event is None and collector.ended is not None:
                    if collector.ended:
                        raise Error("abandoned", collector.ended)
                    return
                if event is None:
                    raise Error("timeout", f"no result of {', '.join(outputs)} within {timeout} s")
                left = None if left is None else left - 1
                yield event

    def exceptions(self, *drones: str) -> Collector:
        """Receives the exceptions of drones: events whose header has "code", "text", "policy", "input"."""
        return Collector(ask_handle(lib.hive_application_exceptions, self._handle, as_json(list(drones))))

    def put(
        self, input: str, body: Union[bytes, bytearray, memoryview] = b"", type: str = "application/octet-stream",
        header: Optional[Mapping[str, Any]] = None,
    ) -> None:
        """Sends one event into an input; returns when the drone has taken it into its queue."""
        text, data = as_json(dict(header or {})), bytes(body)
        lib.hive_application_put(
            self._handle, encoded(input), text, len(text), data if data else None, len(data), encoded(type)
        )

    # --- control ---

    def halt(self, *drones: str) -> None:
        """They take nothing more until they are resumed."""
        for name in self._named(drones):
            lib.hive_application_halt(self._handle, encoded(name))

    def resume(self, *drones: str) -> None:
        for name in self._named(drones):
            lib.hive_application_resume(self._handle, encoded(name))

    def stop(self, *drones: str) -> None:
        """Ends drones, and what they were told is forgotten; returns when they are gone."""
        for name in self._named(drones):
            lib.hive_application_stop(self._handle, encoded(name))

    def exception_policy(self, drone: str, policy: str) -> None:
        """What happens when its code throws: "skip" leaves the input out, "halt" takes nothing more until resumed."""
        lib.hive_application_exception_policy(self._handle, encoded(drone), encoded(policy))

    def _named(self, drones: Names) -> list[str]:
        """Each once, in the order given."""
        names: dict[str, None] = {}
        for drone in [drones] if isinstance(drones, str) else drones:
            names.update(dict.fromkeys(self.find(drone) if _is_many(drone) else [drone]))
        return list(names)

    def _result_outputs(self, drone: str) -> list[str]:
        found = []
        for name in self.find(drone) if _is_many(drone) else [drone]:
            if "." in name and name not in self.drones():
                found.append(name)
                continue
            outputs = self.describe(name)["outputs"]
            fitting = [output for output in outputs if "json" in output["type"]] or outputs
            if len(fitting) != 1:
                ports = ", ".join(f'{name}.{output["name"]}' for output in outputs)
                raise Error("invalid_argument", f"{name} has several outputs", f"say which: {ports}")
            found.append(f'{name}.{fitting[0]["name"]}')
        return found


def _answer(answer: Mapping[str, Any], result: str = "result") -> Any:
    error = answer.get("error")
    return Error(error["code"], error["text"], error["advice"]) if error else answer[result]
