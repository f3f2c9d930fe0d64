// Nothing of its own: holds the precompiled header of what every drone's wiring includes.
