"""A controller that gives the voltage of each sample, behind the guardian of any acquisition."""

import re
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dea import modbus
from dea.acquisition import (
    AcquisitionSettings,
    ClosedLoop,
    ControllerError,
    StoppedError,
    acquire,
)
from dea.acquisition.closed_loop import Asked
from dea.acquisition.voltage_plan import OutputPlan
from dea.errors import InputError
from dea.modbus import read_device, to_counts, to_physical
from served_bench import DESCRIPTION

SETTINGS = AcquisitionSettings(
    mode="polled", ramp_rate=50.0, timeout=0.5, reconnect_time=1.0, paced=False
)
DEVICE = read_device(DESCRIPTION)
SAMPLES = 60
DOCUMENT = Path(__file__).parents[2] / "docs" / "acquisition.md"


class Law:
    """u(k + 1) of u(k) and y(k): easy to compute again from a record."""

    def __init__(self):
        self.measured = []

    def __call__(self, displacement):
        self.measured.append(displacement)
        return 2.0 + 0.05 * displacement


def loop(controller, **changes):
    return ClosedLoop(**{"controller": controller, "samples": SAMPLES, "start": 2.0, "rate": 100.0}
                      | changes)  # fmt: skip


def test_each_voltage_is_the_answer_to_the_sample_before(serve_bench, tmp_path):
    bench, law = serve_bench(), Law()
    record = acquire(bench.endpoint, loop(law), tmp_path / "a.partial", SETTINGS).record
    assert record.sizes["time"] == len(law.measured) == SAMPLES
    expected = to_counts(DEVICE["output"], 2.0 + 0.05 * np.array(law.measured))
    assert np.array_equal(record.voltage_counts, expected)
    assert np.allclose(record.displacement[:-1], law.measured[1:])
    before = bench.displacement[record.device_index.values[0] - 1]
    assert law.measured[0] == pytest.approx(to_physical(DEVICE["displacement"], before))
    assert bench.applied[-1] == 0


def test_the_example_of_the_documentation_drives_within_its_limits(
    serve_bench, tmp_path, monkeypatch
):
    bench = serve_bench()
    monkeypatch.setattr(modbus, "read_device", lambda _: bench.endpoint)
    monkeypatch.chdir(tmp_path)
    text = DOCUMENT.read_text().split("<!-- closed loop")[1]
    example = re.search(r"```python\n(.*?)```", text, re.DOTALL).group(1)
    names = {}
    exec(example.replace('mode="polled"', 'mode="polled", ramp_rate=50.0, paced=False'), names)
    record = names["acquired"].record
    assert record.sizes["time"] == 500
    assert float(record["displacement"][-1]) > 0.8
    assert float(record["voltage"][-1]) == pytest.approx(1.1, abs=1e-3)


def test_a_paced_loop_keeps_its_deadlines_too(serve_bench, tmp_path):
    bench = serve_bench(virtual_clock=False)
    settings = replace(SETTINGS, paced=True)
    acquired = acquire(bench.endpoint, loop(Law()), tmp_path / "a.partial", settings)
    written = acquired.link.write_time.values
    late = written - written[0] - 0.02 * np.arange(written.size)
    # The host may pause once.
    assert np.median(np.abs(late - np.median(late))) < 0.005
    assert np.array_equal(np.diff(acquired.record.device_index), np.ones(SAMPLES - 1))


def test_a_reading_at_the_end_of_its_range_is_no_measurement(serve_bench, tmp_path):
    law = Law()
    bench = serve_bench()
    advance = bench.plant.advance

    def ended(counts):
        applied, measured = advance(counts)
        return applied, np.full_like(measured, 65535) if len(bench.applied) == 30 else measured

    bench.plant.advance = ended
    with pytest.raises(ControllerError, match="gave nan V"):
        acquire(bench.endpoint, loop(law), tmp_path / "a.partial", SETTINGS)
    assert np.isnan(law.measured[-1])
    assert bench.applied[-1] == 0


@pytest.mark.parametrize(
    ("wanted", "reason"),
    [(3.9, "outside the limits"), (-0.1, "outside the limits"), (float("inf"), "gave inf V"),
     (3.5, "faster than its rate")],
)  # fmt: skip
def test_a_voltage_that_is_not_allowed_is_never_applied(serve_bench, tmp_path, wanted, reason):
    bench, volts = serve_bench(), iter([2.0] * 20 + [wanted] * 20)
    with pytest.raises(ControllerError, match=reason):
        acquire(
            bench.endpoint, loop(lambda _: next(volts), rate=20.0), tmp_path / "a.partial", SETTINGS
        )
    assert to_physical(DEVICE["output"], bench.applied.max()) < 2.001
    assert bench.applied[-1] == 0


def test_what_a_controller_raises_is_raised_with_the_output_at_zero(serve_bench, tmp_path):
    bench, law, partial = serve_bench(), Law(), tmp_path / "a.partial"

    def failing(displacement):
        if len(law.measured) == 25:
            raise ZeroDivisionError("a mistake")
        return law(displacement)

    with pytest.raises(ZeroDivisionError, match="a mistake"):
        acquire(bench.endpoint, loop(failing), partial, SETTINGS)
    assert bench.applied.max() > 0
    assert bench.applied[-1] == 0
    assert b"a mistake" in partial.read_bytes()


def test_a_controller_that_hangs_does_not_hold_the_voltage(serve_bench, tmp_path):
    """The guardian does not wait for it: it is at zero while the controller still hangs."""
    bench, law, at_zero = serve_bench(virtual_clock=False), Law(), []

    def hanging(displacement):
        if len(law.measured) == 25:
            time.sleep(1.8)
            at_zero.append(bench.applied[-1] == 0)
        return law(displacement)

    paced = replace(SETTINGS, paced=True)
    with pytest.raises(ControllerError, match="no voltage for 1 s"):
        acquire(bench.endpoint, loop(hanging), tmp_path / "a.partial", paced)
    assert at_zero == [True]


def test_a_device_whose_clock_waits_waits_for_a_busy_host(serve_bench, tmp_path):
    """What is recorded there does not depend on the host's load."""
    records = []
    for pause in 0.0, 1.3:
        law = Law()

        def slow(displacement, law=law, pause=pause):
            if len(law.measured) == 25:
                time.sleep(pause)
            return law(displacement)

        partial = tmp_path / f"{pause}.partial"
        records.append(acquire(serve_bench().endpoint, loop(slow), partial, SETTINGS).record)
    assert np.array_equal(records[0]["voltage"], records[1]["voltage"])

    def hanging(displacement):
        time.sleep(2.0)
        return 2.0

    with pytest.raises(StoppedError, match="behind"):
        acquire(serve_bench().endpoint, loop(hanging), tmp_path / "a.partial",
                replace(SETTINGS, stall_time=1.0))  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "settings", "field"),
    [({}, {"mode": "buffered"}, "mode"), ({}, {"on_break": "restart"}, "on_break"),
     ({"start": 3.9}, {}, "limits"), ({"rate": 0.0}, {}, "rate"),
     ({"samples": 0}, {}, "no samples")],
)  # fmt: skip
def test_bad_loops_are_refused_before_any_voltage(serve_bench, tmp_path, changes, settings, field):
    bench = serve_bench()
    with pytest.raises(InputError, match=field):
        acquire(
            bench.endpoint, loop(Law(), **changes), tmp_path / "a", replace(SETTINGS, **settings)
        )
    assert not bench.applied.any()
    assert not Path(tmp_path / "a").exists()


def test_samples_left_out_repeat_the_last_count_and_ask_for_nothing():
    asked = []
    sequence = Asked(DEVICE, OutputPlan(np.array([5, 9]), 2, 10), 100, asked.append, lambda: 20)
    assert [sequence.count(0), sequence.count(1)] == [5, 9]
    sequence.measured(1, 77)
    assert [sequence.count(number) for number in (2, 3, 4)] == [20, 20, 20]
    assert asked == [77]
    sequence.measured(11, 78)  # the last sample has none after it
    assert asked == [77]
