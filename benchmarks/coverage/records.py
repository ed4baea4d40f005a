"""Records of a plant: which input drives it and where noise enters."""

import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from benchmarks.coverage.plants import Plant, simulate
from dea.arrays import Array

INPUTS = ("white", "band-limited")
NOISES = ("equation", "output", "coloured output")
BAND = 0.02  # periods per sample: 1 Hz at 50 Hz
SETTLING = 500  # samples before a record
NOISE = 0.02  # standard deviation of the noise's part of the output, over that of the output
COLOUR = 0.9  # pole of the coloured noise
DRIFT = 0.1  # relative change of a parameter


@dataclass(frozen=True)
class Records:
    """Inputs, measured outputs and those without noise, (records, samples), and the parameters."""

    u: Array
    y: Array
    clean: Array
    parameters: Array | None = None  # (records, samples, terms), where they change


def generators(seed: int, name: str, numbers: Iterable[int]) -> list[np.random.Generator]:
    """Return the generator of each record, whatever others are drawn beside it."""
    return [np.random.default_rng([seed, zlib.crc32(name.encode()), n]) for n in numbers]


def records(
    plant: Plant, kind: str, noise: str, samples: int, drawn: Sequence[np.random.Generator],
    drifting: str = "",
) -> Records:  # fmt: skip
    """Return a record of each generator; ``drifting`` is empty, ``random walk`` or ``ramp``."""
    total = SETTLING + samples
    u = np.stack([excitation(kind, total, rng) for rng in drawn])
    course = np.stack([_drift(plant, drifting, total, rng) for rng in drawn]) if drifting else None
    white = np.stack([rng.standard_normal(total) for rng in drawn])
    kept = slice(SETTLING, None)
    clean = simulate(plant, u, parameters=course)
    size = clean[:, kept].std(axis=1, keepdims=True)
    if noise == "equation":
        # The plant's poles amplify noise in its equation: scaled by what a little of it adds.
        little = 1e-3 * size * white
        added = (simulate(plant, u, little, course) - clean)[:, kept].std(axis=1, keepdims=True)
        y = simulate(plant, u, NOISE * size / added * little, course)
    else:
        y = clean + NOISE * size * (_coloured(white) if noise == "coloured output" else white)
    if not np.isfinite(y).all():
        raise ValueError(f"{plant.name} diverges with {kind} input and {noise} noise")
    parameters = None if course is None else course[:, kept]
    return Records(u[:, kept], y[:, kept], clean[:, kept], parameters)


def excitation(kind: str, samples: int, rng: np.random.Generator) -> Array:
    """Return a Gaussian input of standard deviation 1/3, so that its half-range is about 1."""
    white = rng.standard_normal(samples)
    if kind == "band-limited":
        spectrum = np.fft.rfft(white)
        spectrum[np.fft.rfftfreq(samples) > BAND] = 0
        white = np.fft.irfft(spectrum, samples)
    scaled: Array = white / white.std() / 3
    return scaled


def _coloured(white: Array) -> Array:
    """Return first-order noise of variance 1."""
    start = np.zeros((len(white), 1))
    coloured: Array = np.sqrt(1 - COLOUR**2) * lfilter([1], [1, -COLOUR], white, zi=start)[0]
    return coloured


def _drift(plant: Plant, kind: str, total: int, rng: np.random.Generator) -> Array:
    """Return parameters of (samples, terms); those of the input's terms change by about a tenth.

    The poles stay, so that every frozen model is stable.
    """
    parameters = np.tile(np.array(plant.parameters), (total, 1))
    for j, term in enumerate(plant.terms):
        if term.inputs and not term.outputs:
            if kind == "ramp":
                course = np.linspace(-1, 1, total) * rng.choice([-1.0, 1.0])
            else:
                course = np.cumsum(rng.standard_normal(total)) / np.sqrt(total)
            parameters[:, j] *= 1 + DRIFT * course
    return parameters
