"""Declarations of a drone: parameters and matching."""

from __future__ import annotations

import ctypes
import operator
from typing import Any, Callable, Generic, Optional, TypeVar

from ._errors import Error
from ._library import as_json, lib, release

Value = TypeVar("Value", int, float, bool, str)
Seconds = float


def value_of(thing: Any) -> Any:
    """Of a parameter its value; anything else is itself."""
    return thing.value if isinstance(thing, Parameter) else thing


def _binary(function: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    return lambda self, other: function(self.value, value_of(other))


def _reflected(function: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    return lambda self, other: function(other, self.value)


def _unary(function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda self: function(self.value)


class Parameter(Generic[Value]):
    """A value that applications may set while the drone runs; it changes only between two callbacks.

    It counts, compares and formats as its :attr:`value`: ``if invert:``, ``2 * low``, ``f"{scale:.2f}"``.  Give
    ``low.value`` to functions that check types.
    """

    __hash__ = None  # type: ignore[assignment]  # its value changes

    def __init__(self, name: str, default: Value) -> None:
        self.name = name
        #: What it is now.  In on_start and on_change it may be changed; what it is when they return is what
        #: applications are told.
        self.value: Value = default

    def __repr__(self) -> str:
        return f"<hive.Parameter {self.name}={self.value!r}>"

    def __format__(self, form: str) -> str:
        return format(self.value, form)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name in ("name", "value"):  # the last two before __init__ has run
            raise AttributeError(name)
        raise AttributeError(f"a hive.Parameter has no {name!r}; its value is {self.name}.value")

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in ("name", "value", "__orig_class__"):
            raise AttributeError(f"a hive.Parameter has no {name!r}; its value is {self.name}.value")
        object.__setattr__(self, name, value)

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any, **more: Any) -> Any:
        """Arrays compare and count with its value."""
        return getattr(function, method)(*map(value_of, inputs), **more)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> Any:
        import numpy

        return numpy.asarray(self.value, dtype)

    def __round__(self, digits: Optional[int] = None) -> Any:
        value: Any = self.value
        return round(value, digits)

    __str__ = _unary(str)
    __bool__ = _unary(bool)
    __int__ = _unary(int)
    __float__ = _unary(float)
    __index__ = _unary(operator.index)
    __len__ = _unary(len)
    __neg__ = _unary(operator.neg)
    __pos__ = _unary(operator.pos)
    __abs__ = _unary(abs)
    __contains__ = _binary(operator.contains)
    __eq__ = _binary(operator.eq)
    __ne__ = _binary(operator.ne)
    __lt__ = _binary(operator.lt)
    __le__ = _binary(operator.le)
    __gt__ = _binary(operator.gt)
    __ge__ = _binary(operator.ge)
    __add__, __radd__ = _binary(operator.add), _reflected(operator.add)
    __sub__, __rsub__ = _binary(operator.sub), _reflected(operator.sub)
    __mul__, __rmul__ = _binary(operator.mul), _reflected(operator.mul)
    __truediv__, __rtruediv__ = _binary(operator.truediv), _reflected(operator.truediv)
    __floordiv__, __rfloordiv__ = _binary(operator.floordiv), _reflected(operator.floordiv)
    __mod__, __rmod__ = _binary(operator.mod), _reflected(operator.mod)
    __pow__, __rpow__ = _binary(operator.pow), _reflected(operator.pow)


class Matching:
    """The matching of some inputs; see :meth:`Drone.on_matched`."""

    def __init__(self, handle: ctypes.c_void_p) -> None:
        self._handle = handle

    def __del__(self) -> None:
        release(self._handle)

    def rule(self, within: Optional[Seconds] = None) -> None:
        """Changes the rule, also for waiting events; None: events of one capture."""
        lib.hive_matching_rule(self._handle, match_of(within))


def match_of(within: Optional[Seconds]) -> Optional[bytes]:
    return None if within is None else as_json({"tolerance_us": int(within * 1e6)})


def type_of(default: Any) -> str:
    """bool first: it is an int as well."""
    for kind, name in ((bool, "flag"), (int, "integer"), (float, "number"), (str, "text")):
        if isinstance(default, kind):
            return name
    raise Error("invalid_argument", f"a parameter is an int, a float, a bool or a str, not {default!r}")
