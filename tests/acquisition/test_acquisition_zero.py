"""What counts as zero, as within the limits and as the device described, at the thresholds."""

from pathlib import Path

import numpy as np
import pytest
from memory_link import Clock, MemoryLink

from dea.acquisition import LinkError, ReadBackError, ZeroNotVerifiedError
from dea.acquisition.output import Output
from dea.acquisition.panel import CONFIRMATIONS, Panel
from dea.acquisition.poll import NEIGHBOURS, Poll
from dea.acquisition.read_back import Echo, ReadBack
from dea.acquisition.verify import verify_device
from dea.acquisition.voltage_plan import check_excitation
from dea.acquisition.zero import STOP, Evidence, WayToZero
from dea.errors import InputError
from dea.modbus import parse_device

STEP = 0.001  # V, one count
OUTPUT = {"address": 0, "type": "int16", "access": "write", "scale": STEP, "unit": "V"}
ECHO = {"address": 1, "type": "int16", "scale": STEP, "unit": "V"}


def module(limits=(-10, 4), quarantine=0, **registers):
    return parse_device(
        {
            "name": "module",
            "endpoint": {"host": "127.0.0.1", "port": 502},
            "unit_id": 1,
            "sampling_rate": 100,
            "quarantine": quarantine,
            "registers": {"output": OUTPUT | {"limits": list(limits)}} | registers,
        },
        source=Path("module.yaml"),
    )


@pytest.fixture
def clock(monkeypatch):
    made = Clock()
    monkeypatch.setattr("dea.acquisition.zero.time", made)
    return made


def way(link, ramp_rate=1.0, requested=0.0):
    return WayToZero(Output(link), ramp_rate=ramp_rate, requested=requested)


@pytest.mark.parametrize("counts", [-1, 0, 1])
def test_one_count_is_zero_to_the_read_back(clock, counts):
    link = MemoryLink(module(applied_output=ECHO), applied_output=counts)
    Output(link).take()
    assert way(link)() == Evidence.READ_BACK
    assert link.written[-1] == ("output", [0])


@pytest.mark.parametrize("counts", [-5000, -2, 2, 5000])
def test_more_than_one_count_is_driven(clock, counts):
    link = MemoryLink(module(applied_output=ECHO), applied_output=counts)
    with pytest.raises(InputError, match=f"the output is not zero: {STEP * counts:g} V"):
        Output(link).take()
    assert link.written == []
    with pytest.raises(ZeroNotVerifiedError, match=f"the output reads {STEP * counts:g} V after"):
        way(link)()


def test_a_read_back_of_floats_shows_zero_and_no_number_does_not(clock):
    echo = {"address": 10, "type": "float32", "unit": "V", "tolerance": 0.01}
    link = MemoryLink(module(applied_output=echo), applied_output=0.005)
    output = Output(link)
    output.take()
    assert output.driven() == 0.0
    link.values["applied_output"] = 0.5
    assert output.driven() == pytest.approx(0.5)
    link.values["applied_output"] = np.nan
    with pytest.raises(LinkError, match="reads differently"):
        WayToZero(output, ramp_rate=1.0, requested=0.0)()


def test_the_way_to_zero_takes_its_time(clock):
    link = MemoryLink(module(), output=0)
    assert way(link, 2.0, requested=4.0)() == Evidence.ANSWERED
    # 4 V at 2 V/s; the last step needs no pause after it.
    assert clock.now == pytest.approx(2.0, abs=0.021)


@pytest.mark.parametrize(("seconds", "ends"), [(0.0, True), (9.0, True), (np.inf, False)])
def test_a_ramp_of_the_device_is_waited_for_twice_as_long_as_it_may_take(clock, seconds, ends):
    """Its limits are 10 V from zero at most, and its rate is 2 V/s."""
    device = module(applied_output=ECHO, state={"address": 2}, command={"address": 3})
    link = MemoryLink(device, applied_output=0, state=lambda: 1 if clock.now < seconds else 0)
    if ends:
        way(link, 2.0)()
        assert clock.now == pytest.approx(seconds, abs=0.1)
    else:
        with pytest.raises(ZeroNotVerifiedError, match="does not end its ramp"):
            way(link, 2.0)()
        assert 10.0 < clock.now < 15.0
    assert link.written == [("command", [STOP])]


def test_a_tripped_device_is_at_zero_already(clock):
    device = module(applied_output=ECHO, state={"address": 2}, command={"address": 3})
    link = MemoryLink(device, applied_output=0, state=3)
    way(link, 2.0)()
    assert link.written == []


@pytest.mark.parametrize(
    ("volts", "counts"), [(-10.0, -10_000), (4.0, 4000), (4.0004, 4000), (-10.0004, -10_000)]
)
def test_the_limits_themselves_are_allowed(volts, counts):
    assert check_excitation(module(), np.array([0.0, volts])).tolist() == [0, counts]


@pytest.mark.parametrize("volts", [-10.001, 4.001, -10.0006, 4.0006])
def test_a_count_beyond_the_limits_is_not(volts):
    with pytest.raises(InputError, match=f"sample 1 .* {volts:g} V, outside -10 to 4 V"):
        check_excitation(module(), np.array([0.0, volts]))


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_voltage_that_no_count_stands_for_is_refused_from_half_a_count_on(sign):
    everything = module(limits=(-40, 40))
    edge = 32767 if sign > 0 else -32768
    near, far = STEP * (edge + sign * 0.4), STEP * (edge + sign * 0.6)
    assert check_excitation(everything, np.array([near])).tolist() == [edge]
    with pytest.raises(InputError, match=r"outside -32\.768 to 32\.767 V"):
        check_excitation(everything, np.array([far]))


@pytest.mark.parametrize(("volts", "worst"), [([-11.5, 0, 5], 0), ([-10.5, 0, 5.1, 4.1], 2)])
def test_the_sample_farthest_outside_is_told(volts, worst):
    with pytest.raises(InputError, match=f"sample {worst} "):
        check_excitation(module(), np.array(volts, float))


def reported(**values):
    """Return the panel of a module that reports ``values`` in float registers of their names."""
    names = {
        name: {"address": 10 + 2 * i, "type": "float32", "unit": "V"}
        for i, name in enumerate(values)
    }
    return Panel(MemoryLink(module(**names), **values))


@pytest.mark.parametrize("low", [-10.5, -10.0, -9.9995])
@pytest.mark.parametrize("high", [4.5, 4.0, 3.9995])
def test_a_device_may_clamp_at_its_limits_or_outside(low, high):
    verify_device(reported(output_low_limit=low, output_high_limit=high))


@pytest.mark.parametrize(("low", "high"), [(-9.998, 4.0), (-10.0, 3.998), (0.0, 4.0)])
def test_a_device_that_clamps_inside_its_limits_is_refused(low, high):
    with pytest.raises(InputError, match=r"the device clamps at .* inside the limit"):
        verify_device(reported(output_low_limit=low, output_high_limit=high))


@pytest.mark.parametrize("end", ["low", "high"])
@pytest.mark.parametrize(("share", "same"), [(0.7e-5, True), (-0.7e-5, True), (1.4e-5, False)])
def test_a_range_may_differ_by_a_hundred_thousandth_of_its_span(end, share, same):
    device = module(
        sensor={"address": 4, "range": [-3, 5], "unit": "V"},
        **{f"sensor_range_{end}": {"address": 10, "type": "float32"}},
    )
    found = (5.0 if end == "high" else -3.0) + 8.0 * share
    panel = Panel(MemoryLink(device, **{f"sensor_range_{end}": found}))
    if same:
        verify_device(panel)
    else:
        with pytest.raises(InputError, match=f"registers.sensor_range_{end}"):
            verify_device(panel)


READ_BACK = {"applied_output": ECHO, "state": {"address": 2}}


def checked(volts, reading, *, state=2, at=(2, 4)):
    """Read ``reading`` (V) after two of the samples ``volts`` were played; check it after four."""
    link = MemoryLink(
        module(limits=(0, 10), **READ_BACK), applied_output=round(reading / STEP), state=state
    )
    read_back = ReadBack(Panel(link), np.rint(np.array(volts) / STEP), 0.05)
    for position in at:
        read_back(position)
    return read_back


# volts[k] is applied after k + 1 samples: between two and four samples, 5 to 7 V are.
PLAYED = [9.0, 5.0, 6.0, 7.0, 2.0]


@pytest.mark.parametrize("reading", [4.6, 5.0, 7.0, 7.4])
def test_a_reading_may_be_any_value_played_around_it(reading):
    assert not checked(PLAYED, reading).pending


@pytest.mark.parametrize("reading", [0.0, 4.4, 7.6])
def test_a_reading_that_was_not_played_around_it_is_an_error(reading):
    with pytest.raises(ReadBackError, match="while 5 to 7 V are played"):
        checked(PLAYED, reading)


@pytest.mark.parametrize(("volts", "state"), [(0.9, 2), (5.0, 1), (5.0, 3)])
def test_a_reading_near_zero_or_of_a_device_that_does_not_play_says_nothing(volts, state):
    assert checked([volts] * 5, 0.0, state=state).pending


def test_a_reading_is_compared_only_with_the_output_clear_of_zero():
    assert checked([3.0, 1.1, 1.1, 0.9, 3.0], 0.0).pending
    with pytest.raises(ReadBackError):
        checked([3.0, 1.1, 1.1, 1.1, 0.0], 0.0)


def test_a_read_back_one_sample_late_is_trusted_but_its_sample_flagged():
    panel = Panel(MemoryLink(module(limits=(0, 10), applied_output=ECHO)))
    echo = Echo(panel, "applied_output", 0.05)  # 0.5 V
    asked = [1000, 1400, 2000, 2600, 3200]
    assert [echo(now, before) for before, now in zip([1000, *asked], asked, strict=False)] == [
        True, True, False, False, False,
    ]  # fmt: skip
    assert [echo(count, 1000) for count in (4000, 5000)] == [False, False]
    with pytest.raises(ReadBackError, match="cannot say whether the output is at zero"):
        echo(6000, 1000)


def test_a_value_is_confirmed_by_the_next_reading_alone():
    def panel(readings):
        return Panel(MemoryLink(module(state={"address": 2}), state=iter(readings).__next__))

    assert panel([1, 2, 1, 3, 3]).confirmed("state") == 3
    # A first reading and as many more as are allowed, of which the last two agree.
    assert panel([*range(CONFIRMATIONS), CONFIRMATIONS - 1]).confirmed("state") == CONFIRMATIONS - 1
    with pytest.raises(LinkError, match="reads differently each time"):
        panel(range(CONFIRMATIONS + 1)).confirmed("state")


@pytest.mark.parametrize(("apart", "requests"), [(NEIGHBOURS - 1, 1), (NEIGHBOURS, 2)])
def test_a_sample_takes_one_request_where_its_registers_are_near(apart, requests):
    device = module(
        applied_output={"address": 10, "unit": "V"},
        displacement={"address": 10 + apart, "unit": "mm"},
        device_index={"address": 9, "table": "input"},
    )  # fmt: skip
    windows = Poll(Panel(MemoryLink(device))).windows
    assert len(windows) == requests + 1
    assert "displacement" in [register.name for register in windows[0].registers]


def test_of_played_samples_those_applied_beyond_the_tolerance_are_not_right():
    """Half a volt is tolerated; the read-back counts tenths of a volt."""
    register = ECHO | {"scale": 0.1}
    panel = Panel(MemoryLink(module(limits=(0, 10), applied_output=register)))
    counts = np.array([4000, 4000, 4000, 4000, 4000, 0])
    applied = np.array([40, 36, 44, 34, 46, 0])
    right = Echo(panel, "applied_output", 0.05).right(counts, applied)
    assert right.tolist() == [True, True, True, False, False, True]
