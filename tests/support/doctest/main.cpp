// The entry of every test program that has none of its own.
#include "possible.hpp"

int main(int argc, char** argv) { return hive::test::run_cases(argc, argv); }
