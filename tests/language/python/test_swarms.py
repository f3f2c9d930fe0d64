"""Whole swarms in Python, with real drones: everything or nothing, and Ctrl-C leaves nothing."""

import json
import logging
import os
import pathlib
import signal
import subprocess
import sys
import textwrap
import threading
import unittest

import hive
from world import TIMEOUT, PROGRAMS, World, eventually

LONG = 60.0  # of a whole swarm, on a machine that does much else


def workers_file(workers):
    return {
        "swarm": "work",
        "drones": {
            "source": {"kind": "ticker", "set": {"fps": 50, "bytes": 100}},
            "worker": {"kind": "sleeper", "count": workers, "set": {"work_ms": 1}},
        },
        "connections": [{"from": "source", "to": "worker-*", "share": True}],
    }


def words(steps):
    return [step["step"] + " " + step["what"] for step in steps]


class Swarms(World):
    def setUp(self):
        super().setUp()
        before = os.environ.get("HIVE_DRONE_PATH")
        os.environ["HIVE_DRONE_PATH"] = PROGRAMS
        self.addCleanup(lambda: os.environ.update(HIVE_DRONE_PATH=before or ""))
        self.addCleanup(self.stop_all)

    def stop_all(self):
        """By another application: a test may have closed its own."""
        with hive.Application(timeout=TIMEOUT) as others:
            others.stop(*others.drones())

    def locks(self):
        return [name for name in os.listdir(self.home) if name.endswith((".sock", ".swarm"))]

    def assert_nothing_is_left(self):
        self.assertEqual((self.swarm.drones(), self.swarm.remembered(), self.swarm.swarms()), ([], [], []))
        self.assertEqual(self.locks(), [])

    def test_up_again_is_nothing_a_change_is_one_step_and_down_ends_it(self):
        content = workers_file(2)
        swarm = self.swarm.swarm(content)
        self.assertEqual((swarm.name, swarm.check(), swarm.notes), ("work", [], []))
        planned = swarm.differences()
        told = []
        self.assertEqual(swarm.up(LONG, lambda *progress: told.append(progress)), planned)
        self.assertEqual(len(planned), 5)
        self.assertEqual((planned[-1]["sender"], planned[-1]["receiver"]), ("source.tick", "worker-2.image"))
        self.assertIn((3, 3, "started"), told)
        self.assertEqual(told[-1], (5, 5, "wired"))
        self.assertEqual(self.swarm.drones(), ["source", "worker-1", "worker-2"])
        self.assertEqual(swarm.up(LONG), [])
        content["drones"]["source"]["set"]["bytes"] = 200
        (step,) = self.swarm.swarm(content).up(LONG)
        self.assertEqual((step["step"], step["values"], step["before"]), ("set", {"bytes": 200}, {"bytes": 100}))
        self.assertEqual(self.swarm.get("source", "bytes"), {"bytes": 200})
        (known,) = self.swarm.swarms()
        self.assertEqual(known.name, "work")
        self.assertEqual(sorted(known.down(LONG)), ["source", "worker-1", "worker-2"])
        self.assert_nothing_is_left()
        self.assertEqual(known.down(LONG), [])

    def test_a_file_a_text_and_a_dict_say_the_same_and_an_application_is_made_for_whom_has_none(self):
        path = pathlib.Path(self.home) / "swarm.json"
        path.write_text(json.dumps(workers_file(1), indent=1), encoding="utf-8")
        for source in (path, str(path), path.read_text(encoding="utf-8"), workers_file(1)):
            with hive.Swarm(source) as swarm:
                self.assertEqual((swarm.name, len(swarm.differences())), ("work", 3))
        self.refused("stopped", swarm.differences)
        with self.assertRaises(FileNotFoundError):
            hive.Swarm("nowhere.json")

    def test_a_file_may_have_variables_comments_and_parts(self):
        part, whole = pathlib.Path(self.home) / "part.json", pathlib.Path(self.home) / "whole.json"
        part.write_text('// a part\n{"drones": {"more": {"kind": "sleeper"}}}', encoding="utf-8")
        whole.write_text(
            '{"swarm": "w", "include": "part.json", "variables": {"n": 1},\n'
            ' "drones": {"a": {"kind": "sleeper", "count": "${n}"}}} // the whole',
            encoding="utf-8",
        )
        with hive.Swarm(whole, variables={"n": 3}) as swarm:
            self.assertEqual((swarm.check(), swarm.name, len(swarm.differences())), ([], "w", 4))
        part.write_text('{"drones": {"more": {"knid": "sleeper"}}}', encoding="utf-8")
        mistakes = hive.Swarm(whole).check()
        self.assertEqual({(mistake.file, mistake.line) for mistake in mistakes}, {(str(part), 1)})
        self.assertTrue(str(mistakes[0]).startswith(f"{part}:1:"))

    def test_a_file_with_mistakes_raises_all_of_them_and_starts_nothing(self):
        text = '{"swarm": "a", "drones": {\n  "source": {"kind": "ticker", "set": {"fsp": 3}}},\n "conections": []}'
        swarm = self.swarm.swarm(text)
        for call in (swarm.up, swarm.down, swarm.differences, lambda: swarm.export("shell")):
            with self.assertRaises(hive.SwarmFileError) as caught:
                call()
            self.assertEqual(caught.exception.code, "invalid_argument")
            places = [(mistake.line, mistake.column) for mistake in caught.exception.mistakes]
            self.assertEqual(places, [(2, 40), (3, 2)])
        self.assertEqual(caught.exception.mistakes, swarm.check())
        self.assertIn("fps", str(swarm.check()[0]))
        self.assertEqual(swarm.check()[0].at, "drones.source.set.fsp")
        self.assertEqual([mistake.line for mistake in hive.Swarm(text, form_only=True).check()], [3])
        self.assertEqual((self.swarm.drones(), hive.Swarm("{").name), ([], ""))
        far = hive.Swarm({"swarm": "a", "drones": {"far": {"kind": "elsewhere", "on": "cam1"}}})
        self.assertEqual((far.check(), [note.at for note in far.notes]), ([], ["drones.far.kind"]))

    def test_when_the_last_drone_does_not_start_nothing_is_left(self):
        content = workers_file(2)
        content["drones"]["zlast"] = {"kind": "ticker", "listen": "tcp://192.0.2.1", "insecure": True}
        with self.assertRaises(hive.SwarmError) as caught:
            self.swarm.swarm(content).up(LONG)
        self.assertEqual((list(caught.exception.failures), caught.exception.remains), (["zlast"], {}))
        self.assertIn("192.0.2.1", str(caught.exception))
        self.assertEqual(caught.exception.code, caught.exception.failures["zlast"].code)
        self.assert_nothing_is_left()

    def test_an_exception_of_the_progress_undoes_what_was_begun(self):
        class Enough(Exception):
            pass

        def progress(done, all, what):
            if done == 2:
                raise Enough

        for last in (1, 0):
            with self.assertRaises(Enough):
                self.swarm.swarm(workers_file(2)).up(LONG, progress)
            self.assert_nothing_is_left()

    def interrupted(self, script, *more):
        """The script says so, and then finds nothing; with so many drones that it comes long before all are there."""
        end = """
            with hive.Application() as others:
                print("interrupted", others.drones(), len(others.swarms()))
            """
        command = [sys.executable, "-c", textwrap.dedent(script) + textwrap.dedent(end)]
        command += [json.dumps(workers_file(60)), *more]
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONG)
        self.assertEqual((done.stdout, done.stderr, done.returncode), ("interrupted [] 0\n", "", 0), done.stderr)
        self.assert_nothing_is_left()

    def test_ctrl_c_in_the_middle_leaves_nothing(self):
        script = """
            import os, signal, sys, hive
            def progress(done, all, what):
                if what == sys.argv[2] and done >= 3:
                    os.kill(os.getpid(), signal.SIGINT)
            try:
                hive.Swarm(sys.argv[1]).up(60.0, progress)
            except KeyboardInterrupt as interruption:
                assert interruption.__cause__ is None, interruption.__cause__
            """
        for moment in ("started", "wired"):
            with self.subTest(moment):
                self.interrupted(script, moment)

    def test_what_a_signal_raises_at_the_edge_of_a_callback_is_raised_by_the_call(self):
        script = """
            import sys, hive
            begun = []
            def raise_there(frame, event, argument):
                if frame.f_code.co_name == "hear" and event == sys.argv[2]:
                    begun.append(event)
                    if len(begun) == 3:
                        raise KeyboardInterrupt
            sys.setprofile(raise_there)
            try:
                hive.Swarm(sys.argv[1]).up(60.0, lambda done, all, what: None)
                sys.exit("it was not interrupted")
            except KeyboardInterrupt:
                sys.setprofile(None)
            """
        for edge in ("call", "return"):
            with self.subTest(edge):
                self.interrupted(script, edge)

    def test_a_second_ctrl_c_while_it_is_undone_leaves_nothing_either(self):
        script = """
            import signal, sys, time, hive
            seen, begun = [], []
            def come(number, frame):
                seen.append(number)
                if len(seen) == 1:
                    signal.setitimer(signal.ITIMER_REAL, 0.005)  # the second, while drones are ended
                raise KeyboardInterrupt
            signal.signal(signal.SIGALRM, come)
            def progress(done, all, what):
                if done >= 3 and not begun:
                    begun.append(done)
                    signal.setitimer(signal.ITIMER_REAL, 0.002)  # the first, while drones are started
            while len(seen) < 2:
                try:
                    if not begun:
                        hive.Swarm(sys.argv[1]).up(60.0, progress)
                        sys.exit("nobody has interrupted it")
                    time.sleep(0.01)
                except KeyboardInterrupt:
                    pass
            """
        self.interrupted(script)

    def test_ctrl_c_of_a_terminal_while_nothing_is_heard_of_the_progress_leaves_nothing(self):
        script = "import sys, hive; hive.Swarm(sys.argv[1]).up(60.0)"
        words = [sys.executable, "-c", script, json.dumps(workers_file(60))]
        process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (process.kill(), process.wait(), process.stderr.close()))
        self.assertTrue(eventually(lambda: os.path.exists(os.path.join(self.home, "worker-5.sock"))))
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(LONG), -signal.SIGINT)
        self.assertIn("KeyboardInterrupt", process.stderr.read())
        self.assert_nothing_is_left()

    def test_whoever_stays_starts_again_what_falls_until_ctrl_c_or_close(self):
        content = workers_file(1)
        content["drones"]["worker"].update(restart="on-failure")
        swarm = hive.Swarm(content)
        swarm.up(LONG)
        before = self.swarm.status("worker-1")["pid"]
        os.kill(before, signal.SIGKILL)
        told = []

        def tell(text):
            told.append(text)
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            swarm.stay(tell)
        self.assertEqual(len(told), 1)
        self.assertIn("worker-1 crashed and was restarted", told[0])
        self.assertNotEqual(self.swarm.status("worker-1")["pid"], before)

        left = []
        thread = threading.Thread(target=lambda: left.append(self.refused("stopped", swarm.stay)))
        os.kill(self.swarm.status("worker-1")["pid"], signal.SIGKILL)
        with self.assertLogs("hive.work", logging.WARNING) as logs:
            thread.start()
            self.assertTrue(eventually(lambda: logs.output, LONG))
        swarm.close()
        thread.join(LONG)
        self.assertEqual(len(left), 1)
        self.assertIn("was restarted", logs.output[0])
        self.swarm.swarms()[0].down(LONG)

    def test_what_runs_is_a_file_again_and_a_file_is_files_for_what_runs_it(self):
        swarm = self.swarm.swarm(workers_file(2))
        swarm.up(LONG)
        text = self.swarm.export()
        self.assertEqual((hive.Swarm(text).name, hive.Swarm(text).up(LONG)), ("work", []))
        part = json.loads(self.swarm.export("worker-*", name="part"))
        self.assertEqual((part["swarm"], len(part.get("connections", []))), ("part", 0))
        files = swarm.export("systemd", programs="/opt/hive")
        self.assertEqual(len(files), 4)
        self.assertIn("/opt/hive/hive-ticker", "".join(file.text for file in files))
        self.refused("invalid_argument", swarm.export, "cron")
        (script,) = swarm.export("shell")
        path = script.write(os.path.join(self.home, "scripts"))
        swarm.down(LONG)
        environment = {**os.environ, "PATH": PROGRAMS + ":" + os.environ["PATH"]}
        done = subprocess.run([path], env=environment, capture_output=True, text=True, timeout=LONG)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(swarm.differences(), [])

    def test_a_new_process_takes_over_and_when_it_does_not_its_log_says_why(self):
        self.swarm.swarm(workers_file(1)).up(LONG)
        before = self.swarm.status("worker-1")["pid"]
        self.swarm.replace("worker-1", parameters={"most_ms": 100}, ready=LONG)
        now = self.swarm.status("worker-1")["pid"]
        self.assertNotEqual(now, before)
        self.assertEqual(self.swarm.get("worker-1", "work_ms", "most_ms"), {"work_ms": 1, "most_ms": 100})
        with self.assertRaises(hive.Error) as caught:
            self.swarm.replace("worker-1", listen="tcp://127.0.0.1:1", ready=LONG)
        self.assertIn("key", str(caught.exception))
        self.assertEqual(self.swarm.status("worker-1")["pid"], now)
        self.refused("not_found", self.swarm.replace, "nobody")

    def test_a_drone_that_hangs_is_replaced_only_with_force_and_the_new_one_is_as_it_was(self):
        swarm = self.swarm.swarm(workers_file(1))
        swarm.up(LONG)
        before = self.swarm.status("worker-1")["pid"]
        os.kill(before, signal.SIGSTOP)
        with hive.Application(timeout=1.0) as hasty, self.assertRaises(hive.Error) as caught:
            hasty.replace("worker-1", ready=LONG)
        self.assertIn("hivectl replace worker-1 --force", caught.exception.advice)
        os.kill(before, 0)
        self.swarm.replace("worker-1", parameters={"most_ms": 100}, force=True, ready=LONG)
        now = self.swarm.status("worker-1")
        self.assertNotEqual(now["pid"], before)
        self.assertEqual(self.swarm.get("worker-1", "work_ms", "most_ms"), {"work_ms": 1, "most_ms": 100})
        self.assertEqual([row["from"] for row in now["inputs"]], ["source.tick"])
        self.assertTrue(eventually(lambda: self.swarm.status("worker-1")["inputs"][0].get("processed", 0) > 0))
        self.assertEqual(sorted(swarm.down(LONG)), ["source", "worker-1"])
        self.assert_nothing_is_left()


if __name__ == "__main__":
    unittest.main()
