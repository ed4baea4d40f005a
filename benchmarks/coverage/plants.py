"""Plants with known equations, simulated here and nowhere else.

A plant is y(t) = sum of coefficients times monomials of past outputs and inputs. The simulation
runs many inputs, or many parameter sets, side by side.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from dea.arrays import Array

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Monomial:
    """A product of outputs and inputs at these lags, with repetition."""

    outputs: tuple[int, ...]
    inputs: tuple[int, ...]

    def __str__(self) -> str:
        factors = [("y", lag) for lag in self.outputs] + [("u", lag) for lag in self.inputs]
        powers = {factor: factors.count(factor) for factor in factors}
        return (
            "".join(
                f"{name}(t-{lag})" + (f"^{power}" if power > 1 else "")
                for (name, lag), power in powers.items()
            )
            or "1"
        )


@dataclass(frozen=True)
class Plant:
    """A polynomial NARX model with its truth."""

    name: str
    source: str
    terms: tuple[Monomial, ...]
    parameters: tuple[float, ...]

    @property
    def max_lag(self) -> int:
        """The largest lag of an output or input."""
        return max(lag for term in self.terms for lag in term.outputs + term.inputs)


def monomial(text: str) -> Monomial:
    """Read ``y(t-1)u(t-3)^2``."""
    lags: dict[str, list[int]] = {"y": [], "u": []}
    for name, lag, power in re.findall(r"([yu])\(t-(\d+)\)(?:\^(\d+))?", text):
        lags[name] += [int(lag)] * int(power or 1)
    return Monomial(tuple(lags["y"]), tuple(lags["u"]))


def _plant(name: str, source: str, equation: dict[str, float]) -> Plant:
    terms = tuple(monomial(text) for text in equation)
    return Plant(name, source, terms, tuple(equation.values()))


def plants() -> dict[str, Plant]:
    """Return every plant by name: six published actuators, and three of the literature."""
    published = yaml.safe_load((ROOT / "config" / "published_models.yaml").read_text())
    found = [
        _plant(name, "Jacobs et al. 2015, Table 1", equation)
        for name, equation in published["models"].items()
    ]
    found.append(
        _plant(
            "wei_billings",
            "H. L. Wei, S. A. Billings, Int. J. Modelling, Identification and Control 3 (2008)",
            {"1": 0.5, "y(t-1)": 0.5, "u(t-2)": 0.8, "u(t-1)^2": 1.0, "y(t-2)^2": -0.05},
        )
    )
    found.append(
        _plant(
            "piroddi_spinelli",
            "L. Piroddi, W. Spinelli, Int. J. Control 76 (2003), a Hammerstein system of one pole",
            {"y(t-1)": 0.8, "u(t-1)": 0.4, "u(t-1)^2": 0.4, "u(t-1)^3": 0.4},
        )
    )
    found.append(
        _plant(
            "two_poles",
            "a Hammerstein system with poles at 0.9 and 0.7",
            {"y(t-1)": 1.6, "y(t-2)": -0.63, "u(t-1)": 0.03, "u(t-1)^2": 0.012},
        )
    )
    return {plant.name: plant for plant in found}


def simulate(plant: Plant, inputs: Array, noise: Array | None = None,
             parameters: Array | None = None) -> Array:  # fmt: skip
    """Return the free run from rest at zero, shape of ``inputs``: (..., samples).

    ``noise`` enters the equation and so the outputs that follow. ``parameters`` of shape
    (..., samples, terms) change with time.
    """
    samples = inputs.shape[-1]
    y = np.zeros_like(inputs)
    lag = plant.max_lag
    u = inputs
    for t in range(lag, samples):
        theta = plant.parameters if parameters is None else parameters[..., t, :].T
        value = np.zeros(inputs.shape[:-1]) if noise is None else noise[..., t].copy()
        for coefficient, term in zip(theta, plant.terms, strict=True):
            product = coefficient * np.ones(inputs.shape[:-1])
            for k in term.outputs:
                product = product * y[..., t - k]
            for k in term.inputs:
                product = product * u[..., t - k]
            value = value + product
        y[..., t] = value
    return y
