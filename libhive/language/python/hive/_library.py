"""The C library behind this package: found, loaded, and its functions declared (see hive.h and hive_swarm.h)."""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import json
import os
import sys
import threading
import weakref
from typing import Any, Generator, Optional, TypeVar

from ._errors import Error

SONAME = "libhive-c.so.0"
_ABI = 6


def _load() -> ctypes.CDLL:
    """$HIVE_LIBRARY; beside this package (a wheel), in the lib folder of a build, or of the prefix into which both were
    installed; or where the system has libraries."""
    here = os.path.dirname(os.path.abspath(__file__))
    architecture = getattr(sys.implementation, "_multiarch", "")  # Debian's lib/x86_64-linux-gnu
    folders: tuple[list[str], ...] = ([], ["..", "..", "lib"], ["..", "..", "..", architecture])
    places = [os.path.normpath(os.path.join(here, *folder, SONAME)) for folder in folders]
    told = os.environ.get("HIVE_LIBRARY")
    found = [told] if told else [place for place in places if os.path.exists(place)]
    try:
        return ctypes.CDLL(found[0] if found else SONAME)
    except OSError as error:
        raise ImportError(
            f"hive: cannot load {SONAME}: {error}; install libhive0, or name the file in $HIVE_LIBRARY"
        ) from None


_library = _load()

callback = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p)
event_callback = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)
set_callback = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.POINTER(ctypes.c_void_p), ctypes.c_size_t)
main_callback = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int64))
end_callback = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_char_p)
body_callback = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.POINTER(ctypes.c_void_p))
encode_callback = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p
)
progress_callback = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t, ctypes.c_char_p
)
told_callback = end_callback
no_callback: Any = ctypes.cast(0, callback)
no_event_callback: Any = ctypes.cast(0, event_callback)
no_progress_callback: Any = ctypes.cast(0, progress_callback)
log_callback = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p)
leveled_log_callback = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p)

# One letter for each argument. Results: a code unless there is a second word.
_TYPES: dict[str, Any] = {
    "h": ctypes.c_void_p,  # a handle, or other memory
    "s": ctypes.c_char_p,
    "n": ctypes.c_size_t,
    "i": ctypes.c_int,
    "c": ctypes.c_int32,
    "l": ctypes.c_int64,
    "b": ctypes.c_bool,
    "P": ctypes.POINTER(ctypes.c_void_p),  # a place for a handle or a text
    "N": ctypes.POINTER(ctypes.c_size_t),
    "I": ctypes.POINTER(ctypes.c_int),
    "B": ctypes.POINTER(ctypes.c_bool),
    "D": ctypes.POINTER(ctypes.c_double),
    "Q": ctypes.POINTER(ctypes.c_int64),
    "A": ctypes.POINTER(ctypes.c_char_p),
    "f": callback,
    "F": event_callback,
    "S": set_callback,
    "M": main_callback,
    "L": log_callback,
    "V": leveled_log_callback,
    "E": end_callback,
    "G": body_callback,
    "C": encode_callback,
    "W": progress_callback,
}
_SIGNATURES = """
error_code - c|error_text - s|error_advice - s|fail cs c|code_token c s|code_sentence c s|code_advice c s
code_exit_code c i|version - s|abi_version - i|stack_descriptor - i|protocol_version - i|default_home P|retain h|release h|handle_count - n
free h -|event_info hPN|event_number hsQ|event_hop hnAQQ|event_header hPN|event_bytes hPN|event_body hP|event_done h|body_new hnP|body_over hnhhP
body_bytes hPN|body_foreign hB|loan_bytes hPN|loan_body hnP|drone_new sssP|drone_from_arguments sssiAPI
drone_on_log hLh|drone_on_leveled_log hVh|drone_name hP|drone_given hsPB|drone_parameter hs|drone_integer hsIss|drone_number hsDss
drone_flag hsBss|drone_text hsAss|drone_values hPN|drone_assign hs|drone_output hsssP|drone_encoded_output hssssChP
encoded_give hsnh|drone_on_event hsssFh|drone_on_matched hssSFhP|matching_rule hs|drone_on_change hfh
drone_on_start hfh|drone_on_end hEh|drone_main hMh|drone_describe hPN|drone_run h|drone_start h|drone_step hlB
drone_end h|drone_wake h|drone_stop h|drone_condition hss|drone_source_events hl|drone_report hcs|drone_log hs
drone_log_at hss|drone_stopping hB|drone_status hPN|output_wanted hB|output_received hB|output_asked hB|output_loan hnP
output_emit hsnhns|output_emit_body hsnhs|output_emit_made hsnGhs|output_emit_captured hlbsnhs
output_emit_captured_made hlbsnGhs|output_fail hlbcs|output_repeat hh|output_end hs|output_begin_source h
application_new sP|application_close h|application_name hP|application_timeout hl|application_drones hPN
application_remembered hPN|application_find hsPN|application_describe hsPN|application_status hsPN
application_status_all hsPN|application_place hsPN|application_places hPN|application_add_place hs
application_forget_place hs|application_wait hssl|application_connect hsssP|application_disconnect hss
application_set hssP|application_set_all hssfhP|application_get hssP|application_get_all hssP|application_collect hssP
application_collect_matched hsssP|application_exceptions hsP|application_put hssnhns|application_halt hs
application_resume hs|application_stop hs|application_exception_policy hss|on_wait fh|collector_next hlP
collector_next_set hlPnN|collector_counts hPN|collector_count hsQ|collector_inputs hPN|collector_ended hBP|collector_close h
swarm_check ssPN|swarm_schema PN|swarm_open hssP|swarm_close h|swarm_export hssPN|swarm_differences hPN
swarm_up hlWhPN|swarm_down hlWhPN|swarm_stay hEh|swarm_remembered hPN|swarm_running hssPN
application_replace hssP|application_start hssP|application_explain hsPN|application_advise hssPN
application_audit hPN|application_graph hPN|application_metrics hPN|application_failures hsPN|application_rerun hslsPN
"""


def _error() -> Error:
    """The last error on this thread."""
    token = _library.hive_code_token(_library.hive_error_code()) or b"failed"
    return Error(token.decode(), text_of(_library.hive_error_text()), text_of(_library.hive_error_advice()))


_raised: list[BaseException] = []  # by signal handlers, which run on the main thread


def _on_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()


def _check(code: int, _function: Any, _arguments: Any) -> int:
    if _raised and _on_main_thread():
        raised = _raised.pop()
        _raised.clear()  # of several, one is raised
        raise raised
    if code != 0:
        raise _error()
    return code


@contextlib.contextmanager
def keeping_raised() -> Generator[None, None, None]:
    """For a call that calls back: a signal can raise at the first or last instruction of a callback, outside of its
    try, and Python would only print that."""
    if not _on_main_thread():
        yield
        return
    print_it = sys.unraisablehook

    def keep(what: Any) -> None:
        if _on_main_thread() and what.exc_value and "ctypes callback" in (what.err_msg or ""):
            _raised.append(what.exc_value)
        else:
            print_it(what)

    sys.unraisablehook = keep
    try:
        yield
    finally:
        sys.unraisablehook = print_it
        _raised.clear()  # of several, one is raised


def _declare(line: str) -> None:
    name, arguments, *result = line.split()
    function = getattr(_library, "hive_" + name)
    function.argtypes = [_TYPES[letter] for letter in arguments if letter != "-"]
    if not result and arguments != "-":
        function.restype = ctypes.c_int32
        function.errcheck = _check
    elif result == ["-"]:
        function.restype = None
    else:
        function.restype = _TYPES[result[0]]


if _library.hive_abi_version() < _ABI:
    raise ImportError(f"hive: {SONAME} is older than this package")

for _line in _SIGNATURES.replace("\n", "|").split("|"):
    if _line:
        _declare(_line)

lib: Any = _library


def _looks_at_signals() -> Generator[int, None, None]:
    """Each look lets Python run the handlers of signals that have come.  What they raise is kept for the call that
    waits, which is told to wait no longer.  A generator, because it is inside of its try whenever it goes on."""
    while True:
        try:
            yield 1 if _raised else 0
        except GeneratorExit:
            return
        except BaseException as raised:
            trace = raised.__traceback__  # without this frame: who clears those of a traceback would end the looking
            _raised.append(raised.with_traceback(trace and trace.tb_next))
            del trace


def _see_signals() -> Any:
    """Has calls of this thread look while they wait."""
    looks = _looks_at_signals()
    next(looks)
    look = callback(looks.send)
    lib.hive_on_wait(look, None)
    return look


_look = _see_signals() if _on_main_thread() else None


def text_of(text: Optional[bytes]) -> str:
    return (text or b"").decode("utf-8", "replace")


def encoded(text: Optional[str]) -> Optional[bytes]:
    """A text for C. One with a zero byte would be cut short there."""
    if text is None:
        return None
    if not isinstance(text, str):
        raise Error("invalid_argument", f"a name is a text, not {text!r}")
    if "\0" in text:
        raise Error("invalid_argument", f"{text!r} contains a zero byte")
    return text.encode("utf-8", "replace")


def _plain(value: Any) -> Any:
    """NumPy's numbers and arrays, parameters, paths and the like, as JSON has them."""
    if type(value).__module__ == "hive.parameter":
        return value.value
    for convert in ("tolist", "__fspath__"):
        if hasattr(value, convert):
            return getattr(value, convert)()
    raise TypeError(f"a value of type {type(value).__name__}")


def as_json(value: Any) -> bytes:
    try:
        return json.dumps(value, default=_plain, allow_nan=False).encode()
    except (TypeError, ValueError) as error:
        raise Error("invalid_argument", f"this cannot travel as JSON: {error}") from None


def take_text(place: ctypes.c_void_p, length: Optional[int] = None) -> Optional[str]:
    """A text that the library has given, which is freed here; None for null."""
    if not place.value:
        return None
    try:
        raw = ctypes.string_at(place.value, -1 if length is None else length)
    finally:
        lib.hive_free(place)
    return raw.decode("utf-8", "replace")


def ask(function: Any, *arguments: Any) -> Any:
    """Calls a function that ends with (char** json, size_t* length), and reads the JSON."""
    place, length = ctypes.c_void_p(), ctypes.c_size_t()
    function(*arguments, ctypes.byref(place), ctypes.byref(length))
    return json.loads(take_text(place, length.value) or "null")


def ask_object(function: Any, *arguments: Any) -> dict[str, Any]:
    """The same for a JSON object."""
    answer: dict[str, Any] = ask(function, *arguments)
    return answer


def ask_list(function: Any, *arguments: Any) -> list[Any]:
    """The same for a JSON array."""
    answer: list[Any] = ask(function, *arguments)
    return answer


def ask_json(function: Any, *arguments: Any) -> Any:
    """Calls a function that ends with (char** json), and reads the JSON."""
    return json.loads(ask_text(function, *arguments) or "null")


def ask_text(function: Any, *arguments: Any) -> Optional[str]:
    """Calls a function that ends with (char** text)."""
    place = ctypes.c_void_p()
    function(*arguments, ctypes.byref(place))
    return take_text(place)


def ask_handle(function: Any, *arguments: Any) -> ctypes.c_void_p:
    """Calls a function that ends with a place for a handle."""
    place = ctypes.c_void_p()
    function(*arguments, ctypes.byref(place))
    return place


def ask_flag(function: Any, *arguments: Any) -> bool:
    place = ctypes.c_bool()
    function(*arguments, ctypes.byref(place))
    return place.value


def release(handle: Optional[ctypes.c_void_p]) -> None:
    """Releases a handle; for __del__, so it raises nothing. Ignores a handle of the process before a fork."""
    if handle and _library is not None and not is_inherited(handle):
        try:
            _library.hive_release(handle)
        except Error:
            pass


_first_own = 0  # handles count upwards: those below were made before this process was forked


def _count_handles() -> None:
    global _next_handle
    place = ctypes.c_void_p()
    _library.hive_body_new(None, 0, ctypes.byref(place))
    _next_handle = place.value or 0
    _library.hive_release(place)


def _own_nothing() -> None:
    global _first_own
    _first_own = _next_handle
    _living.clear()


def is_inherited(handle: ctypes.c_void_p) -> bool:
    return (handle.value or 0) < _first_own


class Owner:
    """What has a handle, which is of no use in a process that was forked from the one that made it: the threads behind
    it are not there."""

    _kept: Optional[ctypes.c_void_p] = None

    @property
    def _handle(self) -> Optional[ctypes.c_void_p]:
        kept = self._kept
        if _first_own and kept is not None and is_inherited(kept):
            name = f"this hive.{type(self).__name__}"
            raise Error("invalid_argument", f"{name} was made before the process forked", "make a new one in the child")
        return kept

    @_handle.setter
    def _handle(self, handle: Optional[ctypes.c_void_p]) -> None:
        self._kept = handle


Closable = TypeVar("Closable", bound="Closing")


class Closing:
    """Closes at the end of ``with`` and ``async with``."""

    def close(self) -> None:
        """Ends its use.  Idempotent."""
        raise NotImplementedError

    def __enter__(self: Closable) -> Closable:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    async def __aenter__(self: Closable) -> Closable:
        return self

    async def __aexit__(self, *_: Any) -> None:
        import asyncio

        await asyncio.to_thread(self.close)


def _codes() -> dict[str, int]:
    tokens = {}
    for code in range(1, 256):
        token = lib.hive_code_token(code)
        if token is None:
            break
        tokens[token.decode()] = code
    return tokens


codes: dict[str, int] = _codes()


def code_of(token: str) -> int:
    return codes.get(token, codes["failed"])


version: str = text_of(lib.hive_version())


def protocol_version() -> int:
    """The version of the protocol; modules with different ones refuse each other."""
    return int(lib.hive_protocol_version())


def default_home() -> str:
    """The runtime directory, where drones of this machine connect: $HIVE_HOME, or $XDG_RUNTIME_DIR/hive, or
    /tmp/hive-UID."""
    return ask_text(lib.hive_default_home) or ""


_living: weakref.WeakSet[Any] = weakref.WeakSet()


def ends_at_exit(thing: Any) -> None:
    """Ends the threads of the library before the process exits."""
    _living.add(thing)


_next_handle = 0
if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_count_handles, after_in_child=_own_nothing)


@atexit.register
def _end_all() -> None:
    for thing in list(_living):
        thing._at_exit()
