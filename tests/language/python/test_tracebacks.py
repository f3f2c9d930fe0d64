"""What users see of errors: their own lines, the name hive.Error, and what can be done."""

import os
import re
import subprocess
import sys
import textwrap
import unittest
import warnings

import hive
from world import TIMEOUT, Embedded

PACKAGE = re.compile(r'File "[^"]*hive/[a-z_]+\.py"')


class Tracebacks(Embedded):
    def run_script(self, body):
        done = subprocess.run([sys.executable, "-c", textwrap.dedent(body)], capture_output=True, text=True, timeout=60)
        self.assertNotEqual(done.returncode, 0)
        return done.stderr

    def test_an_uncaught_error_has_its_name_its_advice_and_no_frame_of_the_package(self):
        said = self.run_script("""
            import hive
            def ask(swarm):
                swarm.describe("nobody")
            ask(hive.Application())
            """)
        self.assertRegex(said.splitlines()[-1], r"^hive\.Error: nobody is not running; .+")
        self.assertIn("in ask", said)
        self.assertIsNone(PACKAGE.search(said), said)

    def test_so_it_is_in_a_thread_and_for_every_kind_of_error(self):
        said = self.run_script("""
            import hive, threading
            thread = threading.Thread(target=lambda: hive.Application().describe("nobody"))
            thread.start()
            thread.join()
            hive.Swarm("{}").up()
            """)
        self.assertIn("hive.Error: nobody is not running; ", said)
        self.assertIn("hive.SwarmFileError: ", said)
        self.assertIsNone(PACKAGE.search(said), said)

    def test_other_errors_are_shown_whole(self):
        self.assertIn("ZeroDivisionError", self.run_script("import hive; 1 / 0"))

    def test_a_notebook_shows_the_same(self):
        try:
            self.swarm.describe("nobody")
        except hive.Error as error:
            shown = "\n".join(error._render_traceback_())
        self.assertIn("hive.Error: nobody is not running", shown)
        self.assertIsNone(PACKAGE.search(shown), shown)

    def test_the_traceback_of_a_callback_is_several_lines_of_the_log_at_level_error(self):
        def work(result, event):
            if event.type == "text/plain":
                raise KeyError("missing")
            if event.type == "a/refused":
                raise hive.Error("refused", "not today")
            if event.type == "image/jpeg":
                event.image()
            result.emit_image(None)

        self.run_embedded(self.worker(work))
        exceptions = self.swarm.exceptions("worker")
        for kind, text, line in (
            ("text/plain", "KeyError: 'missing'", 'raise KeyError("missing")'),
            ("a/b", "None is not an image; check whether reading or capturing it failed", "result.emit_image(None)"),
            ("a/refused", "not today", None),
            ("image/jpeg", "image/jpeg: 1 bytes that are not a complete image of this type", None),
        ):
            with self.subTest(kind), self.assertLogs("hive.worker", "ERROR") as logs:
                self.swarm.put("worker", b"x", kind)
                self.assertEqual(exceptions.next(TIMEOUT).header["text"], text)
                said = [record.getMessage() for record in logs.records]
                self.assertEqual("Traceback (most recent call last):" in said, line is not None, said)
                self.assertEqual(any(each.strip() == line for each in said), line is not None, said)
                self.assertTrue(all("\n" not in each for each in said), said)
                self.assertIsNone(PACKAGE.search("\n".join(said)), said)

    def test_what_belongs_to_another_process_says_so_after_a_fork(self):
        drone = hive.Drone("probe", embedded=True)
        output = drone.output("out", "image/raw")
        calls = {
            "Application": self.swarm.drones,
            "Drone": lambda: drone.step(0.01),
            "Output": lambda: output.loan((2, 2)),
        }
        read, write = os.pipe()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of newer Pythons, for there are threads
            child = os.fork()
        if child == 0:
            texts = []
            for call in calls.values():
                try:
                    call()
                    texts.append("no error")
                except hive.Error as error:
                    texts.append(str(error))
            os.write(write, "\n".join(texts).encode())
            del drone, output, call, calls
            os._exit(0)
        os.close(write)
        with open(read, encoding="utf-8") as said:
            texts = said.read().split("\n")
        os.waitpid(child, 0)
        after = "was made before the process forked; make a new one in the child"
        self.assertEqual(texts, [f"this hive.{name} {after}" for name in calls])
        self.assertEqual(self.swarm.drones(), [])

    def test_a_forked_process_may_make_its_own(self):
        script = """
            import hive, os
            before = hive.Application()
            child = os.fork()
            if child == 0:
                with hive.Application() as own:
                    print(own.drones(), flush=True)
                raise SystemExit(3)
            raise SystemExit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
            """
        words = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(script)]
        done = subprocess.run(words, capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (3, "[]\n", ""))


if __name__ == "__main__":
    unittest.main()
