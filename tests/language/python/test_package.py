"""The package itself: what it declares, how long its import takes, what it says of itself."""

import os
import pickle
import re
import resource
import subprocess
import sys
import unittest

import hive
from hive import _library

HEADER = os.path.join(os.environ["HIVE_SOURCE_DIR"], "libhive/language/c/include/hive.h")


def declared():
    """The functions of hive.h, with how many arguments each has."""
    with open(HEADER, encoding="utf-8") as file:
        text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
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
        with open(HEADER, encoding="utf-8") as file:
            codes = dict(re.findall(r"HIVE_([A-Z_]+) = (\d+)", file.read()))
        codes.pop("OK")
        self.assertEqual(_library.codes, {name.lower(): int(code) for name, code in codes.items()})

    def test_its_import_takes_less_than_60_ms_of_processor_time(self):
        def used(words):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([sys.executable, "-c", words], check=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

        best = min(used("import hive") for _ in range(5)) - min(used("pass") for _ in range(5))
        self.assertLess(best, 0.060)

    def test_neither_numpy_nor_opencv_nor_asyncio_is_imported_with_it(self):
        words = "import hive, sys; print([m for m in ('numpy', 'cv2', 'asyncio', 'logging') if m in sys.modules])"
        out = subprocess.run([sys.executable, "-c", words], check=True, capture_output=True, text=True).stdout
        self.assertEqual(out.strip(), "[]")

    def test_everything_public_has_a_docstring(self):
        for name in hive.__all__:
            thing = getattr(hive, name)
            self.assertTrue(thing.__doc__, name)
            for inner, value in vars(thing).items() if isinstance(thing, type) else ():
                if not inner.startswith("_") and (callable(value) or isinstance(value, property)):
                    if name not in ("Hop", "Share") and inner not in ("resume",):
                        self.assertTrue(value.__doc__, f"{name}.{inner}")

    def test_its_version_is_that_of_the_library(self):
        self.assertRegex(hive.__version__, r"^\d+\.\d+\.\d+")
        self.assertGreaterEqual(hive.protocol_version(), 1)

    def test_errors_travel_between_processes(self):
        for error in (hive.Error("refused", "no", "ask again"), hive.SetError("refused", "no", "", "none", {"a": {}})):
            again = pickle.loads(pickle.dumps(error))
            self.assertEqual((again.code, str(again), again.advice), (error.code, str(error), error.advice))
            self.assertIs(type(again), type(error))

    def test_what_json_cannot_hold_is_refused(self):
        for value in ({"x": float("nan")}, {"x": object()}, {"x": {1, 2}}):
            with self.assertRaises(hive.Error):
                _library.as_json(value)


if __name__ == "__main__":
    unittest.main()
