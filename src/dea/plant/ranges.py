"""The units and ranges of the parameters of the bench configuration."""

from typing import NamedTuple

import numpy as np


class Range(NamedTuple):
    """The unit a parameter must be given in and the values that make sense."""

    unit: str
    low: float
    high: float


_FILM = {
    "frame_radius": Range("m", 1e-3, 1.0),
    "contact_radius": Range("m", 1e-4, 1.0),
    "thickness": Range("m", 1e-5, 1e-2),
    "prestretch": Range("1", 1.0, 6.0),
    "mass": Range("kg", 1e-5, 1.0),
    "damping": Range("N s/m", 0.0, 100.0),
    "yeoh_1": Range("Pa", 1.0, 1e8),
    "yeoh_2": Range("Pa", -1e8, 1e8),
    "yeoh_3": Range("Pa", -1e8, 1e8),
    "branch_modulus": Range("Pa", 0.0, 1e8),
    "branch_time": Range("s", 0.05, 1e6),
    "permittivity": Range("1", 1.0, 1e3),
    "electrode_resistance": Range("Ohm", 1.0, 1e12),
    "leak_resistance": Range("Ohm", 1e3, 1e18),
    "stiffness_ageing": Range("1/h", -0.5, 10.0),
    "leakage_ageing": Range("1/h", -0.5, 1e4),
    "electrode_ageing": Range("1/h", -0.5, 1e4),
    "pull_in_displacement": Range("m", 1e-5, 1.0),
    "breakdown_field": Range("V/m", 1e6, 1e10),
    "rest": Range("s", 0.0, 1e6),
}
SECTIONS: dict[str, dict[str, Range]] = {
    "film": _FILM,
    "amplifier": {
        "gain": Range("V/V", 1.0, 1e5),
        "output_limit": Range("V", 1.0, 1e5),
        "slew_rate": Range("V/s", 1.0, 1e12),
        "current_limit": Range("A", 1e-9, 10.0),
        "cable_capacitance": Range("F", 0.0, 1e-6),
        "bandwidth": Range("Hz", 0.1, 1e6),
    },
    "sensor": {
        "cutoff": Range("Hz", 0.1, np.inf),
        "noise": Range("m", 0.0, 1e-2),
        "range_low": Range("m", -1.0, 1.0),
        "range_high": Range("m", -1.0, 1.0),
    },
    "output_converter": {"low": Range("V", -100.0, 100.0), "high": Range("V", -100.0, 100.0)},
    "displacement_converter": {"low": Range("mm", -1e3, 1e3), "high": Range("mm", -1e3, 1e3)},
}
LISTS = ("branch_modulus", "branch_time")
ORDERED = (
    ("film", "contact_radius", "frame_radius"),
    ("sensor", "range_low", "range_high"),
    ("output_converter", "low", "high"),
    ("displacement_converter", "low", "high"),
)
