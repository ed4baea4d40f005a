"""The registers of a polled sample, read together."""

import pytest
from made_device import module
from memory_link import MemoryLink

from dea.acquisition.panel import Panel
from dea.acquisition.poll import NEIGHBOURS, Poll
from dea.acquisition.retrying_link import DeviceRefusedError


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


def test_a_register_joins_the_group_beside_it_and_no_earlier_one():
    device = module(
        applied_output={"address": 10, "unit": "V"},
        displacement={"address": 100, "unit": "mm"},
        device_index={"address": 102},
    )
    names = [[each.name for each in w.registers] for w in Poll(Panel(MemoryLink(device))).windows]
    assert names == [["displacement", "device_index"], ["applied_output"]]


@pytest.mark.parametrize("refused", [False, True])
def test_registers_are_read_one_by_one_where_the_device_refuses_what_lies_between(refused):
    device = module(
        applied_output={"address": 10, "unit": "V"}, displacement={"address": 14, "unit": "mm"}
    )
    link = MemoryLink(device)
    poll = Poll(Panel(link))
    assert len(poll.windows) == 1

    def read(address, size, table="holding"):
        if refused:
            raise DeviceRefusedError(2, 3)
        return [0] * size

    link.read = read
    poll.learn()
    names = [[register.name for register in window.registers] for window in poll.windows]
    apart, together = [["applied_output"], ["displacement"]], [["applied_output", "displacement"]]
    assert names == (apart if refused else together)
