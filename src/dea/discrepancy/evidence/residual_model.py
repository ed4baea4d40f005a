"""A flexible model of the residual, and a sparse equation of it.

Several inputs are called u1, u2 and so on, in the order of the simulation.

The residual is regressed on a dictionary of input, output, their memory and time. The dictionary
contains no physics: a missing effect could explain what it predicts on blocks that it was not
fitted to. Forward selection of its terms gives an equation, as in Brunton, Proctor and Kutz (2016),
PNAS 113:3932.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from itertools import combinations

import numpy as np

from dea.discrepancy.evidence.regression import least_left, standardised
from dea.discrepancy.problem.problem import Problem, rmse
from dea.inputs import by_input
from dea.simulation import low_pass
from dea.terms import input_symbol

_RIDGES = tuple(np.logspace(-8, 4, 7))
_MAX_TERMS = 5
_BETTER = 0.97  # part of the energy that a further term may leave at most: chance hardly takes more
# A signal in the name of a term: an input, the output, or a derivative of one.
_SYMBOL = re.compile(r"\b(?:u\d*|y)'*")


@dataclass(frozen=True)
class ResidualModel:
    """What the dictionary predicts of a residual.

    Parameters
    ----------
    ratio : float
        Root mean square on held-out samples after the prediction over that before; one where
        nothing can be predicted. A constant counts as predicted: noise has none, and only a
        simulation without an output offset leaves one.
    equation : str
        The sparse equation, in the output's unit, and what standardises the signals in it.
    explained : float
        Part of the residual's energy about its mean on held-out samples that the sparse equation
        explains.
    """

    ratio: float
    equation: str
    explained: float

    @property
    def predicted(self) -> float:
        """Part of the root mean square that the prediction removes on held-out samples."""
        return 1.0 - self.ratio


def dictionary(problem: Problem, simulated: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Return names and columns (n, m) of what a residual could depend on."""
    t = problem.time
    signals = {name: standard(signal) for name, signal in _signals(problem, simulated).items()}
    driving = {name: u for name, u in signals.items() if re.fullmatch(r"u\d*", name)}
    y, rate = signals["y"], signals["y'"]
    terms: dict[str, np.ndarray] = {}
    for name, u in driving.items():
        terms |= {name: u, f"{name}^2": u**2, f"{name}^3": u**3}
    terms |= {"y": y, "y^2": y**2, "y^3": y**3}
    terms |= {f"{name} y": u * y for name, u in driving.items()}
    terms |= {
        "y'": rate, "|y'|": np.abs(rate), "sign(y')": np.tanh(rate / 0.05), "y y'": y * rate,
        "y'^2": rate**2, "y'|y'|": rate * np.abs(rate), "y'^3": rate**3, "y^2 y'": y**2 * rate,
    }  # fmt: skip
    for name, u in driving.items():
        input_rate = signals[f"{name}'"]
        terms |= {f"{name}'": input_rate, f"{name} {name}'": u * input_rate}
        terms[f"|{name}'|"] = np.abs(input_rate)
    terms["y''"] = signals["y''"]
    for first, second in combinations(driving, 2):
        terms[f"{first} {second}"] = driving[first] * driving[second]
    for name, u in driving.items():
        for level in np.quantile(u, [0.1, 0.25, 0.75, 0.9]):
            terms[f"max({name} {-level:+.2g}, 0)"] = np.maximum(u - level, 0)
    for level in np.quantile(y, [0.1, 0.25, 0.75, 0.9]):
        terms[f"max(y {-level:+.2g}, 0)"] = np.maximum(y - level, 0)
    tau = 3.0 * problem.interval
    while tau < 0.3 * t[-1]:
        powers = [(f"{name}{power}", u**degree) for name, u in driving.items()
                  for power, degree in (("", 1), ("^2", 2))]  # fmt: skip
        for name, signal in (*powers, ("y^2", y**2)):
            lag = partial(low_pass, polynomial=[tau / problem.interval, 1.0])
            terms[f"lag({name}, {tau:.2g} s)"] = problem.of_each_record(lag, signal)
        tau *= 3.0
    for radius in (0.2, 0.6, 1.2):
        terms[f"play(y, {radius:g})"] = problem.of_each_record(partial(play, radius=radius), y)
    x = 2.0 * t / t[-1] - 1.0
    for degree in range(1, 7):
        slow = np.polynomial.legendre.Legendre.basis(degree)(x)
        terms[f"time^{degree}"] = slow
        terms |= {f"time^{degree} {name}": slow * u for name, u in driving.items()}
        terms[f"time^{degree} y"] = slow * y
    return list(terms), np.column_stack([np.clip(c, -30, 30) for c in terms.values()])


def _signals(problem: Problem, simulated: np.ndarray) -> dict[str, np.ndarray]:
    """Return inputs, output and their derivatives (n,) by the symbols that terms call them."""
    inputs = by_input(problem.u)
    signals = {input_symbol(k, len(inputs)): u for k, u in enumerate(inputs)}
    signals["y"] = simulated
    signals |= {f"{name}'": problem.rate_of(each) for name, each in signals.items()}
    signals["y''"] = problem.rate_of(signals["y'"])
    return signals


def residual_model(problem: Problem, residual: np.ndarray) -> ResidualModel:
    """Fit the dictionary to ``residual`` on one half of the samples; judge it on the other."""
    simulated = problem.y - residual
    names, X = dictionary(problem, simulated)
    train, test = problem.fit, problem.select
    before = rmse(residual, test)
    if not before:
        return ResidualModel(1.0, "0", 0.0)
    level = residual[train].mean()
    e = residual - level
    told = standardised(problem, X)
    best = min(before, least_left(problem, e, told.columns, _RIDGES))
    chosen, weights, explained = _sparse(told.columns, e, train, test)
    weights = weights / told.scale[chosen]
    terms = {names[told.kept[i]]: float(w) for i, w in zip(chosen, weights, strict=True)}
    constant = float(level - weights @ told.mean[chosen])
    equation = _written(terms, constant, _signals(problem, simulated)) if terms else "0"
    return ResidualModel(best / before, equation, explained)


def _sparse(
    X: np.ndarray, e: np.ndarray, train: np.ndarray, test: np.ndarray
) -> tuple[list[int], np.ndarray, float]:
    """Select terms one by one while the half for choosing is predicted better.

    Returned are their columns, their weights, and the part of the energy that they explain.
    """
    chosen: list[int] = []
    weights = np.zeros(0)
    error = float(np.mean(e[test] ** 2))
    first = error
    remaining = e[train].copy()
    while len(chosen) < _MAX_TERMS:
        correlation = np.abs(X[train].T @ remaining)
        correlation[chosen] = 0.0
        trial = [*chosen, int(np.argmax(correlation))]
        fitted = np.linalg.lstsq(X[train][:, trial], e[train], rcond=None)[0]
        after = float(np.mean((e[test] - X[test][:, trial] @ fitted) ** 2))
        if after > _BETTER * error:
            break
        chosen, weights, error = trial, fitted, after
        remaining = e[train] - X[train][:, chosen] @ weights
    return chosen, weights, max(0.0, 1.0 - error / first)


def _written(terms: Mapping[str, float], constant: float, signals: Mapping[str, np.ndarray]) -> str:
    """Return weighted terms as an equation, with the mean and deviation of every signal in them."""
    weighted = " ".join(f"{weight:+.3g} [{name}]" for name, weight in terms.items())
    symbols = dict.fromkeys(symbol for name in terms for symbol in _SYMBOL.findall(name))
    standards = ", ".join(
        f"{symbol} by {signals[symbol].mean():.3g} ± {signals[symbol].std():.3g}"
        for symbol in symbols
    )
    equation = f"{weighted} {constant:+.3g}"
    return f"{equation}, standardised {standards}" if standards else equation


def play(y: np.ndarray, radius: float) -> np.ndarray:
    """Return the play of a signal (n,): what follows it only beyond this distance."""
    result = np.empty(y.size)
    now = y[0]
    for k, value in enumerate(y):
        now = min(max(now, value - radius), value + radius)
        result[k] = now
    return result


def standard(signal: np.ndarray) -> np.ndarray:
    """Return a signal (n,) with a mean of zero and a deviation of one; a constant as zeros."""
    result: np.ndarray = (signal - signal.mean()) / (signal.std() or 1.0)
    return result
