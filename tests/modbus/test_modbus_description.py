import copy
import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from dea.configuration.register import KNOWN
from dea.errors import InputError
from dea.modbus import parse_device, read_device
from dea.modbus.block import BLOCK, REPLY

DEVICES = sorted((Path(__file__).parents[2] / "config/devices").glob("*.yaml"))

GOOD = {
    "name": "module",
    "endpoint": {"host": "127.0.0.1", "port": 502},
    "unit_id": 1,
    "sampling_rate": 50,
    "registers": {
        "output": {"address": 0, "range": [0, 10], "unit": "V", "limits": [0, 4],
                   "access": "read_write"},
        "displacement": {"address": 0, "table": "input", "scale": 0.01, "unit": "mm"},
        "serial_number": {"address": 10, "type": "uint32"},
    },
}  # fmt: skip


@pytest.mark.parametrize("path", DEVICES, ids=lambda path: path.stem)
def test_the_ready_descriptions_are_good(path):
    device = read_device(path)
    assert device.source == path
    assert device["output"].limits is not None
    assert device["output"].access == "read_write"
    assert device["displacement"].unit == "mm"


def broken(change):
    content = copy.deepcopy(GOOD)
    change(content)
    return content


def setter(*path_and_value):
    *path, key, value = path_and_value

    def change(content):
        for part in path:
            content = content[part]
        content[key] = value

    return change


@pytest.mark.parametrize(
    ("change", "field", "message"),
    [
        (setter("unit_id", 248), "unit_id", "0 to 247"),
        (setter("unit_id", "one"), "unit_id", "0 to 247"),
        (setter("endpoint", "port", 70000), "endpoint.port", "65535"),
        (setter("endpoint", "prot", 502), "endpoint.prot", "Known here"),
        (setter("framing", "rtu"), "framing", "rtu_over_tcp"),
        (setter("sampling_rate", 0), "sampling_rate", "above 0 Hz"),
        (setter("registers", {}), "registers", "at least"),
        (setter("registers", "output", "type", "uint12"), "registers.output.type", "uint16"),
        (setter("registers", "command", {"address": 98, "access": "write"}), "registers.state",
         "missing beside a register command"),
        (setter("registers", "output", "limits", [4, 0]), "registers.output.limits", "cross"),
        (setter("registers", "output", "limits", [4]), "registers.output.limits", "low, high"),
        (setter("registers", "output", "limits", [1, 4]), "registers.output.limits", "out 0 V"),
        (setter("registers", "output", "limits", [0, 11]), "registers.output.limits",
         r"\[0, 11\] leaves the range \[0, 10\]"),
        (setter("registers", "output", "scale", 2), "registers.output.range", "Keep one"),
        (setter("registers", "output_hihg_limit", {"address": 99}), "registers.output_hihg_limit",
         "mean 'output_high_limit'"),
        (setter("registers", "output", "adress", 3), "registers.output.adress", "Known here"),
        (setter("registers", "output", "address", 65536), "registers.output.address", "65535"),
        (setter("registers", "output", "expect", "text"), "registers.output.expect", "type"),
        (setter("registers", "displacement", "access", "write"), "registers.displacement.access",
         "only be read"),
        (setter("registers", "displacement", "scale", 0), "registers.displacement.scale", "count"),
        (setter("registers", "output", "address", 11), "registers.output.address", "overlaps"),
        (setter("registers", "serial_number", "address", 65535), "registers.serial_number.address",
         "runs past"),
        (lambda content: content["registers"]["displacement"].pop("unit"),
         "registers.displacement.unit", "missing. Give the scale or range"),
        (lambda content: content["registers"]["displacement"].update(unit="um"),
         "registers.displacement.unit", "'um', and a record holds it in mm. Give the scale"),
        (lambda content: content["registers"]["output"].update(unit="kV"),
         "registers.output.unit", "'kV', and a record holds it in V. Give the scale or range"),
        (setter("framing", "serial"), "serial", "missing"),
        (setter("endpoint", None), "endpoint", "missing"),
        (setter("registers", "output", 7), "registers.output", "mapping"),
        (setter("registers", "claim", {"address": 90}), "registers.claim.type", "one of uint32"),
        (setter("registers", "claim", {"address": 90, "type": "int32"}), "registers.claim.type",
         "one of uint32"),
        (setter("registers", "block_crc", {"address": 90}), "registers.block_crc.type", "uint32"),
        (setter("registers", "reply_next", {"address": 90, "type": "uint32", "count": 2}),
         "registers.reply_next.type", "count: 1"),
        (setter("registers", "block_samples", {"address": 90, "type": "float32", "count": 9}),
         "registers.block_samples.type", "one of uint16"),
        (setter("registers", "fifo_length", {"address": 90, "type": "float32"}),
         "registers.fifo_length.type", "one of uint16"),
        (setter("registers", "watchdog_time", {"address": 90, "type": "string", "count": 2}),
         "registers.watchdog_time.type", "one of uint16"),
        (setter("registers", "levels", {"address": 90, "count": 3, "expect": 1}),
         "registers.levels.expect", "holds 3 values"),
    ],
)  # fmt: skip
def test_a_wrong_description_names_the_field_and_the_remedy(change, field, message):
    with pytest.raises(InputError, match=message) as caught:
        parse_device(broken(change), source=Path("device.yaml"))
    assert caught.value.field == field
    assert caught.value.remedy
    assert "device.yaml" in str(caught.value)


@pytest.mark.parametrize(
    ("framing", "section", "field"),
    [
        ("serial", {"port": "/dev/ttyS0", "parity": "X"}, "serial.parity"),
        ("serial", {"port": 3}, "serial.port"),
        ("serial", {"port": "/dev/ttyS0", "baudrate": "fast"}, "serial.baudrate"),
        ("serial", {"port": "/dev/ttyS0", "stopbits": 3}, "serial.stopbits"),
        ("serial", {"baud": 9600}, "serial.baud"),
        ("tls", {"ca_file": 3}, "tls.ca_file"),
        ("tls", {"ca": "authority.pem"}, "tls.ca"),
        ("tls", "authority.pem", "tls"),
    ],
)
def test_a_wrong_line_or_certificate_is_refused(framing, section, field):
    content = broken(setter("framing", framing)) | {framing: section}
    with pytest.raises(InputError) as caught:
        parse_device(content)
    assert caught.value.field == field


@pytest.mark.slow
@given(st.recursive(st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
                    lambda inner: st.lists(inner, max_size=3)
                    | st.dictionaries(st.sampled_from([*GOOD, "address", "type"]), inner,
                                      max_size=4)))  # fmt: skip
def test_anything_else_is_an_input_error(content):
    with pytest.raises(InputError):
        parse_device(content)


@given(st.data())
def test_one_damaged_leaf_is_accepted_or_named(data):
    content = copy.deepcopy(GOOD)
    place = content
    while True:
        key = data.draw(st.sampled_from(sorted(place)))
        if not isinstance(place[key], dict) or data.draw(st.booleans()):
            break
        place = place[key]
    place[key] = data.draw(
        st.none() | st.integers() | st.floats() | st.text(max_size=3) | st.lists(st.integers())
    )
    failure = None
    try:
        parse_device(content, source=Path("device.yaml"))
    except InputError as error:
        failure = error
    assert failure is None or failure.field


def test_misspelt_names_are_told_from_registers_of_ones_own():
    assert {*BLOCK, *REPLY} <= set(KNOWN)
    every = yaml.safe_load(DEVICES[-1].read_text())
    assert set(KNOWN) <= set(every["registers"])
    own = broken(setter("registers", "status", {"address": 99}))
    assert "status" in parse_device(own)
    for name in KNOWN:
        letters = list(name)
        letters[1:3] = letters[2:0:-1]
        content = copy.deepcopy(every)
        if (misspelt := "".join(letters)) != name:
            content["registers"][misspelt] = content["registers"].pop(name)
            with pytest.raises(InputError, match=f"Did you mean '{name}'"):
                parse_device(content)


def test_unreadable_files_are_named(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_device(tmp_path / "missing.yaml")
    (tmp_path / "bad.yaml").write_text("registers: [")
    with pytest.raises(InputError, match="not valid YAML"):
        read_device(tmp_path / "bad.yaml")
    (tmp_path / "good.yaml").write_text(yaml.safe_dump(GOOD))
    assert read_device(tmp_path / "good.yaml")["output"].scale == pytest.approx(10 / 65535)


def test_the_manual_lists_every_register_of_the_bench():
    device = read_device(next(path for path in DEVICES if path.stem == "virtual_bench"))
    manual = (DEVICES[0].parents[2] / "docs/acquisition.md").read_text()
    listed = re.findall(r"^\| (\d+)(?:–(\d+))? \| `(\w+)` \|", manual, re.MULTILINE)
    assert {(name, int(first), int(last or first) + 1) for first, last, name in listed} == {
        (register.name, register.address, register.end) for register in device.registers.values()
    }
