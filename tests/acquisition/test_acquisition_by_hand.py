"""What a person is told about an output, and does to it."""

import os
import re
import time
from dataclasses import replace
from datetime import datetime
from types import SimpleNamespace

import numpy as np
import pytest
from made_device import ECHO, module
from memory_link import MemoryLink

from dea.acquisition import (
    AcquisitionSettings,
    LinkError,
    ZeroNotVerifiedError,
    by_hand,
    duty,
    latch,
)
from dea.acquisition.duty import Duty, Order, Phase
from dea.configuration.safety import Safety
from dea.errors import DeviceError, InputError
from dea.progress import heard_by, tell


@pytest.fixture
def device(monkeypatch):
    """A module that reads 1.5 V."""
    monkeypatch.setattr(by_hand, "Link", lambda device, _: MemoryLink(device, applied_output=1500))
    return module(limits=(0, 10), applied_output=ECHO)


def asked(device):
    """Return what was asked of the guardian of a device."""
    content = duty.duty_file(device).read_bytes()
    return Order(content[9])


def test_an_output_that_nobody_has_driven_is_read(device):
    assert by_hand.status(device).splitlines() == [
        "nothing was driven since this machine started",
        "the output reads 1.5 V",
    ]


@pytest.mark.parametrize(
    ("phase", "alive", "after"),
    [
        (Phase.CHECKING, "checks the device", "checks the device"),
        (Phase.DRIVING, "drives", "was killed before it had shown zero"),
        (Phase.TO_ZERO, "ramps to zero", "was killed before it had shown zero"),
        (Phase.ALARM, "ALARM: cannot show that the output is at zero", "was killed before it had"),
        (Phase.AT_ZERO, "has shown that the output is at zero", "has shown that the output"),
        (Phase.DISMISSED, "was dismissed before zero was shown", "was dismissed before zero"),
        (Phase.REFUSED, "was refused before it had driven anything", "was refused before it had"),
        (
            Phase.UNKEPT,
            "has shown that the output is at zero; the disk has not taken its trip",
            "has shown that the output is at zero",
        ),
    ],
)
def test_a_guardian_is_named_with_what_it_does_and_last_asked_for(device, phase, alive, after):
    with Duty(device) as guardian:
        before = time.time()
        guardian.put(phase, 2.25)
        [told] = by_hand.status(device).splitlines()
    found = re.fullmatch(rf"guardian {os.getpid()} (.*); asked for 2.25 V \((.*)\)", told)
    assert found[1] == alive
    assert abs(datetime.fromisoformat(found[2]).timestamp() - before) <= 2.0
    told, reading = by_hand.status(device).splitlines()
    assert told.startswith(f"guardian {os.getpid()} {after}")
    assert reading == "the output reads 1.5 V"


def test_the_trip_is_told_with_its_time_and_before_the_reading(device):
    latch.latch(latch.latch_file(device), device.name, "the door is open", latch.utc_now())
    _, tripped, reading = by_hand.status(device).splitlines()
    assert re.fullmatch(r"tripped at \d{4}-.*Z: the door is open", tripped)
    assert reading == "the output reads 1.5 V"


def test_an_output_without_a_read_back_is_told_as_such(device):
    assert by_hand.status(module()).splitlines()[-1] == "the output has no read-back"


def test_the_connection_is_closed_though_the_reading_fails(device, monkeypatch):
    closed = []
    link = SimpleNamespace(close=lambda: closed.append(True))
    monkeypatch.setattr(by_hand, "Link", lambda *_: link)

    def fail(_):
        raise OSError("unplugged")

    monkeypatch.setattr(by_hand, "Output", fail)
    with pytest.raises(OSError, match="unplugged"):
        by_hand.status(device)
    assert closed == [True]


@pytest.mark.parametrize("phase", duty.ALARMING)
def test_a_guardian_that_raises_its_alarm_is_dismissed_until_it_goes(device, phase, monkeypatch):
    with Duty(device) as guardian:
        guardian.put(phase, 3.0)
        orders = []

        def wait(seconds):
            assert 0.0 < seconds < 0.5
            orders.append(asked(device))
            guardian.clear_order()
            if len(orders) == 3:
                guardian.put(Phase.DISMISSED, 3.0)

        monkeypatch.setattr(by_hand.time, "sleep", wait)
        assert "was dismissed before zero was shown" in by_hand.dismiss(device)
        assert orders == [Order.DISMISS] * 3
        monkeypatch.undo()


@pytest.mark.parametrize("phase", [phase for phase in Phase if phase not in duty.ALARMING])
def test_a_guardian_without_an_alarm_is_not_dismissed(device, phase):
    with Duty(device) as guardian:
        guardian.put(phase, 3.0)
        with pytest.raises(InputError, match=r"no guardian raises an alarm: .*acquisition zero"):
            by_hand.dismiss(device)
        assert asked(device) == Order.NONE


def test_an_alarm_whose_guardian_is_gone_is_not_dismissed(device):
    with Duty(device) as guardian:
        guardian.put(Phase.ALARM, 3.0)
    with pytest.raises(InputError, match=r"no guardian raises an alarm: .* was killed"):
        by_hand.dismiss(device)
    assert asked(device) == Order.NONE


@pytest.fixture
def jobs(monkeypatch):
    """The jobs that recorders are given, which show zero at once."""
    given = []

    class Recorder:
        evidence = "0 V for 1 s"

        def __init__(self, job, *_):
            given.append(job)

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def await_zero(self):
            tell("awaited")

    monkeypatch.setattr(by_hand, "Recorder", Recorder)
    return given


def test_zero_is_reached_no_faster_than_the_safety_model_allows(device, jobs):
    told, slow = [], replace(device, safety=Safety(max_rate=2.0))
    with heard_by(told.append):
        by_hand.zero(slow, AcquisitionSettings(ramp_rate=5.0))
        by_hand.zero(slow, AcquisitionSettings(ramp_rate=1.5))
    assert [job.settings.ramp_rate for job in jobs] == [2.0, 1.5]
    warning, *others = told
    assert "2 V/s, as safety.max_rate allows" in warning
    assert others == ["awaited"] * 2


def test_zero_is_asked_of_the_guardian_until_it_ends_and_then_shown(device, jobs, monkeypatch):
    orders, told = [], []
    guardian = Duty(device).__enter__()
    guardian.put(Phase.DRIVING, 4.0)

    def wait(seconds):
        assert 0.1 < seconds < 1.5
        orders.append(asked(device))
        guardian.clear_order()
        if len(orders) == 2:
            guardian.__exit__(None, None, None)

    monkeypatch.setattr(by_hand.time, "sleep", wait)
    with heard_by(told.append):
        assert by_hand.zero(device, AcquisitionSettings()) == "0 V for 1 s"
    monkeypatch.undo()
    assert orders == [Order.ZERO] * 2
    assert [each.startswith(f"module: guardian {os.getpid()} drives; ") for each in told] == [
        True, True, False,
    ]  # fmt: skip
    [job] = jobs
    assert (job.reset, job.token) == (False, 0)
    np.testing.assert_array_equal(job.counts, [])


def test_zero_is_not_awaited_for_longer_than_an_alarm_takes(device, jobs, clock, monkeypatch):
    monkeypatch.setattr(by_hand.time, "monotonic", lambda: clock.now)
    monkeypatch.setattr(by_hand.time, "sleep", clock.sleep)
    settings = AcquisitionSettings(reconnect_time=20.0)
    with Duty(device) as guardian:
        guardian.put(Phase.ALARM, 3.0)
        with pytest.raises(ZeroNotVerifiedError, match=r"ALARM.* asked for 3 V"):
            by_hand.zero(device, settings)
        assert asked(device) == Order.ZERO
    assert clock.now == pytest.approx(20.0, abs=1.5)
    assert jobs == []


def test_a_trip_that_no_disk_takes_is_no_danger_and_not_awaited_either(
    device, jobs, clock, monkeypatch
):
    monkeypatch.setattr(by_hand.time, "monotonic", lambda: clock.now)
    monkeypatch.setattr(by_hand.time, "sleep", clock.sleep)
    with Duty(device) as guardian:
        guardian.put(Phase.UNKEPT, 0.0)
        with pytest.raises(DeviceError, match=r"at zero; .* Make room in") as caught:
            by_hand.zero(device, AcquisitionSettings(reconnect_time=20.0))
    assert not isinstance(caught.value, ZeroNotVerifiedError)
    assert clock.now == pytest.approx(20.0, abs=1.5)
    assert jobs == []


def test_a_device_that_is_off_hides_neither_guardian_nor_trip(device, monkeypatch):
    """As it is after an emergency stop."""

    def silent(_):
        raise LinkError("no reply from 10.0.0.7")

    monkeypatch.setattr(by_hand.Output, "applied", silent)
    latch.latch(latch.latch_file(device), device.name, "the door is open", latch.utc_now())
    with Duty(device) as guardian:
        guardian.put(Phase.DRIVING, 3.0)
    killed, tripped, reading = by_hand.status(device).splitlines()
    assert "was killed before it had shown zero; asked for 3 V" in killed
    assert "the door is open" in tripped
    assert reading == "the output cannot be read: no reply from 10.0.0.7"


def test_an_output_that_was_dismissed_has_not_been_taken_to_zero(device):
    with Duty(device) as guardian:
        guardian.put(Phase.DISMISSED, 3.0)
    assert duty.look(duty.duty_file(device)).abandoned
