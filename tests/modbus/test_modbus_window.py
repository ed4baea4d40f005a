"""Neighbouring registers in one request, and the checksum among them."""

import pytest

from dea.modbus import Register, Window, adjoining

LEVEL = Register("level", 10)
WIDE = Register("wide", 12, "uint32")
LAST = Register("last", 17)
SEAL = Register("seal", 14, "uint32")


def test_registers_that_are_not_named_and_addresses_between_hold_zero():
    window = Window([LAST, WIDE, LEVEL])
    assert (window.address, window.size) == (10, 8)
    assert window.encode({}) == [0] * 8
    assert window.encode({"wide": 0x00020003, "last": 9}) == [0, 0, 2, 3, 0, 0, 0, 9]
    assert window.decode([1, 7, 2, 3, 7, 7, 7, 9]) == {"level": 1, "wide": 0x20003, "last": 9}


def test_the_checksum_is_of_all_words_but_its_own():
    window = Window([LEVEL, WIDE, SEAL, LAST], SEAL)
    words = window.encode({"level": 5, "wide": 0x00020003, "last": 9})
    # `printf '\0\5\0\0\0\2\0\3\0\0\0\11' | gzip -c | tail -c8 | head -c4`, least byte first.
    assert words == [5, 0, 2, 3, 0xA361, 0xB970, 0, 9]
    assert window.intact(words)
    for place in range(window.size):
        assert not window.intact([w ^ (place == k) for k, w in enumerate(words)])


def test_without_a_checksum_words_are_taken_for_intact():
    assert Window([LEVEL]).intact([65535])


@pytest.mark.parametrize(
    ("registers", "groups"),
    [
        ([("c", 3), ("a", 1), ("b", 2)], [["a", "b", "c"]]),
        ([("a", 1), ("b", 3)], [["a"], ["b"]]),
        ([("a", 1), ("b", 3), ("c", 4), ("d", 6), ("e", 7)], [["a"], ["b", "c"], ["d", "e"]]),
        ([("a", 1, "uint32"), ("b", 2)], [["a"], ["b"]]),
        ([("a", 1, "uint32"), ("b", 3), ("c", 5)], [["a", "b"], ["c"]]),
        ([("a", 1), ("b", 2, "uint16", "input"), ("c", 2)], [["a", "c"], ["b"]]),
        ([], []),
    ],
)
def test_registers_that_follow_each_other_in_one_table_share_a_window(registers, groups):
    windows = adjoining(Register(*each) for each in registers)
    assert [[r.name for r in window.registers] for window in windows] == groups


@pytest.mark.parametrize(
    ("span", "groups"), [(4, [["a"], ["b", "c"]]), (5, [["a", "b"], ["c"]]), (9, [["a", "b", "c"]])]
)
def test_registers_with_gaps_share_a_window_up_to_its_longest_span(span, groups):
    registers = [Register("a", 1), Register("b", 4, "uint32"), Register("c", 7)]
    windows = adjoining(registers, span)
    assert [[r.name for r in window.registers] for window in windows] == groups
