import made_datasets as made
import pytest


@pytest.fixture(params=[1, 3, 6], ids=lambda n: f"{n} actuators")
def names(request):
    return made.NAMES[: request.param]


@pytest.fixture
def each(names):
    """Make a dataset of a kind for every actuator."""
    return lambda make, **options: {
        name: make(seed, **options) for seed, name in enumerate(names, start=1)
    }
