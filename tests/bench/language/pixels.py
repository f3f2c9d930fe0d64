"""What looks at the bytes in the comparison of Python with C++: the same as in pixels.cpp."""
import hive
import numpy

drone = hive.Drone("pixels", "Part of a benchmark.")
result = drone.output("result", "application/json", "the sum")


@drone.on_event("image", "image/raw")
def look(event):
    words = numpy.frombuffer(event.body, numpy.uint64)
    result.emit({"sum": int(words[::8].sum())})


drone.run()
