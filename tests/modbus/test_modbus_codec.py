import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymodbus.client.mixin import ModbusClientMixin

from dea.errors import InputError
from dea.modbus import (
    Register,
    decode,
    encode,
    limit_counts,
    parse_device,
    representable,
    to_counts,
    to_physical,
)

ORDERS = ("big", "little")
INTEGERS = {"uint16": (0, 16), "int16": (1, 16), "uint32": (0, 32), "int32": (1, 32),
            "uint64": (0, 64), "int64": (1, 64)}  # fmt: skip
DATATYPE = ModbusClientMixin.DATATYPE
ORACLE = {"uint16": DATATYPE.UINT16, "int16": DATATYPE.INT16, "uint32": DATATYPE.UINT32,
          "int32": DATATYPE.INT32, "uint64": DATATYPE.UINT64, "int64": DATATYPE.INT64,
          "float32": DATATYPE.FLOAT32, "float64": DATATYPE.FLOAT64}  # fmt: skip


@st.composite
def valued_registers(draw):
    kind = draw(st.sampled_from([*INTEGERS, "float32", "float64"]))
    if kind in INTEGERS:
        signed, bits = INTEGERS[kind]
        low = -(2 ** (bits - 1)) if signed else 0
        one = st.integers(low, low + 2**bits - 1)
    else:
        one = st.floats(width=int(kind[5:]), allow_nan=False)
    count = draw(st.integers(1, 5))
    values = draw(st.lists(one, min_size=count, max_size=count))
    register = Register(
        "x", 0, kind, count=count,
        word_order=draw(st.sampled_from(ORDERS)), byte_order=draw(st.sampled_from(ORDERS)),
    )  # fmt: skip
    return register, values if count > 1 else values[0]


@given(valued_registers())
def test_what_is_written_is_read(case):
    register, value = case
    words = encode(register, value)
    assert len(words) == register.size
    assert all(0 <= word <= 0xFFFF for word in words)
    assert decode(register, words) == value


@given(st.sampled_from([*INTEGERS, "float32", "float64"]), st.data())
def test_registers_of_any_content_survive(kind, data):
    size = Register("x", 0, kind).size
    words = data.draw(st.lists(st.integers(0, 0xFFFF), min_size=size, max_size=size))
    for word_order in ORDERS:
        for byte_order in ORDERS:
            register = Register("x", 0, kind, word_order=word_order, byte_order=byte_order)
            value = decode(register, words)
            if value == value:
                assert encode(register, value) == words


@given(valued_registers())
def test_agrees_with_pymodbus_where_it_has_the_order(case):
    register, value = case
    if register.count > 1 or register.byte_order == "little":
        return
    words = ModbusClientMixin.convert_to_registers(
        value, ORACLE[register.type], word_order=register.word_order
    )
    assert encode(register, value) == words


@pytest.mark.parametrize(
    ("word_order", "byte_order", "wire"),
    [("big", "big", "01020304"), ("little", "big", "03040102"),
     ("big", "little", "02010403"), ("little", "little", "04030201")],
)  # fmt: skip
def test_a_pattern_in_all_four_orders(word_order, byte_order, wire):
    register = Register("x", 0, "uint32", word_order=word_order, byte_order=byte_order)
    words = list(struct.unpack(">2H", bytes.fromhex(wire)))
    assert encode(register, 0x01020304) == words
    assert decode(register, words) == 0x01020304


@given(st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=12))
def test_text(text):
    register = Register("x", 0, "string", count=6)
    assert decode(register, encode(register, text)) == text


@pytest.mark.parametrize("value", [-1, 65536, "text", [1, 2], 1.5])
def test_a_value_that_does_not_fit_is_refused(value):
    with pytest.raises(ValueError, match="x"):
        encode(Register("x", 0, "uint16"), value)


def device_with(**output):
    return parse_device(
        {"name": "d", "endpoint": {"host": "h", "port": 1}, "unit_id": 1, "sampling_rate": 50,
         "registers": {"output": {"address": 0, "unit": "V", "access": "write"} | output}}
    )  # fmt: skip


@given(st.floats(-20, 0), st.floats(0.1, 20), st.sampled_from(["uint16", "int16"]))
def test_a_range_spreads_over_all_counts(low, span, kind):
    register = device_with(type=kind, range=[low, low + span])["output"]
    info = np.iinfo(kind)
    ends = to_physical(register, np.array([info.min, info.max]))
    assert ends == pytest.approx([low, low + span], abs=1e-9)
    counts = np.arange(info.min, info.max, 97)
    assert np.array_equal(to_counts(register, to_physical(register, counts)), counts)


@given(st.floats(-7, 0), st.floats(0.01, 7))
def test_no_count_inside_the_limits_exceeds_them(low, high):
    device = device_with(range=[-7.5, 7.5], limits=[low, high])
    register = device["output"]
    first, last = limit_counts(device)
    tolerance = 1e-8 * register.scale
    assert to_physical(register, first) >= low - tolerance
    assert to_physical(register, last) <= high + tolerance
    assert to_physical(register, first - 1) < low
    assert to_physical(register, last + 1) > high


@given(st.floats(-20, 0), st.floats(0.1, 20), st.sampled_from(["uint16", "int16"]))
def test_the_ends_of_a_range_are_what_a_register_can_hold(low, span, kind):
    register = device_with(type=kind, range=[low, low + span])["output"]
    assert representable(register) == pytest.approx((low, low + span), abs=1e-9)
    falling = device_with(scale=-span / 65535, offset=low + span)["output"]
    assert representable(falling) == pytest.approx((low, low + span), abs=1e-9)


def test_a_voltage_no_count_stands_for_is_refused():
    with pytest.raises(InputError, match=r"stands for 15.1 V. Stay between 0 and 15 V"):
        to_counts(device_with(range=[0, 15])["output"], 15.1)
