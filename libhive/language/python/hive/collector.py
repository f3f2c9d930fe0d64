"""Collectors: receive events one by one, or in matched sets."""

from __future__ import annotations

import ctypes
import operator
import time
from typing import Any, Callable, Generic, Iterator, NamedTuple, Optional, Sequence, Tuple, TypeVar

from . import _library
from ._errors import Error
from ._library import Closing, Owner, ask_list, ask_object, lib, release
from .event import Event

Seconds = float
SLICE = 0.1  # how soon Ctrl-C is seen during a wait
SILENCE = 3.0  # after which the stall reason is logged, as by hivectl
_MOST_IN_SET = 64


class Counts(NamedTuple):
    """The counters of a collector."""

    received: int
    duplicates: int  #: second answers, refused
    missing: int  #: results of shared work that never came
    failed: int  #: reported as exceptions instead
    dropped: int  #: not taken in time


class SetCounts(NamedTuple):
    """The counters of a collector of sets: :class:`Counts` of its events, and of their sets."""

    received: int
    duplicates: int
    missing: int
    failed: int
    dropped: int
    sets: int  #: complete
    waiting: int  #: events whose partners may still come
    unmatched: int  #: events whose partners did not come


def milliseconds(seconds: float) -> int:
    try:
        return max(0, int(min(operator.mul(seconds, 1.0), 24 * 3600) * 1000 + 0.999))
    except (TypeError, ValueError):
        raise Error("invalid_argument", f"a time is a number of seconds, not {seconds!r}") from None


class _Silence:
    """Logs the stall reason once per wait."""

    def __init__(self, why: Callable[[], str]) -> None:
        self._why = why
        self._begun = time.monotonic()
        self._said = False

    def due(self) -> bool:
        return not self._said and time.monotonic() - self._begun >= SILENCE

    def say(self) -> None:
        self._said = True
        if text := self._why():
            import logging

            logging.getLogger("hive").warning("no events: %s", text)


Item = TypeVar("Item")
Self = TypeVar("Self", bound="_Iterated[Any]")


class _Iterated(Generic[Item]):
    """Iterates with ``for`` and ``async for``, until there is no following item."""

    def _following(self) -> Optional[Item]:
        raise NotImplementedError

    async def _following_async(self) -> Optional[Item]:
        raise NotImplementedError

    def __iter__(self: Self) -> Self:
        return self

    def __next__(self) -> Item:
        item = self._following()
        if item is None:
            raise StopIteration
        return item

    def __aiter__(self: Self) -> Self:
        return self

    async def __anext__(self) -> Item:
        item = await self._following_async()
        if item is None:
            raise StopAsyncIteration
        return item


class _Collecting(Owner, Closing, _Iterated[Item]):
    """What both kinds of collectors have: waiting in slices, so that Ctrl-C is seen, and asyncio."""

    def __init__(
        self,
        handle: ctypes.c_void_p,
        why: Callable[[], str] = lambda: "",
    ) -> None:
        self._handle = handle
        self._why = why  # why nothing comes
        self._executor: Any = None
        self._pending: Any = None  # a wait of asyncio: one that was cancelled goes on, and may have taken something
        self._last: Sequence[Event] = ()

    def __del__(self) -> None:
        release(self._kept)

    def _following(self) -> Optional[Item]:
        return self._next(None)

    async def _following_async(self) -> Optional[Item]:
        return await self._next_async()

    def _take(self, seconds: float) -> Optional[Item]:
        raise NotImplementedError

    def _hand_out(self, taken: Any) -> Optional[Item]:
        self._last = () if taken is None else (taken,) if isinstance(taken, Event) else taken
        return taken  # type: ignore[no-any-return]

    def _go_on(self) -> None:
        """Asking for the next event releases the last one."""
        for event in self._last:
            event._left()
        self._last = ()

    def _next(self, timeout: Optional[Seconds]) -> Optional[Item]:
        self._go_on()
        end = None if timeout is None else time.monotonic() + timeout
        pending, self._pending = self._pending, None
        taken = pending.result() if pending is not None else None
        if taken is not None:
            return self._hand_out(taken)
        silence = _Silence(self._why)
        while True:
            left = SLICE if end is None else min(SLICE, max(0.0, end - time.monotonic()))
            taken = self._take(left)
            if taken is not None or (end is not None and time.monotonic() >= end) or self.ended is not None:
                return self._hand_out(taken)
            if silence.due():
                silence.say()

    async def _next_async(self, timeout: Optional[Seconds] = None) -> Optional[Item]:
        import asyncio
        from concurrent.futures import ThreadPoolExecutor

        self._go_on()
        end = None if timeout is None else time.monotonic() + timeout
        silence = _Silence(self._why)
        while True:
            if self._executor is None:
                self._executor = ThreadPoolExecutor(1, "hive-collector")
            if self._pending is None:
                self._pending = self._executor.submit(self._take, SLICE)
            pending = self._pending
            try:
                taken = await asyncio.shield(asyncio.wrap_future(pending))
            except Error:
                self._pending = None
                raise
            if self._pending is not pending:
                continue  # another task had it
            self._pending = None
            late = end is not None and time.monotonic() >= end
            if taken is not None or late or self.ended is not None:
                return self._hand_out(taken)
            if silence.due():
                await asyncio.wrap_future(self._executor.submit(silence.say))

    @property
    def ended(self) -> Optional[str]:
        """What is missing, or "", once all outputs have ended and every event was taken.  None before, and again if
        another event arrives."""
        over, text = ctypes.c_bool(), ctypes.c_void_p()
        lib.hive_collector_ended(self._handle, ctypes.byref(over), ctypes.byref(text))
        return _library.take_text(text) if over.value else None

    def counts(self) -> dict[str, Any]:
        """The counters so far: "received", "duplicates" (rejected), "missing", "failed", "dropped" (not taken in time);
        of sets also "sets": {"sets", "waiting", "unmatched", "missing"}."""
        return ask_object(lib.hive_collector_counts, self._handle)

    def _numbers(self, names: Sequence[str]) -> Iterator[int]:
        value = ctypes.c_int64()
        for name in names:
            lib.hive_collector_count(self._handle, name.encode(), ctypes.byref(value))
            yield value.value

    def inputs(self) -> list[dict[str, Any]]:
        """This end of each connection: "input", "from" ("camera.image"), "connected", "received", "queued", "dropped",
        "last_age_us", "error", "why", ... (SPEC.md, section 6.4); values that are 0, false or empty are omitted."""
        return ask_list(lib.hive_collector_inputs, self._handle)

    def close(self) -> None:
        """Stops receiving.  Idempotent."""
        self._go_on()
        lib.hive_collector_close(self._handle)
        self._pending = None
        executor, self._executor = self._executor, None
        if executor is not None:
            executor.shutdown(wait=False)


class Collector(_Collecting[Event]):
    """Receives events; connections that end are made again by themselves.  Iterate, with ``for`` or ``async for``:
    the event of one round is done when the next one is asked for (see :meth:`Event.hold`)."""

    @property
    def counters(self) -> Counts:
        """The numbers of :meth:`counts` as attributes: ``collector.counters.received``."""
        return Counts(*self._numbers(Counts._fields))

    def next(self, timeout: Optional[Seconds] = None) -> Optional[Event]:
        """The next event; None if none came within ``timeout`` (None: waits forever), or everything has ended."""
        return self._next(timeout)

    def _take(self, seconds: float) -> Optional[Event]:
        place = ctypes.c_void_p()
        lib.hive_collector_next(self._handle, milliseconds(seconds), ctypes.byref(place))
        return Event(place) if place.value else None


class MatchedCollector(_Collecting[Tuple[Event, ...]]):
    """Receives sets of matching events: tuples of one event of each output, in their order."""

    @property
    def counters(self) -> SetCounts:
        """The numbers of :meth:`counts` as attributes: ``collector.counters.sets``."""
        return SetCounts(*self._numbers(SetCounts._fields))

    def next(self, timeout: Optional[Seconds] = None) -> Optional[tuple[Event, ...]]:
        """The next set; None if none was complete within ``timeout`` (None: waits forever), or everything has ended."""
        return self._next(timeout)

    def _take(self, seconds: float) -> Optional[tuple[Event, ...]]:
        places = (ctypes.c_void_p * _MOST_IN_SET)()
        count = ctypes.c_size_t()
        lib.hive_collector_next_set(
            self._handle, milliseconds(seconds), places, _MOST_IN_SET, ctypes.byref(count)
        )
        events = tuple(Event(ctypes.c_void_p(places[i])) for i in range(count.value))
        return events or None


class Results(Closing, _Iterated[Event]):
    """The results of drones, one after the other; see :meth:`Application.results`.  Iterate, with ``for`` or ``async
    for``."""

    def __init__(self, collector: Collector, names: str, count: Optional[int], timeout: Optional[Seconds]) -> None:
        self._collector = collector
        self._names = names
        self._left = count
        self._timeout = timeout

    @property
    def counters(self) -> Counts:
        """The counters until now; see :class:`Counts`."""
        return self._collector.counters

    def close(self) -> None:
        """Stops receiving, as the end of the loop does."""
        self._collector.close()

    def _following(self) -> Optional[Event]:
        event = None if self._left == 0 else self._collector.next(self._timeout)
        if event is None:
            self._end()
        return self._counted(event)

    async def _following_async(self) -> Optional[Event]:
        import asyncio

        event = None if self._left == 0 else await self._collector._next_async(self._timeout)
        if event is None:
            await asyncio.to_thread(self._end)
        return self._counted(event)

    def _counted(self, event: Optional[Event]) -> Optional[Event]:
        if self._left:
            self._left -= 1
        return event

    def _end(self) -> None:
        """Raises what ends the loop before its time."""
        if self._left == 0:
            return self.close()
        lacking = self._collector.ended
        if lacking is None:
            text = f"no result of {self._names} within {self._timeout} s"
            raise Error("timeout", text, self._collector._why() or "see what is connected: hivectl connections")
        self._left = 0
        self.close()
        if lacking:
            raise Error("abandoned", lacking)
