"""A bench served in this process, whose plant remembers every sample it applied and measured."""

import asyncio
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np

from dea.bench.device import BenchDevice
from dea.bench.player import OutputLimits, Player
from dea.bench.server import BenchServer, serve
from dea.modbus import limit_counts, read_device

DESCRIPTION = Path(__file__).parents[1] / "config/devices/virtual_bench.yaml"


class RememberingPlant:
    """Measures a different number in every sample, so that no shift or repetition can hide."""

    def __init__(self):
        self.applied, self.displacement = [], []

    def advance(self, output_counts):
        index = len(self.applied) + np.arange(output_counts.size)
        measured = ((index * 40503 + output_counts) % 65536).astype(np.uint16)
        self.applied += output_counts.tolist()
        self.displacement += measured.tolist()
        return output_counts, measured


class ServedBench:
    """A bench device on a free loopback port, its event loop in a thread."""

    def __init__(
        self, *, virtual_clock=True, plant=None, description=None, tls=None, sampling_rate=50.0,
        **player,
    ):  # fmt: skip
        self.description = replace(
            description or read_device(DESCRIPTION), sampling_rate=sampling_rate
        )
        self.plant = plant or RememberingPlant()
        self.virtual_clock, self._player, self._tls = virtual_clock, player, tls
        self._first: list[int] = []  # samples of the plant before each start of the device
        self._port = 0
        self.start()

    def start(self):
        """Begin (again) with a fresh device at the same port."""
        self._first.append(len(self.plant.applied))
        low, high = limit_counts(self.description)
        self.player = Player(
            self.plant, OutputLimits(low, high, zero=0, ramp_step=2000),
            **{"watchdog_time": 5.0} | self._player,
        )  # fmt: skip
        constants = {
            "identity": "dea-bench", "version": 1, "actuator": "test", "boot": len(self._first),
            "device_rate": self.description.sampling_rate,
            "output_range_low": 0.0, "output_range_high": 15.0,
            "output_low_limit": 0.0, "output_high_limit": 3.76, "displacement_range_low": 0.0,
            "displacement_range_high": 10.0, "fifo_length": self.player.fifo_length,
            "ring_length": self.player.ring.length, "watchdog_time": self.player.watchdog.timeout,
        }  # fmt: skip
        self.device = BenchDevice(
            self.player, self.description, constants, virtual_clock=self.virtual_clock
        )
        self.server = BenchServer(self.device, "127.0.0.1", self._port, self._tls)
        listening = threading.Event()
        self._loop = asyncio.new_event_loop()
        self._task = self._loop.create_task(serve(self.server, lambda _: listening.set()))
        self._thread = threading.Thread(target=self._run)
        self._thread.start()
        assert listening.wait(5), "the bench did not start"
        self._port = self.server.port

    def stop(self):
        """Stop serving; the port is free afterwards."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._task.cancel)
            self._thread.join()

    def restart(self):
        """Take the device's power away and give it back."""
        self.stop()
        self.start()

    def _run(self):
        self._loop.run_until_complete(self._task)
        self._loop.run_until_complete(self._loop.shutdown_asyncgens())
        self._loop.close()

    @property
    def endpoint(self):
        """The description with the address it is served at."""
        return replace(self.description, host="127.0.0.1", port=self._port)

    @property
    def applied(self):
        return np.array(self.plant.applied)

    @property
    def displacement(self):
        return np.array(self.plant.displacement)

    def boots(self):
        """Applied and displacement counts since each start of the device, by device index."""
        ends = [*self._first[1:], len(self.plant.applied)]
        return [
            (self.applied[first:end], self.displacement[first:end])
            for first, end in zip(self._first, ends, strict=True)
        ]
