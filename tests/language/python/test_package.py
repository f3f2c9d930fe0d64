"""The package itself: what it declares, what its import brings, what it says of itself."""

import os
import pickle
import re
import subprocess
import sys
import unittest

import hive
from hive import _library

HEADERS = os.path.join(os.environ["HIVE_SOURCE_DIR"], "libhive/include")


def header(name):
    with open(os.path.join(HEADERS, name), encoding="utf-8") as file:
        return file.read()


def declared():
    """The functions of the headers, with how many arguments each has."""
    text = re.sub(r"/\*.*?\*/", "", header("hive.h") + header("hive_swarm.h"), flags=re.S)
    functions = {}
    for name, arguments in re.findall(r"HIVE_API[^;]*?\bhive_([a-z_]+)\((.*?)\);", text, flags=re.S):
        flat = re.sub(r"\([^()]*\)", "", arguments)
        functions[name] = 0 if flat.strip() == "void" else flat.count(",") + 1
    return functions


class Package(unittest.TestCase):
    def test_every_function_of_the_header_is_declared_with_its_arguments(self):
        table = {}
        for line in _library._SIGNATURES.replace("\n", "|").split("|"):
            if line:
                words = line.split()
                table[words[0]] = 0 if words[1] == "-" else len(words[1])
        self.assertEqual(table, declared())

    def test_every_code_of_the_header_has_the_token_of_its_name(self):
        codes = dict(re.findall(r"HIVE_([A-Z_]+) = (\d+)", header("hive.h")))
        codes.pop("OK")
        self.assertEqual(_library.codes, {name.lower(): int(code) for name, code in codes.items()})

    def test_neither_numpy_nor_opencv_nor_asyncio_is_imported_with_it(self):
        words = "import hive, sys; print([m for m in ('numpy', 'cv2', 'asyncio', 'logging', 'traceback') if m in sys.modules])"
        out = subprocess.run([sys.executable, "-c", words], check=True, capture_output=True, text=True).stdout
        self.assertEqual(out.strip(), "[]")

    def test_what_is_imported_with_it_is_small(self):
        allowed = """atexit collections contextlib copyreg ctypes enum faulthandler functools hive importlib itertools json
                     keyword operator re reprlib struct threading types typing warnings weakref zlib""".split()
        words = "import sys; old = set(sys.modules); import hive; print(*{m.split('.')[0] for m in set(sys.modules) - old})"
        out = subprocess.run([sys.executable, "-c", words], check=True, capture_output=True, text=True).stdout
        self.assertEqual([name for name in out.split() if not name.startswith("_") and name not in allowed], [])

    def test_everything_public_has_a_docstring(self):
        for name in hive.__all__:
            thing = getattr(hive, name)
            self.assertTrue(thing.__doc__, name)
            parts = thing.__mro__ if isinstance(thing, type) else ()
            own = [part for part in parts if part.__module__.startswith("hive")]
            for inner, value in (item for part in own for item in vars(part).items()):
                if not inner.startswith("_") and (callable(value) or isinstance(value, property)):
                    if name not in ("Hop", "Share") and inner not in ("resume",):
                        self.assertTrue(value.__doc__, f"{name}.{inner}")

    def test_its_version_is_that_of_the_library(self):
        self.assertRegex(hive.__version__, r"^\d+\.\d+\.\d+")
        self.assertGreaterEqual(hive.protocol_version(), 1)

    def test_errors_travel_between_processes(self):
        for error in (
            hive.Error("refused", "no", "ask again"),
            hive.SetError("refused", "no", "", "none", {"a": {}}),
            hive.SwarmFileError("invalid_argument", "no", "", [hive.Mistake(1, 2, "", "no", "")]),
            hive.SwarmError("refused", "no", "", {"a": hive.Error("io", "no")}),
        ):
            again = pickle.loads(pickle.dumps(error))
            self.assertEqual((again.code, str(again), again.advice), (error.code, str(error), error.advice))
            self.assertIs(type(again), type(error))
            self.assertEqual(repr(vars(again)), repr(vars(error)))

    def test_what_json_cannot_hold_is_refused(self):
        for value in ({"x": float("nan")}, {"x": object()}, {"x": {1, 2}}):
            with self.assertRaises(hive.Error):
                _library.as_json(value)


if __name__ == "__main__":
    unittest.main()
