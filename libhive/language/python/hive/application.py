"""Applications: find drones, connect, configure, begin to collect."""

from __future__ import annotations

import ctypes
import os
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Optional, Sequence, Union

from . import _library
from ._errors import Error, SetError
from ._finding import Finding, Names, answer_of, is_many
from ._library import as_json, ask, ask_handle, ask_text, encoded, lib, release
from .collector import Collector, MatchedCollector, Seconds, milliseconds
from .event import Event

if TYPE_CHECKING:
    from .swarm import Source, Swarm


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
        options["lease_ms"] = milliseconds(lease)
    if encoding:
        options["encoding"] = encoding
    return options


class Application(Finding):
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
        super().__init__()
        options = {"name": name, "timeout_ms": milliseconds(timeout)}
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
        lib.hive_application_timeout(self._handle, milliseconds(seconds))

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
        if not is_many(drone):
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
        answers = {answer["drone"]: answer_of(answer) for answer in result["answers"]}
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
        if not is_many(drone):
            place = ask_text(lib.hive_application_get, self._handle, encoded(str(drone)), wanted)
            return _library.json.loads(place or "{}")
        place = ask_text(lib.hive_application_get_all, self._handle, as_json(self._named(drone)), wanted)
        return {answer["drone"]: answer_of(answer) for answer in _library.json.loads(place or "[]")}

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
        options = {"connection": connection, "ordered": ordered, "patience_ms": milliseconds(patience)}
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

    # --- whole swarms ---

    def swarm(self, source: Source) -> Swarm:
        """The swarm of a file, a dict or a text, by this application; see :class:`Swarm`."""
        from .swarm import Swarm

        return Swarm(source, application=self)

    def swarms(self) -> list[Swarm]:
        """Those that were brought up from this home."""
        from .swarm import Swarm

        known = ask(lib.hive_swarm_remembered, self._handle)
        return [Swarm(told["text"], application=self, form_only=True) for told in known]

    def export(self, *drones: str, name: Optional[str] = None) -> str:
        """What runs, as a swarm file: bringing it up changes nothing, and where nothing runs it makes the same swarm.

        :param drones: names and globs; none: those of the swarm of that name, or all if it was not brought up from here
        :param name: of the swarm; None: of the only one that was brought up from here, or "swarm"
        """
        wanted = as_json(self._named(drones)) if drones else None
        place, length = ctypes.c_void_p(), ctypes.c_size_t()
        lib.hive_swarm_running(self._handle, encoded(name), wanted, ctypes.byref(place), ctypes.byref(length))
        return _library.take_text(place, length.value) or ""

    def replace(
        self,
        drone: str,
        *,
        kind: str = "",
        parameters: Optional[Mapping[str, Any]] = None,
        arguments: Sequence[str] = (),
        ready: Seconds = 10.0,
        lose_state: bool = False,
    ) -> dict[str, Any]:
        """Lets a new process take over from a drone of this machine while the swarm runs: when it is ready, name,
        parameters and connections pass over.  Gives "drone", "kind", "pid", "before" (the old process) and "log".

        :param kind: what the new one is, or a file of Python; "": what the old one is
        :param parameters: set for the new one, beside what the old one was told
        :param arguments: further words of its command line
        :param ready: how long it may take to get ready; as long as it is not, the old one notices nothing
        :param lose_state: the old one may forget what it remembers of earlier events
        :raises hive.Error: "not_found", "type_mismatch", "refused", "name_taken" when it is being replaced already,
            "timeout"; with the last lines of the log when the new one has failed
        """
        options = {
            "kind": kind,
            "parameters": dict(parameters or {}),
            "arguments": list(arguments),
            "ready_ms": milliseconds(ready),
            "lose_state": lose_state,
        }
        words: list[str] = []
        hear = _library.log_callback(lambda _, line: words.append(_library.text_of(line)))
        try:
            told = ask_text(
                lib.hive_application_replace, self._handle, encoded(drone), as_json(options), hear, None
            )
        except Error as error:
            text = "\n".join([str(error) + (", and its log says:" if words else ""), *words])
            raise Error(error.code, text, error.advice) from None
        replaced: dict[str, Any] = _library.json.loads(told or "{}")
        return replaced

    # --- between drones and outputs ---

    def _result_outputs(self, drone: str) -> list[str]:
        found = []
        for name in self.find(drone) if is_many(drone) else [drone]:
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
