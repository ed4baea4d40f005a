"""What is named beside coloured noise and small drifts."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_resonator import (
    NOISE,
    graded,
    in_noise,
    leaving,
)
from scipy.signal import lfilter

from dea.discrepancy.decision import (
    Decision,
    Reason,
    Status,
    decide,
    without_small_drift,
)
from dea.discrepancy.evidence.colour import coloured_level
from dea.discrepancy.evidence.presence import Presence
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.rules import Rules
from dea.simulation import (
    catalogue,
    load_simulation,
    measured_scales,
    prepared,
)


@pytest.mark.parametrize(
    ("bent", "weight", "reason"),
    [
        (0.0, 1.0, Reason.COLOURED), (0.0, 0.85, Reason.REMAINS), (1.2, 1.0, Reason.REMAINS),
        (2.0, 1.0, Reason.REMAINS),
    ],
)  # fmt: skip
def test_a_pair_may_leave_coloured_noise_and_nothing_else(bent, weight, reason):
    """What is left may follow the input by a tenth; of certain effects, a part is named even so."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    noise = lfilter([1.0], [1.0, -0.9], np.random.default_rng(9).standard_normal(1500))
    left = 1.5 * noise / noise.std() + bent * evidence.problem.u / evidence.problem.u.std()
    pair = candidate(1.5, "sensor_lag", "second_mode")
    pair = replace(pair, fit=replace(pair.fit, residual=NOISE * left))
    alone = [candidate(size, name) for size, name in ((6.0, "sensor_lag"), (7.0, "second_mode"))]
    other = candidate(4.0, "sensor_lag", "dead_zone")
    weighed = Presence((pair, other), np.array([weight, 1.0 - weight]))
    pool = [pair, other, *alone, candidate(8.0, "dead_zone")]
    found = decide(evidence, pair, pool, alone, weighed)
    assert found.reason == reason
    assert found.answer is (pair if weight == 1.0 else alone[0])


@pytest.mark.parametrize(
    ("residual", "before", "names", "level"),
    [
        (in_noise(2.5), 9.0, ("dead_zone",), 2.5),
        (in_noise(2.5), 4.0, ("dead_zone",), 2.5),
        (in_noise(2.5), 3.4, ("dead_zone",), 0.0),
        (in_noise(0.3), 9.0, ("dead_zone",), 0.0),
        (in_noise(2.5, follows=1.5), 9.0, ("dead_zone",), 2.9),
        (in_noise(2.5, follows=1.5), 9.0, ("dead_zone", "sensor_lag"), 0.0),
        (in_noise(2.5, follows=4.0), 12.0, ("dead_zone",), 0.0),
    ],
)
def test_the_level_of_coloured_noise_is_what_the_best_candidate_leaves(
    residual, before, names, level
):
    """It is none where that is white, half of the energy, or follows the input."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules(), nominal=candidate(before).fit)
    best = leaving(candidate, residual, *names)
    screened = replace(candidate(1.0, "dead_zone"), finished=False)
    assert coloured_level(evidence, []) == 0.0
    assert coloured_level(evidence, [screened]) == 0.0
    assert coloured_level(evidence, [screened, best]) == pytest.approx(level * NOISE, rel=0.1)


def test_beyond_its_priors_a_simulation_has_no_level_of_coloured_noise():
    evidence, candidate = graded()
    best = leaving(candidate, in_noise(2.5), "dead_zone")
    assert coloured_level(evidence, [best]) > 0.0
    coordinates = best.fit.coordinates.copy()
    coordinates[0] = 3.0
    best = replace(best, fit=replace(best.fit, coordinates=coordinates))
    assert coloured_level(evidence, [best]) == 0.0


@pytest.mark.parametrize(("counted", "status"), [(False, "unknown"), (True, "named")])
def test_beside_coloured_noise_the_gap_counts_above_it(counted, status):
    """The dead zone removes all of what exceeds the noise, but half of what exceeds a white one."""
    evidence, candidate = graded()
    chosen = leaving(candidate, in_noise(2.0), "dead_zone")
    evidence = replace(evidence, rules=Rules(), nominal=candidate(3.6).fit)
    level = coloured_level(evidence, [chosen])
    assert level == pytest.approx(2.0 * NOISE, rel=0.1)
    evidence = replace(evidence, coloured_level=level if counted else 0.0)
    weighed = Presence((chosen,), np.array([1.0]))
    found = decide(evidence, chosen, [chosen], [chosen], weighed)
    assert found.status == status
    assert found.reason is (Reason.COLOURED if counted else Reason.UNEXPLAINED)


@pytest.mark.parametrize(("accuracy", "floor"), [(0.0, np.hypot(1.0, 2.0)), (3.0, np.hypot(1, 3))])
def test_the_floor_holds_the_larger_of_accuracy_and_coloured_noise(accuracy, floor):
    evidence, _ = graded()
    evidence = replace(evidence, accuracy=accuracy * NOISE, coloured_level=2.0 * NOISE)
    assert evidence.floor == pytest.approx(floor * NOISE)
    assert evidence.stated_floor == pytest.approx(np.hypot(1.0, accuracy) * NOISE)


@pytest.mark.parametrize("proven", [True, False])
@pytest.mark.parametrize(
    ("stiffest", "status", "reason"),
    [(2.9, "none", Reason.COLOURED), (3.0, "unknown", None)],
)
def test_beyond_its_priors_a_simulation_leaves_no_coloured_noise(proven, stiffest, status, reason):
    """Coloured noise is left, and an effect that does not lower the error on blocks left out."""
    evidence, candidate = graded()
    noise = lfilter([1.0], [1.0, -0.9], np.random.default_rng(9).standard_normal(1500))
    left = 4.0 * NOISE * noise / noise.std()
    coordinates = np.zeros(evidence.nominal.coordinates.size)
    coordinates[0] = stiffest
    nominal = replace(evidence.nominal, residual=left, coordinates=coordinates)
    evidence = replace(evidence, rules=Rules(), nominal=nominal)
    useless = candidate(4.0, "dead_zone")
    useless = replace(useless, fit=replace(useless.fit, residual=left))
    weighed = Presence((useless,), np.array([1.0]))
    found = decide(evidence, useless if proven else None, [useless], [], weighed)
    assert found.status == status
    assert found.reason is (reason or (Reason.UNEXPLAINED if proven else Reason.NO_EFFECT))


def beside_noise(
    second="baseline_drift", size=1.4, before=9.0, bent=0.0, finished=True, better=9.0
):
    """Decide on a dead zone with a second effect, which takes up what is not white noise.

    ``size`` is all noise in floors, ``bent`` an error of the law, ``before`` what the simulation
    alone leaves, and ``better`` what another single effect does.
    """
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules(), nominal=candidate(before).fit)
    rng = np.random.default_rng(8)
    slow = lfilter([1.0], [1.0, -0.98], rng.standard_normal(1500))
    white = candidate(1.0).fit.residual
    law = evidence.problem.u**3
    noise = white + NOISE * np.sqrt(size**2 - 1.0 - bent**2) * slow / slow.std()
    noise += bent * NOISE * law / law.std()

    def leaving(residual, *names):
        made = candidate(1.0, *names)
        error = evidence.problem.seen_rmse(residual)
        return replace(made, fit=replace(made.fit, residual=residual), rmse=error, error=error)

    alone = replace(leaving(noise, "dead_zone"), finished=finished)
    pair = leaving(white, "dead_zone", second)
    pool = [pair, alone, candidate(6.0, second), candidate(better, "strain_stiffening")]
    weighed = Presence((pair, alone), np.array([1.0, 0.0]))
    decided = decide(evidence, pair, pool, [alone], weighed)
    return without_small_drift(decided, evidence, pool)


def test_a_drift_as_small_as_the_white_noise_is_noise():
    found = beside_noise()
    assert (found.status, found.answer.names) == ("named", ("dead_zone",))
    assert found.reason is Reason.COLOURED


@pytest.mark.parametrize(
    ("size", "bent", "name", "none"),
    [
        (1.2, 0.0, "baseline_drift", True), (1.8, 0.0, "baseline_drift", False),
        (1.4, 0.95, "baseline_drift", False), (1.2, 0.0, "gain_drift", False),
    ],
)  # fmt: skip
def test_a_drift_alone_that_is_as_small_as_the_white_noise_is_noise(size, bent, name, none):
    """Unless it is larger, the residual follows the input, or it is no drift of the reading."""
    evidence, candidate = graded()
    drift = candidate(1.0, name)
    slow = lfilter([1.0], [1.0, -0.98], np.random.default_rng(8).standard_normal(1500))
    left = drift.fit.residual + NOISE * np.sqrt(size**2 - 1.0 - bent**2) * slow / slow.std()
    left += bent * NOISE * evidence.problem.u / evidence.problem.u.std()
    nominal = replace(evidence.nominal, residual=left)
    evidence = replace(evidence, rules=Rules(), nominal=nominal)
    decided = Decision(Status.NAMED, drift)
    found = without_small_drift(decided, evidence, [drift])
    assert found.status is (Status.NONE if none else Status.NAMED)
    assert (found.answer, found.reason) == ((None, Reason.COLOURED) if none else (drift, None))


@pytest.mark.parametrize(
    "changed",
    [
        {"size": 1.7},  # it is larger than white noise
        {"second": "gain_drift"},  # what it explains follows the motion
        {"second": "sensor_lag"},
        {"second": "periodic_disturbance"},  # a line is no noise
        {"size": 1.45, "bent": 1.0},  # what is left follows the input
        {"before": 1.8},  # the dead zone removes less than half of the gap
        {"finished": False},
        {"better": 1.2},  # without the drift another effect is better
    ],
)
def test_what_a_further_effect_explains_is_noise_only_if_it_is_a_small_drift(changed):
    found = beside_noise(**changed)
    assert found.answer is None or len(found.answer.names) == 2
    assert found.reason is not Reason.COLOURED


def test_what_is_named_without_its_drift_acts_at_the_same_place():
    evidence, candidate = graded()
    simulation = load_simulation("two_heaters")
    u = np.random.default_rng(1).uniform(0.0, 50.0, (1500, len(simulation.inputs)))
    plain = prepared(simulation, u, 1.0, 1e-2)
    evidence = replace(evidence, problem=replace(evidence.problem, u=u, interval=1.0))
    values = plain.layout.prior_means
    y = plain.simulate(values, u, 1.0)
    told = measured_scales(plain, values, SimpleNamespace(u=u, y=y, interval=1.0))

    def made(residual, *laws):
        extended = plain
        for name, place in laws:
            extended = extended.attach(catalogue()[name], told, place)
        fitted = Fit(
            extended, np.zeros(extended.layout.free.size), residual, np.zeros((1500, 1)), 0.0
        )
        error = evidence.problem.seen_rmse(residual)
        return Candidate(fitted, error, error, 9.0)

    rng = np.random.default_rng(3)
    slow = lfilter([1.0], [1.0, -0.98], rng.standard_normal(1500))
    white = candidate(1.0).fit.residual
    noise = white + 0.9 * NOISE * slow / slow.std()
    pair = made(white, ("end_stop", 1), ("baseline_drift", 0))
    here, elsewhere = made(1.01 * noise, ("end_stop", 1)), made(1.05 * noise, ("end_stop", 0))
    assert here.names == elsewhere.names
    assert here.labels != elsewhere.labels
    decided = Decision(Status.NAMED, pair)
    assert without_small_drift(decided, evidence, [here, elsewhere, pair]).answer is here
    assert without_small_drift(decided, evidence, [elsewhere, pair]) is decided
