"""Finds drones, their addresses and their status."""

from __future__ import annotations

from typing import Any, Mapping, Sequence, Union

from ._errors import Error, error_of
from ._library import Owner, as_json, ask_list, ask_object, encoded, lib
from .collector import Seconds, milliseconds

Names = Union[str, Sequence[str]]


def flat(*names: Names) -> list[str]:
    """Names and lists of them as one list."""
    found: list[str] = []
    for name in names:
        if isinstance(name, str):
            found.append(name)
        elif isinstance(name, bytes) or not hasattr(name, "__iter__"):
            raise Error("invalid_argument", f"a drone is called by its name, not {name!r}")
        else:
            found += flat(*name)
    return found


def is_many(drone: Names) -> bool:
    return not isinstance(drone, str) or "*" in drone or "?" in drone


class Finding(Owner):
    """The calls of an application that find and query drones."""

    def drones(self) -> list[str]:
        """The drones running on this and other known machines; sorted."""
        return ask_list(lib.hive_application_drones, self._handle)

    def remembered(self) -> list[str]:
        """Crashed drones whose state is restored at a restart."""
        return ask_list(lib.hive_application_remembered, self._handle)

    def find(self, pattern: str) -> list[str]:
        """The drones that match a glob or a name.  :raises hive.Error: "not_found" when there is none"""
        return ask_list(lib.hive_application_find, self._handle, encoded(pattern))

    def describe(self, drone: str) -> dict[str, Any]:
        """Its interface: "kind", "summary", "version", "stateful", "inputs", "outputs", "parameters"."""
        return ask_object(lib.hive_application_describe, self._handle, encoded(drone))

    def status(self, drone: Names) -> dict[str, Any]:
        """Its status: "state", "events", "inputs", "outputs", ... (SPEC.md, section 6.4).  With a glob or several
        drones: a dict by drone, with an :class:`Error` for one that does not answer."""
        if not is_many(drone):
            return ask_object(lib.hive_application_status, self._handle, encoded(str(drone)))
        answers = ask_list(lib.hive_application_status_all, self._handle, as_json(self._named(drone)))
        return {answer["drone"]: answer_of(answer, "status") for answer in answers}

    def place(self, drone: str) -> dict[str, Any]:
        """Where it is reachable: "drone", "host" ("local": this machine), "address", "ssh", "answered_us".

        :raises hive.Error: "not_found"; "invalid_argument" if several have the name: use "NAME@HOST"
        """
        return ask_object(lib.hive_application_place, self._handle, encoded(drone))

    def places(self) -> list[dict[str, Any]]:
        """The list of places: addresses of drones on other machines."""
        return ask_list(lib.hive_application_places, self._handle)

    def add_place(self, drone: str, address: str, host: str = "") -> None:
        """Adds the address of a drone, "tcp://HOST:PORT", to the list of places.

        :param host: the name of its machine; "": as in the address
        """
        host = host or address.partition("://")[2].rpartition(":")[0].strip("[]")
        lib.hive_application_add_place(self._handle, as_json({"drone": drone, "host": host, "address": address}))

    def forget_place(self, place: Mapping[str, Any]) -> None:
        """Removes one of :meth:`places` from the list.  :raises hive.Error: "not_found" if it is not in the list"""
        lib.hive_application_forget_place(self._handle, as_json(dict(place)))

    def wait(self, drone: str, state: str = "running", timeout: Seconds = 10.0) -> None:
        """Returns when the drone is "running" (started and answering), "idle", "halted" or "gone".

        :raises hive.Error: "timeout"
        """
        lib.hive_application_wait(self._handle, encoded(drone), encoded(state), milliseconds(timeout))

    def _ends(self, names: Names) -> list[str]:
        """The ends of connections that names and globs mean: "face", "face.image", "face-*", "face-*.image"; each once.

        :raises hive.Error: "not_found" when none fits a glob
        """
        ends: dict[str, None] = {}
        for name in flat(names):
            ends.update(dict.fromkeys(self._ends_like(name) if is_many(name) else [name]))
        return list(ends)

    def _ends_like(self, glob: str) -> list[str]:
        """What fits a drone as a whole wins over a port behind the last dot."""
        try:
            return self.find(glob)
        except Error as error:
            drones, dot, port = glob.rpartition(".")
            if error.code != "not_found" or not dot:
                raise
            return [f"{drone}.{port}" for drone in self.find(drones)]

    def _named(self, drones: Names) -> list[str]:
        """Each once, in the order given."""
        names: dict[str, None] = {}
        for drone in flat(drones):
            names.update(dict.fromkeys(self.find(drone) if is_many(drone) else [drone]))
        return list(names)


def answer_of(answer: Mapping[str, Any], result: str = "result") -> Any:
    """The answer of one of several drones, or its :class:`Error`."""
    return error_of(answer["error"]) if "error" in answer else answer[result]
