"""Which sets of effects are tried, and what their rivals are judged by."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from dea.discrepancy.budget import Budget
from dea.discrepancy.decision import (
    Decision,
    Reason,
    Status,
    best_extension,
    decide,
    sure_alone,
    without_small_drift,
)
from dea.discrepancy.decision.parts import each_adds
from dea.discrepancy.evidence.colour import coloured_level
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.held_out import HeldOut
from dea.discrepancy.evidence.identifiability import most_visible, visibility
from dea.discrepancy.evidence.presence import Presence
from dea.discrepancy.fitting.candidates import Candidate, judged
from dea.discrepancy.fitting.fit import Columns, Fit, at, fit
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.split import split
from dea.discrepancy.rules import Rules
from dea.discrepancy.search import rounds as search_rounds
from dea.discrepancy.search import screening
from dea.discrepancy.search.degenerate import unfinish_degenerate
from dea.discrepancy.search.hints import jumps
from dea.discrepancy.search.rounds import Round, extend_by_each
from dea.discrepancy.search.screening import Base, Offer, promising, where_it_does_nothing
from dea.discrepancy.search.search import Search, pool_of
from dea.simulation import (
    ForcePort,
    Parameter,
    Port,
    State,
    catalogue,
    load_simulation,
    measured_scales,
    prepared,
)

INTERVAL, NOISE = 0.02, 0.002
SPRING = load_simulation("mass_spring_damper")
DEVICE = replace(
    SPRING,
    parameters=tuple(
        replace(each, nominal={"natural_frequency": 3.0, "damping_ratio": 0.5}.get(each.name, 1.0))
        for each in SPRING.parameters
    ),
)
PRESENT = {
    "slew_limit": {"rate": 20.0},
    "input_saturation": {"limit": 1.0},
    "dead_zone": {"threshold": 0.4},
    "sensor_lag": {"time_constant": 0.12},
    "stress_relaxation": {"relaxation": 0.3, "time": 10.0},
    "viscoelastic_creep": {"stiffness": 0.2},
    "charge_leakage": {"loss": 0.2, "field_growth": 3.0, "settling_time": 2.0},
}


class Predicted(HeldOut):
    """Held-out residuals that are given by a function of the fit."""

    def __init__(self, problem, residual):
        super().__init__(problem)
        self._given = residual

    def residual(self, fitted, beside=None):
        return self._given(fitted)


def hidden(*names, seed=1):
    """Return a problem in which the named effects are hidden, and the simulation without them."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-2, 2, 60), 25)
    extended = prepared(DEVICE, u, INTERVAL, 1e-4)
    values = extended.layout.prior_means
    everything = np.ones(u.size, bool)
    told = measured_scales(
        extended, values, Problem(u, u, INTERVAL, everything, everything, everything)
    )
    truth = extended
    for name in names:
        effect = catalogue()[name]
        truth = truth.attach(effect, told)
        own = dict(
            zip((p.name for p in effect.parameters(told)), effect.starts(told)[0], strict=True)
        )
        values = np.concatenate([values, list((own | PRESENT[name]).values())])
    y = truth.simulate(values, u, INTERVAL) + NOISE * rng.standard_normal(u.size)
    parts = split(u, INTERVAL, 0.1)
    problem = Problem(
        u, y, INTERVAL, parts.fit, parts.select, parts.certify, NOISE, 1e-4, extended.substeps
    )
    return problem, extended


def test_an_event_of_nothing_is_found_at_once_where_it_may_have_happened():
    problem, extended = hidden()
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    effect = catalogue()["step_fault"]
    told = replace(measured_scales(extended, nominal.values, problem), jumps=(12.0, 20.0))
    tried = []

    class Counted(Base):
        def residual(self, *given):
            tried.append(given)
            return super().residual(*given)

    base = Counted.of(problem, nominal)
    found = where_it_does_nothing(problem, base, Offer(effect, told))
    values = dict(
        zip(
            found.extended.layout.names,
            found.extended.layout.values(found.coordinates),
            strict=True,
        )
    )
    assert values["step_fault.instant"] == pytest.approx(12.0)
    residual = problem.residual(found.extended, found.extended.layout.values(found.coordinates))
    assert np.allclose(residual, nominal.residual, atol=0.1 * NOISE)
    assert len(tried) <= 10


@pytest.mark.parametrize("phase", np.linspace(0.0, 2 * np.pi, 9)[:-1])
def test_a_disturbance_promises_most_at_its_frequency_whatever_its_phase(phase):
    problem, extended = hidden()
    wave = 0.1 * np.sin(2 * np.pi * 1.3 * problem.time + phase)
    shaken = replace(problem, y=problem.y + wave + 0.1 * wave**3)
    nominal = fit(shaken, extended, np.zeros(extended.layout.free.size))
    scales = measured_scales(extended, nominal.values, shaken)
    told = replace(scales, foreign_frequencies=(1.3, 3.9))
    effect = catalogue()["periodic_disturbance"]
    base = Base.of(shaken, nominal)
    best, *_ = promising(shaken, [base], Offer(effect, told), 2)
    frequency = best.extended.layout.names.index("periodic_disturbance.frequency")
    assert best.extended.layout.values(best.coordinates)[frequency] == pytest.approx(1.3)


def test_a_start_that_changes_nothing_promises_nothing():
    problem, extended = hidden()
    base = Base.of(problem, fit(problem, extended, np.zeros(extended.layout.free.size)))
    start = screening._promised(problem, base, base.fit.extended, np.empty(0))
    assert start.left == base.left @ base.left


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", ["baseline_drift", "gain_drift", "step_fault"])
def test_a_course_in_time_promises_much_whether_it_rises_or_falls(name, sign):
    problem, extended = hidden()
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    simulated = problem.y - nominal.residual
    course = 0.2 * (problem.time > 0.4 * problem.time[-1] if name == "step_fault" else
                    problem.time / problem.time[-1])  # fmt: skip
    added = course * (1.0 if name == "baseline_drift" else simulated - simulated.mean())
    moved = replace(problem, y=problem.y + sign * added)
    nominal = fit(moved, extended, np.zeros(extended.layout.free.size))
    scales = replace(
        measured_scales(extended, nominal.values, moved),
        jumps=jumps(moved, nominal.residual),
    )
    base = Base.of(moved, nominal)
    best, *_ = promising(moved, [base], Offer(catalogue()[name], scales), 2)
    assert best.left < 0.3 * (base.left @ base.left)


def test_a_law_starts_within_the_motion_of_the_fit_that_it_is_attached_to():
    """Fits with other constants at the input: one device moves above the other."""
    problem, extended = hidden()
    extended = replace(extended, simulation=replace(extended.simulation, input_offset_spread=5.0))
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    lifted = nominal.coordinates.copy()
    lifted[[extended.layout.names[i] for i in extended.layout.free].index("input_offset")] = 2.0
    stop = Offer(catalogue()["end_stop"], measured_scales(extended, nominal.values, problem))
    for fitted in (nominal, at(problem, extended, lifted)):
        position = fitted.extended.run(fitted.values, problem.u, INTERVAL)[1]
        for start in promising(problem, [Base.of(problem, fitted)], stop, 2):
            values = start.extended.layout.values(start.coordinates)
            own = dict(zip(start.extended.layout.names, values, strict=True))
            stops = own["end_stop.upper_stop"], own["end_stop.lower_stop"]
            assert any(position.min() < each < position.max() for each in stops)


def test_a_law_takes_its_scales_at_the_force_port_that_it_is_attached_to():
    own = load_simulation("two_heaters")
    rng = np.random.default_rng(4)
    u = np.repeat(rng.uniform(0, 100, (40, 2)), 20, axis=0)
    everything = np.ones(len(u), bool)
    extended = prepared(own, u, 1.0, 1e-3)
    y = extended.simulate(extended.layout.prior_means, u, 1.0)
    problem = Problem(u, y, 1.0, everything, ~everything, ~everything)
    fitted = at(problem, extended, np.zeros(extended.layout.free.size))
    base = Base.of(problem, fitted)
    assert len(base.motions) == len(own.force_ports) > 1
    for place in range(len(own.force_ports)):
        told = measured_scales(extended, fitted.values, problem, place)
        found = Offer(catalogue()["end_stop"], told, place).attached_to(base)
        assert found.attached[-1].scales == told


@pytest.mark.parametrize("first", ["slew_limit", "input_saturation"])
def test_the_order_of_two_laws_on_the_inputs_way_is_found(first):
    [second] = {"slew_limit", "input_saturation"} - {first}
    problem, extended = hidden(first, second)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    effects = catalogue()
    alone = extend_by_each(problem, [nominal], [effects["slew_limit"]], Budget(), 1)
    [both] = extend_by_each(
        problem, [alone.candidates[0].fit], [effects["input_saturation"]], Budget(), 1
    ).candidates
    assert both.rmse < 1.5 * NOISE
    assert alone.candidates[0].rmse > 10 * NOISE
    assert both.fit.extended.attached[-1].upstream is (first == "input_saturation")


@pytest.mark.slow
@pytest.mark.parametrize("relaxes", [True, False])
@pytest.mark.parametrize(
    ("name", "drift"), [("stress_relaxation", 0.2), ("viscoelastic_creep", 0.1)]
)
def test_a_drift_does_not_bear_the_name_of_a_relaxation(name, drift, relaxes):
    """A prestress lost alone is a force that drifts; the stress must relax, or answer motion."""
    problem, extended = hidden(*[name] * relaxes)
    if not relaxes:
        late = (problem.time / 10.0) ** 0.8
        problem = replace(problem, y=problem.y + drift * (1.0 - np.exp(-late)))
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    effect = catalogue()[name]
    alone = extend_by_each(problem, [nominal], [effect], Budget(), 1)
    assert alone.candidates[0].finished
    assert alone.candidates[0].rmse < 1.5 * NOISE
    [judged_again] = unfinish_degenerate(problem, [alone], Rules(), NOISE, 1)
    assert judged_again.candidates[0].finished == relaxes


@pytest.mark.parametrize("leaks", [True, False])
def test_a_bent_input_does_not_bear_the_name_of_a_leak(leaks):
    """A charge that is lost at once bends the input's curve."""
    problem, extended = hidden(*["charge_leakage"] * leaks)
    if not leaks:
        own = extended.layout.prior_means
        curved = problem.u * (1.0 - 0.1 * np.exp(3.0 * (np.abs(problem.u) / 2.0 - 1.0)))
        noise = problem.y - extended.simulate(own, problem.u, INTERVAL)
        problem = replace(problem, y=extended.simulate(own, curved, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    effect = catalogue()["charge_leakage"]
    alone = extend_by_each(problem, [nominal], [effect], Budget(), 1)
    assert alone.candidates[0].finished
    assert alone.candidates[0].rmse < 0.7 * problem.seen_rmse(nominal.residual)
    [judged_again] = unfinish_degenerate(problem, [alone], Rules(), NOISE, 1)
    assert judged_again.candidates[0].finished == leaks


def limited_since(since, begun):
    """Whether a limit since that time (s) keeps the name of an event, fitted from another time."""
    problem, extended = hidden()
    own = extended.layout.prior_means
    limited = np.where(problem.time >= since, np.minimum(problem.u, 1.2), problem.u)
    noise = problem.y - extended.simulate(own, problem.u, INTERVAL)
    problem = replace(problem, y=extended.simulate(own, limited, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    scales = replace(measured_scales(extended, nominal.values, problem), jumps=(19.0,))
    law = extended.attach(catalogue()["step_fault"], scales)
    low, high = problem.u.min(), problem.u.max()
    start = (begun, 0.0, 0.0, 0.1, 0.0, 1.3, low, 0.0, low, high, 6.0, 1.2, 0.0)
    found = fit(problem, law, law.layout.coordinates(np.concatenate([nominal.values, start])))
    assert problem.seen_rmse(found.residual) < 2.0 * NOISE
    candidate = judged(problem, found)
    [judged_again] = unfinish_degenerate(problem, [Round(nominal, (candidate,))], Rules(), NOISE, 1)
    return judged_again.candidates[0].finished


@pytest.mark.parametrize("since", [0.0, 20.0])
def test_a_limit_from_the_start_does_not_bear_the_name_of_an_event(since):
    assert limited_since(since, since + 0.7) == (since > 0.0)


@pytest.mark.parametrize(("since", "begun"), [(0.0, 0.45), (20.0, 20.7)])
def test_an_event_in_the_first_fiftieth_of_a_record_is_one_from_the_start(
    since, begun, monkeypatch
):
    """Even if it explains more than from the start on, as the state at the start may."""
    monkeypatch.setattr("dea.discrepancy.search.degenerate._explains_as_much", lambda *_: False)
    assert limited_since(since, begun) == (since > 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("threshold", [True, False])
def test_a_power_of_the_input_does_not_bear_the_name_of_a_threshold(threshold):
    """A heater's power goes with the square of its voltage, from zero on."""
    problem, extended = hidden(*["dead_zone"] * threshold)
    if not threshold:
        own = extended.layout.prior_means
        squared = problem.u * np.abs(problem.u) / 2.0
        noise = problem.y - extended.simulate(own, problem.u, INTERVAL)
        problem = replace(problem, y=extended.simulate(own, squared, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    alone = extend_by_each(problem, [nominal], [catalogue()["dead_zone"]], Budget(), 1)
    assert alone.candidates[0].finished
    assert alone.candidates[0].rmse < 1.2 * NOISE
    [judged_again] = unfinish_degenerate(problem, [alone], Rules(), NOISE, 1)
    assert judged_again.candidates[0].finished == threshold


@pytest.mark.slow
@pytest.mark.parametrize("relaxes", [True, False])
def test_a_law_loses_its_name_beside_one_that_keeps_its_own(relaxes):
    problem, extended = hidden("dead_zone", *["stress_relaxation"] * relaxes)
    if not relaxes:
        late = (problem.time / 10.0) ** 0.8
        problem = replace(problem, y=problem.y + 0.2 * (1.0 - np.exp(-late)))
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [catalogue()[name] for name in ("dead_zone", "stress_relaxation")]
    rounds = Search(problem, [nominal], offered, Budget(), Rules(), 1).rounds()
    best = pool_of(rounds)[0]
    assert best.effects == {"dead_zone", "stress_relaxation"}
    assert best.rmse < 1.5 * NOISE
    judged_again = pool_of(unfinish_degenerate(problem, rounds, Rules(), NOISE, 1))
    assert [c.finished for c in judged_again if c.effects == best.effects] == [relaxes]


@pytest.mark.slow
def test_two_effects_are_found_beside_laws_that_pass_for_them():
    problem, extended = hidden("dead_zone", "sensor_lag")
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [
        catalogue()[name]
        for name in ("dead_zone", "sensor_lag", "coulomb_friction", "electrode_lag", "second_mode")
    ]
    rounds = Search(problem, [nominal], offered, Budget(), Rules(), 1).rounds()
    pool = pool_of(rounds)
    assert set(pool[0].names) == {"dead_zone", "sensor_lag"}
    assert pool[0].rmse < 1.1 * NOISE < rounds[0].candidates[0].rmse
    sets = [(frozenset(c.labels), c.finished) for c in pool]
    assert len(sets) == len(set(sets))


@pytest.mark.slow
def test_a_second_effect_that_only_helped_the_first_one_is_dropped():
    """The fits of single effects stopped where they started; only pairs are fitted to the end."""
    problem, extended = hidden("sensor_lag")
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [catalogue()["dead_zone"], catalogue()["sensor_lag"]]
    told = measured_scales(nominal.extended, nominal.values, problem)

    def started(effect):
        attached = extended.attach(effect, told)
        laws = [attached.attached[-1].started(start) for start in effect.starts(told)]
        places = [
            attached.layout.coordinates(np.concatenate([nominal.values, law])) for law in laws
        ]
        return min(
            (judged(problem, at(problem, attached, p)) for p in places), key=lambda c: c.rmse
        )

    class Stuck(Search):
        @property
        def singles(self):
            stopped = [started(effect) for effect in offered]
            return Round(nominal, tuple(sorted(stopped, key=lambda c: c.error)))

    search = Stuck(problem, [nominal], offered, Budget(exchanges=0), Rules())
    assert search.singles.candidates[0].rmse > 2 * NOISE
    best = search.rounds()[0].candidates[0]
    assert best.names == ("sensor_lag",)
    assert best.rmse < 1.1 * NOISE


@pytest.mark.parametrize(("held_out_rival", "status"), [(1.5, "named"), (1.0, "ambiguous")])
def test_a_rival_that_fits_better_must_also_predict_better(held_out_rival, status):
    problem, extended = hidden("dead_zone")
    plain = at(problem, extended, np.zeros(extended.layout.free.size))
    values = extended.layout.prior_means
    told = measured_scales(extended, values, problem)
    gap = NOISE * np.random.default_rng(2).standard_normal(problem.u.size)

    def candidate(name, size, error):
        attached = extended.attach(catalogue()[name], told)
        return Candidate(
            Fit(attached, plain.coordinates, size * gap, plain.jacobian, 0.0), error, error, 9.0
        )

    chosen = candidate("dead_zone", 1.0, 1.1 * NOISE)
    rival = candidate("strain_stiffening", 0.9, 1.3 * NOISE)
    known = {chosen.fit: gap, rival.fit: held_out_rival * gap}
    blocks = [slice(k, k + 100) for k in range(0, 1500, 100)]
    evidence = Evidence(
        problem, replace(plain, residual=9.0 * gap), SimpleNamespace(residual=known.get), blocks,
        NOISE, 0.0, Rules(), np.random.default_rng(3),
    )  # fmt: skip
    weighed = Presence((chosen, rival), np.array([0.5, 0.5]))
    found = decide(evidence, chosen, [chosen, rival], [chosen], weighed)
    assert found.status == status


@pytest.mark.parametrize(
    ("curve", "before", "names", "status"),
    [
        (0.0, 9.0, ("dead_zone",), "named"),
        (2.5, 9.0, ("dead_zone",), "unknown"),
        (0.0, 4.0, ("dead_zone",), "unknown"),
        (0.0, 9.0, ("dead_zone", "second_mode"), "unknown"),
    ],
)
def test_one_effect_may_leave_noise_of_any_colour_and_nothing_else(curve, before, names, status):
    """What is left is three floors of coloured noise, in part replaced by a curve of the input.

    The effect is likely, not certain: a certain one is named in part whatever is left.
    """
    problem, extended = hidden("dead_zone")
    plain = at(problem, extended, np.zeros(extended.layout.free.size))
    told = measured_scales(extended, extended.layout.prior_means, problem)
    rng = np.random.default_rng(6)
    slow = lfilter([1.0], [1.0, -0.9], rng.standard_normal(problem.u.size))
    noise = NOISE * (rng.standard_normal(slow.size) + np.sqrt(8.0 - curve**2) * slow / slow.std())
    bent = problem.u**3
    left = noise + curve * bent / bent.std() * NOISE
    attached = extended
    for name in names:
        attached = attached.attach(catalogue()[name], told)
    error = problem.seen_rmse(left)
    chosen = Candidate(
        Fit(attached, np.zeros(attached.layout.free.size), left, plain.jacobian, 0.0),
        error,
        error,
        9.0,
    )
    nominal = replace(plain, residual=left * before * NOISE / error)
    held_out = Predicted(problem, lambda fitted: fitted.residual)
    evidence = Evidence(
        problem, nominal, held_out, [slice(k, k + 100) for k in range(0, 1500, 100)], NOISE, 0.0,
        Rules(), np.random.default_rng(7),
    )  # fmt: skip
    weighed = Presence((chosen,), np.full(1, 0.8))
    found = decide(evidence, chosen, [chosen], [chosen], weighed)
    assert found.status == status
    assert (found.reason is Reason.COLOURED) == (status == "named")


def test_a_held_out_gap_is_found_once():
    problem, extended = hidden("dead_zone")
    fitted = fit(problem, extended, np.zeros(extended.layout.free.size))
    held_out = HeldOut(problem)
    assert held_out.residual(fitted) is held_out.residual(fitted)
    assert held_out.rmse(fitted) == problem.seen_rmse(held_out.residual(fitted))


def graded():
    """Return evidence on a hidden dead zone, and what makes candidates of a given misfit."""
    problem, extended = hidden("dead_zone")
    plain = at(problem, extended, np.zeros(extended.layout.free.size))
    told = measured_scales(extended, extended.layout.prior_means, problem)
    u = problem.u / problem.u.std()
    noise = NOISE * np.random.default_rng(4).standard_normal(u.size)

    def candidate(size, *names):
        longer = extended
        for name in names:
            longer = longer.attach(catalogue()[name], told)
        residual = noise + NOISE * np.sqrt(size**2 - 1.0) * u**3 / (u**3).std()
        fitted = Fit(longer, np.zeros(longer.layout.free.size), residual, plain.jacobian, 0.0)
        return Candidate(fitted, problem.seen_rmse(residual), problem.seen_rmse(residual), 9.0)

    held_out = Predicted(problem, lambda fitted: fitted.residual)
    evidence = Evidence(
        problem, candidate(9.0).fit, held_out,
        [slice(k, k + 100) for k in range(0, 1500, 100)], NOISE, 0.0, Rules(misfit=1e-3),
        np.random.default_rng(5),
    )  # fmt: skip
    return evidence, candidate


@pytest.mark.parametrize(
    ("without", "left", "named"),
    [(3.0, 1.5, ("dead_zone",)), (1.7, 1.5, None), (3.0, 6.0, ("dead_zone",))],
)
def test_the_certain_part_of_an_answer_is_named(without, left, named):
    """A dead zone is in both good answers; what is beside it is not known."""
    evidence, candidate = graded()
    alone = candidate(left, "dead_zone")
    pairs = [candidate(1.4, "dead_zone", "sensor_lag"), candidate(1.42, "dead_zone", "slew_limit")]
    others = [candidate(without, "sensor_lag"), candidate(without, "slew_limit")]
    pool = [*pairs, alone, *others]
    weighed = Presence(tuple(pairs), np.array([0.5, 0.5]))
    found = decide(evidence, pairs[0], pool, [alone], weighed)
    if named is None:
        assert found.status != "named"
    else:
        assert (found.status, found.answer.names, found.whole) == ("named", named, False)


@pytest.mark.parametrize(
    ("sure", "only", "left", "kin", "named"),
    [
        ("sensor_lag", 8.5, 4.0, 8.0, True),
        ("sensor_lag", 8.9, 4.0, 8.0, False),  # by itself no more than an error of a law
        ("sensor_lag", 8.5, 4.0, 5.0, False),  # another one of the family comes near
        ("sensor_lag", 8.5, 5.5, 8.9, False),
        ("gain_drift", 8.5, 4.0, 8.0, False),
    ],
)
def test_a_part_is_certain_by_what_it_removes_beside_other_effects(sure, only, left, kin, named):
    """All good answers hold one effect, which alone removes little of 9 noise deviations.

    A course in time would follow whatever else is slow.
    """
    evidence, candidate = graded()
    alone = candidate(only, sure)
    pairs = [candidate(left, sure, "dead_zone"), candidate(1.01 * left, sure, "slew_limit")]
    others = [candidate(8.8, "dead_zone"), candidate(8.8, "slew_limit")]
    pool = [*pairs, alone, *others, candidate(kin, "electrode_lag", "dead_zone")]
    weighed = Presence(tuple(pairs), np.array([0.5, 0.5]))
    found = decide(evidence, pairs[0], pool, [alone], weighed)
    assert (found.status == "named") == named
    assert not named or (found.answer, found.whole) == (alone, False)


@pytest.mark.parametrize(
    ("presence", "without", "named"),
    [
        (1.0, 2.6, ("dead_zone", "sensor_lag")),
        (1.0, 2.1, ("dead_zone",)),  # another second effect does nearly as well
        (0.8, 2.6, ("dead_zone",)),
    ],
)
def test_two_effects_are_certain_where_nothing_replaces_the_second(presence, without, named):
    evidence, candidate = graded()
    alone = candidate(3.6, "dead_zone")
    pair = candidate(1.8, "dead_zone", "sensor_lag")
    rival = candidate(without, "dead_zone", "gain_drift")
    pool = [pair, rival, alone, candidate(6.0, "sensor_lag"), candidate(6.5, "gain_drift")]
    weighed = Presence((pair, rival), np.array([presence, 1.0 - presence]))
    found = decide(evidence, pair, pool, [alone], weighed)
    assert (found.status, found.answer.names, found.whole) == ("named", named, False)


@pytest.mark.parametrize(("without", "named"), [(3.0, True), (2.4, False)])
def test_two_effects_are_certain_though_neither_alone_explains_most(without, named):
    evidence, candidate = graded()
    pair = candidate(1.8, "dead_zone", "sensor_lag")
    alone = [candidate(6.5, "dead_zone"), candidate(7.0, "sensor_lag")]
    others = [
        candidate(without, "sensor_lag", "gain_drift"),
        candidate(3.0, "dead_zone", "gain_drift"),
    ]
    weighed = Presence((pair, *others), np.array([0.96, 0.02, 0.02]))
    found = decide(evidence, pair, [pair, *others, *alone], alone, weighed)
    part = pair if named else alone[1]  # which both of the best explanations hold
    assert (found.status, found.answer, found.whole) == ("named", part, False)


def test_of_three_effects_each_is_certain_only_where_nothing_replaces_it():
    evidence, candidate = graded()
    names = "dead_zone", "sensor_lag", "gain_drift"
    triple, pair = candidate(1.8, *names), candidate(1.9, *names[:2])
    alone = candidate(3.6, "dead_zone")
    pool = [triple, pair, alone, candidate(6.0, "sensor_lag"), candidate(6.5, "gain_drift")]
    weighed = Presence((triple,), np.array([1.0]))
    found = decide(evidence, triple, pool, [alone], weighed)
    assert (found.status, found.answer.names, found.whole) == ("named", names[:2], False)


@pytest.mark.parametrize(
    ("presence", "left", "before", "found"),
    [(0.95, 1.02, 4.0, 1), (0.8, 1.02, 4.0, 0), (0.95, 1.4, 4.0, 0), (0.95, 1.02, 1.2, 0)],
)
def test_an_effect_that_acts_rarely_is_sure_where_it_leaves_noise_alone(
    presence, left, before, found
):
    evidence, candidate = graded()
    evidence = replace(evidence, nominal=candidate(before).fit)
    rare, other = candidate(left, "output_saturation"), candidate(3.0, "sensor_lag")
    weighed = Presence((rare, other), np.array([presence, 1.0 - presence]))
    sure = sure_alone(evidence, [Round(evidence.nominal, (rare, other))], weighed)
    assert sure == [rare][:found]
    worse = SimpleNamespace(
        residual=lambda fitted, _=None: (5.0 if fitted is rare.fit else 1.0) * fitted.residual
    )
    evidence = replace(evidence, held_out=worse)
    assert not sure_alone(evidence, [Round(evidence.nominal, (rare, other))], weighed)


@pytest.mark.parametrize(("left", "chosen"), [(1.4, "pair"), (1.6, "alone")])
def test_a_further_effect_must_remove_most_of_what_is_left(left, chosen):
    """Of a misfit of 2.83 floors it leaves 0.98, or 1.25, where at most 0.99 may be left."""
    evidence, candidate = graded()
    alone, pair = candidate(3.0, "dead_zone"), candidate(left, "dead_zone", "sensor_lag")
    rounds = [Round(evidence.nominal, (alone,)), Round(alone.fit, (pair,))]
    assert best_extension(evidence, rounds, [alone]) is {"pair": pair, "alone": alone}[chosen]


@pytest.mark.parametrize(
    ("left", "second", "chosen"),
    [
        (1.6, "dead_zone", "pair"),  # 14 % of the gap, for a law of another family
        (1.26, "dead_zone", "pair"),
        (1.6, "slew_limit", "alone"),
        (3.0, "slew_limit", "pair"),  # 32 %
    ],
)
def test_a_further_effect_of_the_same_family_needs_more_room(left, second, chosen):
    """A lag leaves so many noise deviations of nine, both together hardly more than noise."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    alone, pair = candidate(left, "sensor_lag"), candidate(1.01, "sensor_lag", second)
    rounds = [Round(evidence.nominal, (alone,)), Round(alone.fit, (pair,))]
    assert best_extension(evidence, rounds, [alone]) is {"pair": pair, "alone": alone}[chosen]


def test_extensions_are_compared_on_the_same_blocks_left_out():
    """A course in time is predicted well in short blocks alone, and so is all beside it."""
    evidence, candidate = graded()
    alone, pair = candidate(4.0, "gain_drift"), candidate(1.5, "dead_zone", "sensor_lag")
    compared = []

    class Seen(Predicted):
        def residual(self, fitted, beside=None):
            compared.append((fitted, beside))
            return super().residual(fitted, beside)

    evidence = replace(evidence, held_out=Seen(evidence.problem, lambda fitted: fitted.residual))
    rounds = [Round(evidence.nominal, (alone,)), Round(alone.fit, (pair,))]
    best_extension(evidence, rounds, [alone])
    assert (pair.fit, alone.fit) in compared


def test_no_more_effects_are_combined_than_the_budget_allows():
    problem, extended = hidden("dead_zone", "sensor_lag")
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [catalogue()[name] for name in ("dead_zone", "sensor_lag")]
    rounds = Search(problem, [nominal], offered, Budget(effects=1, restarted=0), Rules()).rounds()
    assert {len(c.names) for each in rounds for c in each.candidates} == {1}


@pytest.mark.parametrize(
    ("left", "second", "chosen"),
    [
        (1.02, "baseline_drift", "pair"),
        (1.6, "baseline_drift", "alone"),
        (1.02, "sensor_lag", "alone"),
    ],
)
def test_a_drift_that_leaves_noise_alone_need_not_predict_every_block(left, second, chosen):
    """A drift that three blocks show is extrapolated badly to each of them; a law is not."""
    evidence, candidate = graded()
    alone, pair = candidate(4.0, "dead_zone"), candidate(left, "dead_zone", second)
    worse = {pair.fit: 5.0 * pair.fit.residual}

    held_out = Predicted(evidence.problem, lambda fitted: worse.get(fitted, fitted.residual))
    evidence = replace(evidence, held_out=held_out)
    rounds = [Round(evidence.nominal, (alone,)), Round(alone.fit, (pair,))]
    assert best_extension(evidence, rounds, [alone]) is {"pair": pair, "alone": alone}[chosen]


def test_what_an_effect_reduces_is_not_called_noise():
    """The residual of the simulation alone is noise by every test, but a part of it is removed."""
    evidence, candidate = graded()
    noise = lfilter([1.0], [1.0, -0.9], np.random.default_rng(8).standard_normal(1500))
    noise *= 9.0 * NOISE / noise.std()
    alone = candidate(6.0, "dead_zone")
    weighed = Presence((alone,), np.full(1, 0.5))
    for share, status in ((0.7, "unknown"), (1.0, "none")):
        half = replace(alone, fit=replace(alone.fit, residual=share * noise))
        nominal = replace(evidence.nominal, residual=noise)
        own = replace(evidence, nominal=nominal)
        assert decide(own, half, [half], [half], weighed).status == status


@pytest.mark.parametrize(("weight", "status"), [(0.02, "named"), (0.1, "ambiguous")])
def test_a_rival_of_the_same_class_counts_by_its_own_weight(weight, status):
    """Other classes are beaten, so that only the same class is compared with the name."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    right = candidate(1.001, "dead_zone", "input_saturation")
    akin = candidate(1.002, "dead_zone", "output_saturation")
    beaten = candidate(4.0, "dead_zone", "sensor_lag")
    weights = np.array([0.2, weight, 0.7])
    weighed = Presence((right, akin, beaten), weights)
    found = decide(evidence, right, [right, akin, beaten], [], weighed)
    assert (found.status, found.answer) == (status, right)


@pytest.mark.parametrize(
    ("other", "weight", "status"),
    [
        ("output_saturation", 0.46, "ambiguous"),
        ("output_saturation", 0.65, "named"),
        ("sensor_lag", 0.46, "named"),
    ],
)
def test_an_effect_that_is_likelier_leads_one_of_its_family(other, weight, status):
    """It leaves more, and predicts blocks left out worse, so that it is no rival by its error."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    chosen, likelier = candidate(1.001, "input_saturation"), candidate(1.3, other)
    pool = [chosen, likelier]
    weighed = Presence((likelier, chosen), np.array([1.0 - weight, weight]))
    found = decide(evidence, chosen, pool, [chosen], weighed)
    leads = likelier if status == "ambiguous" else chosen
    assert (found.status, found.answer) == (status, leads)
    assert found.rivals == ((chosen,) if status == "ambiguous" else ())


@pytest.mark.parametrize("with_it", [0.60, 0.93])
def test_an_uncertain_answer_does_not_exclude_an_effect_that_is_certain(with_it):
    """A delay is in every likely explanation, beside a lag or beside a second mode."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    chosen = candidate(1.1, "sensor_lag")
    lag = candidate(1.001, "sensor_lag", "transport_delay")
    mode = candidate(1.002, "second_mode", "transport_delay")
    weighed = Presence((lag, mode, chosen), np.array([with_it, 0.99 - with_it, 0.01]))
    found = decide(evidence, chosen, [lag, mode, chosen], [chosen], weighed)
    names = found.answer.effects if found.answer else frozenset()
    assert found.answer is (chosen if with_it > 0.9 else found.answer)
    assert with_it > 0.9 or "transport_delay" in names


def test_a_name_that_the_evidence_is_against_is_not_given():
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    chosen = candidate(1.001, "dead_zone")
    others = candidate(1.3, "sensor_lag"), candidate(1.3, "strain_stiffening")
    pool = [chosen, *others]
    for weights, status in (([0.48, 0.47, 0.05], "ambiguous"), ([0.3, 0.2, 0.5], "named")):
        weighed = Presence((*others, chosen), np.array(weights))
        found = decide(evidence, chosen, pool, [chosen], weighed)
        assert (found.status, found.answer) == (status, chosen)


@pytest.mark.parametrize(("error", "status"), [(1.04, "ambiguous"), (1.07, "named")])
def test_another_pair_with_nearly_the_error_is_a_rival_though_its_misfit_is_larger(error, status):
    """Of single effects the misfit counts, which of a small error is much larger."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    chosen, other = (candidate(1.1 * size, "sensor_lag", name)
                     for size, name in ((1.0, "dead_zone"), (error, "second_mode")))  # fmt: skip
    alone = [candidate(8.0, name) for name in ("sensor_lag", "dead_zone", "second_mode")]
    pool = [chosen, other, *alone]
    weighed = Presence((chosen, other), np.array([0.8, 0.2]))
    found = decide(evidence, chosen, pool, [], weighed)
    assert (found.status, found.answer) == (status, chosen)
    single, rival = candidate(1.1, "dead_zone"), candidate(1.1 * error, "second_mode")
    weighed = Presence((single, rival), np.array([0.8, 0.2]))
    found = decide(evidence, single, [single, rival], [], weighed)
    assert (found.status, found.answer) == ("named", single)


@pytest.mark.parametrize("given", [True, False])
@pytest.mark.parametrize("status", list(Status))
def test_only_an_answer_is_whole_or_a_part(status, given):
    chosen = object()
    named = status in (Status.NAMED, Status.AMBIGUOUS)
    assert Decision(status, chosen, whole=given).whole is (given if named else None)
    assert Decision(status, None, whole=given).whole is None


@pytest.mark.parametrize(
    ("error", "weights", "leads"),
    [(1.19, [0.8, 0.02], True), (1.19, [0.5, 0.4], False), (1.21, [0.8, 0.02], False)],
)
def test_what_the_evidence_excludes_does_not_lead_where_another_is_closer(error, weights, leads):
    """Blocks left out, of which there may be few, had chosen it."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    pairs = (1.20, "dead_zone", "sensor_lag"), (error, "input_saturation", "second_mode")
    chosen, likely = (candidate(error, *names) for error, *names in pairs)
    alone = [candidate(8.0, name) for _, *names in pairs for name in names]
    weighed = Presence((likely, chosen), np.array(weights))
    found = decide(evidence, chosen, [chosen, likely, *alone], alone, weighed)
    assert found.status == "ambiguous"
    assert found.answer is (likely if leads else chosen)
    assert {*found.rivals, found.answer} == {chosen, likely}


def test_the_likeliest_other_explanation_is_one_rival():
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    chosen, rival = candidate(1.3, "dead_zone"), candidate(1.3, "sensor_lag")
    weighed = Presence((chosen, rival), np.array([0.5, 0.5]))
    found = decide(evidence, chosen, [chosen, rival], [chosen], weighed)
    assert (found.status, found.rivals) == ("ambiguous", (rival,))


def test_what_is_unlikely_and_has_no_rival_is_not_named():
    evidence, candidate = graded()
    chosen = candidate(1.001, "dead_zone")
    weighed = Presence((chosen,), np.array([0.05]))
    found = decide(evidence, chosen, [chosen], [chosen], weighed)
    assert (found.status, found.reason) == ("unknown", Reason.NO_EFFECT)


@pytest.mark.parametrize(
    ("weights", "status"), [([0.45, 0.45, 0.1], "named"), ([0.25, 0.25, 0.5], "ambiguous")]
)
def test_what_a_pair_shares_with_its_rivals_is_named_where_it_is_likely(weights, status):
    evidence, candidate = graded()
    alone = candidate(1.1, "dead_zone")
    pairs = [candidate(1.0, "dead_zone", name) for name in ("sensor_lag", "gain_drift")]
    other = candidate(1.4, "sensor_lag", "gain_drift")
    weighed = Presence((*pairs, other), np.array(weights))
    pool = [*pairs, alone, other]
    found = decide(evidence, pairs[0], pool, [alone], weighed)
    assert (found.status, found.answer) == (status, {"named": alone}.get(status, pairs[0]))


@pytest.mark.parametrize(("name", "named"), [("dead_zone", False), ("gain_drift", True)])
def test_a_law_that_predicts_blocks_left_out_worse_is_not_named_by_the_evidence(name, named):
    """A course in time may be extrapolated badly to them."""
    evidence, candidate = graded()
    surest = candidate(1.01, name)
    worse = SimpleNamespace(
        residual=lambda fitted, _=None: (12.0 if fitted is surest.fit else 1.0) * fitted.residual,
        rmse=lambda fitted, _=None: evidence.problem.seen_rmse(fitted.residual),
    )
    evidence = replace(evidence, rules=Rules(), held_out=worse)
    weighed = Presence((surest,), np.array([1.0]))
    found = decide(evidence, None, [surest], [], weighed)
    assert (found.answer is surest) == named


@pytest.mark.parametrize(("nominal", "named"), [(1.3, True), (1.1, False)])
def test_of_a_simulation_that_leaves_noise_nothing_is_named_by_the_evidence_alone(nominal, named):
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules(), nominal=candidate(nominal).fit)
    sure, rival = candidate(1.01, "sensor_lag"), candidate(1.05, "dead_zone")
    weighed = Presence((sure, rival), np.array([0.95, 0.05]))
    found = decide(evidence, None, [sure, rival], [], weighed)
    assert (found.answer is sure) == named


@pytest.mark.parametrize(
    ("left", "weight", "status"),
    [(1.3, 0.5, "ambiguous"), (1.3, 0.7, "named"), (1.001, 0.2, "named")],
)
def test_an_unlikely_name_is_given_only_where_it_leaves_noise(left, weight, status):
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    chosen, pair = candidate(left, "dead_zone"), candidate(1.2, "sensor_lag", "second_mode")
    weighed = Presence((pair, chosen), np.array([1.0 - weight, weight]))
    found = decide(evidence, chosen, [chosen], [chosen], weighed)
    assert (found.status, found.answer) == (status, chosen)
    assert found.rivals == ((pair,) if status == "ambiguous" else ())


@pytest.mark.parametrize(("weights", "whole"), [([0.5, 0.5, 0.0], False), ([0.3, 0.3, 0.4], True)])
def test_an_effect_is_not_all_of_the_answer_where_a_further_one_is_sure(weights, whole):
    """Whichever it is: two of them do as well."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules(room=0.06))
    alone = candidate(1.4, "dead_zone")
    pairs = [candidate(1.3, "dead_zone", name) for name in ("sensor_lag", "second_mode")]
    weighed = Presence((*pairs, alone), np.array(weights))
    pool = [*pairs, alone, candidate(6.0, "sensor_lag"), candidate(6.0, "second_mode")]
    found = decide(evidence, alone, pool, [alone], weighed)
    assert (found.status, found.answer, found.whole) == ("named", alone, whole)


def test_what_a_further_effect_surely_explains_is_not_called_noise():
    """What one effect leaves is coloured noise by every test, but a pair is much likelier."""
    evidence, candidate = graded()
    noise = lfilter([1.0], [1.0, -0.9], np.random.default_rng(8).standard_normal(1500))
    alone = candidate(3.0, "dead_zone")
    alone = replace(alone, fit=replace(alone.fit, residual=3.0 * NOISE * noise / noise.std()))
    pair = candidate(2.5, "dead_zone", "second_mode")
    for weights, reason in (([0.95, 0.05], Reason.REMAINS), ([0.5, 0.5], Reason.COLOURED)):
        weighed = Presence((pair, alone), np.array(weights))
        found = decide(evidence, alone, [alone], [alone], weighed)
        assert (found.status, found.reason) == ("named", reason)


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


def in_noise(size, *, follows=0.0):
    """Return coloured noise of so many floors beside white noise of one, (1500,).

    It ``follows`` the input of the record by so many floors.
    """
    problem, _ = hidden("dead_zone")
    rng = np.random.default_rng(12)
    slow = lfilter([1.0], [1.0, -0.95], rng.standard_normal(1500))
    white = rng.standard_normal(1500)
    u = problem.u / problem.u.std()
    return NOISE * (white + size * slow / slow.std() + follows * u)


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


def leaving(candidate, residual, *names):
    """Return a candidate that leaves a residual."""
    made = candidate(1.0, *names)
    rmse = float(np.sqrt(np.mean(residual**2)))
    return replace(made, fit=replace(made.fit, residual=residual), rmse=rmse, error=rmse)


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


@pytest.mark.parametrize(
    ("residual", "before", "offered"),
    [
        (in_noise(2.5), 9.0, {"baseline_drift"}),
        (in_noise(2.5), 3.4, {"baseline_drift", "dead_zone"}),
        (in_noise(2.5, follows=2.0), 9.0, {"baseline_drift", "dead_zone"}),
    ],
)
def test_beside_coloured_noise_courses_in_time_alone_are_offered(residual, before, offered):
    evidence, candidate = graded()
    first = leaving(candidate, residual, "sensor_lag")
    effects = [catalogue()[name] for name in ("baseline_drift", "dead_zone")]
    searched = []

    class Told(Search):
        def _round(self, bases, effects):
            searched.append({effect.name for effect in effects})
            return Round(bases[0])

    nominal = candidate(before).fit
    search = Told(evidence.problem, [nominal], effects, Budget(), Rules(), 1, evidence.blocks)
    search._extended([first])
    assert searched == [offered]


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


@pytest.mark.parametrize(
    ("weight", "left", "rival", "status", "leads"),
    [
        (0.95, 1.01, 1.1, "named", True),
        (0.8, 1.01, 1.1, "ambiguous", False),
        (0.95, 3.0, 1.1, "ambiguous", False),
        (0.95, 1.01, 1.0, "ambiguous", False),  # others fit as well
        (0.95, 1.001, 1.0012, "ambiguous", True),  # nor by much worse
        (0.95, 1.13, 1.18, "named", True),  # a fifth more misfit, though the errors are close
    ],
)
def test_what_the_evidence_alone_leaves_is_named_whatever_few_blocks_predict(
    weight, left, rival, status, leads
):
    evidence, candidate = graded()
    sure = candidate(left, "sensor_lag")
    others = [candidate(rival, name) for name in ("dead_zone", "strain_stiffening")]
    predicted = {sure.fit: 2.0}
    held_out = SimpleNamespace(
        residual=evidence.held_out.residual,
        rmse=lambda fitted, _=None: predicted.get(fitted, 1.0) * evidence.held_out.rmse(fitted),
    )
    weighed = Presence((sure, *others), np.array([weight, 1.0 - weight, 0.0]))
    found = decide(
        replace(evidence, held_out=held_out), others[0], [*others, sure], others[:1],
        weighed,
    )  # fmt: skip
    assert found.status == status
    assert found.answer is (sure if leads else others[0])


@pytest.mark.parametrize(("beside", "status"), [(0.7, "named"), (0.5, "ambiguous")])
def test_larger_sets_that_are_not_accepted_do_not_take_the_weight_of_a_name(beside, status):
    """Few blocks do not tell it from its rival, but all that hold it are certain together."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    alone, rival = candidate(1.4, "sensor_lag"), candidate(2.2, "dead_zone")
    pair = candidate(1.38, "sensor_lag", "gain_drift")
    predicted = Predicted(
        evidence.problem, lambda each: (2.0 if each is alone.fit else 1.0) * each.residual
    )
    weighed = Presence((pair, alone, rival), np.array([beside, 0.28, 0.72 - beside]))
    evidence = replace(evidence, held_out=predicted)
    found = decide(evidence, alone, [pair, alone, rival], [alone], weighed)
    assert found.status == status
    assert found.answer is alone


def named_against(evidence, sure, rival, predicted=None, alone=()):
    """The name given where one has nearly all the weight; ``predicted`` are held-out residuals.

    ``alone`` are the effects of a pair by themselves.
    """
    predicted = predicted or {}
    held_out = Predicted(evidence.problem, lambda fitted: predicted.get(fitted, fitted.residual))
    weighed = Presence((sure, rival), np.array([0.95, 0.05]))
    found = decide(
        replace(evidence, held_out=held_out), rival, [rival, sure, *alone], [rival], weighed
    )  # fmt: skip
    return found.answer if found.status == "named" else None


@pytest.mark.parametrize(
    ("names", "factor", "named"),
    [
        (("sensor_lag",), 2.0, True),
        (("sensor_lag",), 1.05, False),  # the rival predicts nearly as well
        (("sensor_lag", "slew_limit"), 1.05, True),
        (("sensor_lag", "slew_limit"), 0.99, False),  # pairs bend to what they see
    ],
)
def test_a_rival_that_fits_as_well_is_none_if_it_predicts_much_worse(names, factor, named):
    evidence, candidate = graded()
    sure, rival = candidate(1.01, *names), candidate(1.01, "dead_zone", *names[1:])
    predicted = {rival.fit: factor * rival.fit.residual}
    alone = [candidate(6.0, name) for name in names if len(names) > 1]
    assert (named_against(evidence, sure, rival, predicted, alone) is sure) == named


@pytest.mark.parametrize(
    ("error", "predicted", "named"),
    [(1.18, 1.12, False), (1.25, 1.12, True), (1.18, 1.14, True)],
)
def test_a_pair_is_named_beside_another_one_with_nearly_its_error_that_predicts_worse(
    error, predicted, named
):
    evidence, candidate = graded()
    sure = candidate(1.13, "dead_zone", "sensor_lag")
    rival = candidate(error, "dead_zone", "gain_drift")
    held_out = {rival.fit: candidate(predicted).fit.residual}
    alone = [candidate(6.0, name) for name in sure.names]
    assert (named_against(evidence, sure, rival, held_out, alone) is sure) == named


@pytest.mark.parametrize(("error", "named"), [(1.18, False), (1.25, True)])
def test_a_pair_is_not_named_beside_one_of_other_families_with_nearly_its_error(error, named):
    """What lags behind the input is a loss and a curve, or a drift and a hum, as well."""
    evidence, candidate = graded()
    sure = candidate(1.13, "charge_leakage", "strain_stiffening")
    rival = candidate(error, "gain_drift", "periodic_disturbance")
    held_out = {rival.fit: candidate(2.0).fit.residual}
    alone = [candidate(6.0, name) for name in sure.names]
    assert (named_against(evidence, sure, rival, held_out, alone) is sure) == named


def test_a_certain_part_must_leave_less_than_other_families_and_not_than_its_own():
    evidence, candidate = graded()
    pair = candidate(1.9, "sensor_lag", "dead_zone")
    alone = candidate(2.0, "sensor_lag")
    weighed = Presence((pair, alone), np.array([0.5, 0.5]))
    for kin, other, named in ((2.0, 4.0, True), (4.0, 2.0, False)):
        pool = [pair, alone, candidate(kin, "electrode_lag"), candidate(other, "gain_drift")]
        found = decide(evidence, pair, pool, [alone], weighed)
        assert (found.status == "named") == named
        assert not named or found.answer is alone


@pytest.mark.parametrize(("rival", "named"), [(1.6, False), (2.2, True)])
def test_no_part_is_certain_that_another_of_its_family_replaces_with_less_left(rival, named):
    evidence, candidate = graded()
    pair, alone = candidate(1.9, "sensor_lag", "dead_zone"), candidate(2.0, "sensor_lag")
    pool = [
        pair,
        alone,
        candidate(rival, "electrode_lag", "gain_drift"),
        candidate(4.0, "dead_zone"),
    ]
    weighed = Presence((pair, alone), np.array([0.5, 0.5]))
    found = decide(evidence, pair, pool, [alone], weighed)
    assert (found.answer is alone) == named


@pytest.mark.parametrize(("left", "names"), [(3.6, 2), (2.0, 1)])
def test_a_second_effect_of_the_same_family_must_leave_less_than_the_first_one(left, names):
    evidence, candidate = graded()
    alone = candidate(left, "sensor_lag")
    pair = candidate(1.8, "sensor_lag", "electrode_lag")
    pool = [pair, alone, candidate(6.0, "dead_zone")]
    found = decide(evidence, pair, pool, [alone], Presence((pair,), np.ones(1)))
    assert found.status == "named"
    assert found.answer.names == pair.names[:names]


@pytest.mark.parametrize(("held_out", "names", "whole"), [(3.5, 1, False), (2.0, 2, True)])
def test_a_second_effect_must_remove_half_of_what_is_left_where_it_was_not_fitted(
    held_out, names, whole
):
    """Both leave noise alone where they were fitted."""
    evidence, candidate = graded()
    alone, pair = candidate(4.0, "dead_zone"), candidate(1.1, "dead_zone", "sensor_lag")
    predicted = {pair.fit: candidate(held_out).fit.residual}
    of_blocks = Predicted(evidence.problem, lambda fitted: predicted.get(fitted, fitted.residual))
    evidence = replace(evidence, held_out=of_blocks)
    pool = [pair, alone, candidate(6.0, "sensor_lag")]
    weighed = Presence((pair,), np.ones(1))
    found = decide(evidence, pair, pool, [alone], weighed)
    assert (found.status, found.answer.names) == ("named", pair.names[:names])
    assert found.whole is whole


@pytest.mark.parametrize(("left", "named"), [(1.2, "part"), (3.0, "pair")])
def test_of_a_pair_that_the_evidence_leaves_a_part_must_leave_room(left, named):
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    part, pair = candidate(left, "dead_zone"), candidate(1.0, "dead_zone", "sensor_lag")
    weighed = Presence((pair, part), np.array([0.95, 0.05]))
    found = decide(evidence, part, [pair, part], [part], weighed)
    assert (found.status, found.answer) == ("named", {"part": part, "pair": pair}[named])


@pytest.mark.parametrize(
    ("name", "left", "named"),
    [
        ("gain_drift", 1.02, True),
        ("gain_drift", 1.2, True),
        ("gain_drift", 1.6, False),
        ("baseline_drift", 1.02, False),
    ],
)
def test_what_leaves_no_room_need_not_predict_unless_readings_drift(name, left, named):
    """A course that few blocks show is extrapolated badly, and readings drift of themselves."""
    evidence, candidate = graded()
    evidence = replace(evidence, rules=Rules())
    course, rival = candidate(left, name), candidate(1.8, "dead_zone")
    predicted = {course.fit: 0.9 * evidence.nominal.residual}
    assert (named_against(evidence, course, rival, predicted) is course) == named


@pytest.mark.parametrize(
    ("effect", "values", "at_bounds"),
    [
        ("cyclic_softening", {"softening": 0.2}, ()),  # and none by the stroke
        ("cyclic_softening", {"softening": 0.9}, ("cyclic_softening.softening",)),
        ("transport_delay", {"delay": 0.0}, ("transport_delay.delay",)),  # all of the law
    ],
)
def test_a_part_that_a_law_does_without_is_no_parameter_at_its_bound(effect, values, at_bounds):
    problem, extended = hidden()
    told = measured_scales(extended, extended.layout.prior_means, problem)
    attached = extended.attach(catalogue()[effect], told)
    found = attached.layout.prior_means
    for name, value in values.items():
        found[attached.layout.names.index(f"{effect}.{name}")] = value
    fitted = Fit(attached, attached.layout.coordinates(found), problem.y, problem.y[:, None], 0.0)
    assert Candidate(fitted, 1.0, 1.0, 1.0).at_bounds == at_bounds


def test_a_leading_fit_whose_simulation_was_led_astray_is_made_again():
    problem, extended = hidden("dead_zone")
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    told = measured_scales(extended, nominal.values, problem)
    attached = extended.attach(catalogue()["dead_zone"], told)
    start = dict(
        zip((p.name for p in catalogue()["dead_zone"].parameters(told)),
            catalogue()["dead_zone"].starts(told)[1], strict=True)
    )  # fmt: skip
    law = attached.attached[-1].started(tuple((start | PRESENT["dead_zone"]).values()))
    astray = extended.layout.values(np.full(extended.layout.free.size, 1.5))
    stuck = judged(problem, at(problem, attached, attached.layout.coordinates(np.r_[astray, law])))

    class Stuck(Search):
        @property
        def singles(self):
            return Round(nominal, (stuck,))

    def best(restarted):
        budget = Budget(effects=1, restarted=restarted)
        return Stuck(problem, [nominal], [], budget, Rules()).rounds()[0].candidates[0]

    assert best(restarted=0) is stuck
    assert stuck.rmse > 2 * NOISE
    assert best(restarted=1).rmse < 1.1 * NOISE


@pytest.mark.slow
def test_pairs_are_also_built_on_an_effect_that_acts_elsewhere_than_the_leading_ones():
    problem, extended = hidden("dead_zone", "sensor_lag")
    names = "dead_zone", "input_saturation", "sensor_lag"
    offered = [catalogue()[name] for name in names]
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    _, *pairs = Search(problem, [nominal], offered, Budget(beam=1, exchanges=0), Rules()).rounds()
    ports = [a.effect.port for each in pairs for a in each.before.extended.attached]
    assert sorted(ports) == [Port.INPUT, Port.OUTPUT]


@pytest.mark.parametrize(("room", "tried"), [(0.0, True), (0.9, False)])
def test_pairs_are_tried_where_enough_of_the_gap_is_left(room, tried):
    problem, extended = hidden("dead_zone", "sensor_lag")
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [catalogue()["sensor_lag"]]
    budget = Budget(starts=1, shakes=0, exchanges=0, restarted=0, room=room)
    _, *pairs = Search(problem, [nominal], offered, budget, Rules()).rounds()
    assert bool(pairs) == tried


@pytest.mark.slow
def test_fewer_further_effects_are_fitted_to_the_end_than_first_ones():
    problem, extended = hidden("dead_zone")
    base = fit(problem, extended, np.zeros(extended.layout.free.size))
    names = "dead_zone", "input_saturation", "strain_stiffening", "sensor_lag", "electrode_lag"
    budget = Budget(finished=3, starts=2, shakes=0, near=100.0)
    for finished in (3, 2):
        found = extend_by_each(problem, [base], [catalogue()[n] for n in names], budget, 1)
        assert sum(c.finished for c in found.candidates) == finished
        base = found.candidates[0].fit


@pytest.mark.parametrize(
    ("names", "above", "refits"),
    [
        (("dead_zone",), 1.0, 1 + 3),
        (("dead_zone",), 200.0, 1),  # little is left already
        (("dead_zone", "sensor_lag"), 1.0, 1),  # fitted from enough starts
    ],
)
def test_the_best_single_effects_are_fitted_from_perturbed_starts_too(
    monkeypatch, names, above, refits
):
    problem, extended = hidden("dead_zone")
    told = measured_scales(extended, extended.layout.prior_means, problem)
    for name in names:
        extended = extended.attach(catalogue()[name], told)
    start = at(problem, extended, np.zeros(extended.layout.free.size))
    starts = []

    def again(problem, fitted, budget):
        starts.append(fitted.coordinates)
        return fitted

    monkeypatch.setattr(search_rounds, "fitted_again", again)
    search_rounds._polished(problem, start, Budget(shakes=3, shake_above=above))
    assert len(starts) == refits
    for each in starts[1:]:
        np.testing.assert_array_equal(each != start.coordinates, extended.layout.of_laws)


def tried(error, *labels):
    return SimpleNamespace(error=error, labels=labels, finished=True)


def scripted(errors, opened=True, better=True, **budget):
    """A search whose pairs have the ``errors``, one exchange after the other, and what it does."""
    extended, exchanged = [], []

    class Scripted(Search):
        @property
        def singles(self):
            found = [tried(20.0 + k, label) for k, label in enumerate("abc")]
            return SimpleNamespace(candidates=found)

        def _extended(self, candidates):
            extended.append([c.labels for c in candidates])
            return [SimpleNamespace(candidates=[tried(errors[0], "a", "c")])]

        def _open(self, grown):
            return opened

        def _better(self, grown):
            return better

        def _exchanged(self, pair):
            exchanged.append(pair.error)
            pair = tried(errors[len(exchanged)], f"x{len(exchanged)}", "c")
            return [SimpleNamespace(candidates=[pair])]

    return Scripted(None, [], [], Budget(**budget), Rules()), extended, exchanged


@pytest.mark.parametrize(
    ("errors", "expected"),
    [
        ([10.0, 8.9, 8.5, 0.0], [10.0, 8.9]),
        ([10.0, 9.0, 8.9], [10.0, 9.0]),  # a tenth less is enough for another one
        ([10.0, 8.9, 8.0, 7.0, 0.0], [10.0, 8.9, 8.0]),  # three are all
        ([10.0, 11.0, 0.0], [10.0]),
    ],
)
def test_a_pair_is_exchanged_again_while_that_lowers_its_error_by_a_tenth(errors, expected):
    search, extended, exchanged = scripted(errors, exchanges=3, exchange_gain=0.9)
    grown = search._pairs_from([tried(20.0, "a"), tried(21.0, "b")])
    assert exchanged == expected
    best = min(c.error for each in grown for c in each.candidates)
    assert best == min(errors[: len(expected) + 1])
    # The partner that the best pair has found is extended too.
    assert extended == [[("a",), ("b",)], [("c",)]]


@pytest.mark.parametrize(
    ("exchanges", "better", "also"),
    [(0, True, []), (3, True, [[("c",)]]), (3, False, [])],
)
def test_no_pair_is_exchanged_where_none_may_be_or_none_is_worth_it(exchanges, better, also):
    """But the partner of a pair that is the answer is extended: another one may be as well."""
    search, extended, exchanged = scripted([10.0], False, better, exchanges=exchanges)
    found = search._pairs_from([tried(20.0, "a")])
    assert found[0].candidates[0].error == 10.0
    assert (extended, exchanged) == ([[("a",)], *also], [])


def test_an_effect_that_was_screened_and_is_fitted_again_counts_once_as_it_was_finished(
    monkeypatch,
):
    """What was screened may even have the smaller error, with a charge for fewer steps."""

    def single(label, finished, error):
        return SimpleNamespace(labels=(label,), finished=finished, error=error)

    again = {"a": single("a", True, 2.0), "b": single("b", True, 2.5)}
    pair = SimpleNamespace(names=("a", "b"), fit=["b", "a"])
    monkeypatch.setattr("dea.discrepancy.search.search.without", lambda problem, fitted, i: (
        SimpleNamespace(stable=True, label=fitted[i])
    ))  # fmt: skip
    monkeypatch.setattr(
        "dea.discrepancy.search.search.fitted_again", lambda problem, start, budget: start.label
    )
    monkeypatch.setattr("dea.discrepancy.search.search.judged", lambda problem, label: again[label])
    screened = [single("a", False, 1.9), single("b", True, 3.0), single("c", False, 4.0)]
    search = SimpleNamespace(
        problem=None, budget=None, singles=Round(None, tuple(screened)),
        _leading=lambda rounds: [pair],
    )  # fmt: skip
    found = Search._reduced(search, [Round(None)]).candidates
    assert [(c.labels[0], c.finished, c.error) for c in found] == [
        ("a", True, 2.0), ("b", True, 2.5), ("c", False, 4.0),
    ]  # fmt: skip


def test_a_load_on_an_elastic_shaft_is_found_behind_a_drive_that_nothing_pulls_back():
    """Its own motion shows in the drive's speed, and its place is unknown."""
    shaft = replace(
        SPRING, name="shaft", output_unit="rad/s", drive="gain", output_offset_spread=0.0,
        states=(State("angle", "rad", 0.0), State("speed", "rad/s", 0.0, 0.5)),
        parameters=(
            Parameter("gain", "1/kg m^2", 50.0, 0.2, 1.0, 1e3, log=True),
            Parameter("friction", "1/s", 2.5, 0.2, 0.05, 50.0, log=True),
        ),
        derivative=_shaft, output=_speed, input_interpolation="zero",
        force_ports=(ForcePort(equation="speed", position="angle", velocity="speed"),),
    )  # fmt: skip
    interval, parts, noise = 0.005, 20, 0.03
    rng = np.random.default_rng(22)
    u = np.repeat(rng.uniform(-1, 1, 60), 25)
    turning, twist, load, y = 0.0, 0.0, 0.0, np.empty(u.size)
    for k in range(u.size):
        y[k] = turning
        for _ in range(parts):
            torque = 12.0 * twist + 0.012 * (turning - load)
            turning, twist, load = (
                turning + interval / parts * (u[k] - 0.05 * turning - torque) / 0.02,
                twist + interval / parts * (turning - load),
                load + interval / parts * (torque - 0.05 * load) / 0.015,
            )
    y += noise * rng.standard_normal(y.size)
    extended = prepared(shaft, u, interval, 1e-3)
    roles = split(u, interval, 0.1)
    problem = Problem(
        u, y, interval, roles.fit, roles.select, roles.certify, noise, 1e-3, extended.substeps
    )
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    [found] = extend_by_each(
        problem, [nominal], [catalogue()["second_mode"]], Budget(), 1
    ).candidates
    law = dict(zip(found.fit.extended.layout.names, found.fit.values, strict=True))
    assert found.rmse < 1.3 * noise < 0.3 * problem.seen_rmse(nominal.residual)
    assert law["second_mode.coupling"] == pytest.approx(0.75, rel=0.1)
    assert law["second_mode.frequency"] == pytest.approx(
        np.sqrt(12.0 / 0.015) / 2 / np.pi, rel=0.05
    )


def _shaft(x, u, p, dx):
    dx[0] = x[1]
    dx[1] = p[0] * u - p[1] * x[1]


def _speed(x, u, p):
    return x[1]


@pytest.mark.parametrize("limited", [True, False])
def test_a_gently_bent_reading_does_not_bear_the_name_of_a_limit(limited):
    """An arm that turns reads the sine of its angle; a rail ends the reading."""
    problem, extended = hidden()
    own = extended.layout.prior_means
    y = extended.simulate(own, problem.u, INTERVAL)
    noise = NOISE * np.random.default_rng(4).standard_normal(y.size)
    far = np.abs(y).max()
    bent = np.minimum(y, 0.7 * far) if limited else far / 0.8 * np.sin(0.8 * y / far)
    problem = replace(problem, y=bent + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [catalogue()[name] for name in ("output_saturation", "sensor_nonlinearity")]
    singles = extend_by_each(problem, [nominal], offered, Budget(), 1)
    [again] = unfinish_degenerate(problem, [singles], Rules(), NOISE, 1)
    finished = {c.names[0] for c in again.candidates if c.finished}
    assert ("output_saturation" in finished) == limited
    assert {c.names[0]: c.rmse < 1.2 * NOISE for c in again.candidates}["output_saturation"]


@pytest.mark.parametrize("limited", [True, False])
def test_a_gently_bent_command_does_not_bear_the_name_of_a_limit(limited):
    """Nothing else is a curve of the command, so that nothing else explains it."""
    problem, extended = hidden()
    own = extended.layout.prior_means
    peak = np.abs(problem.u).max()
    bent = np.clip(problem.u, -0.7 * peak, 0.7 * peak)
    if not limited:
        bent = problem.u * (1.0 - 0.12 * np.abs(problem.u) / peak)  # the slope falls to 0.76
    noise = NOISE * np.random.default_rng(4).standard_normal(problem.y.size)
    problem = replace(problem, y=extended.simulate(own, bent, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    singles = extend_by_each(problem, [nominal], [catalogue()["input_saturation"]], Budget(), 1)
    [again] = unfinish_degenerate(problem, [singles], Rules(), NOISE, 1)
    [found] = again.candidates
    assert found.finished is limited
    assert found.rmse < 1.2 * NOISE


def test_a_stop_beyond_the_motion_counts_as_visible():
    problem, extended = hidden()
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    told = measured_scales(extended, nominal.values, problem)
    stop = extended.attach(catalogue()["end_stop"], told)
    far = {"upper_stop": told.z_high + told.z_span, "lower_stop": told.z_low - told.z_span}
    law = [far.get(p.name, p.nominal) for p in stop.attached[-1].parameters]
    values = np.concatenate([nominal.values, law])
    found = at(problem, stop, stop.layout.coordinates(values))
    enough = Rules().detectable
    assert visibility(problem, nominal, found).size < enough
    assert most_visible(problem, nominal, found, enough).size >= enough


def test_what_leads_once_others_have_fallen_is_tested_too():
    problem, extended = hidden()
    own = extended.layout.prior_means
    bent = problem.u * (1.0 - 0.12 * np.abs(problem.u) / np.abs(problem.u).max())
    noise = NOISE * np.random.default_rng(4).standard_normal(problem.y.size)
    problem = replace(problem, y=extended.simulate(own, bent, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    singles = extend_by_each(problem, [nominal], [catalogue()["input_saturation"]], Budget(), 1)
    [found] = singles.candidates
    rules = Rules()
    further = replace(found, error=2.0 * rules.near * found.error)
    singles = replace(singles, candidates=(found, further))
    [again] = unfinish_degenerate(problem, [singles], rules, NOISE, 1)
    assert [c.finished for c in again.candidates] == [False, False]


@pytest.mark.parametrize(("partner", "needed"), [("sensor_lag", True), ("coulomb_friction", False)])
def test_an_effect_of_a_pair_is_needed_only_if_the_other_alone_leaves_much(partner, needed):
    """The other one was never fitted to the end by itself."""
    problem, extended = hidden("dead_zone", *(("sensor_lag",) if needed else ()))
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    told = measured_scales(extended, nominal.values, problem)
    both = extended
    values = nominal.values
    for name in ("dead_zone", partner):
        both = both.attach(catalogue()[name], told)
        own = both.attached[-1]
        best = min(
            (own.started(start) for start in own.effect.starts(told)),
            key=lambda law: problem.seen_rmse(problem.residual(both, np.r_[values, law])),
        )
        start = both.layout.coordinates(np.concatenate([values, best]))
        # As in the search, what shapes a law waits until its place and size are found.
        placed = fit(problem, both, start, columns=Columns(held=both.layout.shapes))
        values = fit(problem, both, placed.coordinates).values
    chosen = judged(problem, fit(problem, both, both.layout.coordinates(values)))
    assert chosen.rmse < 1.1 * NOISE
    evidence = Evidence(
        problem, nominal, HeldOut(problem), problem.blocks(100), NOISE, 0.0, Rules(),
        np.random.default_rng(8),
    )  # fmt: skip
    assert each_adds(evidence, chosen, [chosen]) == needed
