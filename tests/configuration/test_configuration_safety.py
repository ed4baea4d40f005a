"""Device descriptions that would drive a device dangerously, each refused by its key."""

import re
from pathlib import Path

import pytest
import yaml

from changed_content import changed
from dea.configuration.device import DeviceDescription
from dea.configuration.problems import validated
from dea.errors import InputError
from dea.modbus import read_device

GOOD = {
    "name": "amplifier",
    "endpoint": {"host": "127.0.0.1", "port": 502},
    "unit_id": 1,
    "sampling_rate": 50,
    "registers": {
        "output": {"address": 0, "range": [0, 10], "unit": "V", "access": "read_write"},
        "displacement": {"address": 0, "table": "input", "unit": "mm"},
        "claim": {"address": 9, "type": "uint32", "access": "read_write"},
        "voltage": {"address": 1, "table": "input", "unit": "V"},
        "current": {"address": 2, "table": "input", "unit": "A"},
        "door": {"address": 0, "table": "discrete", "type": "bool"},
        "enable": {"address": 0, "table": "coil", "type": "bool", "access": "read_write"},
        "alive": {"address": 1, "access": "write"},
        "switch": {"address": 2, "type": "int16", "access": "write"},
        "text": {"address": 20, "type": "string", "count": 4, "access": "read_write"},
    },
    "safety": {
        "monitor": {"name": "voltage", "gain": 800, "tolerance": 20},
        "current": {"name": "current", "limit": 3e-4},
        "interlocks": {"door": {"name": "door"}},
        "enable": {"name": "enable"},
        "heartbeat": {"name": "alive", "period": 0.5},
    },
}
DOCUMENT = Path(__file__).parents[2] / "docs" / "acquisition.md"
BLOCKS = {"address": 100, "count": 55, "access": "read_write"}


def good_but(changes):
    """Return the good description with other values at dotted keys."""
    content = GOOD
    for place, value in changes.items():
        content = changed(content, place.split("."), value)
    return content


def test_signals_with_registers_of_their_own_are_accepted():
    validated(DeviceDescription, good_but({}))
    validated(DeviceDescription, good_but({"safety.enable": {"name": "switch", "on": 32767}}))
    validated(DeviceDescription, good_but({"registers.device_index": {"address": 5}}))


def test_the_example_of_the_documentation_is_read(tmp_path):
    example = re.search(r"```yaml\n(safety:.*?)```", DOCUMENT.read_text(), re.DOTALL).group(1)
    registers = dict(GOOD["registers"])
    for key, name in (("voltage", "high_voltage"), ("door", "door_closed"), ("door", "trip")):
        registers[name] = {**GOOD["registers"][key], "address": 30 + len(registers)}
    description = {**GOOD, "registers": registers}
    del description["safety"]
    file = tmp_path / "device.yaml"
    file.write_text(yaml.safe_dump(description) + example)
    safety = read_device(file).safety
    assert (safety.enable.on, safety.enable.off) == (1, 0)
    assert (safety.film.thickness, safety.current.limit) == (50.0, 3e-4)  # µm, A


@pytest.mark.parametrize(
    ("changes", "field", "told"),
    [
        ({"safety.enable.on": 0}, "safety.enable.off", "0, as on"),
        ({"safety.enable.off": 2}, "safety.enable.off", "holds 1 at most"),
        ({"safety.enable": {"name": "switch", "off": 32768}}, "safety.enable.off", "32767 at most"),
        ({"safety.enable.name": "output"}, "safety.enable.name", "'output' is a register that"),
        ({"safety.enable.name": "claim"}, "safety.enable.name", "'claim' is a register that"),
        ({"safety.heartbeat.name": "output"}, "safety.heartbeat.name", "'output' is a register"),
        ({"safety.monitor.name": "output"}, "safety.monitor.name", "'output' is a register that"),
        ({"safety.heartbeat.name": "switch", "safety.enable.name": "switch"},
         "safety.heartbeat.name", "the register of safety.enable.name already"),
        ({"safety.current.name": "voltage"}, "safety.current.name", "of safety.monitor.name"),
        ({"safety.interlocks.trip": {"name": "enable"}}, "safety.interlocks.trip.name",
         "of safety.enable.name already"),
        ({"safety.heartbeat.name": "text"}, "registers.text.type", "string, count 4"),
        ({"safety.enable.name": "text"}, "registers.text.type", "string, count 4"),
        ({"safety.monitor.name": "door"}, "registers.door.type", "bool, count 1"),
        ({"registers.displacement": {"address": 7, "access": "write"}},
         "registers.displacement.access", "write. Give read or"),
        ({"registers.applied_output": {"address": 7, "access": "write"}},
         "registers.applied_output.access", "write. Give read or"),
        ({"registers.output.access": "read"}, "registers.output.access", "read. Give write"),
        ({"registers.output": {"address": 0, "unit": "V"}}, "registers.output.access",
         "missing, which means read"),
        ({"registers.device_index": {"address": 5, "type": "float32"}},
         "registers.device_index.type", "float32, count 1, and the device counts"),
        ({"registers.device_index": {"address": 5, "count": 2}},
         "registers.device_index.type", "uint16, count 2"),
    ],
)  # fmt: skip
def test_a_dangerous_description_is_refused(changes, field, told):
    with pytest.raises(InputError) as caught:
        validated(DeviceDescription, good_but(changes), "device.yaml")
    assert caught.value.field == field
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_heartbeat_that_no_mode_keeps_is_refused():
    slow = {"sampling_rate": 1, "safety.heartbeat.period": 0.3}
    with pytest.raises(InputError, match="a polled device is given one in 1 s") as caught:
        validated(DeviceDescription, good_but(slow))
    assert caught.value.field == "safety.heartbeat.period"
    fifo = slow | {"registers.block_samples": BLOCKS}
    described = validated(DeviceDescription, good_but(fifo))
    assert described.safety.unkept_heartbeat("buffered", described.sampling_rate) is None
    with pytest.raises(InputError, match="Give 1 s or more, here"):
        validated(DeviceDescription, good_but(fifo | {"safety.interval": 0.5}))
    as_written = {"sampling_rate": 30, "safety.heartbeat.period": 0.033}
    validated(DeviceDescription, good_but(as_written))
