"""How far a device may differ from its description, at the thresholds."""

import pytest
from made_device import module
from memory_link import MemoryLink

from dea.acquisition.panel import Panel
from dea.acquisition.verify import verify_device
from dea.errors import InputError


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
