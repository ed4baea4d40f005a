"""Random schedules of faults: the record is complete or says what it lacks, and ends at zero."""

from collections import Counter
from dataclasses import replace

import pytest
from fault_proxy import FAULTS, Fault
from faulty_run import SETTINGS, check, run_with_faults
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from served_bench import ServedBench

pytestmark = pytest.mark.faults


def faults(kinds, last):
    fault = st.builds(
        Fault,
        way=st.sampled_from(["request", "reply"]),
        number=st.integers(0, last),
        kind=st.sampled_from(kinds),
        amount=st.floats(0.0, 1.0, exclude_max=True),
    )
    return st.lists(fault, min_size=1, max_size=6, unique_by=lambda f: (f.way, f.number))


@st.composite
def situations(draw):
    """A bench, how it is driven, and what goes wrong."""
    mode = draw(st.sampled_from(["buffered", "buffered", "buffered", "polled"]))
    kinds = list(FAULTS)
    if mode == "polled":
        # Modbus TCP leaves checksums to TCP, and a plain module's reply has none of its own: what
        # is garbled in spite of TCP is seen in the blocks of the buffered protocol alone.
        kinds.remove("garble")
    return {
        "virtual_clock": draw(st.sampled_from([True, True, True, False])),
        "read_write_multiple": draw(st.booleans()),
        "acquisition": replace(
            SETTINGS, mode=mode, on_break=draw(st.sampled_from(["stop", "stop", "restart"]))
        ),
        "faults": draw(faults(kinds, last=40 if mode == "buffered" else 330)),
    }


def test_any_schedule(tmp_path_factory, request):
    count = request.config.getoption("--fault-schedules")
    outcomes = Counter()

    @settings(
        max_examples=count, derandomize=True, deadline=None, database=None,
        phases=[Phase.generate], suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(situations())
    def keeps_the_laws(situation):
        bench = served(situation)
        try:
            run = run_with_faults(
                bench, situation["faults"], tmp_path_factory.mktemp("t"), situation["acquisition"]
            )
            check(run)
        finally:
            bench.stop()
        outcomes[type(run.failure).__name__ if run.failure else "complete"] += 1

    keeps_the_laws()
    print(f"{count} schedules: {dict(outcomes.most_common())}")
    assert outcomes["complete"] > count / 2, "most schedules should cost nothing"


def served(situation):
    """A bench whose wall clock outruns a slow host: ten times as fast, with a short memory."""
    options = {"watchdog_time": 1.0, "virtual_clock": situation["virtual_clock"]}
    if not situation["virtual_clock"] and situation["acquisition"].mode == "buffered":
        options |= {"sampling_rate": 500.0, "fifo_length": 128, "ring_length": 256}
    bench = ServedBench(**options)
    bench.description = replace(
        bench.description, read_write_multiple=situation["read_write_multiple"]
    )
    return bench
