"""Tracebacks end in the code of the caller: the frames of this package say nothing about it."""

from __future__ import annotations

import os
import sys
import threading
import types
from typing import Any, Optional

from ._errors import Error

_HERE = os.path.dirname(os.path.abspath(__file__)) + os.sep


def _is_own(trace: types.TracebackType) -> bool:
    return os.path.abspath(trace.tb_frame.f_code.co_filename).startswith(_HERE)


def without_package(trace: Optional[types.TracebackType]) -> Optional[types.TracebackType]:
    """The same without the frames of this package; all of it when nothing would be left."""
    frames = []
    step = trace
    while step is not None:
        if not _is_own(step):
            frames.append(step)
        step = step.tb_next
    kept: Optional[types.TracebackType] = None
    for frame in reversed(frames):
        kept = types.TracebackType(kept, frame.tb_frame, frame.tb_lasti, frame.tb_lineno)
    return kept or trace


def ends_in_package(trace: Optional[types.TracebackType]) -> bool:
    """Was it raised by this package, and not by the code of its user?"""
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return trace is not None and _is_own(trace)


def _shorten(error: Optional[BaseException]) -> None:
    if isinstance(error, Error):
        error.__traceback__ = without_package(error.__traceback__)


def install() -> None:
    """Has uncaught errors shown so, by whatever shows them now."""
    shown, shown_in_thread = sys.excepthook, threading.excepthook

    def hook(kind: type[BaseException], error: BaseException, trace: Optional[types.TracebackType]) -> None:
        _shorten(error)
        shown(kind, error, error.__traceback__ if isinstance(error, Error) else trace)

    def hook_in_thread(arguments: Any) -> None:
        _shorten(arguments.exc_value)
        if isinstance(arguments.exc_value, Error):
            words = (arguments.exc_type, arguments.exc_value, arguments.exc_value.__traceback__, arguments.thread)
            arguments = threading.ExceptHookArgs(words)
        shown_in_thread(arguments)

    sys.excepthook, threading.excepthook = hook, hook_in_thread
