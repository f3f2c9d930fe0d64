"""The tutorial, the recipes and the page of every name: each block as it stands there, in an empty folder."""

import ctypes
import functools
import glob
import importlib.util
import inspect
import json
import os
import re
import socket
import subprocess
import sys
import unittest

import hive
from hive import _library
from world import TIMEOUT, PROGRAMS, World

SOURCE = os.environ["HIVE_SOURCE_DIR"]
FOLDER = os.path.join(SOURCE, "libhive/language/python")
# Here nobody closes a window: what is to be viewed is served as a page, for a moment.
PRELUDE = """
set -e
hivectl() {
    [ "$1" != view ] || { timeout --signal=INT 3 hivectl "$@" --http PORT || [ $? = 124 ]; return; }
    command hivectl "$@"
}
"""


def sections(page):
    """The blocks of each heading: ("python", file name, text) or ("sh", "", text)."""
    with open(os.path.join(FOLDER, page), encoding="utf-8") as file:
        parts = re.split(r"^## (.*)\n", file.read(), flags=re.M)
    for title, text in zip(["", *parts[1::2]], parts[0::2]):
        found = re.split(r"^```(\w+)\n(.*?)^```", text, flags=re.M | re.S)
        blocks = []
        for before, language, block in zip(found[0::3], found[1::3], found[2::3]):
            names = re.findall(r"ave this as\s+`([\w.]+)`", before)
            blocks.append((language, names[-1] if language == "python" else "", block))
        yield title, blocks


def modules_of(blocks):
    texts = [text for language, _, text in blocks if language == "python"]
    return {name for text in texts for name in re.findall(r"^(?:import|from) (\w+)", text, flags=re.M)}


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


class Pages(World):
    def setUp(self):
        super().setUp()
        self.folder = os.path.join(self.home, "work")
        own = os.path.join(self.home, "bin")
        os.makedirs(self.folder)
        os.makedirs(own)
        os.symlink(sys.executable, os.path.join(own, "python3"))
        path = os.pathsep.join([own, PROGRAMS, os.environ["PATH"]])
        self.environment = {**os.environ, "PATH": path, "HIVE_DRONE_PATH": PROGRAMS}
        self.addCleanup(lambda: self.run_words(os.path.join(PROGRAMS, "hivectl"), "stop", "--all"))

    def run_words(self, *words):
        more = {"cwd": self.folder, "env": self.environment, "timeout": 150}
        return subprocess.run(words, capture_output=True, text=True, **more)

    def done(self, *words):
        result = self.run_words(*words)
        self.assertEqual(result.returncode, 0, f"{words}\n{result.stdout}{result.stderr}")
        self.assertNotIn("Traceback", result.stderr)
        return result.stdout

    def read(self, blocks):
        """Saves, runs what is for the shell, then the programs of which the shell has said nothing. Gives what those
        printed."""
        shell = "".join(text for language, _, text in blocks if language == "sh")
        for language, name, text in blocks:
            if language == "sh":
                self.done("bash", "-c", PRELUDE.replace("PORT", str(free_port())) + text)
            else:
                with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                    file.write(text)
        alone = [name for language, name, _ in blocks if name and name not in shell]
        return [self.done("python3", *self.program(name)) for name in alone]

    @staticmethod
    def program(name):
        """A cell is run twice in one interpreter, which then ends the drone in it."""
        return ["-c", "for _ in range(2):\n exec(open('cell.py').read())\ndrone.stop()"] if name == "cell.py" else [name]

    def recipe(self, title):
        """Reads one of the recipes, after the camera that they take for granted."""
        found = dict(sections("recipes.md"))
        needed = [name for name in modules_of(found[title]) if not importlib.util.find_spec(name)]
        if needed:
            self.skipTest(f"not installed: {', '.join(needed)}")
        self.read(found[""])
        return self.read(found[title])

    @unittest.skipUnless(os.path.exists(os.path.join(PROGRAMS, "hive-view")), "a build without the drone view")
    def test_the_tutorial(self):
        steps = list(sections("tutorial.md"))
        self.assertEqual(len(steps), 7)
        self.read([block for _, blocks in steps for block in blocks])
        self.assertEqual(os.path.exists(os.path.join(self.folder, "drawing-3.png")), True)
        self.assertEqual(self.swarm.drones(), [])

    def test_every_recipe_is_tried(self):
        tried = {each for name in dir(self) if name.startswith("test_") for each in self.titles(getattr(self, name))}
        self.assertEqual(tried, {title for title, blocks in sections("recipes.md") if title and blocks})

    @staticmethod
    def titles(test):
        return re.findall(r"\{(.*?)\}", test.__doc__ or "")

    def test_images(self):
        """{Camera to NumPy}"""
        self.assertIn("(240, 320, 3)", self.recipe("Camera to NumPy")[0])

    def lines_of(self, title):
        """In each program of a recipe, those that are not empty."""
        return [len(text.split("\n")) - text.count("\n\n") - 1 for language, _, text in
                dict(sections("recipes.md"))[title] if language == "python"]

    def test_faces(self):
        """{Find faces}"""
        (printed,) = self.recipe("Find faces")
        self.assertGreater(printed.count("'w':"), 5)
        self.assertLessEqual(self.lines_of("Find faces")[0], 12)

    def test_two_inputs(self):
        """{A drone with two inputs}"""
        self.recipe("A drone with two inputs")
        self.assertGreater(os.path.getsize(os.path.join(self.folder, "difference.png")), 1000)
        found = next(self.swarm.results("fuse.amount", timeout=20)).header
        self.assertEqual(set(found), {"share", "value"})
        self.assertLessEqual(self.lines_of("A drone with two inputs")[0], 35)

    def test_two_cameras(self):
        """{Two cameras, matched}"""
        (printed,) = self.recipe("Two cameras, matched")
        self.assertEqual(printed.count("ms apart"), 3)
        self.assertRegex(printed, r"SetCounts\(.*sets=\d+")

    def test_a_video(self):
        """{Save a video}"""
        self.recipe("Save a video")
        self.assertGreater(os.path.getsize(os.path.join(self.folder, "video.mp4")), 1000)

    def test_a_tracker(self):
        """{A tracker}"""
        self.recipe("A tracker")
        self.assertTrue(self.swarm.describe("tracker")["stateful"])

    def test_a_source(self):
        """{A source of your own}"""
        self.recipe("A source of your own")
        begin = self.swarm.status("ramp")["outputs"][0]["produced"]
        self.swarm.set("ramp", interval=0.2)
        with self.swarm.collect("ramp", window=1) as images:  # one that asks again and again does not make it faster
            times = [images.next(TIMEOUT).captured for _ in range(6)]
        self.assertGreater(times[-1] - times[1], 0.6)
        self.assertLess(begin, 100)

    def test_a_sweep(self):
        """{A sweep of a parameter}"""
        (printed,) = self.recipe("A sweep of a parameter")
        self.assertEqual(printed.count("per second"), 3)

    def test_asyncio(self):
        """{asyncio, two swarms}"""
        (printed,) = self.recipe("asyncio, two swarms")
        self.assertEqual((printed.count("north"), printed.count("south")), (3, 3))

    def test_a_notebook(self):
        """{A notebook, cells run again}"""
        (printed,) = self.recipe("A notebook, cells run again")
        self.assertEqual(len(printed.split()), 2)

    def test_processes(self):
        """{fork and multiprocessing}"""
        (printed,) = self.recipe("fork and multiprocessing")
        self.assertEqual(printed.count("(0, "), 1)

    def test_loader(self):
        """{DataLoader of PyTorch}"""
        (printed,) = self.recipe("DataLoader of PyTorch")
        self.assertEqual(printed.splitlines(), ["torch.Size([4, 240, 320, 3])"] * 2)

    def test_torch(self):
        """{PyTorch in a drone}"""
        self.recipe("PyTorch in a drone")
        event = next(self.swarm.results("classify", timeout=60))
        self.assertAlmostEqual(sum(event.header["scores"]), 1, places=3)

    def test_mediapipe(self):
        """{MediaPipe in a drone}"""
        ((_, _, text),) = dict(sections("recipes.md"))["MediaPipe in a drone"]
        compile(text, "hands.py", "exec")
        if not importlib.util.find_spec("mediapipe"):
            self.skipTest("not installed: mediapipe")
        with open(os.path.join(self.folder, "hands.py"), "w", encoding="utf-8") as file:
            file.write(text)
        self.assertIn("hands", self.done("python3", "hands.py", "--describe"))

    def table(self, heading):
        """The rows of a table of the page of the languages, without its head: the words in code of each cell."""
        with open(os.path.join(SOURCE, "libhive/language/README.md"), encoding="utf-8") as file:
            lines = file.read().partition(f"\n| {heading} |")[2].partition("\n\n")[0].splitlines()[2:]
        return [[re.findall("`([^`]+)`", cell) for cell in line.split("|")[2:-1]] for line in lines]

    @staticmethod
    def headers():
        found = glob.glob(os.path.join(SOURCE, "**/include/hive/**/*.h*"), recursive=True)
        texts = []
        for header in found:
            with open(header, encoding="utf-8") as file:
                texts.append(file.read())
        return "\n".join(texts)

    def require_in_headers(self, names, headers):
        for name in names:
            self.assertRegex(headers, rf"\b{name.rpartition('::')[2].rpartition('.')[2]}\b", name)

    def test_what_is_done_has_these_names(self):
        rows, headers = self.table("thing"), self.headers()
        self.assertGreater(len(rows), 20)
        help_of = functools.lru_cache(None)(lambda verb: self.done("hivectl", verb, "--help"))
        for commands, calls, names in rows:
            for verb, _, option in (command.partition(" ") for command in commands):
                self.assertIn(option if option.startswith("--") else "", help_of(verb))
            for owner, name, argument in (re.fullmatch(r"(?:(\w+)\.)?(\w+)(?:\((\w+)=?\))?", call).groups() for call in calls):
                function = getattr(getattr(hive, owner or "Application"), name)
                self.assertIn(argument or "self", inspect.signature(function).parameters)
            self.require_in_headers(names, headers)

    def test_what_an_event_has_is_called_so(self):
        self.drone("ticker", "ticker")
        printed = json.loads(self.done("hivectl", "results", "ticker", "-n", "1", "--json").splitlines()[0])
        event, headers = next(self.swarm.results("ticker", timeout=20)), self.headers()
        rows, number = self.table("of an event"), ctypes.c_int64()
        self.assertEqual({name for row in rows for name in row[0]}, set(printed))
        for _, attributes, names, numbers in rows:
            for attribute in attributes:
                getattr(event, attribute.partition(".")[2])
            self.require_in_headers(names, headers)
            for name in numbers:
                _library.lib.hive_event_number(event._handle, name.encode(), ctypes.byref(number))

    def test_the_page_of_every_name_is_what_the_docstrings_say(self):
        with open(os.path.join(FOLDER, "API.md"), encoding="utf-8") as file:
            written = file.read()
        told = self.done("python3", "-B", os.path.join(SOURCE, "scripts/python-api"))
        self.assertEqual(written, told, "run scripts/python-api > libhive/language/python/API.md")


if __name__ == "__main__":
    unittest.main()
