"""Registers by name."""

import pytest
from made_device import STEP, module
from memory_link import MemoryLink

from dea.acquisition import LinkError
from dea.acquisition.panel import CONFIRMATIONS, Panel


def test_a_value_is_confirmed_by_the_next_reading_alone():
    def panel(readings):
        return Panel(MemoryLink(module(state={"address": 2}), state=iter(readings).__next__))

    assert panel([1, 2, 1, 3, 3]).confirmed("state") == 3
    # A first reading and as many more as are allowed, of which the last two agree.
    assert panel([*range(CONFIRMATIONS), CONFIRMATIONS - 1]).confirmed("state") == CONFIRMATIONS - 1
    with pytest.raises(LinkError, match="reads differently each time"):
        panel(range(CONFIRMATIONS + 1)).confirmed("state")


def test_the_physical_value_of_an_array_is_a_list_and_of_text_itself():
    registers = {
        "levels": {"address": 10, "type": "int16", "count": 3, "scale": STEP, "offset": 1.0},
        "label": {"address": 20, "type": "string", "count": 2},
    }
    panel = Panel(MemoryLink(module(**registers), levels=[0, -500, 2000], label="abc"))
    assert panel.physical("levels") == pytest.approx([1.0, 0.5, 3.0])
    assert panel.physical("label") == "abc"
