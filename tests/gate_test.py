#!/usr/bin/env python3
"""The gate against a project of nine tests: one fails once, one always, one is skipped, one hangs, five are good."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
PRESETS = """{"version": 6,
  "configurePresets": [{"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build"}],
  "testPresets": [{"name": "release", "configurePreset": "release",
                   "execution": {"noTestsAction": "error", "timeout": 2, "jobs": 3}}]}"""
PROJECT = """cmake_minimum_required(VERSION 3.25)
project(gate NONE)
enable_testing()
add_test(NAME good COMMAND true)
add_test(NAME "once: a (b) [c]" COMMAND sh -c "test -e once || { touch once; echo 'x.cpp:7: ERROR: CHECK( a ) is NOT \
correct!'; echo '  values: CHECK( 1 == 2 )'; exit 1; }")
add_test(NAME broken COMMAND sh -c "echo 'Error: no luck'; exit 1")
add_test(NAME hangs COMMAND sleep 30)
add_test(NAME skipped COMMAND echo "skipped: no camera")
foreach(i RANGE 1 4)
  add_test(NAME long${i} COMMAND sleep 0.9)
endforeach()
set_tests_properties(skipped PROPERTIES SKIP_REGULAR_EXPRESSION "skipped: ")
"""
FLAKY = "flaky: once: a (b) [c] (x.cpp:7: ERROR: CHECK( a ) is NOT correct! values: CHECK( 1 == 2 ))"


class Gate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "tests").mkdir()
        shutil.copy(HERE / "gate.py", self.root / "tests")
        (self.root / "CMakePresets.json").write_text(PRESETS)
        (self.root / "CMakeLists.txt").write_text(PROJECT)
        subprocess.run(["cmake", "--preset", "release"], cwd=self.root, check=True, capture_output=True)

    def run_gate(self, *options):
        environment = {name: value for name, value in os.environ.items() if name != "HIVE_GATE_LIST"}
        done = subprocess.run([self.root / "tests/gate.py", "release", *options], cwd=self.root, env=environment,
                              capture_output=True, text=True, timeout=60, check=False)
        return done.returncode, done.stdout + done.stderr

    def test_that_fails_once_is_flaky(self):
        code, output = self.run_gate("-E", "broken|hangs")
        self.assertEqual(code, 0, output)
        self.assertIn(FLAKY, output)
        self.assertIn("skipped: skipped (no camera)", output)
        self.assertNotIn("failed: ", output)

    def test_that_fails_again_fails_the_run(self):
        code, output = self.run_gate()
        self.assertEqual(code, 1, output)
        self.assertIn(FLAKY, output)
        self.assertIn("failed: broken (Error: no luck)", output)
        self.assertIn("failed: hangs (no failed check, over after 2.", output)

    def test_that_the_time_does_not_suffice_for_is_counted(self):
        stop = time.strftime("%H:%M:%S", time.localtime(time.time() + 2))
        code, output = self.run_gate("-R", "long", "-j", "1", "--stop-time", stop)
        self.assertEqual(code, 0, output)
        self.assertRegex(output, "skipped: [1-3] tests of release .no time left.")
        self.assertNotIn("flaky: ", output)

    def test_run_of_no_test_fails(self):
        code, output = self.run_gate("-R", "nonesuch")
        self.assertEqual(code, 1, output)
        self.assertIn("gate: ctest ran no test", output)


if __name__ == "__main__":
    unittest.main()
