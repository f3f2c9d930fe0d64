"""Hive: distributed vision processing, from Python.

A *drone* is a process with a clear interface: parameters, inputs, outputs.  This is a whole one::

    import cv2, hive

    drone = hive.Drone("edges", "Finds edges.")
    low = drone.parameter("low", 50, least=0, most=255, help="weakest gradient that continues an edge")
    edges = drone.output("edges", "image/raw")

    @drone.on_event("image", "image/raw")
    def find(event):
        edges.emit_image(cv2.Canny(event.image(), low.value, 2 * low.value), count=1)

    drone.run()

An *application* connects drones into a swarm, sets their parameters and collects their results::

    import hive
    with hive.Application() as swarm:
        swarm.connect("camera", "face")
        swarm.set("face", scale=1.05)
        for event in swarm.results("face", count=5):
            print(event.sequence, event.header["faces"])

Times are seconds as ``float`` unless a name ends in ``_us`` (microseconds).  Whatever goes wrong is a
:class:`hive.Error` with a ``code`` ("not_found", "timeout", ...).  Waiting never holds the interpreter's lock, and
Ctrl-C ends it.  NumPy is needed for pictures alone, OpenCV nowhere.
"""

from ._errors import Error, SetError
from ._library import protocol_version, version as __version__
from .application import Application, Collector, MatchedCollector
from .drone import Drone, Matching, Output, Parameter
from .event import Event, Hop, Share

__all__ = [
    "Application",
    "Collector",
    "Drone",
    "Error",
    "Event",
    "Hop",
    "MatchedCollector",
    "Matching",
    "Output",
    "Parameter",
    "SetError",
    "Share",
    "protocol_version",
]
