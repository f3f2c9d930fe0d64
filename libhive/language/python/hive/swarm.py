"""Whole swarms: reads, checks, starts, stops and exports swarm files."""

from __future__ import annotations

import ctypes
import json
import os
from typing import TYPE_CHECKING, Any, Callable, Mapping, NamedTuple, Optional, Sequence, Union

from . import _library
from ._errors import Error, error_of
from ._library import Closing, Owner, as_json, ask, ask_handle, ask_list, code_of, encoded, lib, release
from .collector import Seconds, milliseconds

if TYPE_CHECKING:
    from .application import Application

Source = Union[str, os.PathLike[str], Mapping[str, Any]]
Progress = Callable[[int, int, str], Any]


class Mistake(NamedTuple):
    """A mistake in a swarm file, or a part that could not be checked, with its position."""

    line: int  #: from 1
    column: int  #: from 1, in characters
    at: str  #: "drones.face.set.scale"; "": the file as a whole
    text: str
    advice: str
    file: str = ""  #: an included one; "": the file itself

    def __str__(self) -> str:
        return (f"{self.file}:" if self.file else "") + f"{self.line}:{self.column}: {self.text}" + (f"; {self.advice}" if self.advice else "")


class SwarmFileError(Error):
    """A swarm file with mistakes: ``mistakes`` has all of them."""

    def __init__(self, code: str, text: str, advice: str = "", mistakes: Sequence[Mistake] = ()) -> None:
        super().__init__(code, text, advice)
        self.mistakes: list[Mistake] = list(mistakes)

    def __reduce__(self) -> Any:
        return (type(self), (self.code, self.text, self.advice, self.mistakes))


class SwarmError(Error):
    """A swarm that could not be brought up, and was not changed, or could not be taken down.

    ``failures`` has the :class:`Error` of each failed drone, ``remains`` those of changes that could not be rolled
    back.
    """

    def __init__(
        self, code: str, text: str, advice: str = "", failures: Any = None, remains: Any = None
    ) -> None:
        super().__init__(code, text, advice)
        self.failures: dict[str, Error] = failures or {}
        self.remains: dict[str, Error] = remains or {}

    def __reduce__(self) -> Any:
        return (type(self), (self.code, self.text, self.advice, self.failures, self.remains))


for _kind in (SwarmFileError, SwarmError):
    _kind.__module__ = "hive"  # where users find it


class ExportedFile(NamedTuple):
    """A file for a service manager; see :meth:`Swarm.export`."""

    name: str  #: of several machines in a folder for each: "cam1/hive-doorway.target"
    text: str
    program: bool  #: to be made executable

    def write(self, folder: Union[str, os.PathLike[str]]) -> str:
        """Writes it into a folder, which is created if missing.  Returns its path."""
        path = os.path.join(folder, self.name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.text)
        if self.program:
            os.chmod(path, os.stat(path).st_mode | 0o111)
        return path


class Swarm(Owner, Closing):
    """The drones, parameters and connections of a swarm file (libhive/docs/swarm-file.md).

    Drone programs are found in $HIVE_DRONE_PATH and $PATH.  Calls that need a valid file raise :class:`SwarmFileError`
    otherwise.

    :param source: a path, a dict with the content of the file, or its text, which starts with "{" or has several lines
    :param application: the application to use; None: a new ``hive.Application()``
    :param variables: values for variables of the file
    :param form_only: do not query programs for their ports and parameters, which are then not checked
    :raises OSError: the file cannot be read
    """

    def __init__(
        self,
        source: Source,
        *,
        application: Optional[Application] = None,
        form_only: bool = False,
        variables: Optional[dict[str, Any]] = None,
    ) -> None:
        self._handle = None
        self._application = application
        self._options = {
            "form_only": form_only,
            "folder": _folder_of(source),
            "variables": variables or {},
        }
        self._own: Optional[Application] = None
        #: Its file.
        self.text = _text_of(source)
        #: What the last :meth:`check` could not look at, and why.
        self.notes: list[Mistake] = []

    def __del__(self) -> None:
        release(self._kept)

    def __repr__(self) -> str:
        return f"<hive.Swarm {self.name}>"

    def close(self) -> None:
        """Ends :meth:`stay` of other threads; the drones keep running.  Idempotent."""
        if self._handle:
            lib.hive_swarm_close(self._handle)
        if self._own:
            self._own.close()

    @property
    def name(self) -> str:
        """Its name in the file; "" if it cannot be read."""
        try:
            options = as_json({**self._options, "form_only": True})
            return str(ask(lib.hive_swarm_check, encoded(self.text), options)["swarm"])
        except Error:
            return ""

    def check(self, timeout: Seconds = 10.0) -> list[Mistake]:
        """Checks the file without starting anything; no mistakes: it is valid.

        :param timeout: for the programs on this machine to describe their ports and parameters
        """
        options = as_json({**self._options, "timeout_ms": milliseconds(timeout)})
        told = ask(lib.hive_swarm_check, encoded(self.text), options)
        self.notes = [Mistake(**note) for note in told["notes"]]
        return [Mistake(**mistake) for mistake in told["mistakes"]]

    def differences(self) -> list[dict[str, Any]]:
        """What :meth:`up` would do now: "step" ("start", "restart", "change", "set", "connect", "disconnect" or
        "stop"), "drone" and "what", a text; of a restart, a change and a set also "values" and "before", of connections
        "sender", "receiver", "options".

        :raises hive.Error: "name_taken" if a name belongs to another kind of drone, or to one on another machine, that
            this swarm did not have before; "refused" if an engine cannot start a drone from here
        """
        steps: list[dict[str, Any]] = ask(lib.hive_swarm_differences, self._opened())
        return steps

    def up(self, timeout: Seconds = 60.0, progress: Optional[Progress] = None) -> list[dict[str, Any]]:
        """Starts missing drones, restarts those that only a new process can change, waits until they answer, then
        changes, sets, connects, disconnects and stops what differs: all or nothing.  Returns what was done, in the form
        of :meth:`differences`; a second call does nothing.

        Ctrl-C, or an exception of ``progress``, is raised after all changes are rolled back.

        :param timeout: for all drones to be ready
        :param progress: ``progress(done, all, what)`` is called with the progress; it must not call this application
        :raises SwarmError: nothing was changed; see its ``failures``
        """
        steps: list[dict[str, Any]] = self._work(lib.hive_swarm_up, timeout, progress)
        return steps

    def down(self, timeout: Seconds = 10.0, progress: Optional[Progress] = None) -> list[str]:
        """Stops all drones: sources first, then each drone once its events are delivered.  Returns their names.  After
        Ctrl-C they stop at once.

        :param timeout: for events in flight; then they are lost
        :raises SwarmError: some could not be stopped
        """
        return [step["drone"] for step in self._work(lib.hive_swarm_down, timeout, progress)]

    def stay(self, told: Optional[Callable[[str], Any]] = None) -> None:
        """Restarts crashed drones with "restart", at most 5 times within 60 s each, until Ctrl-C or :meth:`close`; the
        swarm keeps running then.  Stopped drones stay down until the next up.  Meanwhile other calls of its application
        wait.

        :param told: is called with a sentence for each change; None: ``logging`` gets it, as "hive.NAME"
        :raises hive.Error: "stopped" after close()
        """
        tell = told or _logger(self.name)
        left: list[BaseException] = []

        def hear(_: Any, text: bytes) -> int:
            return _kept(left, tell, _library.text_of(text))

        try:
            with _library.keeping_raised():
                lib.hive_swarm_stay(self._opened(), _library.told_callback(hear), None)
        except Error:
            if left:
                raise left[0] from None
            raise

    def export(self, form: str, *, programs: str = "", image: str = "") -> list[ExportedFile]:
        """Writes it for a service manager; each drone's command line alone restores its parameters and connections.
        The first file says how to use them.

        :param form: "systemd", "compose", "kubernetes", "slurm" or "shell"
        :param programs: the folder of the drones' programs; "": "/usr/bin"
        :param image: of containers; "": "hive:latest"
        """
        options = as_json({"programs": programs, "image": image})
        files = ask(lib.hive_swarm_export, self._opened(), encoded(form), options)
        return [ExportedFile(**file) for file in files]

    def _opened(self) -> ctypes.c_void_p:
        """The handle, once the file is right."""
        if self._handle is None:
            if self._application is None:
                from .application import Application

                self._application = self._own = Application()
            try:
                self._handle = ask_handle(
                    lib.hive_swarm_open, self._application._handle, encoded(self.text), as_json(self._options)
                )
            except Error as error:
                if error.code == "invalid_argument":
                    raise SwarmFileError(error.code, error.text, error.advice, self.check()) from None
                raise
        return self._handle

    def _work(self, function: Any, timeout: Seconds, progress: Optional[Progress]) -> Any:
        """The steps.  What an interruption leaves behind is raised after it was undone."""
        left: list[BaseException] = []

        def hear(_: Any, done: int, of: int, what: bytes) -> int:
            return _kept(left, progress, done, of, _library.text_of(what))

        call = _library.progress_callback(hear) if progress else _library.no_progress_callback
        place, length = ctypes.c_void_p(), ctypes.c_size_t()
        places = ctypes.byref(place), ctypes.byref(length)
        try:
            with _library.keeping_raised():
                function(self._opened(), milliseconds(timeout), call, None, *places)
        except BaseException as interruption:
            if not place.value:
                raise
            left.append(interruption)
        outcome = json.loads(_library.take_text(place, length.value) or "{}")
        problem = _problem(outcome)
        if left:
            raise left[0] from (problem if problem and problem.remains else None)
        if problem:
            raise problem
        return outcome["steps"]


def _is_text(source: Source) -> bool:
    return isinstance(source, str) and (source.lstrip().startswith("{") or "\n" in source)


def _folder_of(source: Source) -> str:
    if isinstance(source, Mapping) or _is_text(source):
        return "."
    return os.path.dirname(source) or "."


def _text_of(source: Source) -> str:
    if isinstance(source, Mapping):
        return as_json(dict(source)).decode()
    if _is_text(source):
        return str(source)
    with open(source, encoding="utf-8") as file:
        return file.read()


def _logger(name: str) -> Callable[[str], Any]:
    import logging

    logger = logging.getLogger("hive." + name)
    return lambda text: logger.warning("%s", text)


def _kept(left: list[BaseException], function: Any, *arguments: Any) -> int:
    """Calls what must not raise into C; what it raises is kept, and C is told to go no further."""
    try:
        function(*arguments)
        return 0
    except BaseException as raised:
        left.append(raised)
        return code_of("stopped")


def _problem(outcome: Mapping[str, Any]) -> Optional[SwarmError]:
    failures, remains = (
        {failure["drone"]: error_of(failure["error"]) for failure in outcome[part]} for part in ("failures", "remains")
    )
    texts = [f"{drone}: {error.text}" for drone, error in failures.items()]
    texts += [f"{drone} was not undone: {error.text}" for drone, error in remains.items()]
    for error in (*failures.values(), *remains.values()):
        return SwarmError(error.code, "; ".join(texts), error.advice, failures, remains)
    return None
