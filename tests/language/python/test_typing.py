"""The types that the package declares, as mypy reads them."""

import os
import subprocess
import sys
import tempfile
import textwrap
import unittest

import hive

PROGRAM = """
    import hive

    drone = hive.Drone("probe")
    low = drone.parameter("low", 50, least=0)
    edges = drone.output("edges", "image/raw")

    @drone.on_event("image", "image/raw")
    def find(event: hive.Event) -> None:
        if low < 3 and low:
            edges.emit_image(event.image(), {"age": event.age}, count=2 * low.value)

    async def read() -> None:
        async with hive.Application() as swarm:
            name: str = swarm.start("face", scale=1.05)
            swarm.connect(["camera"], "face-*", share=True)
            async for event in swarm.results(name, count=5):
                print(event.sequence, event.hops[0].work_us)
    """


class Typing(unittest.TestCase):
    def setUp(self):
        try:
            import mypy  # noqa: F401
        except ImportError:
            self.skipTest("mypy is not installed: apt-get install python3-mypy")

    def mypy(self, *words):
        package = os.path.dirname(os.path.dirname(hive.__file__))
        with tempfile.TemporaryDirectory() as cache:
            command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache, *words]
            environment = {**os.environ, "MYPYPATH": package}
            done = subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=package, env=environment)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_package_is_strictly_typed(self):
        self.mypy("-p", "hive")

    def test_so_is_a_program_that_uses_it(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "probe.py")
            with open(file, "w", encoding="utf-8") as program:
                program.write(textwrap.dedent(PROGRAM))
            self.mypy(file)


if __name__ == "__main__":
    unittest.main()
