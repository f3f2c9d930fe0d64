"""What a drone declares beside its callbacks: parameters, and which events belong together."""

from __future__ import annotations

import ctypes
from typing import Any, Generic, Optional, TypeVar

from ._errors import Error
from ._library import as_json, lib, release

Value = TypeVar("Value", int, float, bool, str)
Seconds = float


class Parameter(Generic[Value]):
    """A value that applications may set while the drone runs; between two callbacks it does not change."""

    def __init__(self, name: str, default: Value) -> None:
        self.name = name
        #: What it is now.  In on_start and on_change it may be changed; what it is when they return is what
        #: applications are told.
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
        lib.hive_matching_rule(self._handle, match_of(within))


def match_of(within: Optional[Seconds]) -> Optional[bytes]:
    return None if within is None else as_json({"tolerance_us": int(within * 1e6)})


def type_of(default: Any) -> str:
    """bool first: it is an int as well."""
    for kind, name in ((bool, "flag"), (int, "integer"), (float, "number"), (str, "text")):
        if isinstance(default, kind):
            return name
    raise Error("invalid_argument", f"a parameter is an int, a float, a bool or a str, not {default!r}")
