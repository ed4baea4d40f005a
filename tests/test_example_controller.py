"""The reference controller: driven by the acquisition, and against the bench's own device."""

import socket
import struct
import subprocess
import sys
import time
import zlib
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dea.acquisition import AcquisitionSettings, acquire
from dea.acquisition.panel import Panel
from dea.acquisition.retrying_link import Link
from dea.bench.device import BenchDevice
from dea.bench.device import RefusedError as BenchRefusedError
from dea.bench.device import Session as BenchSession
from dea.bench.player import OutputLimits, Player
from dea.modbus import read_device
from served_bench import RememberingPlant

FOLDER = Path(__file__).parents[1] / "examples/controller"
sys.path.insert(0, str(FOLDER))
from block_device import BLOCK_SIZE, BlockDevice, Hardware, RefusedError, Session  # noqa: E402

PERIOD = 20_000  # us


@pytest.fixture
def served():
    process = subprocess.Popen(
        [sys.executable, FOLDER / "serve.py", "--port", "0"], stdout=subprocess.PIPE, text=True
    )
    port = int(process.stdout.readline().rsplit(":", 1)[1])
    yield replace(read_device(FOLDER / "controller.yaml"), port=port)
    process.kill()
    process.wait()
    process.stdout.close()


def test_the_buffered_path_drives_it(served, tmp_path):
    volts = 1.0 + 0.5 * np.sin(np.arange(150) / 10)
    settings = AcquisitionSettings(ramp_rate=10.0)
    record = acquire(served, volts, tmp_path / "a.partial", settings).record
    assert record.sizes["time"] == volts.size
    assert not record.quality.values.any()
    np.testing.assert_allclose(record.voltage, volts, atol=15 / 65535)
    film, counts = Hardware(), record.voltage_counts.values
    film.position = int(record.displacement_counts[0])
    expected = []
    for count in counts[1:].tolist():
        film.write(count)
        expected.append(film.read())
    assert record.displacement_counts.values[1:].tolist() == expected
    link = Link(served)
    panel = Panel(link)
    assert (panel.get("applied_output"), panel.get("state"), panel.get("owner")) == (0, 0, 0)
    link.close()


def device():
    made = BlockDevice(Hardware(), 0, boot=7)
    owner = Session()
    made.claim(owner, 5, 0)
    return made, owner


def block(sequence, counts, index=0):
    """Return the words of a block."""
    data = struct.pack(">IIH", sequence, index, len(counts))
    data += struct.pack(">55H", *counts, *[0] * (55 - len(counts)))
    return list(struct.unpack(">62H", struct.pack(">I", zlib.crc32(data)) + data))


def test_a_silent_owner_trips_the_watchdog_which_latches():
    made, owner = device()
    made.write(owner, 100, block(1, [1000] * 55), 0)
    made.command(1)
    for now in range(0, 900_000, PERIOD):
        made.advance(now)
    assert made.hardware.count == 1000
    for now in range(900_000, 1_100_000, PERIOD):
        made.advance(now)
    assert (made.hardware.count, made.state, made.latched) == (0, 3, 1)
    with pytest.raises(RefusedError):
        made.command(1)
    made.command(3)
    made.command(1)


def test_a_hold_up_is_recorded_as_held_and_never_made_up_for():
    made, owner = device()
    made.write(owner, 100, block(1, [1000, 2000, 3000]), 0)
    made.command(1)
    made.advance(PERIOD)
    made.advance(6 * PERIOD)
    assert [entry[0] for entry in made.ring] == [1000] * 5 + [2000]
    assert [entry[2] for entry in made.ring] == [1, 2, 2, 2, 2, 1]


class Film(RememberingPlant):
    """The plant of the bench, as hardware of the controller."""

    def write(self, count):
        self.count = count

    def read(self):
        _, measured = self.advance(np.array([self.count]))
        return int(measured[0])


def benched():
    description = replace(read_device(FOLDER / "controller.yaml"))
    player = Player(RememberingPlant(), OutputLimits(0, 16427, 0, 218), ring_length=4096)
    return BenchDevice(player, description, {}, virtual_clock=False)


@pytest.mark.parametrize("seed", range(20))
def test_it_answers_like_the_bench_whatever_is_asked(seed):
    """Random requests by two masters, some damaged, to both; a sample now and then."""
    rng = np.random.default_rng(seed)
    ours, bench = BlockDevice(Film(), 0, boot=7, watchdog=10**6), benched()
    masters = [(Session(), BenchSession()) for _ in range(2)]
    for _ in range(300):
        mine, theirs = masters[rng.integers(2)]
        kind = rng.choice(
            ["sample", "block", "command", "claim", "read"], p=[0.3, 0.3, 0.2, 0.1, 0.1]
        )
        if kind == "sample":
            ours.sample()
            bench.player.advance(1)
        elif kind in ("block", "command", "claim"):
            address, words = request(rng, kind, ours)
            answers = (
                outcome(ours.write, mine, address, words, 0),
                outcome(bench.write, theirs, address, words),
            )
            assert answers[0] == answers[1]
        assert ours.reply(mine)[2:] == tuple(bench.read(theirs, 202, 122))
        assert list(ours.read(mine, 44, 3)) == bench.read(theirs, 44, 3)
        assert list(ours.read(mine, 55, 8)) == bench.read(theirs, 55, 8)


def request(rng, kind, device):
    if kind == "command":
        return 70, [int(rng.choice([1, 1, 1, 2, 3, 4, 9]))]
    if kind == "claim":
        return 71, [0, int(rng.choice([0, 1, 1, 1, 2]))]
    counts = rng.integers(0, 20_000, int(rng.integers(1, 20))).tolist()
    words = block(device.sequence + int(rng.choice([0, 1, 1, 1, 1, 2])), counts, device.end - 10
                  if device.end > 10 else 0)  # fmt: skip
    if rng.random() < 0.1:
        words[int(rng.integers(BLOCK_SIZE))] ^= 1
    return 100, words


def outcome(write, *arguments):
    """Return the exception code that a write is answered with, or None."""
    try:
        write(*arguments)
    except (RefusedError, BenchRefusedError) as refusal:
        return refusal.code
    return None


def test_an_owner_that_reconnects_over_lost_connections_is_let_in(served):
    with ExitStack() as stack:
        for _ in range(6):
            panel = Panel(stack.enter_context(closing(Link(served))))
            panel.set("claim", 9)
            assert panel.get("owner") == 2


def test_a_master_that_does_not_fetch_its_replies_is_dropped(served):
    ask = struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 0, 50)
    with socket.create_connection((served.host, served.port), timeout=10) as link:
        while True:
            try:
                link.sendall(100 * ask)
            except ConnectionError:
                break
    with closing(Link(served)) as other:
        assert Panel(other).get("owner") == 0


def test_a_silent_master_leaves_it_to_the_watchdog(served):
    link = Link(served)
    panel = Panel(link)
    panel.set("claim", 9)
    panel.set("command", 1)
    panel.set("output", 4000)
    assert panel.get("applied_output") == 4000
    time.sleep(1.3)
    assert (panel.get("applied_output"), panel.get("watchdog_latched")) == (0, 1)
    link.close()
