"""Applications: find, connect and configure drones, and collect results."""

from __future__ import annotations

import ctypes
import os
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Sequence, Union

from . import _library
from ._errors import Error, SetError, require_text
from ._finding import Finding, Names, answer_of, flat, is_many
from ._library import Closing, as_json, ask_handle, ask_json, ask_list, ask_object, ask_text, encoded, lib, release
from .output import view_of
from .collector import Collector, MatchedCollector, Results, Seconds, milliseconds

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
    options = {
        "transfer": "stream" if stream else None,
        "delivery": "notify" if notify else None,
        "window": window,
        "group": group or None,
        "first_frame": first_frame or None,
        "lease_ms": None if lease is None else milliseconds(lease),
        "encoding": encoding or None,
    }
    return {name: value for name, value in options.items() if value is not None}


class Application(Finding, Closing):
    """An application in the swarm.  Calls return when they are confirmed; after ``timeout`` seconds they raise
    :class:`hive.Error` "timeout".  A port is "camera.image", or "camera" if only one port fits.  From any thread; a
    closed application raises "stopped".

    :param name: its name in the swarm; "": "app-PID"
    :param home: the runtime directory; None: $HIVE_HOME, or its default
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
        handle, self._handle = self._kept, None
        if handle and not _library.is_inherited(handle):
            try:
                lib.hive_application_close(handle)
            except Error:
                pass
            release(handle)

    def __repr__(self) -> str:
        try:
            return f"<hive.Application {self.name}>"
        except Error:
            return "<hive.Application of another process>"

    def close(self) -> None:
        """Leaves the swarm, and closes its collectors.  Idempotent."""
        if self._handle:
            lib.hive_application_close(self._handle)

    @property
    def name(self) -> str:
        """Its name in the swarm."""
        return ask_text(lib.hive_application_name, self._handle) or ""

    def timeout(self, seconds: Seconds) -> None:
        """Changes the deadline of the calls that follow."""
        lib.hive_application_timeout(self._handle, milliseconds(seconds))

    # --- run ---

    def start(
        self,
        kind: Union[str, os.PathLike[str]],
        name: str = "",
        on: str = "",
        *,
        parameters: Optional[Mapping[str, Any]] = None,
        halted: bool = False,
        on_exception: str = "",
        listen: str = "",
        advertise: str = "",
        insecure: bool = False,
        no_announce: bool = False,
        remote_operator: bool = False,
        key: Union[str, os.PathLike[str]] = "",
        log_level: str = "",
        if_missing: bool = False,
        ready: Seconds = 10.0,
        **values: Any,
    ) -> str:
        """Starts a drone in the background and returns its name when it is ready: ``swarm.start("face", scale=1.05)``.
        It keeps running when this program exits; see :meth:`stop`.

        :param kind: the program hive-KIND in $HIVE_DRONE_PATH or $PATH, or a Python file, "edges.py"
        :param name: in the swarm; "": the kind
        :param on: ssh host of another machine with Hive installed; "": this machine
        :param parameters: initial parameters, as ``values``; for names that are arguments of this call
        :param listen: address to listen at, "tcp://HOST:PORT"; with ``on`` the default is all addresses
        :param if_missing: reuse a running drone of this name and kind: for notebook cells that run again
        :param advertise: address for other machines, if it differs from ``listen``
        :param ready: how long it may take to become ready; then it is stopped
        :raises hive.Error: "name_taken", "not_found" if there is no such program, "timeout"; if it exits instead, the
            error with its exit code, or "failed", with the end of its log
        """
        texts = {"name": name, "on": on, "on_exception": on_exception, "listen": listen, "advertise": advertise}
        for argument, text in {**texts, "log_level": log_level}.items():
            require_text(argument, text)
        options = {
            "name": name,
            "ssh": on,
            "parameters": {**(parameters or {}), **values},
            "halted": halted,
            "on_exception": on_exception,
            "listen": listen,
            "advertise": advertise,
            "insecure": insecure,
            "no_announce": no_announce,
            "remote_operator": remote_operator,
            "key": os.fspath(key),
            "log_level": log_level,
            "if_missing": if_missing,
            "ready_ms": milliseconds(ready),
        }
        started = ask_json(lib.hive_application_start, self._handle, encoded(os.fspath(kind)), as_json(options))
        return str(started["drone"])

    def replace(
        self,
        drone: str,
        *,
        kind: Union[str, os.PathLike[str]] = "",
        parameters: Optional[Mapping[str, Any]] = None,
        lose_state: bool = False,
        force: bool = False,
        ready: Seconds = 10.0,
        **options: Any,
    ) -> None:
        """Replaces a running drone with a new process, which takes over name, addresses, parameters and connections
        once it is ready.  Options default to those of the old drone.

        :param kind: kind of the new drone, or a Python file; "": that of the old one
        :param parameters: parameters of the new drone, in addition to those of the old one
        :param lose_state: replace even a stateful drone, without its state
        :param force: kill a drone that does not answer within 3 s or is of another version, and start a new one with its
            parameters and connections; other options get their defaults
        :param ready: how long it may take to become ready; until then the old one is unaffected
        :param options: those of :meth:`start` from ``halted`` to ``log_level``, for the new one
        :raises hive.Error: "not_found", "type_mismatch", "refused", "name_taken" if it is already being replaced,
            "timeout"; with the end of the log if the new one failed
        """
        options = {
            **options,
            "kind": os.fspath(kind),
            "parameters": dict(parameters or {}),
            "lose_state": lose_state,
            "force": force,
            "ready_ms": milliseconds(ready),
        }
        if "key" in options:
            options["key"] = os.fspath(options["key"])
        lib.hive_application_replace(self._handle, encoded(drone), as_json(options), None)

    # --- wire ---

    def connect(
        self,
        sender: Names,
        receiver: Names,
        *,
        stream: bool = False,
        notify: bool = False,
        window: Optional[int] = None,
        share: bool = False,
        group: str = "",
        first_frame: bool = False,
        lease: Optional[Seconds] = None,
        encoding: str = "",
    ) -> Union[tuple[str, str], list[tuple[str, str]]]:
        """Connects an output to an input, confirmed by both.  Returns the two ends: ("camera.image", "face.image").

        With lists or globs, connects every sender to every receiver, and returns a list.  If some fail, the others are
        connected anyway, and the error names those that failed.

        :param stream: send every event; otherwise the receiver gets the newest one when it is ready
        :param notify: headers only
        :param window: events to request ahead, 1 to 64
        :param share: the receivers share the events, one each: ``swarm.connect("camera", "face-*", share=True)``
        :param group: share with all receivers of this group; default with ``share``: the sender's name
        :param first_frame: start with the newest existing event
        :param lease: shared: how long a receiver may work on one event before another gets it
        :param encoding: of the bodies: "raw", "png", "jpeg", "jpeg:80"
        :raises hive.Error: "type_mismatch", "not_found", "invalid_argument" when several ports fit, "refused"
        """
        def connect(one: str, other: str) -> tuple[str, str]:
            shared = group or (self._drone_of(one) if share else "")
            options = _connection(stream, notify, window, shared, first_frame, lease, encoding)
            ends = ask_json(
                lib.hive_application_connect, self._handle, encoded(one), encoded(other), as_json(options)
            )
            return ends["sender"], ends["receiver"]

        if not (is_many(sender) or is_many(receiver)):
            return connect(str(sender), str(receiver))
        return self._each_pair(connect, self._ends(sender), self._ends(receiver))

    def disconnect(self, sender: Names, receiver: Names) -> None:
        """Ends a connection; with lists or globs, between every sender and every receiver.  If the receiver has exited,
        its sender forgets it."""
        def disconnect(one: str, other: str) -> None:
            lib.hive_application_disconnect(self._handle, encoded(one), encoded(other))

        self._each_pair(disconnect, self._ends(sender), self._ends(receiver))

    def _drone_of(self, end: str) -> str:
        """Of "camera.image"; a drone may have the whole name."""
        return end if end in self.drones() else end.rpartition(".")[0] or end

    def _each_pair(self, call: Callable[[str, str], Any], senders: list[str], receivers: list[str]) -> list[Any]:
        made, failed = [], []
        for sender in senders:
            for receiver in receivers:
                try:
                    made.append(call(sender, receiver))
                except Error as error:
                    failed.append((f"{sender} to {receiver}: {error.text}", error))
        if len(failed) == 1 and not made:
            raise failed[0][1]
        if failed:
            raise Error(failed[0][1].code, "; ".join(text for text, _ in failed), failed[0][1].advice)
        return made

    # --- configure ---

    def set(self, drone: Names, values: Optional[Mapping[str, Any]] = None, **parameters: Any) -> dict[str, Any]:
        """Sets parameters, all together or none: ``swarm.set("face", scale=1.05)``.  Returns the applied values.

        With a glob or several names: on all of these drones or on none; returns a dict by drone.

        :raises hive.Error: "refused" with the reason, "not_found"; on several drones :class:`hive.SetError`
        """
        wanted = as_json({**(values or {}), **parameters})
        if not is_many(drone):
            applied: dict[str, Any] = ask_json(
                lib.hive_application_set, self._handle, encoded(str(drone)), wanted
            )
            return applied
        result = ask_json(
            lib.hive_application_set_all,
            self._handle,
            as_json(self._named(drone)),
            wanted,
            _library.no_callback,
            None,
        )
        answers = {answer["drone"]: answer_of(answer) for answer in result["answers"]}
        errors = [answer for answer in answers.values() if isinstance(answer, Error)]
        if errors:
            # Those that were left as they were are "refused"; what went wrong may be something else.
            first = next((error for error in errors if error.code != "refused"), errors[0])
            raise SetError(first.code, "; ".join(error.text for error in errors), first.advice, result["changed"], answers) from None
        return answers

    def get(self, drone: Names, *names: str) -> dict[str, Any]:
        """The current values of all or of the named parameters.  With a glob or several drones: a dict by drone, with
        an :class:`Error` for one that does not answer."""
        wanted = as_json(list(names)) if names else None
        if not is_many(drone):
            values: dict[str, Any] = ask_json(lib.hive_application_get, self._handle, encoded(str(drone)), wanted)
            return values
        answers = ask_json(lib.hive_application_get_all, self._handle, as_json(self._named(drone)), wanted)
        return {answer["drone"]: answer_of(answer) for answer in answers}

    # --- collect ---

    def collect(
        self,
        *outputs: Names,
        ordered: bool = False,
        reorder_timeout: Seconds = 30.0,
        stream: bool = False,
        notify: bool = False,
        window: int = 64,
        first_frame: bool = False,
        encoding: str = "",
    ) -> Collector:
        """Receives from outputs: drones, globs or lists of them.  Returns when every drone has acknowledged.

        A wait of 3 s logs the stall reason to ``logging``, as "hive".

        :param ordered: results of each source in capture order, even from several workers
        :param reorder_timeout: ordered: how long a missing result delays those after it
        """
        connection = _connection(stream, notify, None if stream else window, "", first_frame, None, encoding)
        options = {"connection": connection, "ordered": ordered, "reorder_timeout_ms": milliseconds(reorder_timeout)}
        ends = self._ends(flat(*outputs))
        handle = ask_handle(lib.hive_application_collect, self._handle, as_json(ends), as_json(options))
        return Collector(handle, self._when_silent(ends, notify))

    def collect_matched(
        self,
        *outputs: Names,
        within: Optional[Seconds] = None,
        notify: bool = False,
        window: int = 64,
        encoding: str = "",
    ) -> MatchedCollector:
        """Receives sets of matching events, one of each of two or more outputs.

        :param within: None: events of one capture; otherwise the nearest in time, at most this many seconds apart
        """
        options = {"connection": _connection(notify=notify, window=window, encoding=encoding)}
        match = None if within is None else as_json({"tolerance_us": int(within * 1e6)})
        ends = self._ends(flat(*outputs))
        handle = ask_handle(
            lib.hive_application_collect_matched, self._handle, as_json(ends), match, as_json(options)
        )
        return MatchedCollector(handle, self._when_silent(ends, notify))

    def _when_silent(self, outputs: list[str], notify: bool) -> Callable[[], str]:
        """The stall reason."""
        wanted = as_json(outputs)

        def why() -> str:
            try:
                found = ask_object(lib.hive_application_explain, self._handle, wanted)
            except Error:
                return ""  # closed, or cancelled
            if notify and any(cause["what"] == "held" for cause in found["causes"]):
                return f"the source is on demand and waits for a receiver of bodies: {found['text']}"
            return str(found["text"])

        return why

    def results(
        self, *drones: Names, count: Optional[int] = None, timeout: Optional[Seconds] = None, ordered: bool = False
    ) -> Results:
        """The results of drones, one after the other: from the named output ("face.faces"), or from the only one with
        results in the header.  Iterate, with ``for`` or ``async for``.

        :param drones: names, globs, or lists of them
        :param count: number of results; None: unlimited
        :param timeout: how long to wait for each; then :class:`hive.Error` "timeout" is raised with the stall reason.
            A wait of 3 s logs it to ``logging``, as "hive".

        The loop ends when everything has ended.  If something is missing, it raises a :class:`hive.Error` "abandoned"
        with the reason.
        """
        if count is not None and not hasattr(count, "__index__"):
            raise Error("invalid_argument", f"count is a whole number, not {count!r}")
        if timeout is not None:
            milliseconds(timeout)  # refused here, not at the first result
        outputs = [name for drone in flat(*drones) for name in self._result_outputs(drone)]
        return Results(self.collect(outputs, ordered=ordered), ", ".join(outputs), count, timeout)

    def explain(self, *outputs: Names, sender: str = "", receiver: str = "") -> dict[str, Any]:
        """The causes of a stall, as `hivectl explain --json` prints them: "text" is one line, "" if nothing blocks the
        events; "causes" has "what", "text", "evidence" and "command" of each cause; "flows" the events per second.

        :param outputs: drones or outputs; without any, all drones
        :param sender: instead: the events from this drone or output to `receiver`, and whether the two are connected
        """
        if outputs and (sender or receiver):
            raise TypeError("explain is about outputs, or about a sender and a receiver")
        pair = {"sender": sender, "receiver": receiver}
        wanted = pair if sender or receiver else self._ends(flat(*outputs))
        return ask_object(lib.hive_application_explain, self._handle, as_json(wanted))

    def advise(self, *drones: Names, goal: str = "fps", time: float = 2) -> dict[str, Any]:
        """Where events spend their time and what would help, as `hivectl advise --json` prints it: "lines" have
        "stations", "limits", of which the first is the bottleneck, and "proposals" with "command" and
        "predicted_per_s".

        :param drones: the last drone of a pipeline, or the first and the last; without any, all pipelines
        :param goal: "fps", or "latency" (the age of events)
        :param time: seconds to measure
        """
        options = {"goal": goal, "time_ms": milliseconds(time)}
        return ask_object(lib.hive_application_advise, self._handle, as_json(flat(*drones)), as_json(options))

    def audit(self) -> dict[str, Any]:
        """Whether anything was lost: "clean"; "connections", each as `hivectl audit --json` prints it; "silent", the
        drones that did not answer."""
        return ask_object(lib.hive_application_audit, self._handle)

    def graph(self) -> dict[str, Any]:
        """The drones and connections of the swarm, as `hivectl graph --json` prints them: "drones" have "name", "host",
        "kind", "state" (also "silent", "crashed", "failed" and "gone") and "note"; "connections" have "from", "to", "group" and "connected"."""
        return ask_object(lib.hive_application_graph, self._handle)

    def metrics(self) -> list[dict[str, Any]]:
        """The counters of the swarm, as `hivectl metrics --json` prints them: each with "name", "type" ("counter",
        "gauge", "info" or "stateset"), "help", "unit" if it has one, and "samples": each with "labels", "value" and,
        of a counter, "created_us", the wall clock at which it was 0.  A name lacks the "_total" or "_info" of the text
        form.  A drone that does not answer has "hive_drone_up" 0 and nothing else."""
        return ask_list(lib.hive_application_metrics, self._handle)

    def failures(self, drone: str) -> list[dict[str, Any]]:
        """The failures of a drone that are kept on this machine, the newest last: "number", "time_us", "code" (of
        an error, or "died", "silent", "late"), "text", and "inputs", each with "input", "sender", "source", "seq",
        "type", "size" and "header".  The drone need not run."""
        return ask_list(lib.hive_application_failures, self._handle, encoded(drone))

    def rerun(
        self,
        drone: str,
        number: int = 0,
        *,
        kind: str = "",
        program: str = "",
        timeout: Seconds = 30.0,
        under: Sequence[str] = (),
        on: str = "",
        **parameters: Any,
    ) -> dict[str, Any]:
        """Reruns the inputs of a failure in a new drone of the same kind, outside of the swarm: "outcome" is "passed",
        "threw", "died" or "hung", "text" the details, "log" the end of its log, "unfit" how it differs from the drone
        of a file.

        :param drone: or a file of ``hivectl rerun --save``: a path with a slash, or NAME.failure
        :param number: of the failure, see :meth:`failures`; 0: the newest
        :param kind: a kind or a Python file; "": what the drone is or was
        :param program: of another build
        :param under: runs the drone under these words at this terminal, such as ``["gdb", "--args"]``
        :param on: the ssh host of the machine that keeps the failure
        :param parameters: beside those that the drone was given
        """
        options = {
            "kind": kind,
            "program": program,
            "parameters": parameters,
            "under": list(under),
            "limit_ms": milliseconds(timeout),
            "on": on,
        }
        return ask_object(lib.hive_application_rerun, self._handle, encoded(drone), number, as_json(options))

    def exceptions(self, *drones: Names) -> Collector:
        """Receives the exceptions of drones: events whose header has "code", "text", "policy", "input"."""
        return Collector(ask_handle(lib.hive_application_exceptions, self._handle, as_json(self._named(flat(*drones)))))

    def put(
        self, input: str, body: Union[bytes, bytearray, memoryview] = b"", type: str = "application/octet-stream",
        header: Optional[Mapping[str, Any]] = None,
    ) -> None:
        """Sends one event into an input; returns when the drone has taken it into its queue."""
        if getattr(body, "ndim", 1) > 1:
            shape = getattr(body, "shape", "")
            advice = 'encode it: put(..., cv2.imencode(".png", image)[1], "image/png")'
            raise Error("invalid_argument", f"a body is bytes, not an array of shape {shape}", advice)
        text, data = as_json(dict(header or {})), bytes(view_of(body))
        lib.hive_application_put(
            self._handle, encoded(input), text, len(text), data if data else None, len(data), encoded(type)
        )

    # --- control ---

    def halt(self, *drones: Names) -> None:
        """They take no more events until resumed."""
        for name in self._named(flat(*drones)):
            lib.hive_application_halt(self._handle, encoded(name))

    def resume(self, *drones: Names) -> None:
        for name in self._named(flat(*drones)):
            lib.hive_application_resume(self._handle, encoded(name))

    def stop(self, *drones: Names) -> None:
        """Stops drones, discards their saved state, and returns when they have exited."""
        for name in self._named(flat(*drones)):
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

        known = ask_list(lib.hive_swarm_remembered, self._handle)
        return [Swarm(told["text"], application=self, form_only=True) for told in known]

    def export(self, *drones: Names, name: Optional[str] = None) -> str:
        """What runs, as a swarm file: bringing it up changes nothing, and where nothing runs it makes the same swarm.

        :param drones: names and globs; none: those of the swarm of that name, or all if it was not brought up from here
        :param name: of the swarm; None: of the only one that was brought up from here, or "swarm"
        """
        wanted = as_json(self._named(flat(*drones))) if drones else None
        place, length = ctypes.c_void_p(), ctypes.c_size_t()
        lib.hive_swarm_running(self._handle, encoded(name), wanted, ctypes.byref(place), ctypes.byref(length))
        return _library.take_text(place, length.value) or ""

    # --- between drones and outputs ---

    def _result_outputs(self, drone: str) -> list[str]:
        found = []
        for name in self._ends(drone):
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
