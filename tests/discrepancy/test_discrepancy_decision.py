"""What is named: answers, their parts, and their rivals."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_resonator import NOISE, Predicted, graded, hidden
from scipy.signal import lfilter

from dea.discrepancy.decision import (
    Decision,
    Reason,
    Status,
    best_extension,
    decide,
    sure_alone,
)
from dea.discrepancy.decision.parts import each_adds
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.held_out import HeldOut
from dea.discrepancy.evidence.presence import Presence
from dea.discrepancy.fitting.candidates import Candidate, judged
from dea.discrepancy.fitting.fit import Columns, Fit, at, fit
from dea.discrepancy.rules import Rules
from dea.discrepancy.search.rounds import Round
from dea.simulation import (
    catalogue,
    measured_scales,
)


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


@pytest.mark.parametrize(
    ("course", "left", "adds"),
    [
        ("gain_drift", 1.2, True),
        ("gain_drift", 1.4, False),
        ("baseline_drift", 1.2, False),
        ("sensor_lag", 1.2, False),
    ],
)
def test_beside_a_course_in_time_an_effect_may_add_where_it_was_fitted(course, left, adds):
    """Blocks left out show the error of the course alone: those of both are predicted alike."""
    evidence, candidate = graded()
    alone, pair = candidate(4.0, course), candidate(left, "dead_zone", course)
    predicted = Predicted(evidence.problem, lambda _: candidate(5.0).fit.residual)
    evidence = replace(evidence, held_out=predicted)
    assert each_adds(evidence, pair, [pair, alone, candidate(6.0, "dead_zone")]) == adds


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
