"""The safety model: what trips, what a trip does, and who may drive after it."""

import socket
import threading
import time
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from made_device import described as device_with
from memory_link import MemoryLink

from dea.acquisition import AcquisitionSettings, TripError, acquire, by_hand, duty, latch
from dea.acquisition.laws import Laws
from dea.acquisition.output import Output
from dea.acquisition.panel import Panel
from dea.acquisition.retrying_link import LinkError
from dea.acquisition.zero import WayToZero, ZeroEvidence, ZeroNotVerifiedError
from dea.errors import DeviceError, InputError

OUTPUT = {"address": 0, "scale": 0.001, "limits": [0, 4], "unit": "V", "access": "write"}
REGISTERS = {
    "output": OUTPUT,
    "voltage": {"address": 1, "unit": "V"},
    "current": {"address": 2, "scale": 1e-6, "unit": "A"},
    "door": {"address": 0, "table": "discrete", "type": "bool"},
    "enable": {"address": 3, "table": "coil", "type": "bool", "access": "read_write"},
    "alive": {"address": 4, "access": "write"},
}
WRITE_COIL = 5  # Modbus function code
WHEN = "2026-03-14T15:09:26Z"
SAFETY = {
    "max_rate": 50.0,
    "monitor": {"name": "voltage", "gain": 800.0, "offset": 4.0, "tolerance": 20.0, "delay": 0.1},
    "current": {"name": "current", "limit": 300e-6},
    "interlocks": {"door": {"name": "door"}},
    "enable": {"name": "enable"},
    "heartbeat": {"name": "alive", "period": 0.5},
}


def device(registers=REGISTERS, safety=SAFETY):
    return device_with(registers, safety=safety)


def memory(**values):
    return MemoryLink(device(), **({"voltage": 4, "current": 0, "door": 1, "enable": 0} | values))


def way_to_zero(link):
    way = WayToZero(Output(link), ramp_rate=1.0, requested=1.0)
    with suppress(ZeroNotVerifiedError):
        way()
    return way


def test_a_door_that_opens_during_the_ramp_to_zero_is_a_trip(clock):
    link = memory(door=0)
    way = way_to_zero(link)
    assert "door reads 0" in str(way.trip)
    volts = [words[0] for name, words in link.written if name == "output"]
    assert volts == sorted(volts, reverse=True)
    assert volts[-1] == 0


def test_a_door_that_opens_at_zero_is_none(clock):
    way = WayToZero(Output(memory(door=0)), ramp_rate=1.0, requested=0.0)
    way()
    assert way.trip is None


def test_an_interlock_that_does_not_answer_holds_up_no_ramp(clock):
    link = memory()
    asked = []

    def silent(address, count, table):
        if link._name(address, table) == "door":
            asked.append(clock.now)
            raise LinkError("no reply")
        return MemoryLink.read(link, address, count, table)

    link.read = silent
    way_to_zero(link)
    assert len(asked) == 3
    assert link.written[-1][1] == [0]


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"door": 0}, "interlock door: door reads 0"),
        ({"current": 300}, "the current is 0.0003 A, at most 0.0003"),
        ({"voltage": 1625}, "reads 1625 V, where 1604 to 1604 are due"),
        ({"voltage": 1583}, "reads 1583 V, where 1604 to 1604 are due"),
    ],
)
def test_what_does_not_hold_trips(clock, values, told):
    laws = Laws(Panel(memory(**{"voltage": 1604} | values)))
    with pytest.raises(TripError, match=told):
        laws.check(2.0, 2.0)


@pytest.mark.parametrize("voltage", [1585, 1604, 1623])
def test_what_holds_does_not(clock, voltage):
    Laws(Panel(memory(voltage=voltage, current=299))).check(2.0, 2.0)


def test_a_monitor_may_be_behind_by_its_delay_and_no_longer(clock):
    link = memory(voltage=804)
    laws = Laws(Panel(link))
    laws.check(1.0, 1.0)
    for _ in range(8):  # 0.1 s and two periods
        clock.sleep(0.02)
        laws.check(3.0, 3.0)
    clock.sleep(0.02)
    with pytest.raises(TripError):
        laws.check(3.0, 3.0)


def test_the_heartbeat_counts_up_once_in_a_period(clock):
    link = memory()
    laws = Laws(Panel(link))
    for _ in range(40):
        laws.beat()
        clock.sleep(0.05)
    assert link.written == [("alive", [1]), ("alive", [2]), ("alive", [3]), ("alive", [4])]


def test_it_is_armed_at_the_start_and_disarmed_after_zero_is_shown(clock):
    link = memory()
    output = Output(link)
    output.take()
    output.arm()
    assert link.written == [("alive", [1]), ("enable", [1])]
    assert WayToZero(output, ramp_rate=10.0, requested=0.1)() == ZeroEvidence.MONITOR
    assert link.written[-1] == ("enable", [0])
    assert [words for name, words in link.written if name == "output"][-1] == [0]


def test_an_open_interlock_is_refused_before_anything_is_written(clock):
    link = memory(door=0)
    with pytest.raises(InputError, match="interlock door") as caught:
        Output(link).take()
    assert caught.value.field == "safety"
    assert {name for name, _ in link.written} <= {"alive"}


def test_zero_is_not_believed_while_the_monitor_shows_voltage(clock):
    link = memory()
    output = Output(link)
    output.take()
    link.values["voltage"] = 404
    assert output.driven() == pytest.approx(0.5)


def test_zero_is_not_believed_of_a_monitor_that_reads_no_number(clock):
    voltage = REGISTERS["voltage"] | {"address": 10, "type": "float32"}
    target = device(registers=REGISTERS | {"voltage": voltage})
    link = MemoryLink(target, voltage=4.0, current=0, door=1, enable=0)
    output = Output(link)
    output.take()
    assert not output.driven()
    link.values["voltage"] = np.nan
    with pytest.raises(ZeroNotVerifiedError):
        WayToZero(output, ramp_rate=1.0, requested=0.0)()


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"monitor": {"name": "hv", "gain": 1, "tolerance": 1}}, "safety.monitor.name"),
        ({"enable": {"name": "door"}}, "registers.door.access"),
        ({"current": {"name": "alive", "limit": 1}}, "registers.alive.access"),
        ({"monitor": {"name": "voltage", "gain": 0, "tolerance": 1}}, "safety.monitor.gain"),
        ({"max_rat": 1}, "safety.max_rat"),
    ],
)
def test_a_wrong_safety_section_is_refused(changes, place):
    with pytest.raises(InputError) as caught:
        device(safety=SAFETY | changes)
    assert caught.value.field == place


SETTINGS = AcquisitionSettings(
    mode="polled", ramp_rate=20.0, timeout=0.3, reconnect_time=2.0, armed_by="A. Person"
)


def described(module, **safety):
    """The plain module, its read-back as a monitor of gain one."""
    monitor = {"name": "applied_output", "gain": 1.0, "tolerance": 0.1, "delay": 0.1}
    return module.description(safety={"monitor": monitor} | safety)


def test_a_trip_takes_the_output_to_zero_and_latches_until_acknowledged(module, tmp_path):
    target = described(module)
    begun = time.monotonic()
    # From a quarter of a second on, the reading is 0.15 V off: within the read-back's tolerance.
    module.read_back = lambda count: count + 983 * (count > 6000)
    volts, partial = np.full(100, 3.0), tmp_path / "a.partial"
    with pytest.raises(TripError, match="monitor of the high voltage"):
        acquire(target, volts, partial, SETTINGS)
    assert module.volts == 0.0
    assert time.monotonic() - begun < 10.0
    writes = len(module.history)
    with pytest.raises(InputError, match=r"tripped at .* monitor of the high voltage"):
        acquire(target, volts, tmp_path / "b.partial", SETTINGS)
    assert len(module.history) == writes
    assert "monitor" in latch.acknowledge(target, "A. Person")
    assert latch.acknowledge(target, "A. Person") is None
    module.read_back = lambda count: count
    assert acquire(target, volts, tmp_path / "c.partial", SETTINGS).record.sizes["time"] == 100


def test_an_interlock_of_one_bit_is_read_and_a_coil_switched_on_the_wire(module, tmp_path):
    safety = {"interlocks": {"door": {"name": "door"}}, "enable": {"name": "enable"}}
    plain = module.description()
    target = replace(
        device(safety=safety | {"heartbeat": None}), port=module.port, source=None,
        registers={name: device()[name] for name in ("door", "enable")} | dict(plain.registers),
    )  # fmt: skip

    def open_door(samples, _):
        assert module.enabled
        module.closed = 0

    with pytest.raises(TripError, match="interlock door: door reads 0"):
        acquire(target, np.full(100, 3.0), tmp_path / "a.partial", SETTINGS, watch=open_door)
    assert module.volts == 0.0
    assert not module.enabled


def switched(module):
    """The plain module with a coil that switches the high voltage."""
    registers = module.description().registers | {"enable": device()["enable"]}
    return replace(
        device(safety={"enable": {"name": "enable"}}),
        port=module.port, source=None, registers=registers, quarantine=0.2,
    )  # fmt: skip


def once_switched_on(module, answer):
    """Have ``answer(connection, frame)`` follow when the module has switched the voltage on."""
    usual = module._answer

    def answered(connection, frame):
        if frame[7] == WRITE_COIL and frame[10]:
            module.enabled = True
            answer(connection, frame)
        else:
            usual(connection, frame)

    module._answer = answered


def test_a_high_voltage_that_may_be_on_though_nothing_answers_is_switched_off(module, tmp_path):
    once_switched_on(module, lambda *_: None)
    with pytest.raises(LinkError) as caught:
        acquire(switched(module), np.full(50, 1.0), tmp_path / "a", replace(SETTINGS, retries=0))
    assert "The output is at zero" in caught.value.__notes__[0]
    assert not module.enabled
    assert not any(volts for _, volts in module.history)


def test_a_high_voltage_that_may_be_on_behind_a_lost_network_raises_the_alarm(module, tmp_path):
    once_switched_on(module, lambda *_: setattr(module, "deaf", True))
    lost = replace(SETTINGS, retries=0, reconnect_time=0.5)
    with pytest.raises(ZeroNotVerifiedError, match="switch the amplifier off"):
        acquire(switched(module), np.full(50, 1.0), tmp_path / "a", lost)
    notice = duty.look(duty.duty_file(module.description()))
    assert (notice.alive, notice.phase) == (True, duty.Phase.ALARM)
    assert module.enabled
    module.deaf = False
    deadline = time.monotonic() + 5.0
    while module.enabled:
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_one_that_is_killed_as_it_switches_on_has_left_a_voltage(module, tmp_path):
    phases = []

    def answer(connection, frame):
        phases.append(duty.look(duty.duty_file(module.description())).phase)
        connection.sendall(frame)

    once_switched_on(module, answer)
    acquire(switched(module), np.full(5, 1.0), tmp_path / "a", SETTINGS)
    assert set(phases) <= set(duty.DANGEROUS)
    assert phases


def test_a_switch_that_the_device_does_not_know_is_refused_without_an_alarm(module, tmp_path):
    def answer(connection, frame):
        module.enabled = False
        connection.sendall(frame[:4] + bytes([0, 3, frame[6], WRITE_COIL | 0x80, 2]))

    once_switched_on(module, answer)
    with pytest.raises(InputError, match="exception 2") as caught:
        acquire(switched(module), np.full(5, 1.0), tmp_path / "a", SETTINGS)
    assert caught.value.field == "safety.enable"
    assert "was refused" in by_hand.status(switched(module))
    assert not module.history


def test_a_switch_that_is_refused_after_an_attempt_without_an_answer_may_be_on(module, tmp_path):
    answers = iter([lambda *_: None])

    def answer(connection, frame):
        refused = frame[:4] + bytes([0, 3, frame[6], WRITE_COIL | 0x80, 3])
        next(answers, lambda *_: connection.sendall(refused))(connection, frame)

    once_switched_on(module, answer)
    with pytest.raises(DeviceError, match="exception 3") as caught:
        acquire(switched(module), np.full(5, 1.0), tmp_path / "a", SETTINGS)
    assert not isinstance(caught.value, InputError)
    assert "The output is at zero" in caught.value.__notes__[0]
    assert not module.enabled


def test_a_host_is_looked_up_once_so_that_what_was_checked_is_driven(module, tmp_path, monkeypatch):
    asked, look_up = [], socket.getaddrinfo

    def looked_up(host, *given, **named):
        asked.append(host)
        return look_up(host, *given, **named)

    monkeypatch.setattr(socket, "getaddrinfo", looked_up)
    target = described(module).at(host="localhost")
    acquire(target, np.full(5, 1.0), tmp_path / "a.partial", SETTINGS)
    assert asked.count("localhost") == 1
    assert max(volts for _, volts in module.history) == pytest.approx(1.0, abs=1e-3)


def test_nothing_is_driven_unless_somebody_has_armed_it(module, tmp_path):
    with pytest.raises(InputError, match="nobody has armed"):
        acquire(described(module), np.ones(5), tmp_path / "a", replace(SETTINGS, armed_by=""))
    assert not module.history


def test_signs_of_life_that_come_too_seldom_are_refused(module, tmp_path):
    """Polled, they are given with the samples."""
    slow = replace(device(), port=module.port, source=None, sampling_rate=1.0)
    with pytest.raises(InputError, match="a polled device is given one in 1 s") as caught:
        acquire(slow, np.zeros(5), tmp_path / "a", replace(SETTINGS, mode="polled"))
    assert caught.value.field == "safety.heartbeat.period"
    assert not module.history


def test_a_rate_beyond_the_largest_is_refused(module, tmp_path):
    target = described(module, max_rate=30.0)
    with pytest.raises(InputError, match=r"change by 49\.\d+ V/s at sample") as caught:
        acquire(target, np.array([1.0, 2.0, 1.0]), tmp_path / "a", SETTINGS)
    assert caught.value.field == "safety.max_rate"
    assert not module.history


@pytest.mark.parametrize("rate", [np.inf, np.nan, 0.0, -1.0])
def test_a_ramp_that_is_none_is_refused(module, tmp_path, rate):
    with pytest.raises(InputError, match="ramp_rate"):
        acquire(described(module), np.ones(5), tmp_path / "a", replace(SETTINGS, ramp_rate=rate))
    assert not module.history


def test_the_first_check_is_due_at_once_and_the_next_after_the_interval(clock):
    laws = Laws(Panel(memory()))
    assert laws.due()
    laws.check(0.0, 0.0)
    assert not laws.due()
    clock.sleep(0.9 * laws.interval)
    assert not laws.due()
    clock.sleep(0.2 * laws.interval)
    assert laws.due()


def latched_before_the_end(target, drive):
    """How long before it ended a drive had latched its trip, s."""
    latched = []

    def look():
        while not (latch.latch_file(target).exists() or ended.is_set()):
            time.sleep(0.01)
        latched.append(time.monotonic())

    ended = threading.Event()
    looking = threading.Thread(target=look)
    looking.start()
    drive()
    shown = time.monotonic()
    ended.set()
    looking.join()
    return shown - latched[0]


def test_a_trip_is_latched_before_zero_has_been_shown(module, tmp_path):
    """A guardian that dies on the way must not take the trip with it."""
    target = replace(described(module), quarantine=3.0)
    module.read_back = lambda count: count + 983 * (count > 6000)

    def drive():
        with pytest.raises(TripError):
            acquire(target, np.full(100, 3.0), tmp_path / "a.partial", SETTINGS)

    assert latched_before_the_end(target, drive) > 2.0
    latch.acknowledge(target, "A. Person")


def test_a_trip_on_the_way_to_zero_is_latched_before_it_is_shown(module, tmp_path):
    plain = module.description()
    target = replace(
        device(safety={"interlocks": {"door": {"name": "door"}}}), port=module.port, source=None,
        registers={"door": device()["door"]} | dict(plain.registers), quarantine=3.0,
    )  # fmt: skip
    write, written = module._write, [0]

    def open_door_as_it_falls(count):
        module.closed = int(count >= max(written))
        written.append(count)
        write(count)

    module._write = open_door_as_it_falls

    def drive():
        with pytest.raises(RuntimeError, match="enough"):
            acquire(target, np.full(100, 3.0), tmp_path / "a.partial", SETTINGS, watch=stop)

    def stop(*_):
        raise RuntimeError("enough")

    assert latched_before_the_end(target, drive) > 2.0
    assert "door reads 0" in latch.acknowledge(target, "A. Person")


@pytest.fixture
def full_disk(module, tmp_path, monkeypatch):
    """Drive until a trip that the disk does not take; return the device and the obstacle."""
    target, obstacle = described(module), tmp_path / "trips"
    monkeypatch.setitem(acquire.__globals__, "latch_file", lambda _: obstacle / "trip")
    obstacle.touch()  # a folder that cannot be made
    module.read_back = lambda count: count + 983 * (count > 6000)
    settings = replace(SETTINGS, reconnect_time=0.5)
    with pytest.raises(ZeroNotVerifiedError, match=r"monitor .* is not kept yet: .*trips"):
        acquire(target, np.full(100, 3.0), tmp_path / "a.partial", settings)
    assert module.volts == 0.0
    assert "has not taken its trip" in by_hand.status(target)
    module.read_back = lambda count: count
    return target, obstacle


def test_a_trip_reaches_the_disk_once_there_is_room(full_disk):
    _, obstacle = full_disk
    obstacle.unlink()
    deadline = time.monotonic() + 20
    while not (obstacle / "trip").exists():
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert "monitor of the high voltage" in (obstacle / "trip").read_text()


def test_a_trip_that_no_disk_has_taken_binds_though_its_guardian_was_dismissed(
    full_disk, module, tmp_path
):
    target, _ = full_disk
    assert "has shown that the output is at zero" in by_hand.dismiss(target)
    writes = len(module.history)
    with pytest.raises(InputError, match=r"tripped at .* monitor of the high voltage"):
        acquire(target, np.full(100, 3.0), tmp_path / "b.partial", SETTINGS)
    assert len(module.history) == writes
    assert "monitor" in latch.acknowledge(target, "A. Person")
    latch.refuse_latched(target)


def test_the_next_guardian_brings_a_held_trip_to_the_disk(module):
    target = described(module)
    latch.hold(target, "the door is open", WHEN)
    by_hand.zero(target, SETTINGS)
    assert latch.held(target) is None
    assert latch.trip(target)["time"] == WHEN
    assert latch.acknowledge(target, "A. Person") == "the door is open"


def test_a_start_that_is_refused_does_not_hide_that_it_was_driven_before(module, tmp_path):
    target, volts = module.description(), np.full(20, 1.0)
    acquire(target, volts, tmp_path / "a.partial", SETTINGS)
    module.read_back = lambda count: 20000
    with pytest.raises(InputError):
        acquire(target, volts, tmp_path / "b.partial", SETTINGS)
    assert "was refused before it had driven anything" in by_hand.status(target)


def test_a_trip_that_is_kept_while_a_drive_waits_for_the_output_binds_it(
    module, tmp_path, monkeypatch
):
    target = described(module)
    monkeypatch.setitem(
        acquire.__globals__, "refuse_latched",
        lambda _: latch.latch(latch.latch_file(target), target.name, "the door is open", WHEN),
    )  # fmt: skip
    with pytest.raises(InputError, match="the door is open"):
        acquire(target, np.full(100, 3.0), tmp_path / "a.partial", SETTINGS)
    assert not module.history
    latch.acknowledge(target, "A. Person")
