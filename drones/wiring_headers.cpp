// Holds the precompiled header that the wiring of every drone includes, and no code.
