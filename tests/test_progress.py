"""What a long computation says of itself."""

import pytest

from dea.discrepancy.fitting.parallel import in_parallel
from dea.progress import heard_by, part_of, tell


def test_only_what_is_told_while_it_listens_is_heard():
    heard = []
    tell("before")
    with heard_by(heard.append), part_of("trial 2 of 3"):
        tell("the simulation alone")
    tell("after")
    assert heard == ["trial 2 of 3: the simulation alone"]


def test_a_listener_is_gone_after_an_error():
    heard = []
    with pytest.raises(ZeroDivisionError), heard_by(heard.append), part_of("a trial"):
        raise ZeroDivisionError
    with heard_by(heard.append):
        tell("next")
    assert heard == ["next"]


@pytest.mark.parametrize("workers", [1, 4])
def test_items_are_counted_in_order_on_any_number_of_threads(workers):
    heard = []
    with heard_by(heard.append):
        found = in_parallel(lambda item: item**2, range(30), workers, "squares")
        in_parallel(lambda item: item, range(3), workers)
    assert found == [item**2 for item in range(30)]
    assert heard == [f"squares, {done} of 30 done" for done in range(31)]
