"""The settings of a case, from its rate, its length, its band and its dynamics."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.inputs import by_input
from dea.intake.bandwidth import band
from dea.intake.dynamics import Dynamics, linear_dynamics, samples_needed, written
from dea.missing import filled, runs
from dea.store import Record
from dea.warm_up import LONGEST_WARM_UP

# No measurement of these values is recorded, nor a source; the page on cases says what follows from
# them, and a user may change what they lead to in the case.
_HELD_OUT = 1 / 3  # share of the record, at its end, that identification does not see
_LONGEST = 4000  # samples to identify from: more take longer and change little
_SHORTEST = 60  # samples of a record, whatever its inputs
_PER_CANDIDATE = 4  # samples for each term that could be selected
_POOR = 0.5  # error of the linear model over the output's deviation, above which it says little
_MOST_LAGS = 4
_WINDOWS = 3
_RESAMPLES = 10
_RESPONSES = 120  # times at which responses are taken, at most
# Slowest time constants in a record, at least: with less than eight a diagnosis cannot split it.
_SLOWEST_TIMES = 10
_SETTLINGS = 20  # settling times in a window of the local tracker


@dataclass(frozen=True)
class CaseSettings:
    """How a record is studied: sections of its case, and at which sample the part held out begins.

    ``inferred`` says in words what the settings rest on.
    """

    sections: Mapping[str, Any]
    held_out: int
    inferred: tuple[str, ...]


def infer_settings(signals: Record) -> CaseSettings:
    """Return the settings for a record on uniform times.

    Raises
    ------
    InputError
        If it is too short to identify from one part and test on another.
    """
    u, y, rate = signals.u, signals.y, signals.sampling_rate
    columns = by_input(u)
    in_a_row = samples_needed(len(columns))
    shortest = max(_SHORTEST, ceil(in_a_row / (1 - _HELD_OUT)))
    if y.size < shortest:
        driven = f" of {len(columns)} inputs" if len(columns) > 1 else ""
        raise InputError(
            f"it holds {y.size} samples{driven} at {rate:g} Hz",
            remedy=f"Record at least {shortest}: two thirds to identify from, the rest to test",
        )
    outputs, seen = filled(y)
    known = round((1 - _HELD_OUT) * y.size)
    used = min(known, _LONGEST)
    part = _part_of_models(signals, seen[:used], in_a_row)
    linear = linear_dynamics(u[part], outputs[part])
    lags, degree = _size(linear, part.stop - part.start)
    held = y.size - known
    reach = min(50, held // (2 * _WINDOWS) - 1)
    windows = _windows(known, max(reach, 3), u, seen)
    bands = [band(each, rate) for each in columns]
    low, high = min(each[0] for each in bands), max(each[1] for each in bands)
    time = y.size / rate
    sections = {
        "identification": {
            "start": 0.0,
            "length": _in_seconds(used, rate),
            "y_lags": lags.y_lags,
            "u_lags": written(lags.u_lags),
            "degree": degree,
            "threshold": None,
            "resamples": _RESAMPLES if _moves(u[:used], lags.longest) else 0,
        },
        "orders": {
            "start": _in_seconds(known, rate),
            "length": _in_seconds(min(held, used), rate),
            "dynamic": min(5, max(used // 60, 2)),
            "polynomial": degree,
            "lags": min(lags.y_lags, 2),
        },
        "validation": {
            "windows": [[_in_seconds(a, rate), _in_seconds(b, rate)] for a, b in windows],
            "before": _in_seconds(min(used, windows[0][0]), rate),
            "max_lag": max(reach, 3),
        },
        "tracking": _tracking(y.size, linear.settling, lags),
        "gfrf": _responses(low, max(high, band(outputs, rate)[1]), rate, y.size),
        "split": {
            "slowest_time": float(f"{min(linear.slowest / rate, time / _SLOWEST_TIMES):.3g}"),
            "warm_up": float(f"{min(linear.settling / rate, LONGEST_WARM_UP * time):.3g}"),
        },
    }
    inferred = (
        f"{y.size} samples at {rate:.6g} Hz, {time:.5g} s"
        + (f", {signals.left_out} of them missing" if signals.left_out else ""),
        f"the input{'s hold their' if len(columns) > 1 else ' holds its'} power between"
        f" {low:.3g} and {high:.3g} Hz",
        f"a step settles within {linear.settling / rate:.3g} s; lags {_listed(lags)} explain"
        f" {100 * max(1 - linear.error**2, 0):.1f} % of an unseen part linearly",
        f"models come from the first {used / rate:.4g} s, tests from the last {held / rate:.4g} s",
    )
    return CaseSettings(sections, known, inferred)


def _listed(lags: Dynamics) -> str:
    driving = [f"{each[0]} to {each[-1]} of" for each in lags.u_lags]
    if len(driving) == 1:
        return f"1 to {lags.y_lags} of the output and {driving[0]} the input"
    named = ", ".join(f"{each} input {k}" for k, each in enumerate(driving, start=1))
    return f"1 to {lags.y_lags} of the output, {named}"


def _size(linear: Dynamics, samples: int) -> tuple[Dynamics, int]:
    """Return lags and degree with at most one candidate term for every few samples.

    A nonlinear system needs no fewer lags than its linear part. Two are offered at least, and four
    where the linear part explains little, since its order is then no guide.
    """
    order = _MOST_LAGS if linear.error > _POOR else max(linear.y_lags, 2)
    signals = 1 + len(linear.u_lags)
    while True:
        for degree in (3, 2, 1):
            candidates = comb(signals * order + degree, degree)
            if candidates * _PER_CANDIDATE <= samples or order == degree == 1:
                lags = tuple(tuple(range(each[0], each[0] + order)) for each in linear.u_lags)
                return Dynamics(order, lags, linear.settling, linear.error), degree
        order -= 1


def _tracking(samples: int, settling: int, lags: Dynamics) -> dict[str, Any]:
    window = int(np.clip(_SETTLINGS * settling, samples // 12, samples // 3))
    window = max(window, 40 * (lags.y_lags + sum(map(len, lags.u_lags))))
    memory = int(np.clip(_SETTLINGS * settling, 100, max(samples // 4, 100)))
    return {
        "trackers": {
            "rls": {
                "forgetting": float(f"{1 - 1 / memory:.5g}"),
                "leakage": float(f"{0.1 / memory:.2g}"),
                "delta": 1.0,
            },
            "kalman": {"delta": 1e-4, "thinning": int(np.clip(settling // 2, 1, 20))},
            "local": {"window": window},
        },
        "instants": min(_RESPONSES, samples // 4),
        "frozen_window": int(np.clip(samples // 20, 20, 1000)),
    }


def _responses(low: float, high: float, rate: float, samples: int) -> dict[str, Any]:
    """Return the frequencies of responses, as shares of the sampling rate."""
    top = min(1.5 * high / rate, 0.45)
    bottom = max(min(low / rate, top / 20), 2 / samples)
    return {
        "instants": min(_RESPONSES, samples // 4),
        "lowest": float(f"{bottom:.3g}"),
        "highest": float(f"{top:.3g}"),
        "plane_highest": float(f"{top / 1.5:.3g}"),
        "third_frequency": float(f"{top / 4:.3g}"),
    }


def _windows(first: int, reach: int, u: Array, seen: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return up to three windows of one length from ``first`` on, those without a missing sample.

    There are fewer where the input would be constant over one of them.
    """
    held = len(u) - first
    for count in range(max(min(_WINDOWS, held // (2 * reach + 2)), 1), 0, -1):
        length = min(held // count, _LONGEST)
        apart = (held - length) / max(count - 1, 1)
        found = [(a, a + length) for a in (first + round(i * apart) for i in range(count))]
        if all(np.ptp(u[a:b], axis=0).any() for a, b in found):
            break
    else:
        raise InputError(
            f"the input is constant from sample {first} on, in the part held out for tests",
            remedy="Cut the record where the input no longer changes",
        )
    whole = [(a, b) for a, b in found if seen[a:b].all()]
    return whole or found


def _moves(u: Array, lag: int) -> bool:
    """Whether blocks that are drawn from the input anew hold many lags, and none is constant."""
    changes = np.diff(u.reshape(len(u), -1), axis=0) != 0.0
    return len(u) > 40 * lag and bool(np.all(np.count_nonzero(changes, axis=0) > len(u) / 2))


def _part_of_models(signals: Record, seen: NDArray[np.bool_], in_a_row: int) -> slice:
    """Return the longest part in which all outputs are ``seen``, for models to come from.

    Raises
    ------
    InputError
        If it has fewer samples ``in_a_row``, or an input is constant in it.
    """
    part = max(runs(seen), key=lambda run: run.stop - run.start)
    if part.stop - part.start < in_a_row:
        raise InputError(
            f"the longest part without a missing sample, within the first {seen.size}, holds"
            f" {part.stop - part.start}",
            remedy=f"At least {in_a_row} in a row are needed: record it again, or cut it",
        )
    rate = signals.sampling_rate
    for (name, _), column in zip(signals.inputs, by_input(signals.u), strict=True):
        if not np.ptp(column[part]):
            raise InputError(
                f"{name} is constant at {column[part.start]:g} from {part.start / rate:g} to"
                f" {part.stop / rate:g} s, the part that models come from",
                field="input",
                remedy="Leave it out, or cut the record so that it moves there",
            )
    return part


def _in_seconds(samples: int, rate: float) -> float:
    return float(f"{samples / rate:.15g}")
