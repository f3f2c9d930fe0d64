// The main function of test programs without their own.
#include "possible.hpp"

int main(int argc, char** argv) { return hive::test::run_cases(argc, argv); }
