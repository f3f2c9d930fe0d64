// Hostile peers: what they send never crashes a module, never costs it memory by their numbers, never loses another's events.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
