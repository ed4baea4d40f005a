"""Which sets of effects are tried."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_resonator import (
    INTERVAL,
    NOISE,
    PRESENT,
    SPRING,
    graded,
    hidden,
    in_noise,
    leaving,
)

from dea.discrepancy.budget import Budget
from dea.discrepancy.evidence.identifiability import most_visible, visibility
from dea.discrepancy.fitting.candidates import Candidate, judged
from dea.discrepancy.fitting.fit import Fit, at, fit
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.split import split
from dea.discrepancy.rules import Rules
from dea.discrepancy.search import rounds as search_rounds
from dea.discrepancy.search import screening
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


def test_no_more_effects_are_combined_than_the_budget_allows():
    problem, extended = hidden("dead_zone", "sensor_lag")
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [catalogue()[name] for name in ("dead_zone", "sensor_lag")]
    rounds = Search(problem, [nominal], offered, Budget(effects=1, restarted=0), Rules()).rounds()
    assert {len(c.names) for each in rounds for c in each.candidates} == {1}


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
