"""The registers of a polled sample, read together."""

import pytest
from made_device import module
from memory_link import MemoryLink

from dea.acquisition.panel import Panel
from dea.acquisition.poll import NEIGHBOURS, Poll


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
