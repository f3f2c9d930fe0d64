"""The exceptions of Hive."""

from __future__ import annotations

from typing import Any, Mapping


class Error(RuntimeError):
    """The error of a call, with a code that all parts of Hive share.

    ``code`` is one of the names of SPEC.md, section 7: "invalid_argument", "not_found", "unreachable",
    "connection_lost", "timeout", "refused", "type_mismatch", "halted", "locked", "name_taken", "not_permitted",
    "too_large", "malformed", "version_mismatch", "unsupported", "failed", "abandoned", "stopped", "io".  ``text`` is
    what happened, ``advice`` what can be done about it; ``str(error)`` has both.  Raise one in a callback to set the
    code of the drone's exception.
    """

    def __init__(self, code: str, text: str, advice: str = "") -> None:
        super().__init__(text)
        self.code = code
        self.text = text
        self.advice = advice

    def __str__(self) -> str:
        between = "\n" if "\n" in self.text else "; "  # behind the lines of a log it has one of its own
        return f"{self.text}{between}{self.advice}" if self.advice else self.text

    def __repr__(self) -> str:
        return f"hive.{type(self).__name__}({self.code!r}, {str(self)!r})"

    def __reduce__(self) -> Any:
        return (type(self), (self.code, self.text, self.advice))

    def _render_traceback_(self) -> list[str]:
        """For notebooks: the frames of the caller alone."""
        import traceback

        from ._tracebacks import without_package

        lines = traceback.format_exception(type(self), self, without_package(self.__traceback__))
        return "".join(lines).rstrip().split("\n")


class SetError(Error):
    """A set on several drones that did not change all of them.

    ``changed`` is "none" (each has its old values) or "unclear"; ``answers`` has for each drone the applied values, or
    the :class:`Error` with which it refused.
    """

    def __init__(self, code: str, text: str, advice: str = "", changed: str = "none", answers: Any = None) -> None:
        super().__init__(code, text, advice)
        self.changed = changed
        self.answers: dict[str, Any] = answers or {}

    def __reduce__(self) -> Any:
        return (type(self), (self.code, self.text, self.advice, self.changed, self.answers))


for _kind in (Error, SetError):
    _kind.__module__ = "hive"  # where users find it


def error_of(told: Mapping[str, str]) -> Error:
    """Of {"code", "text", "advice"}."""
    return Error(told["code"], told["text"], told["advice"])


def require_text(what: str, value: Any) -> str:
    if not isinstance(value, str):
        raise Error("invalid_argument", f"{what} is a text, not {value!r}")
    return value


def require_list(what: str, value: Any, example: str) -> Any:
    """Refuses a text instead of a list of texts: it would be split into letters."""
    if isinstance(value, (str, bytes)):
        raise Error("invalid_argument", f"{what} is a list, not the text {value!r}", f"write {what}={example}")
    return value
