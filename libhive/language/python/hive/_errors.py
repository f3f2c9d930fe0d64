"""What Hive raises."""

from __future__ import annotations

from typing import Any, Mapping


class Error(RuntimeError):
    """Why something failed, in the words that every part of Hive uses.

    ``code`` is one of the names of SPEC.md, section 7: "invalid_argument", "not_found", "unreachable",
    "connection_lost", "timeout", "refused", "type_mismatch", "halted", "locked", "name_taken", "not_permitted",
    "too_large", "malformed", "version_mismatch", "unsupported", "failed", "abandoned", "stopped", "io".
    ``advice`` says what can be done about it.  Raise one in a callback to give the drone's exception a code of its own.
    """

    def __init__(self, code: str, text: str, advice: str = "") -> None:
        super().__init__(text)
        self.code = code
        self.advice = advice

    def __str__(self) -> str:
        return str(self.args[0])

    def __repr__(self) -> str:
        return f"hive.Error({self.code!r}, {str(self)!r})"

    def __reduce__(self) -> Any:
        return (type(self), (self.code, str(self), self.advice))


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
        return (type(self), (self.code, str(self), self.advice, self.changed, self.answers))


def error_of(told: Mapping[str, str]) -> Error:
    """Of {"code", "text", "advice"}."""
    return Error(told["code"], told["text"], told["advice"])
