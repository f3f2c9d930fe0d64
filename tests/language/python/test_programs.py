"""Drones in Python that are programs of their own."""

import os
import re
import signal
import subprocess
import sys
import textwrap
import time
import unittest

import numpy

import hive
from hive import _library, _images
from world import TIMEOUT, PROGRAMS, World, eventually


class Programs(World):
    """Drones that are programs of their own."""

    BODY = """
        import time, hive
        drone = hive.Drone("thing", "Does things.")
        work_ms = drone.parameter("work_ms", 0, least=0, help="how long each event takes")
        result = drone.output("result", "application/json", "results")

        @drone.on_event("in", "*/*")
        def work(event):
            "anything"
            time.sleep(work_ms.value / 1000)
            if event.header.get("raise"):
                raise KeyError("missing")
            while event.header.get("spin"):
                pass
            result.emit({"n": event.header.get("index", 0)})

        drone.run()
        print("ran to its end")
        """

    def script(self, body=BODY):
        path = os.path.join(self.home, "thing.py")
        with open(path, "w", encoding="utf-8") as file:
            file.write(textwrap.dedent(body))
        return path

    def thing(self, name="thing", *more, wait=True):
        return self.process(sys.executable, "-u", self.script(), *more, name=name, wait=wait)

    def run_thing(self, *words):
        return subprocess.run([sys.executable, self.script(), *words], capture_output=True, text=True, timeout=60)

    CRASH = """
        import ctypes, hive
        drone = hive.Drone("thing", "Crashes.")

        def read_nothing():
            ctypes.string_at(0)

        @drone.on_event("in", "*/*")
        def work(event):
            read_nothing()

        drone.run()
        """

    def crash(self, **environment):
        """Has a drone die of SIGSEGV. Returns what ps shows."""
        script = self.script(self.CRASH)
        thing = self.process(sys.executable, script, name="thing", env={**os.environ, **environment})
        try:
            self.swarm.put("thing.in", b"x", "text/plain")
        except hive.Error:
            pass  # it may be gone before it has answered
        self.assertEqual(thing.wait(TIMEOUT), -signal.SIGSEGV)
        words = [os.path.join(PROGRAMS, "hivectl"), "ps", "--json"]
        shown = subprocess.run(words, capture_output=True, text=True, timeout=60)
        return _library.json.loads(shown.stdout)

    def test_a_crash_shows_the_stack_of_python_and_of_c(self):
        row = self.crash()[0]
        self.assertEqual(row["state"], "crashed")
        self.assertEqual(row["crash"]["function"], "read_nothing")
        self.assertTrue(row["crash"]["source"].endswith("thing.py:6"), row)
        log = self.log("thing")
        self.assertEqual(log.count("Fatal Python error: Segmentation fault"), 1, log)
        self.assertIn("in read_nothing", log)
        self.assertIn("hive::service::Worker::run()", log)

    def test_a_faulthandler_of_the_user_is_left_alone(self):
        self.assertEqual(self.crash(PYTHONFAULTHANDLER="1"), [])
        self.assertIn("in read_nothing", self.log("thing"))
        self.assertNotIn("crashed: ", self.log("thing"))

    def test_the_command_line_is_that_of_every_drone(self):
        told = self.run_thing("--describe")
        self.assertEqual(told.returncode, 0, told.stderr)
        described = _library.json.loads(told.stdout.replace("ran to its end\n", ""))
        self.assertEqual(described["inputs"], [{"name": "in", "type": "*/*", "help": "anything"}])
        self.assertEqual(self.run_thing("--help").returncode, 0)
        self.assertIn("Does things.", self.run_thing("--help").stdout)
        self.assertTrue(self.run_thing("--version").stdout.startswith(hive.__version__))
        self.assertNotEqual(self.run_thing("--no-such-flag").returncode, 0)
        wrong = self.run_thing("--set", "work_ms=-1")
        self.assertEqual((wrong.returncode, wrong.stderr.count("Traceback")), (5, 0), wrong.stderr)
        self.assertIn("hive-thing: ", wrong.stderr)

    def test_hivectl_starts_a_file_with_parameters(self):
        hivectl = os.path.join(PROGRAMS, "hivectl")
        words = [hivectl, "start", self.script(), "work_ms=3"]
        done = subprocess.run(words, capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout), (0, "thing\n"), done.stderr)
        self.addCleanup(lambda: subprocess.run([hivectl, "stop", "--all"], env={**os.environ, "HIVE_HOME": self.home}))
        self.assertEqual(self.swarm.get("thing"), {"work_ms": 3})
        self.swarm.stop("thing")
        missing = subprocess.run([hivectl, "start", "missing.py"], capture_output=True, text=True, timeout=60)
        self.assertEqual(missing.returncode, 3)
        self.assertIn("missing.py", missing.stderr)

    def test_what_is_set_to_its_default_while_the_next_one_prepares_is_not_lost(self):
        slow = """
        @drone.on_start
        def start():
            import os
            path = os.path.join(os.environ["HIVE_HOME"], "slow")
            if os.path.exists(path):
                os.rename(path, path + "-begun")
                time.sleep(1)

        drone.run()
        """
        script = self.script(self.BODY[: self.BODY.index("drone.run()")] + slow.lstrip())
        hivectl = os.path.join(PROGRAMS, "hivectl")
        subprocess.run([hivectl, "start", script, "work_ms=3"], check=True, capture_output=True, timeout=60)
        self.addCleanup(lambda: subprocess.run([hivectl, "stop", "--all"], env={**os.environ, "HIVE_HOME": self.home}))
        before = self.swarm.status("thing")["pid"]
        mark = os.path.join(self.home, "slow")
        open(mark, "w", encoding="utf-8").close()
        with subprocess.Popen([hivectl, "replace", "thing", "--kind", script], stdout=subprocess.DEVNULL) as replacing:
            self.assertTrue(eventually(lambda: os.path.exists(mark + "-begun")))
            self.swarm.set("thing", work_ms=0)
            self.assertEqual(replacing.wait(TIMEOUT), 0)
        self.assertNotEqual(self.swarm.status("thing")["pid"], before)
        self.assertEqual(self.swarm.get("thing"), {"work_ms": 0})

    def test_hivectl_says_why_a_file_does_not_start(self):
        hivectl = os.path.join(PROGRAMS, "hivectl")
        reasons = {
            "drone = (": "SyntaxError",
            "import sys; import nothing_of_this_name": "cannot import nothing_of_this_name",
            "import sys; sys.path; import nothing_of_this_name": "ModuleNotFoundError: No module named 'nothing_of",
            "import sys; sys.exit('no camera here')": "no camera here",
            "import hive; hive.Drone('thing')": "ended with exit code 0 before it was ready (the drone must call run()",
            "import hive; hive.Drone('thing').on_event('../x', 'a/b')(print)": "hive.Error",
        }
        for body, reason in reasons.items():
            with self.subTest(reason):
                words = [hivectl, "start", self.script(body)]
                done = subprocess.run(words, capture_output=True, text=True, timeout=60)
                self.assertEqual((done.returncode, done.stdout), (3 if "cannot import" in reason else 1, ""))
                self.assertIn(reason, done.stderr)
        self.assertEqual(self.swarm.drones(), [])

    def test_a_file_that_does_not_describe_itself_is_named_with_the_command_that_shows_why(self):
        self.drone("sleeper", "old")
        path = self.script("drone = (")
        words = [os.path.join(PROGRAMS, "hivectl"), "replace", "old", "--kind", path]
        said = subprocess.run(words, capture_output=True, text=True, timeout=60).stderr
        self.assertIn(f"replace: {path} --describe ended with exit code 1: SyntaxError: ", said)
        self.assertRegex(said, f"; see all that it prints: [^ ]*python3? .*{re.escape(path)} --describe\n$")

    def interpreter(self, folder, *words):
        """A python3 in a folder that runs the present one so. Gives its path."""
        path = os.path.join(self.home, folder, "python3")
        os.makedirs(os.path.dirname(path))
        with open(path, "w", encoding="utf-8") as file:
            file.write(" ".join(["#!/bin/sh\n" + words[0], "exec", sys.executable, *words[1:], '"$@"\n']))
        os.chmod(path, 0o700)
        return path

    def start_with(self, script, **environment):
        """What hivectl start says, without the $HIVE_PYTHON of the tests."""
        own = {name: value for name, value in os.environ.items() if name not in ("HIVE_PYTHON", "VIRTUAL_ENV")}
        words = [os.path.join(PROGRAMS, "hivectl"), "start", script]
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, env={**own, **environment})
        if done.returncode == 0:
            self.swarm.stop("thing")
        return done.stdout + done.stderr

    def test_a_file_is_run_by_the_first_interpreter_that_has_what_it_imports(self):
        with open(os.path.join(self.home, "only_there.py"), "w", encoding="utf-8"):
            pass
        there = self.interpreter("there/bin", f"PYTHONPATH={self.home}:$PYTHONPATH")
        bare = self.interpreter("bare", "", "-E", "-S")  # of another prefix: it has no hive
        path = os.path.dirname(bare) + os.pathsep + os.environ["PATH"]
        os.mkdir(os.path.join(self.home, "apart"))
        script = os.path.join(self.home, "apart", "thing.py")
        with open(script, "w", encoding="utf-8") as file:
            file.write('"""A docstring."""\nfrom __future__ import annotations\n' + textwrap.dedent(self.BODY))
        self.assertEqual(self.start_with(script, PATH=path), "thing\n")
        with open(script, "a+", encoding="utf-8") as file:
            file.seek(0)
            text = file.read().replace("import time, hive", "import time, hive, only_there.part as part, only_there")
            file.truncate(0)
            file.write(text.replace("only_there.part as part", "xml.dom"))
        refused = self.start_with(script, PATH=path)
        for word in (f"{bare} cannot import hive, only_there; ", "/usr/bin/python3 cannot import only_there", "HIVE_PYTHON"):
            self.assertIn(word, refused)
        self.assertEqual(self.start_with(script, PATH=path, VIRTUAL_ENV=os.path.join(self.home, "there")), "thing\n")
        self.assertEqual(self.start_with(script, PATH=path, HIVE_PYTHON=there), "thing\n")
        alone = self.start_with(script, VIRTUAL_ENV=os.path.join(self.home, "there"), HIVE_PYTHON=bare)
        self.assertIn(bare, alone)
        self.assertNotIn("/usr/bin/python3 cannot", alone)
        with open(os.path.join(self.home, "apart", "only_there.py"), "w", encoding="utf-8"):
            pass
        self.assertEqual(self.start_with(script, PATH=path), "thing\n")  # beside the file it is there for all

    def test_a_file_that_uses_images_is_run_by_the_first_interpreter_that_has_numpy(self):
        plain = self.interpreter("plain", "", "-S")  # without the packages of the system
        lines = ["import hive", "drone = hive.Drone('thing')", "drone.parameter('flags', __import__('sys').flags.no_site)"]
        look = ["@drone.on_event('image', 'image/*')", "def look(event):", "    event.image()"]
        for more, first in (([], 1), (look, 0)):
            script = self.script("\n".join([*lines, *more, "drone.run()"]))
            environment = {**os.environ, "PATH": os.path.dirname(plain) + os.pathsep + os.environ["PATH"]}
            environment.pop("HIVE_PYTHON", None)
            hivectl = os.path.join(PROGRAMS, "hivectl")
            subprocess.run([hivectl, "start", script, "--as", "thing"], check=True, timeout=60, env=environment)
            self.assertEqual(self.swarm.get("thing")["flags"], first)
            self.swarm.stop("thing")

    def test_replace_asks_for_the_file_of_what_is_no_program(self):
        hivectl = os.path.join(PROGRAMS, "hivectl")
        self.thing()
        done = subprocess.run([hivectl, "replace", "thing"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 3)
        self.assertIn("there is no program hive-thing; say what the new one is, if a Python file: --kind FILE.py", done.stderr)

    def test_a_notebook_is_told_that_its_drones_are_embedded(self):
        words = "import sys, hive\nsys.argv = ['kernel', '-f', 'kernel.json']\nhive.Drone('mine')\n"
        done = subprocess.run([sys.executable, "-i"], input=words, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("hive.Drone(..., embedded=True)", done.stderr)

    def test_without_numpy_it_starts_and_says_what_images_need(self):
        os.mkdir(os.path.join(self.home, "numpy"))
        with open(os.path.join(self.home, "numpy", "__init__.py"), "w", encoding="utf-8") as file:
            file.write("raise ImportError('not installed')")
        look = "event.type == 'image/raw' and event.image()\n            if event.header.get"
        body = self.BODY.replace("if event.header.get", look, 1)
        path = self.script(body)
        search = os.pathsep.join([self.home, os.environ["PYTHONPATH"]])
        self.process(sys.executable, path, name="thing", env={**os.environ, "PYTHONPATH": search})
        exceptions, results = self.swarm.exceptions("thing"), self.swarm.collect("thing")
        image = {"width": 1, "height": 1, "pixel_format": "gray8"}
        self.swarm.put("thing", b"x", "image/raw", image)
        text = exceptions.next(TIMEOUT).header["text"]
        self.assertEqual(text, "images need NumPy; install python3-numpy")
        self.swarm.put("thing", b"x", "text/plain", {"index": 3})
        self.assertEqual(results.next(TIMEOUT).header["n"], 3)

    def test_two_drones_in_one_program(self):
        body = """
            import hive, threading
            ends = hive.Drone("first", arguments=["--name", "first"])
            other = hive.Drone("second", embedded=True)
            thread = threading.Thread(target=other.run)
            thread.start()
            ends.run()
            other.stop()
            thread.join()
            print("both ended")
            """
        process = self.process(sys.executable, "-u", self.script(body), name="first")
        self.await_drone("second")
        self.assertEqual(self.swarm.drones(), ["first", "second"])
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(TIMEOUT), 0)
        self.assertIn("both ended", self.log("first"))
        self.assertEqual(self.swarm.drones(), [])

    def test_what_it_was_told_before_a_crash_is_remembered(self):
        told = "print(drone.given('work_ms'), drone.remembered('work_ms'))\n        result = drone"
        body = self.BODY.replace("result = drone", told)
        process = self.process(sys.executable, "-u", self.script(body), name="thing")
        self.swarm.set("thing", work_ms=2)
        process.kill()
        process.wait()
        self.process(sys.executable, "-u", self.script(body), name="thing")
        self.assertIn("None False", self.log("thing"))
        self.assertIn("2 True", self.log("thing"))

    def test_signals_and_stop_end_it_well(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            process = self.thing()
            process.send_signal(number)
            self.assertEqual(process.wait(TIMEOUT), 0)
        process = self.thing()
        self.swarm.stop("thing")
        self.assertEqual(process.wait(TIMEOUT), 0)
        self.assertEqual(self.log("thing").count("ran to its end"), 3)

    def test_a_callback_that_never_returns_does_not_keep_it_alive(self):
        process = self.thing()
        self.swarm.put("thing", b"", header={"spin": True})
        self.assertTrue(eventually(lambda: self.swarm.status("thing").get("busy_for_us", 0) > 0))
        self.assertEqual(self.swarm.describe("thing")["kind"], "thing")
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(TIMEOUT), 0)
        process = self.thing()
        self.swarm.put("thing", b"", header={"spin": True})
        self.assertTrue(eventually(lambda: self.swarm.status("thing").get("busy_for_us", 0) > 0))
        self.swarm.stop("thing")
        self.assertEqual(process.wait(TIMEOUT), 0)

    def test_an_exception_halts_when_it_is_told_to_and_the_log_has_the_traceback(self):
        self.thing("thing", "--on-exception", "halt")
        exceptions = self.swarm.exceptions("thing")
        self.swarm.put("thing", b"", header={"raise": True})
        self.assertEqual(exceptions.next(TIMEOUT).header["text"], "KeyError: 'missing'")
        self.swarm.wait("thing", "halted")
        self.assertIn('raise KeyError("missing")', self.log("thing"))

    def test_the_log_has_the_lines_of_its_level_and_above(self):
        body = """
            import hive
            drone = hive.Drone("thing", "Logs.")

            @drone.on_start
            def start():
                drone.log("of no level")
                for level in ("debug", "info", "warning", "error"):
                    drone.log("of " + level, level)

            @drone.on_event("in", "*/*")
            def work(event):
                raise KeyError("missing")

            drone.run()
            """
        script = self.script(body)
        for count, level in enumerate(("off", "error", "warning", "info", "debug")):
            self.process(sys.executable, "-u", script, "--log-level", level, name=level)
            self.swarm.put(level, b"")
            failed = lambda name=level: self.swarm.status(name).get("last_exception")
            self.assertTrue(eventually(failed))
            lines = self.log(level).splitlines()
            own = [line.split(" ", 1)[1] for line in lines if ": of " in line]
            levels = ("debug", "info", "info", "warning", "error")
            texts = ("of debug", "of no level", "of info", "of warning", "of error")
            wanted = {f"{one} {level}: {text}" for one, text in zip(levels, texts)
                      if ("error", "warning", "info", "debug").index(one) < count}
            self.assertEqual(set(own), wanted)
            self.assertEqual('raise KeyError("missing")' in self.log(level), level != "off")
            self.assertEqual("exception: failed" in self.log(level), level != "off")

    def test_a_drone_in_cpp_takes_alpha_and_says_what_to_do_about_floats(self):
        self.drone("background", "background")
        exceptions, masks = self.swarm.exceptions("background"), self.swarm.collect("background.mask")
        for kind, text in (("float32", "bgr32f; let its sender scale"), ("uint16", "bgr16; let its sender emit")):
            image = numpy.zeros((40, 60, 3), kind)
            self.swarm.put("background", image.tobytes(), "image/raw", _images.raw_header(image))
            self.assertIn(text, exceptions.next(TIMEOUT).header["text"])
        image = numpy.zeros((40, 60, 4), numpy.uint8)
        self.swarm.put("background", image.tobytes(), "image/raw", _images.raw_header(image))
        self.assertEqual(masks.next(TIMEOUT).image().shape, (40, 60))

    def test_every_drone_says_what_to_do_about_floats(self):
        settings = {"view": ["window=off"], "write": ["file=" + os.path.join(self.home, "out.avi")]}
        image = numpy.zeros((40, 60, 3), "float32")
        for kind in ("annotate", "background", "detect", "face", "gesture", "view", "write"):
            if not os.path.exists(os.path.join(PROGRAMS, "hive-" + kind)):
                continue  # built without what it needs
            with self.subTest(kind):
                self.drone(kind, kind, *settings.get(kind, []))
                with self.swarm.exceptions(kind) as exceptions:
                    self.swarm.put(kind, image.tobytes(), "image/raw", _images.raw_header(image))
                    self.assertIn("bgr32f; let its sender scale", exceptions.next(TIMEOUT).header["text"])

    def test_a_drone_in_python_takes_16_bits_and_alpha_and_says_what_to_do_about_floats(self):
        script = os.path.join(os.environ["HIVE_SOURCE_DIR"], "drones/edges/edges.py")
        self.process(sys.executable, script, name="edges")
        exceptions, edges = self.swarm.exceptions("edges"), self.swarm.collect("edges")
        for kind, channels in (("uint16", 1), ("uint8", 4), ("float32", 3)):
            image = numpy.zeros((40, 60, channels), kind)
            image[10:20] = 1 << 15 if kind == "uint16" else 128
            self.swarm.put("edges", image.tobytes(), "image/raw", _images.raw_header(image))
            if kind == "float32":
                self.assertIn("let its sender scale", exceptions.next(TIMEOUT).header["text"])
            else:
                self.assertTrue(edges.next(TIMEOUT).image().any())

    def test_a_worker_that_is_killed_loses_nothing_of_shared_work(self):
        source = self.drone("ticker", "source", "pace=demand", "count=60", "bytes=5000")
        workers = [self.thing(name, "--set", "work_ms=5") for name in ("one", "two")]
        self.drone("sleeper", "three", "work_ms=5")
        results = self.swarm.collect("one", "two", "three", ordered=True)
        self.swarm.halt("source")
        for name in ("one", "two", "three"):
            self.swarm.connect("source", name, group="workers")
        self.swarm.resume("source")
        numbers = []
        for number in range(60):
            if number == 20:
                workers[0].kill()
            event = results.next(TIMEOUT)
            self.assertIsNotNone(event, f"no result {number + 1}")
            numbers.append(event.sequence)
        self.assertEqual(numbers, list(range(1, 61)))
        self.assertIsNone(source.poll())


if __name__ == "__main__":
    unittest.main()
