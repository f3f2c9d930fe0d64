#!/usr/bin/env python3
"""The edges drone: images in, their edges out, and a model of a drone in Python."""
import cv2
import hive

drone = hive.Drone("edges", "Finds edges.")
low = drone.parameter("low", 50, least=0, most=2000, help="minimum gradient to continue an edge")
high = drone.parameter("high", 100, least=0, most=2000, help="minimum gradient to start an edge")
edges = drone.output("edges", "image/raw", "the edges, white on black")

@drone.on_event("image", "image/jpeg,image/png,image/raw", "grey or colour images")
def find(event):
    found = cv2.Canny(event.image(bits=8), low.value, high.value)
    edges.emit_image(found, share=round(cv2.countNonZero(found) / found.size, 4))

drone.run()
