"""Fixtures of every room."""

import os

import pytest
from hypothesis import Phase, settings

import made_datasets as made
from served_bench import ServedBench

# The first call of a compiled function compiles it, which no deadline allows for.
settings.register_profile("compiled", deadline=None)
settings.load_profile("compiled")
# Whether any example fails is what a mutant is judged by, not which the smallest is.
settings.register_profile(
    "first_failure", deadline=None, phases=[Phase.explicit, Phase.generate], database=None
)


def pytest_addoption(parser):
    parser.addoption(
        "--fault-schedules", type=int, default=100, metavar="N",
        help="random schedules of faults to put the acquisition through",
    )  # fmt: skip
    parser.addoption(
        "--fuzz-frames", type=int, default=5000, metavar="N",
        help="malformed frames to send to the bench",
    )  # fmt: skip


def pytest_collection_modifyitems(items):
    """Begin with the file that makes the small study, and end with the others of the workflow.

    They wait for it, and find compiled what their jobs call.
    """

    def turn(item):
        return item.path.name != "test_workflow.py", "workflow" in item.path.parts

    items.sort(key=turn)


@pytest.fixture(scope="session", autouse=True)
def duty_folder(tmp_path_factory):
    """Keep the files and the trips of guardians out of the machine's own.

    Whichever test is the first to drive a device starts what all guardians descend from.
    """
    folder = tmp_path_factory.mktemp("duty")
    os.environ["DEA_DUTY"] = str(folder)
    return folder


@pytest.fixture
def clock_off(monkeypatch):
    """Have the clock of a bench be 2 % off its 50 Hz.

    A bench plays as fast as it is fed; the rate is what a device at wall time would show.
    """
    for room in ("device_clock", "record"):
        monkeypatch.setattr(f"dea.acquisition.{room}.fitted_rate", lambda _: 51.0)


@pytest.fixture
def serve_bench():
    """Return a function that serves a bench and stops it after the test."""
    served = []

    def start(**options):
        served.append(ServedBench(**options))
        return served[-1]

    yield start
    for bench in served:
        bench.stop()


@pytest.fixture(params=[1, 3, 6], ids=lambda n: f"{n} actuators")
def names(request):
    return made.NAMES[: request.param]


@pytest.fixture
def each(names):
    """Make a dataset of a kind for every actuator."""
    return lambda make, **options: {
        name: make(seed, **options) for seed, name in enumerate(names, start=1)
    }
