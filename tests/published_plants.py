"""The published models as plants, and an input that suits them."""

from pathlib import Path

import numpy as np

from dea.narx import NarxModel, load_published

_FILE = Path(__file__).parents[1] / "config" / "published_models.yaml"


def published_plants() -> dict[str, NarxModel]:
    """Return the models of the config by name."""
    return load_published(_FILE)


def smooth_input(samples=3000):
    """Return two tones well below the sampling rate, within the plants' input range."""
    time = np.arange(samples) / 50
    return 0.4 * np.sin(2 * np.pi * 0.3 * time) + 0.4 * np.sin(2 * np.pi * 0.77 * time + 1)
