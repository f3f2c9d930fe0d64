"""Collecting with asyncio: beside other work, cancelled, closed, in several tasks and loops."""

import asyncio
import time
import unittest

from world import TIMEOUT, World


def run(coroutine):
    return asyncio.run(asyncio.wait_for(coroutine, TIMEOUT))


class Asyncio(World):
    def collector(self, count, **options):
        """Of a source on demand that is halted."""
        self.drone("ticker", "source", "pace=demand", f"count={count}")
        self.swarm.halt("source")
        return self.swarm.collect("source", **options)

    def test_asyncio_waits_beside_other_work_and_a_cancelled_wait_loses_nothing(self):
        collector = self.collector(30, window=4)
        turns = []

        async def other():
            while True:
                turns.append(time.monotonic())
                await asyncio.sleep(0.001)

        async def collect():
            beside = asyncio.ensure_future(other())
            waiting = asyncio.ensure_future(collector.__anext__())
            while len(turns) < 20 and not waiting.done():
                await asyncio.sleep(0.001)
            with self.assertRaises(asyncio.TimeoutError):
                await asyncio.wait_for(waiting, 0.05)
            self.swarm.resume("source")
            numbers = [event.sequence async for event in collector]
            beside.cancel()
            return numbers

        self.assertEqual(run(collect()), list(range(1, 31)))
        self.assertGreaterEqual(len(turns), 20)

    async def cancelled(self, collector):
        """A wait that is cancelled when an event has come and the loop does not know it yet."""
        task = asyncio.ensure_future(collector.__anext__())
        await asyncio.sleep(0.01)
        self.swarm.resume("source")
        time.sleep(0.3)  # the loop stands still meanwhile
        task.cancel()
        with self.assertRaises(asyncio.CancelledError):
            await task

    def test_what_a_cancelled_wait_has_taken_comes_next_in_another_loop(self):
        collector = self.collector(6, window=1)

        async def rest():
            return [event.sequence async for event in collector]

        run(self.cancelled(collector))
        self.assertEqual(run(rest()), [1, 2, 3, 4, 5, 6])

    def test_what_a_cancelled_wait_has_taken_comes_next_without_a_loop(self):
        collector = self.collector(6, window=1)
        run(self.cancelled(collector))
        self.assertEqual([event.sequence for event in collector], [1, 2, 3, 4, 5, 6])

    def test_two_tasks_get_each_event_once(self):
        collector = self.collector(40)
        self.swarm.resume("source")

        async def eat():
            return [event.sequence async for event in collector]

        async def both():
            return await asyncio.gather(eat(), eat())

        first, second = run(both())
        self.assertEqual(sorted(first + second), list(range(1, 41)))

    def test_who_waits_while_it_is_closed_is_told(self):
        collector = self.collector(1)

        async def close():
            task = asyncio.ensure_future(collector.__anext__())
            await asyncio.sleep(0.05)
            collector.close()
            await task

        self.refused("stopped", run, close())
        self.refused("stopped", run, collector.__anext__())


if __name__ == "__main__":
    unittest.main()
