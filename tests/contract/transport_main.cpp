// The transport contract: the same promises over unix sockets, tcp and inside the process.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
