"""What the library claims of a record: intervals, set against the truth."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import dea
from benchmarks.coverage import truth
from benchmarks.coverage.plants import Plant, plants, simulate
from benchmarks.coverage.records import BAND, SETTLING, excitation
from dea.arrays import Array
from dea.errors import InputError
from dea.narx import NarxModel, Scaling, estimate, refine
from dea.terms import Term
from dea.tracking import with_constant

# Periods per sample, inside the excited band: white input holds power everywhere.
FREQUENCIES = {
    "white": np.array([0.002, 0.01, 0.05, 0.17]),
    "band-limited": np.array([0.002, 0.005, 0.01, 0.9 * BAND]),
}
PAIRS = ((0, 0), (0, 2), (1, 1), (1, 3), (3, 3))  # of these frequencies, for H2
QUANTITIES = ("parameters", "H1 gain", "H1 phase", "H2 gain", "H2 phase", "rest", "free run")
HELD = np.array([-0.3, 0.3])  # inputs at which the rest is judged
FRESH, FROM = 600, 40  # samples of a free run on an input of its own, and the first one judged
TRACKERS = ("rls", "kalman", "output_error", "local")
INSTANTS = 8  # of a track, or of a free run, that are judged


@dataclass(frozen=True)
class Judged:
    """1 where an interval contains the truth, 0 where it does not, missing where it is withheld."""

    inside: dict[str, Array]  # by quantity, (points,)
    withheld: str  # the reason given


@cache
def responses(name: str, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the true H1 and H2 of a plant at rest, inside the band of an input."""
    plant, f = plants()[name], FREQUENCIES[kind]
    return truth.h1(plant, f), truth.h2(plant, _pairs(kind))


@cache
def outputs(name: str, kind: str) -> tuple[Array, Array, Array]:
    """Return a plant's true rests at HELD, a fresh input (FRESH,), and its output on that."""
    plant = plants()[name]
    rests = simulate(plant, np.repeat(HELD[:, None], truth.SETTLING, axis=1))[:, -1]
    u = excitation(kind, SETTLING + FRESH, np.random.default_rng(0))
    return rests, u[SETTLING:], simulate(plant, u)[SETTLING:]


def _pairs(kind: str) -> Array:
    f = FREQUENCIES[kind]
    return np.array([(f[i], f[j]) for i, j in PAIRS])


def terms(plant: Plant) -> tuple[Term, ...]:
    """Return the plant's terms as the library writes them, in the plant's order."""
    return tuple(Term.parse(str(term)) for term in plant.terms)


def judge(plant: Plant, kind: str, u: Array, y: Array, refined: bool) -> Judged:
    """Estimate the plant's own structure and judge its parameters, H1 and H2."""
    model = estimate(terms(plant), u, y, scaling=Scaling())
    if refined:
        model = refine(model, u, y)
    h1, h2 = responses(plant.name, kind)
    withheld = model.withheld
    _, low, high = dea.parameter_interval(model)
    pairs = _pairs(kind)
    inside = {"parameters": contains(_true_parameters(plant, model), low, high)}
    for label, true, order, f in (
        ("H1", h1, 1, FREQUENCIES[kind]),
        ("H2", h2, 2, (pairs[:, 0], pairs[:, 1])),
    ):
        try:
            band = dea.frequency_response_band(model, order, f, 1.0, operating_point=0.0)
        except InputError as error:  # the estimate has no rest
            withheld = withheld or str(error)
            missing = np.full(len(true), np.nan)
            inside |= {f"{label} gain": missing, f"{label} phase": missing}
            continue
        phase = np.degrees(np.angle(true))
        inside[f"{label} gain"] = contains(np.abs(true), band.gain_low, band.gain_high)
        inside[f"{label} phase"] = phase_contains(phase, band.phase_low, band.phase_high)
    rests, fresh, output = outputs(plant.name, kind)
    inside["rest"] = np.full(HELD.size, np.nan)
    try:
        found = [dea.gfrf.zero_input_interval(model, operating_point=held) for held in HELD]
        ends_at_rest = (np.array([float(each[end]) for each in found]) for end in (1, 2))
        inside["rest"] = contains(rests, *ends_at_rest)
    except InputError as error:  # the estimate has no rest
        withheld = withheld or str(error)
    _, *ends = dea.simulation_interval(model, fresh, output[: model.max_lag])
    judged = np.linspace(FROM, FRESH - 1, INSTANTS).astype(int)
    held_by = contains(output[judged], *(end[judged] for end in ends))
    # A run that diverges has no interval, and is none that is withheld.
    inside["free run"] = held_by if withheld else np.nan_to_num(held_by)
    return Judged(inside, withheld)


def judge_track(
    plant: Plant, kind: str, u: Array, y: Array, clean: Array, true: Array, tracker: str
) -> Judged:
    """Track the parameters of the plant's structure; ``true`` is (samples, terms).

    The true responses are those of the plant with the parameters of the instant, by the algebra
    that probed responses confirm for plants at rest (tests/benchmarks/test_coverage.py).
    """
    pairs = _pairs(kind)
    asked = (("H1", 1, FREQUENCIES[kind]), ("H2", 2, (pairs[:, 0], pairs[:, 1])))
    model = refine(estimate(terms(plant), u, y, scaling=Scaling()), u, y)
    followed = with_constant(model)
    try:
        track = dea.track_parameters(model, u, y, method=tracker)
    except (InputError, np.linalg.LinAlgError) as error:
        points = (
            {"parameters": len(followed.terms)}
            | {
                f"{label} {part}": len(FREQUENCIES[kind] if order == 1 else pairs)
                for label, order, _ in asked
                for part in ("gain", "phase")
            }
            | {"rest": HELD.size, "free run": 1}
        )
        nothing = {name: np.full(INSTANTS * count, np.nan) for name, count in points.items()}
        return Judged(nothing, f"fails: {error}")
    columns = {term: true[:, j] for j, term in enumerate(terms(plant))}
    instants = track["instant"].values
    # The first quarter is where a recursion still learns; smoothers are judged there alike.
    late = np.flatnonzero(instants > len(u) / 4)
    chosen = late[np.linspace(0, len(late) - 1, INSTANTS).astype(int)]
    at = np.round(instants[chosen]).astype(int)
    expected = np.stack([columns.get(term, np.zeros(len(u)))[at] for term in followed.terms])
    low, high = (track[end].values[chosen].T for end in ("band_low", "band_high"))
    inside = {"parameters": contains(expected, low, high).ravel()}
    covariance = track["covariance"].values[chosen]
    for label, order, f in asked:
        common: dict[str, Any] = {"operating_point": 0.0, "allow_missing": True}
        response = dea.frequency_response(followed, order, f, 1.0, parameters=expected.T, **common)
        band = dea.frequency_response_band(
            followed, order, f, 1.0, covariance=covariance,
            parameters=track["parameter"].values[at], **common,
        )  # fmt: skip
        phase = np.degrees(np.angle(response))
        inside[f"{label} gain"] = contains(np.abs(response), band.gain_low, band.gain_high).ravel()
        inside[f"{label} phase"] = phase_contains(phase, band.phase_low, band.phase_high).ravel()
    at_rest: dict[str, Any] = {"allow_missing": True}
    rests = []
    for held in HELD:
        at_rest["operating_point"] = held
        known = dea.gfrf.zero_input_response(followed, parameters=expected.T, **at_rest)
        found = dea.gfrf.zero_input_interval(
            followed, parameters=track["parameter"].values[at], covariance=covariance, **at_rest
        )
        rests.append(contains(known, found.low, found.high))
    inside["rest"] = np.concatenate(rests)
    runs = dea.tracking.compare_free_runs(model, {tracker: track}, u, y, window=len(u))
    run = runs.sel(simulation=tracker)
    ends = (run[f"simulated_{end}"].values[at] for end in ("low", "high"))
    inside["free run"] = contains(clean[at], *ends)
    return Judged(inside, str(track.attrs["withheld"]))


def _true_parameters(plant: Plant, model: NarxModel) -> Array:
    known = dict(zip(terms(plant), plant.parameters, strict=True))
    return np.array([known[term] for term in model.terms])


def contains(true: Array, low: Array, high: Array) -> Array:
    inside = ((low <= true) & (true <= high)).astype(float)
    inside[np.isnan(low) | np.isnan(high)] = np.nan
    return inside


def phase_contains(true: Array, low: Array, high: Array) -> Array:
    """Compare modulo a turn."""
    middle = (low + high) / 2
    turned = middle + (true - middle + 180) % 360 - 180
    return contains(turned, low, high)
