import pytest
from hypothesis import given
from hypothesis import strategies as st

from dea.effect_label import RESERVED, between, ends, joined, labelled, name_and_place, parted

NAMES = st.text(st.characters(codec="utf-8", exclude_characters=RESERVED), min_size=1)
OPTIONAL = NAMES | st.just("")


@given(NAMES, OPTIONAL)
def test_a_label_holds_its_name_and_place(name, place):
    assert name_and_place(labelled(name, place)) == (name, place)


@given(NAMES, OPTIONAL)
def test_a_place_holds_what_a_force_acts_between(equation, reaction):
    assert ends(between(equation, reaction)) == (equation, reaction)


@given(st.lists(st.builds(labelled, NAMES, OPTIONAL), min_size=1))
def test_a_text_holds_the_labels_that_it_joins(labels):
    assert parted(joined(labels)) == tuple(labels)


@pytest.mark.parametrize(
    ("name", "place", "label"),
    [
        ("dead_zone", None, "dead_zone"),
        ("dead_zone", "left", "dead_zone@left"),
        ("end_stop", between("upper_level", "lower_level"), "end_stop@upper_level>lower_level"),
    ],
)
def test_a_label_is_written_as_datasets_hold_it(name, place, label):
    assert labelled(name, place) == label


def test_labels_are_joined_as_datasets_hold_them():
    assert joined(["dead_zone@left", "sensor_lag"]) == "dead_zone@left+sensor_lag"
