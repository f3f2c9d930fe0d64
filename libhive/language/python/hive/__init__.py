"""Hive: distributed vision processing, from Python.

A *drone* is a process with a clear interface: parameters, inputs, outputs.  This is a whole one::

    import cv2, hive

    drone = hive.Drone("edges", "Finds edges.")
    low = drone.parameter("low", 50, least=0, most=255, help="minimum gradient to continue an edge")
    edges = drone.output("edges", "image/raw")

    @drone.on_event("image", "image/raw")
    def find(event):
        edges.emit_image(cv2.Canny(event.image(), low.value, 2 * low.value), count=1)

    drone.run()

An *application* starts drones, connects them into a swarm, sets their parameters and collects their results::

    import hive
    with hive.Application() as swarm:
        swarm.start("camera")
        swarm.start("face")
        swarm.connect("camera", "face")
        swarm.set("face", scale=1.05)
        for event in swarm.results("face", count=5):
            print(event.sequence, event.header["faces"])

A *swarm file* says which drones run where and how they are connected; a dict says it as well::

    import hive
    hive.Swarm("doorway.json").up()

Times are seconds as ``float`` unless a name ends in ``_us`` (microseconds).  Whatever goes wrong is a
:class:`hive.Error` with a ``code`` ("not_found", "timeout", ...).  Waiting never holds the interpreter's lock, and
Ctrl-C ends it.  NumPy is needed for images alone, OpenCV nowhere.
"""

from typing import TYPE_CHECKING as _TYPE_CHECKING, Any as _Any

from . import _tracebacks
from ._errors import Error, SetError
from ._library import default_home, protocol_version, version as __version__
from .application import Application
from .collector import Collector, Counts, MatchedCollector, Results, SetCounts
from .drone import Drone
from .encoding import Encoding, images
from .event import Event, Hop, Share
from .output import Output
from .parameter import Matching, Parameter

if _TYPE_CHECKING:
    from .swarm import ExportedFile, Mistake, Swarm, SwarmError, SwarmFileError

__all__ = [
    "Application",
    "Collector",
    "Counts",
    "Drone",
    "Encoding",
    "Error",
    "Event",
    "ExportedFile",
    "Hop",
    "MatchedCollector",
    "Matching",
    "Mistake",
    "Output",
    "Parameter",
    "Results",
    "SetCounts",
    "SetError",
    "Share",
    "Swarm",
    "SwarmError",
    "SwarmFileError",
    "default_home",
    "images",
    "protocol_version",
]

_tracebacks.install()


def __getattr__(name: str) -> _Any:
    """Loads the classes for whole swarms on first use: most programs do not need them."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import swarm

    return getattr(swarm, name)
