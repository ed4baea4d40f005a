"""Records of a plant: which input drives it and where noise enters."""

from dataclasses import dataclass

import numpy as np

from benchmarks.coverage.plants import Array, Plant, simulate

INPUTS = ("white", "band-limited")
NOISES = ("equation", "output", "coloured output")
BAND = 0.02  # periods per sample: 1 Hz at 50 Hz
SETTLING = 500  # samples before a record
NOISE = 0.02  # standard deviation of the noise's part of the output, over that of the output
COLOUR = 0.9  # pole of the coloured noise


@dataclass(frozen=True)
class Record:
    """Input, measured output, and the parameters at each sample where they change."""

    u: Array
    y: Array
    parameters: Array | None = None


def excitation(kind: str, samples: int, rng: np.random.Generator) -> Array:
    """Return a zero-mean Gaussian input of half-range about 1: standard deviation 1/3."""
    white = rng.standard_normal(samples)
    if kind == "band-limited":
        spectrum = np.fft.rfft(white)
        spectrum[np.fft.rfftfreq(samples) > BAND] = 0
        white = np.fft.irfft(spectrum, samples)
    return np.clip(white / white.std() / 3, -1, 1) if kind == "white" else white / white.std() / 3


def record(
    plant: Plant, kind: str, noise: str, samples: int, rng: np.random.Generator,
    parameters: Array | None = None,
) -> Record:  # fmt: skip
    """Return a record; ``parameters`` of (SETTLING + samples, terms) where the plant drifts."""
    total = SETTLING + samples
    u = excitation(kind, total, rng)
    clean = simulate(plant, u, parameters=parameters)
    drawn = rng.standard_normal(total)
    if noise == "equation":
        # Noise in the equation is amplified by the poles: scaled by what it adds.
        small = 1e-3 * clean.std()
        gain = (simulate(plant, u, small * drawn, parameters) - clean)[SETTLING:].std() / small
        y = simulate(plant, u, NOISE * clean[SETTLING:].std() / gain * drawn, parameters)
    else:
        if noise == "coloured output":
            drawn = _coloured(drawn)
        y = clean + NOISE * clean[SETTLING:].std() * drawn
    kept = slice(SETTLING, None)
    return Record(u[kept], y[kept], None if parameters is None else parameters[kept])


def _coloured(white: Array) -> Array:
    """Return first-order noise of variance 1."""
    coloured = np.empty_like(white)
    coloured[0] = white[0]
    for t in range(1, len(white)):
        coloured[t] = COLOUR * coloured[t - 1] + np.sqrt(1 - COLOUR**2) * white[t]
    return coloured


def drift(plant: Plant, kind: str, samples: int, rng: np.random.Generator) -> Array:
    """Return parameters of (SETTLING + samples, terms) that walk at random or follow a ramp.

    Input terms change, by a tenth of their value over the record; the poles stay, so that every
    frozen model is stable.
    """
    total = SETTLING + samples
    parameters = np.tile(np.array(plant.parameters), (total, 1))
    for j, term in enumerate(plant.terms):
        if term.outputs or not term.inputs:
            continue
        if kind == "ramp":
            course = np.linspace(-0.5, 0.5, total) * rng.choice([-1.0, 1.0])
        else:
            course = np.cumsum(rng.standard_normal(total)) / np.sqrt(total)
        parameters[:, j] *= 1 + 0.1 * course
    return parameters
