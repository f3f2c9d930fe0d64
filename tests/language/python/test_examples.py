"""The examples of the pages, run as they stand there: each is a drone that answers or an application that prints."""

import json
import os
import re
import subprocess
import sys
import unittest

from world import TIMEOUT, PROGRAMS, World

SOURCE = os.environ["HIVE_SOURCE_DIR"]
PAGES = ("README.md", "libhive/language/README.md")
SWARM_PAGE = "libhive/docs/swarm-file.md"
FLAGS = ("-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror")


def blocks(page, language):
    with open(os.path.join(SOURCE, page), encoding="utf-8") as file:
        return re.findall(rf"^```{language}\n(.*?)^```", file.read(), flags=re.S | re.M)


def drones_in(language, mark):
    return [(page, text) for page in PAGES for text in blocks(page, language) if mark in text]


class Examples(World):
    def write(self, name, text):
        path = os.path.join(self.home, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def built(self, text, name):
        source, program = self.write(name + ".c", text), os.path.join(self.home, "hive-" + name)
        library = os.path.join(PROGRAMS, "..", "lib")
        subprocess.run(
            [os.environ["HIVE_TEST_CC"], *FLAGS, "-I", os.path.join(SOURCE, "libhive/include"), source,
             "-L", library, "-lhive-c", "-Wl,-rpath," + library, "-Wl,-rpath-link," + library, "-o", program],
            check=True,
        )
        return program

    def hivectl(self, *words):
        done = subprocess.run([os.path.join(PROGRAMS, "hivectl"), *words], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def stop_all(self):
        subprocess.run([os.path.join(PROGRAMS, "hivectl"), "stop", "--all"], env={**os.environ, "HIVE_HOME": self.home})

    def brightness(self, name):
        """The drone answers for pictures of the camera, with the mean that they have."""
        with self.swarm.collect_matched("camera.image", name + ".brightness") as sets:
            self.swarm.connect("camera", name)
            picture, result = sets.next(TIMEOUT)
        self.assertAlmostEqual(result.header["mean"], float(picture.image().mean()), places=2)
        self.swarm.set(name, least=255)
        self.refused("refused", self.swarm.set, name, least=256)

    def test_the_drones_in_python(self):
        self.addCleanup(self.stop_all)
        self.drone("camera", "camera", "width=320", "height=240")
        found = drones_in("python", "hive.Drone(")
        self.assertEqual(len(found), 3)
        for page, text in found:
            name = re.search(r'hive\.Drone\("([a-z]+)"', text).group(1)
            self.hivectl("start", self.write(name + ".py", text))
            with self.subTest(page=page, name=name):
                if name != "outlines":
                    getattr(self, name)(name)
                    continue
                results = self.swarm.collect(name, window=1)
                self.swarm.connect("camera", name)
                self.assertEqual(results.next(TIMEOUT).image().shape, (240, 320))

    def redact(self, name):
        """A face of the scene is not there any more."""
        self.drone("face", "face")
        with self.swarm.collect_matched("camera.image", "face.faces", name + ".redacted", name + ".count") as sets:
            self.swarm.connect("camera", [name + ".image", "face"], window=8)
            self.swarm.connect("face.faces", name + ".faces", window=8)
            for _ in range(50):
                picture, faces, redacted, count = sets.next(TIMEOUT)
                self.assertEqual(count.header["faces"], len(faces.header["faces"]))
                same = bool((picture.image() == redacted.image()).all())
                self.assertEqual(same, not faces.header["faces"])
                if not same:
                    return
        self.fail("no face was found in 50 images")

    def test_the_drone_in_c(self):
        self.drone("camera", "camera", "width=320", "height=240")
        found = drones_in("c", "hive_drone_from_arguments")
        self.assertEqual(len(found), 1)
        program = self.built(found[0][1], "brightness")
        self.process(program, name="brightness")
        self.brightness("brightness")
        self.assertEqual(subprocess.run([program, "--help"], stdout=subprocess.DEVNULL).returncode, 0)
        self.assertNotEqual(subprocess.run([program, "--no"], stderr=subprocess.DEVNULL).returncode, 0)

    def test_the_applications(self):
        self.drone("camera", "camera", "width=320", "height=240", "fps=50")
        self.drone("face", "face")
        python = drones_in("python", "hive.Application(")
        c = drones_in("c", "hive_application_new")
        starting = [text for _, text in python if "swarm.start(" in text]
        python = [each for each in python if each[1] not in starting]
        self.assertEqual((len(python), len(c), len(starting)), (1, 1, 1))
        programs = [[sys.executable, self.write(f"faces{i}.py", text)] for i, (_, text) in enumerate(python)]
        for words in [*programs, [self.built(c[0][1], "faces")]]:
            done = subprocess.run(words, capture_output=True, text=True, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(len(done.stdout.splitlines()), 5, done.stdout)
            self.assertEqual(self.swarm.get("face", "scale"), {"scale": 1.05})

    def test_the_application_that_starts_its_drones(self):
        (text,) = [text for _, text in drones_in("python", "hive.Application(") if "swarm.start(" in text]
        self.addCleanup(self.stop_all)
        more = {"env": {**os.environ, "HIVE_DRONE_PATH": PROGRAMS}, "timeout": 100}
        command = [sys.executable, self.write("starting.py", text)]
        done = subprocess.run(command, capture_output=True, text=True, **more)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"^(\d+ face-[12] \d+\.\d{3} s\n){5}$")
        self.assertEqual(self.swarm.drones(), [])

    def test_the_swarm_of_a_file_in_each_language(self):
        (file,) = [text for text in blocks(SWARM_PAGE, "sh") if "<<'END'" in text]
        self.write("doorway.json", file.partition("<<'END'\n")[2].partition("END\n")[0])
        (c,) = blocks(SWARM_PAGE, "c")
        (python,) = blocks(SWARM_PAGE, "python")
        script = [sys.executable, self.write("swarm.py", python)]
        self.addCleanup(self.stop_all)
        environment = {**os.environ, "HIVE_DRONE_PATH": PROGRAMS}
        for command in [[os.path.join(PROGRAMS, "swarm_of_page")], [self.built(c, "swarm")], script]:
            with self.subTest(command[-1]):
                for steps in (5, 0):
                    more = {"cwd": self.home, "env": environment, "timeout": 100}
                    done = subprocess.run(command, capture_output=True, text=True, **more)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    told = json.loads(done.stdout)["steps"] if done.stdout.startswith("{") else done.stdout.splitlines()
                    self.assertEqual(len(told), steps, done.stdout)
                self.assertEqual(self.swarm.drones(), ["camera", "face-1", "face-2"])
                self.swarm.swarms()[0].down(60)

    def test_they_are_as_short_as_was_promised(self):
        for _, text in drones_in("python", "hive.Application("):
            self.assertLessEqual(len(text.strip().splitlines()), 12)
        (text,) = [text for _, text in drones_in("python", "on_matched(") if "hive.Drone(" in text]
        self.assertLessEqual(len(text.strip().splitlines()), 35)
        self.assertEqual((text.count("drone.parameter("), text.count("drone.output(")), (4, 2))
        with open(os.path.join(SOURCE, "drones/edges/edges.py"), encoding="utf-8") as file:
            code = [line for line in file if line.strip() and not line.startswith(("#", '"""'))]
        self.assertLessEqual(len(code), 15)


if __name__ == "__main__":
    unittest.main()
