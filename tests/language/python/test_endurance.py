"""What takes long: workers in Python that are killed again and again, and very many events."""

import os
import sys
import textwrap
import time
import unittest

from world import TIMEOUT, World, eventually

EVENTS = int(os.environ.get("HIVE_TEST_EVENTS", "20000"))  # 1000000 shows more, and takes minutes

REMEMBERED = 65536  # works whose second answers an application would refuse: until then it grows

WORKER = """
    import time, hive
    from hive import _library
    drone = hive.Drone("thing", "Does things.")
    work_ms = drone.parameter("work_ms", 0.0, least=0, help="how long each event takes")
    result = drone.output("result", "application/json", "results")

    @drone.on_event("in", "*/*")
    def work(event):
        time.sleep(work_ms.value / 1000)
        result.emit({"sum": int(event.body[0]) + event.body[-1], "handles": _library.lib.hive_handle_count()})

    drone.run()
    """


def resident_kb(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS:"))


class Endurance(World):
    def worker(self, name, work_ms=0.0):
        path = os.path.join(self.home, "thing.py")
        with open(path, "w", encoding="utf-8") as file:
            file.write(textwrap.dedent(WORKER))
        return self.process(sys.executable, path, "--set", f"work_ms={work_ms}", name=name, wait=False)

    def test_a_worker_killed_every_half_second_beside_those_in_cpp_loses_nothing_and_answers_nothing_twice(self):
        count, work_ms = 2000, 12
        self.drone("ticker", "source", "pace=demand", f"count={count}", "bytes=50000")
        names = ["python", "cpp-1", "cpp-2"]
        victim = self.worker("python", work_ms)
        for name in names[1:]:
            self.drone("sleeper", name, f"work_ms={work_ms}")
        self.await_drone("python")
        self.swarm.halt("source")
        for name in names:
            self.swarm.connect("source", name, group="workers")
        results = self.swarm.collect(*names, ordered=True)
        self.swarm.resume("source")
        numbers, by, kills, killed = [], {}, 0, time.monotonic()
        while len(numbers) < count:
            event = results.next(TIMEOUT)
            self.assertIsNotNone(event, f"no result {len(numbers) + 1} after {kills} kills: {results.counts()}")
            numbers.append(event.sequence)
            by[event.sender] = by.get(event.sender, 0) + 1
            if time.monotonic() - killed >= 0.5:
                victim.kill()
                victim.wait()
                victim = self.worker("python", work_ms)
                kills, killed = kills + 1, time.monotonic()
        self.assertEqual(numbers, list(range(1, count + 1)))
        self.assertIsNone(results.next(TIMEOUT))
        self.assertEqual(results.ended, "")
        self.assertEqual((results.counts()["missing"], results.counts()["failed"]), (0, 0))
        self.assertGreaterEqual(kills, 5)
        self.assertGreater(by.get("python", 0), 0, "the worker in Python did nothing")

    def test_many_events_leave_no_memory_no_handle_and_nothing_in_hand(self):
        self.drone("ticker", "source", "pace=demand", f"count={EVENTS}", "bytes=5000")
        process = self.worker("python")
        self.await_drone("python")
        results = self.swarm.collect("python")
        self.swarm.connect("source", "python")
        memory, handles, expected = [], [], 0
        for event in results:
            expected += 1
            self.assertEqual(event.sequence, expected)
            if expected % (EVENTS // 10) == 0:
                memory.append((resident_kb(process.pid), resident_kb(os.getpid())))
                handles.append(event.header["handles"])
        self.assertEqual(expected, EVENTS)
        self.assertLessEqual(handles[-1], handles[0])
        self.assertLess(memory[-1][0] - memory[2][0], 3000, memory)
        if EVENTS >= REMEMBERED * 10:
            self.assertLess(memory[-1][1] - memory[2][1], 3000, memory)
        print(f"{EVENTS} events; resident memory, KB, of the drone and of the application: {memory}", file=sys.stderr)
        self.assertTrue(eventually(lambda: self.swarm.status("python")["events"]["in_hand"] == 0))

        def account():
            edge = self.swarm.status("source")["outputs"][0]["edges"][0]
            return edge["came"], edge.get("acknowledged", 0), edge.get("in_flight", 0)

        self.assertTrue(eventually(lambda: account() == (EVENTS, EVENTS, 0)), account())


if __name__ == "__main__":
    unittest.main()
