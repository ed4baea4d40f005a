"""Clauses of the verdict's sentence, and that they agree with each other."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dea.discrepancy.decision import Decision, Reason, Status
from dea.discrepancy.evidence.certificate import Certificate, Certified
from dea.discrepancy.evidence.localisation import Band, Concentration, Localisation
from dea.discrepancy.evidence.model_error import ModelError
from dea.discrepancy.evidence.modulation import ModulatedWave
from dea.discrepancy.evidence.presence import Share
from dea.discrepancy.evidence.residual_model import ResidualModel
from dea.discrepancy.evidence.unknown_force import UnknownForce
from dea.discrepancy.problem.split import Split
from dea.discrepancy.report.lags import common_lag
from dea.discrepancy.report.remarks import remainder, remarks
from dea.discrepancy.report.sentence import (
    equation_sentence,
    label_in_words,
    law_too_poor,
    rivals_told,
    verdict_sentence,
)
from dea.discrepancy.report.verdict import Bend, Change, Estimate, NamedEffect
from dea.discrepancy.rules import Rules
from dea.simulation import Input, Parameter, catalogue

BAND = Band(0.5, 1.0, 0.4)
BEFORE = (
    "the residual of 0.3 mm (RMS) is concentrated nowhere; 40 % of its energy lies between 0.5 and "
    "1 Hz"
)
AFTER = BEFORE.replace("0.3", "0.02")
NEAR = f"near the simulation's priors {BEFORE}"
NOISE = "noise floor 0.01 mm"
NAMES = "stiffness", "gain", "timing_offset"
SHARE = Share(0.724, 0.63, 0.79)
NO_EQUATION = ResidualModel(1.0, "0", 0.0)
EQUATION = ResidualModel(0.5, "0.3 u(t-1)", 0.4)


SMOOTH = np.sin(np.arange(300.0))


def concentrated(rms):
    return Localisation(None, None, BAND, rms, "mm")


def candidate(*names, at_bounds=(), fit=None):
    fit = fit or SimpleNamespace(extended=extension(*names))
    return SimpleNamespace(names=names, effects={*names}, at_bounds=at_bounds, fit=fit)


def attach(label):
    """An effect as it is attached, at the input that its label names."""
    name, _, at = label.partition("@")
    return SimpleNamespace(effect=catalogue()[name], at=Input(at, "V") if at else None)


def extension(*names):
    """An extended simulation with two parameters of its own, which are fitted, and effects."""
    return SimpleNamespace(
        attached=[attach(name) for name in names],
        places=SimpleNamespace(
            label=lambda attached: attached.effect.name, input_of=lambda attached: attached.at
        ),
        simulation=SimpleNamespace(
            parameters=[Parameter(name, "1", 1.0, 0.1) for name in NAMES[:2]], accuracy=0.0
        ),
        layout=SimpleNamespace(
            names=NAMES,
            free=np.arange(3),
            bounds=(np.full(3, -3.0), np.full(3, 3.0)),
            effect_slices=[],
        ),
        timing_spread=0.008,
    )


NOISE_REMAINS = " What remains, 5 noise floors, looks like coloured noise."


def found(
    status, *names, reason=None, whole=True, rivals=(), at_bounds=(), block=(0.2, 0.011),
    white=0.01, left=0.0, accuracy=0.0, coloured=0.0, coordinates=(0.0, 0.0, 0.0), share=SHARE,
    effects=None, families=None, equation=NO_EQUATION, force=None, modulated=None, pool=(),
    apart=3.0,
    slowest=9.0, closest=1, records=1, residual=SMOOTH, decimation=1, gap=0.3, seen=0.011,
    timing_deviation=0.05, weighed=(),
):  # fmt: skip
    """A diagnosis as far as its sentence needs one, at 50 Hz."""
    extended = extension(*names)
    extended.simulation.accuracy = accuracy
    fit = SimpleNamespace(
        extended=extended,
        coordinates=np.array(coordinates),
        residual=residual,
    )
    chosen = candidate(*names, at_bounds=at_bounds, fit=fit) if names else None
    rivals = tuple(candidate(*each) for each in rivals)
    return SimpleNamespace(
        decision=Decision(status, chosen, rivals, reason, whole),
        certificate=Certificate(Certified(*block, 100), {}),
        unexplained=equation,
        force=force,
        modulated=modulated,
        pool=pool,
        where=SimpleNamespace(before=concentrated(0.3), after=concentrated(0.02)),
        nominal=fit,
        extended=fit,
        final=fit,
        uncertainty=SimpleNamespace(deviation=np.array([0.3, 0.3, timing_deviation])),
        problem=SimpleNamespace(
            recorded_interval=0.02,
            interval=0.02,
            lengths=(4,) * records,
            seen=np.ones(4, bool),
            seen_rmse=lambda residual: seen,
            known=np.ones(residual.size, bool),
            decimation=decimation,
        ),
        split=Split(*3 * [np.ones(4, bool)], 1, apart, slowest, closest),
        above_white=gap,
        noise_floor=white,
        floor=float(np.hypot(white, max(accuracy, coloured))),
        stated_floor=float(np.hypot(white, accuracy)),
        coloured_level=coloured,
        error=ModelError(white, left, left, 1.0),
        share=share,
        presence=SimpleNamespace(
            effects=effects or {},
            families=families or {},
            candidates=[candidate(*each) for each in weighed],
        ),
        inputs=(Input("input", "V"),),
        units=("V", "mm"),
        rules=Rules(),
    )


def named(name="dead_zone", unit="V"):
    width, slope = Estimate(0.4, unit, 0.3, 0.5, 0.4), Estimate(0.01, "1", -0.01, 0.03, 0.0)
    told = {"slope": slope, "threshold": width}
    return NamedEffect(name, "", "", told, 0.2, 0.1, (0.7, 0.6, 0.8), quoted=("threshold",))


def sentence(diagnosis):
    effects = [named(each.effect.name) for each in diagnosis.extended.extended.attached]
    return verdict_sentence(diagnosis, effects, remarks(diagnosis))


PROOF = f"the error on the certified samples falls from 0.2 to 0.011 mm, {NOISE}"
ZONE = "`dead_zone` (threshold 0.4 ± 0.1 V)"
REMOVES = f"{ZONE} removes 72 % (63 to 79 %) of the gap"
FIRST = "The first explanation removes 72 % (63 to 79 %) of the gap"


@pytest.mark.parametrize(
    ("equation", "explained", "text"),
    [
        ("0", 0.0, ""),
        (
            "0.3 u(t-1)^2",
            0.42,
            " The best equation for the residual of the simulation alone (explains 42 %): "
            "0.3 u(t-1)^2.",
        ),
    ],
)
def test_an_equation_that_explains_nothing_is_left_out(equation, explained, text):
    assert equation_sentence(ResidualModel(0.5, equation, explained)) == text


def test_a_name_leads_with_its_share_and_its_proof():
    text = sentence(found(Status.NAMED, "dead_zone"))
    assert text == f"{REMOVES}: {PROOF}. Without it, {NEAR}."


def test_no_name_removes_less_than_nothing():
    """A course in time needs no share, since blocks left out extrapolate it."""
    text = sentence(found(Status.NAMED, "dead_zone", share=Share(-0.05, -0.3, 0.1)))
    assert text.startswith(f"{ZONE} removes none of the gap on blocks left out: {PROOF}.")


def test_two_names_are_spoken_of_as_two():
    text = sentence(found(Status.NAMED, "dead_zone", "sensor_lag", block=(0.2, 0.02)))
    assert text == (
        f"Probably {ZONE} and `sensor_lag` (threshold 0.4 ± 0.1 V) remove 72 % (63 to 79 %) of the "
        f"gap: the error on the certified samples falls from 0.2 to 0.02 mm, {NOISE}. "
        f"Their laws are too poor here: 2 noise floors remain. Without them, {NEAR}."
    )


@pytest.mark.parametrize(
    ("after", "accuracy", "coloured", "reason", "clause"),
    [
        (0.013, 0.0, 0.0, None, ""),
        (0.0131, 0.0, 0.0, None, " Its law is too poor here: 1.3 noise floors remain."),
        (0.05, 0.0, 0.0, None, " Its law is too poor here: 5 noise floors remain."),
        (0.05, 0.04, 0.0, None, ""),  # which is said to be accurate enough
        (0.05, 0.0, 0.0, Reason.COLOURED, NOISE_REMAINS),
        (0.05, 0.0, 0.05, Reason.COLOURED, NOISE_REMAINS),
        (0.05, 0.05, 0.05, Reason.COLOURED, ""),
        (0.05, 0.0, 0.02, None, " Its law is too poor here: 5 noise floors remain."),
        (0.012, 0.0, 0.0, Reason.COLOURED, ""),
    ],
)
def test_a_law_is_too_poor_where_more_remains_than_of_a_complete_simulation(
    after, accuracy, coloured, reason, clause
):
    levels = {"accuracy": accuracy, "coloured": coloured}
    text = sentence(found(Status.NAMED, "dead_zone", block=(0.2, after), reason=reason, **levels))
    probably = "Probably " * ("poor" in clause)
    assert text == (
        f"{probably}{REMOVES}: the error on the certified samples falls from 0.2 to {after:.3g} mm,"
        f" {NOISE}."
        f"{clause} Without it, {NEAR}."
    )


@pytest.mark.parametrize(
    ("status", "change", "poor"),
    [
        (Status.NAMED, {}, True),
        (Status.NAMED, {"block": (0.2, 0.013)}, False),
        (Status.NAMED, {"reason": Reason.COLOURED}, False),
        (Status.NAMED, {"reason": Reason.REMAINS, "whole": False}, False),  # that is said already
        (Status.AMBIGUOUS, {"rivals": [("sensor_lag",)]}, False),
        (Status.UNKNOWN, {}, False),
    ],
)
def test_only_a_law_of_the_whole_answer_is_called_too_poor(status, change, poor):
    assert law_too_poor(found(status, "dead_zone", **{"block": (0.2, 0.05)} | change)) is poor


def test_a_rival_of_the_class_that_would_do_as_well_is_told():
    rivals = [("input_saturation",), ("sensor_lag", "end_stop@left")]
    present = {"input_saturation": 0.1, "sensor_lag": 1.0, "end_stop@left": 0.2}
    text = sentence(found(Status.NAMED, "dead_zone", rivals=rivals, effects=present))
    doubt = (
        "In this record input_saturation or sensor_lag+end_stop at left of its class would do as "
        "well."
    )
    assert text == f"{REMOVES}: {PROOF}. {doubt} Without it, {NEAR}."


def lagging(name, time):
    """A lag that is named, of a time."""
    told = Estimate(time, "s", 0.9 * time, 1.1 * time, 0.1)
    defining = catalogue()[name].defining
    return NamedEffect(
        name, "", "", {defining: told}, 0.2, 0.1, (0.7, 0.6, 0.8), quoted=(defining,)
    )


def fitted(*names, time):
    """A candidate of which the last effect is a lag of a time."""
    extended = extension(*names)
    *_, lag = extended.attached
    lag.parameters = [Parameter("damping", "1", 1.0, 0.1)]
    lag.parameters.append(Parameter(lag.effect.defining, "s", 0.1, 0.1))
    extended.layout.effect_slices = [slice(1, 3)] * len(names)
    fit = SimpleNamespace(extended=extended, values=np.array([9.0, 1.5, time]))
    return candidate(*names, fit=fit)


def test_explanations_that_are_all_a_lag_are_told_as_one_with_its_places():
    rivals = [fitted("sensor_lag", time=0.0232), fitted("transport_delay", time=0.0229)]
    unsure = found(Status.AMBIGUOUS, "electrode_lag", reason=Reason.RIVAL)
    unsure.decision = replace(unsure.decision, rivals=tuple(rivals))
    assert verdict_sentence(unsure, [lagging("electrode_lag", 0.0231)]).startswith(
        "It is `electrode_lag` (time constant 0.0231 ± 0.0023 s), or sensor_lag or transport_delay."
        f" Each holds a lag of 23 ms, of the input or of the sensor. {FIRST}: "
    )
    sure = found(
        Status.NAMED, "electrode_lag", effects={"sensor_lag": 0.4, "transport_delay": 0.01}
    )
    sure.decision = replace(sure.decision, rivals=tuple(rivals))
    assert (
        "In this record sensor_lag of its class would do as well: a lag of 23 ms, of the input or "
        "of the sensor. Without it, "
    ) in verdict_sentence(sure, [lagging("electrode_lag", 0.0231)])


@pytest.mark.parametrize(
    ("own", "rival", "told"),
    [
        (("sensor_lag", 2.0), fitted("electrode_lag@left_wall", time=1.5),
         "a lag of 1.5 to 2 s, of the sensor or of the input left wall"),
        (("transport_delay", 0.02), fitted("electrode_lag", time=0.02),
         "a lag of 20 ms, of the input"),
        (("sensor_lag", 0.02), candidate("dead_zone"), ""),
        (("sensor_lag", 0.02), candidate("dead_zone", "electrode_lag"), ""),
        (("dead_zone", 0.02), fitted("electrode_lag", time=0.02), ""),
    ],
)  # fmt: skip
def test_only_lags_are_told_as_one(own, rival, told):
    assert common_lag(candidate(own[0]), [lagging(*own)], [rival]) == told


def test_a_lag_beside_an_effect_that_all_explanations_hold_is_told():
    answer, rival = candidate("dead_zone", "sensor_lag"), fitted("dead_zone", "slew_limit", time=1)
    effects = [named(), lagging("sensor_lag", 0.02)]
    assert common_lag(answer, effects, [fitted("dead_zone", "electrode_lag", time=0.02)]) == (
        "a lag of 20 ms, of the sensor or of the input"
    )
    rival.fit.extended.attached[1].parameters[1] = Parameter("rate", "V/s", 1.0, 0.1)
    assert common_lag(answer, effects, [rival]) == ""


def test_a_rival_that_the_evidence_excludes_is_not_said_to_do_as_well():
    """Of two effects one may be excluded; of an ambiguous answer no rival is."""
    rivals, present = (
        [("input_saturation", "end_stop")],
        {"end_stop": 1.0, "input_saturation": 0.09},
    )
    sure = found(Status.NAMED, "dead_zone", rivals=rivals, effects=present)
    assert sentence(sure) == f"{REMOVES}: {PROOF}. Without it, {NEAR}."
    assert rivals_told(sure) == []
    unsure = found(Status.AMBIGUOUS, "dead_zone", rivals=rivals, effects=present)
    assert f"It is {ZONE}, or input_saturation+end_stop. " in sentence(unsure)


@pytest.mark.parametrize(
    ("families", "hint"),
    [
        ({"lag": 0.7, "slow change": 0.6}, " (lag is likely)"),
        ({"threshold": 0.9, "slow change": 0.6}, " (slow change is likely)"),  # one is named
        ({"slow change": 0.59}, ""),
    ],
)
def test_a_part_is_certain_and_not_said_to_be_all(families, hint):
    part = found(Status.NAMED, "dead_zone", reason=Reason.REMAINS, whole=False, families=families)
    assert sentence(part) == (
        f"Certain part of the answer: {REMOVES}; {PROOF}. "
        f"What remains is not named{hint}: {AFTER}. "
        f"Without it, {NEAR}."
    )


@pytest.mark.parametrize(
    ("block", "change"),
    [
        ((0.2, 0.011), "falls from 0.2 to 0.011 mm"),
        ((0.0100, 0.0103), "is 0.01 mm before and 0.0103 mm after"),
        ((0.01001, 0.01), "is 0.01 mm before and 0.01 mm after"),
    ],
)
def test_an_error_falls_only_where_the_numbers_shown_do(block, change):
    text = sentence(found(Status.NAMED, "dead_zone", block=block))
    assert f"the error on the certified samples {change}, {NOISE}." in text


def test_of_rivals_none_leads_alone():
    text = sentence(
        found(Status.AMBIGUOUS, "dead_zone", rivals=[("sensor_lag",)], reason=Reason.RIVAL)
    )
    assert text == (
        f"It is {ZONE}, or sensor_lag. {FIRST}: {PROOF}. Without it, {NEAR}. "
        "`make resolve` designs the record that decides."
    )
    of_two = found(Status.AMBIGUOUS, "dead_zone", rivals=[("sensor_lag",)], reason=Reason.RIVAL)
    of_two.inputs *= 2
    assert sentence(of_two).endswith("A further record that moves each input by itself may decide.")


@pytest.mark.parametrize("reason", [Reason.NOISE, Reason.ACCURATE, Reason.IRREDUCIBLE])
def test_nothing_is_missing_for_a_reason(reason):
    text = sentence(found(Status.NONE, reason=reason, block=(0.011, 0.011), share=None))
    assert text == (
        f"Nothing is missing that this record could show: {reason} (error 0.011 mm, {NOISE})."
    )


@pytest.mark.parametrize(
    ("error", "accuracy", "coloured", "large"),
    [
        (0.0151, 0.0, 0.0, True),
        (0.0151, 0.0, 0.011, True),
        (0.0149, 0.0, 0.0, False),
        (0.0151, 0.01, 0.0, False),
    ],
)
def test_coloured_noise_that_is_large_is_told_first(error, accuracy, coloured, large):
    """Then something may well be missing that looks like noise."""
    levels = {"accuracy": accuracy, "coloured": coloured}
    text = sentence(found(Status.NONE, reason=Reason.COLOURED, block=(error, error), **levels))
    numbers = f"(error {error:.3g} mm, {NOISE})."
    if large:
        assert text == (
            f"Nothing is named, but 1.5 noise floors remain: {Reason.COLOURED}, nor anything else "
            f"that was tested {numbers}"
        )
    else:
        assert text.startswith("Nothing is missing that this record could show: ")
        assert text.endswith(f"{Reason.COLOURED} {numbers}")


@pytest.mark.parametrize(
    "reason",
    [
        Reason.UNEXPLAINED,
        Reason.NO_EFFECT,
        Reason.CONTRADICTED,
        Reason.OF_ONE_RECORD,
        Reason.CONTRADICTED_ELSEWHERE,
    ],
)
def test_what_is_unknown_is_described(reason):
    text = sentence(
        found(
            Status.UNKNOWN,
            reason=reason,
            share=None,
            effects={"end_stop@left": 0.7, "dead_zone": 0.65},
            equation=EQUATION,
            pool=[
                SimpleNamespace(names=names, rmse=left, finished=finished)
                for names, left, finished in (
                    (("end_stop@left",), 0.01, False),
                    (("end_stop@right",), 0.02, True),
                    (("dead_zone", "end_stop@left"), 0.03, True),
                    (("end_stop@left",), 0.04, True),
                )
            ],
        )
    )
    assert text == (
        f"Something is missing, but {reason}: the simulation alone has an error of 0.2 mm, "
        f"{NOISE}. "
        f"Most explanations hold `end_stop` at left; the best leaves 0.03 mm. N{NEAR[1:]}. "
        "The best equation for the residual of the simulation alone (explains 40 %): 0.3 u(t-1)."
    )


def test_a_drift_is_told_by_its_ends():
    diagnosis = found(Status.NAMED, "gain_drift")
    drift = replace(named("gain_drift"), change=Change("factor on gain", "1", 1.0, 0.8037))
    told = "`gain_drift` (factor on gain 1 at the start and 0.804 at the end) removes"
    assert verdict_sentence(diagnosis, [drift]).startswith(told)
    drift = replace(drift, change=Change("change of the reading", "mm", 0.0, -0.3))
    told = "`gain_drift` (change of the reading 0 mm at the start and -0.3 mm at the end) removes"
    assert verdict_sentence(diagnosis, [drift]).startswith(told)


def test_a_creep_is_told_by_what_its_branches_amount_to():
    amounts = {
        "relaxing_stiffness": Estimate(20.0, "N/m", 15.0, 33.0, 1.0),
        "half_time": Estimate(3.0, "s", 2.9, 3.1, 1.0),
    }
    creep = replace(named("viscoelastic_creep"), quantities=amounts)
    told = "`viscoelastic_creep` (relaxing stiffness 15 to 33 N/m, half time 3 ± 0.1 s) removes"
    assert verdict_sentence(found(Status.NAMED, "viscoelastic_creep"), [creep]).startswith(told)


def test_a_curve_of_the_reading_is_told_by_its_bend():
    diagnosis = found(Status.NAMED, "sensor_nonlinearity")
    bend = Bend("reading", "mm", -0.3187, "output", "mm", 1.2, 0.9)
    told = "`sensor_nonlinearity` (reading bent by up to -0.319 mm, at output 1.2 mm) removes"
    curve = replace(named("sensor_nonlinearity"), bend=bend)
    assert verdict_sentence(diagnosis, [curve]).startswith(told)
    curve = replace(curve, bend=replace(bend, slope=-0.9))
    told = "`sensor_nonlinearity` (reading of the opposite sign, bent by up to -0.319 mm, at"
    assert verdict_sentence(diagnosis, [curve]).startswith(told)


def test_a_sentence_has_room_for_two_parameters():
    diagnosis = found(Status.NAMED, "dead_zone")
    told = "`dead_zone` (threshold 0.4 ± 0.1 V, slope 0.01 ± 0.02) removes"
    many = replace(named(), quoted=("threshold", "slope", "threshold"))
    assert verdict_sentence(diagnosis, [many]).startswith(told)


def test_a_parameter_at_its_bound_has_no_interval():
    diagnosis = found(Status.NAMED, "dead_zone")
    effect = named()
    wide = {"threshold": replace(effect.parameters["threshold"], at_bound=True)}
    told = "`dead_zone` (threshold 0.4 V at its bound) removes"
    assert verdict_sentence(diagnosis, [replace(effect, parameters=wide)]).startswith(told)


@pytest.mark.parametrize(("high", "told"), [(0.59, "0.4 ± 0.14 V"), (0.61, "0.3 to 0.61 V")])
def test_a_lopsided_interval_is_told_by_its_ends(high, told):
    effect = named()
    effect.parameters["threshold"] = Estimate(0.4, "V", 0.3, high, 0.1)
    text = verdict_sentence(found(Status.NAMED, "dead_zone"), [effect])
    assert text.startswith(f"`dead_zone` (threshold {told}) removes")


def test_what_withdrew_an_answer_is_told():
    withdrawn = found(Status.UNKNOWN, reason=Reason.CONTRADICTED_ELSEWHERE, share=None)
    withdrawn.decision = Decision(
        Status.UNKNOWN,
        SimpleNamespace(labels=("dead_zone@left",)),
        reason=Reason.CONTRADICTED_ELSEWHERE,
        contradicted={"night": Certified(0.1, 0.2, 9), "day": Certified(0.1, 0.3, 9)},
    )
    assert sentence(withdrawn).startswith(
        f"Something is missing, but {Reason.CONTRADICTED_ELSEWHERE} (with `dead_zone` at left the "
        "error on night is 0.1 mm before and 0.2 mm after, on day is 0.1 mm before and 0.3 mm "
        f"after): the simulation alone has an error of 0.2 mm, {NOISE}."
    )


def test_an_answer_that_improves_too_little_is_told_beside_what_it_was_fitted_to():
    withdrawn = found(Status.UNKNOWN, reason=Reason.CONTRADICTED, share=None)
    residual = np.full(300, 0.05)
    withdrawn.decision = Decision(
        Status.UNKNOWN,
        SimpleNamespace(labels=("baseline_drift",), fit=SimpleNamespace(residual=residual)),
        reason=Reason.CONTRADICTED,
        contradicted={"certified samples": Certified(0.3, 0.25, 9)},
    )
    withdrawn.nominal.residual = 6.0 * residual
    withdrawn.problem.seen_rmse = lambda residual: float(np.sqrt(np.mean(residual**2)))
    assert (
        "(with `baseline_drift` the error on certified samples falls from 0.3 to 0.25 mm, but from "
        "0.3 to 0.05 mm where it was fitted)"
    ) in sentence(withdrawn)


def test_what_only_the_certified_samples_show_is_not_described_by_the_others():
    text = sentence(
        found(
            Status.UNKNOWN,
            reason=Reason.ONLY_CERTIFIED,
            share=None,
            effects={"dead_zone": 0.9},
            equation=EQUATION,
        )
    )
    assert text == (
        "Something is missing, but only the certified samples show it: the simulation alone has an "
        f"error of 0.2 mm, {NOISE}. N{NEAR[1:]}."
    )


def test_what_was_taken_for_noise_is_not_said_to_show_nothing():
    diagnosis = found(Status.UNKNOWN, reason=Reason.ONLY_CERTIFIED, seen=0.0116, equation=EQUATION)
    assert sentence(diagnosis) == (
        "Something is missing: on the certified samples the simulation alone has an error of "
        f"0.2 mm, {NOISE}. On the others its error of 0.0116 mm, 1.2 noise floors, was taken for "
        f"noise. N{NEAR[1:]}."
    )


def test_an_effect_is_likely_or_not_spoken_of():
    unsure = found(
        Status.UNKNOWN, reason=Reason.UNEXPLAINED, share=None, effects={"dead_zone": 0.59}
    )
    assert "Most explanations" not in sentence(unsure)


def test_a_place_is_told_with_its_numbers():
    diagnosis = found(Status.NAMED, "dead_zone")
    bin_ = Concentration("direction", 2, 0.5, 1.5, "1", 0.4, 0.1, "direction", "the output")
    diagnosis.where.before = Localisation(None, bin_, BAND, 0.3, "mm")
    assert sentence(diagnosis).endswith(
        "Without it, near the simulation's priors the residual is 0.4 mm (RMS) while the output is "
        "rising, 0.1 mm elsewhere; 40 % of its energy lies between 0.5 and 1 Hz."
    )


# Remarks


@pytest.mark.parametrize(
    ("offset", "remark"),
    [
        # 8 ms is the prior spread, 0.4 ms the standard deviation.
        (-1.25, "The output is logged 10 ± 0.8 ms early (0.5 samples)."),
        (-2.5, "The output is logged 20 ± 0.8 ms early (1 sample)."),
        (
            1.25,
            "The output is logged 10 ± 0.8 ms late (0.5 samples), or the device has a lag this "
            "short.",
        ),
        (0.24, ""),  # within a tenth of a sample
        (-0.24, ""),
    ],
)  # fmt: skip
@pytest.mark.parametrize("status", list(Status))
def test_a_record_is_logged_early_or_late_where_nothing_else_can_pass_for_it(
    status, offset, remark
):
    names = () if status is Status.NONE else ("dead_zone",)
    diagnosis = found(status, *names, coordinates=(0.0, 0.0, offset))
    sure = status in (Status.NAMED, Status.NONE)
    assert remarks(diagnosis) == ((remark,) if remark and sure else ())


EARLY = "The output is logged 10 ± 0.8 ms early (0.5 samples)"


def test_the_time_of_logging_is_as_unsure_as_all_that_was_estimated():
    diagnosis = found(Status.NONE, coordinates=(0.0, 0.0, -1.25), timing_deviation=0.42)
    assert remarks(diagnosis) == ()
    diagnosis.uncertainty.deviation[2] = 0.41
    [text] = remarks(diagnosis)
    assert text.startswith("The output is logged 10 ± 6.6 ms early")


@pytest.mark.parametrize(
    ("kind", "doubted"),
    [
        ({}, False),
        ({"seen": 0.0116}, True),
        ({"block": (0.2, 0.0116)}, True),
        ({"block": (0.2, 0.0116), "accuracy": 0.01}, False),
    ],
)
def test_where_more_than_noise_is_left_an_error_may_pass_for_a_time_offset(kind, doubted):
    early = found(Status.NAMED, "dead_zone", coordinates=(0.0, 0.0, -1.25), **kind)
    doubt = ", or an error of the law looks like such an offset" if doubted else ""
    assert remarks(early) == (f"{EARLY}{doubt}.",)
    alone = found(Status.NONE, coordinates=(0.0, 0.0, 1.25), **kind)
    [text] = remarks(alone)
    assert text.endswith(
        "lag this short"
        + (", or an error of the simulation looks like such an offset." if doubted else ".")
    )


def test_a_record_that_seems_early_beside_a_lag_may_have_a_shorter_lag():
    early = found(Status.NAMED, "slew_limit", coordinates=(0.0, 0.0, -1.25))
    assert remarks(early) == (f"{EARLY}, or the fitted lag is too long by this time.",)


@pytest.mark.parametrize(("coordinate", "doubted"), [(3.0, True), (2.9, False), (0.0, False)])
def test_a_law_at_its_bound_may_pass_for_a_time_offset(coordinate, doubted):
    """At a bound that is its prior mean a part of a law has vanished."""
    diagnosis = found(Status.NAMED, "dead_zone", coordinates=(0.0, 0.0, -1.25, coordinate))
    extended = diagnosis.final.extended
    extended.layout.names, extended.layout.free = (*NAMES, "dead_zone.slope"), np.arange(4)
    extended.layout.effect_slices = [slice(3, 4)]
    extended.layout.bounds = np.array([-3.0, -3.0, -3.0, 0.0]), np.full(4, 3.0)
    assert remarks(diagnosis) == (
        f"{EARLY}, or an error of the law looks like such an offset." if doubted else f"{EARLY}.",
    )


@pytest.mark.parametrize(
    ("coordinates", "remark"),
    [
        ((3.0, 0.0), "stiffness is at its bound"),
        ((-2.9995, 3.0), "stiffness and gain are at their bounds"),
    ],
)
def test_priors_that_exclude_the_record_are_told(coordinates, remark):
    diagnosis = found(Status.UNKNOWN, reason=Reason.NO_EFFECT, coordinates=(*coordinates, 0.0))
    assert remarks(diagnosis) == (
        f"Of the simulation's own parameters {remark}: the declared priors exclude what the record "
        "asks for.",
    )
    assert remarks(found(Status.UNKNOWN, coordinates=(2.99, -2.99, 3.0))) == ()


@pytest.mark.parametrize(
    ("names", "coordinates", "remark"),
    [
        (["dead_zone"], (3.0, 0.0), "stiffness is at its bound without the effect"),
        (["dead_zone", "sensor_lag"], (3.0, -3.0),
         "stiffness and gain are at their bounds without the effects"),
    ],
)  # fmt: skip
def test_priors_that_an_effect_may_stand_for_end_the_sentence(names, coordinates, remark):
    diagnosis = found(Status.NAMED, *names, apart=1.5)
    diagnosis.nominal = SimpleNamespace(
        extended=diagnosis.nominal.extended, coordinates=np.array([*coordinates, 0.0])
    )
    assert sentence(diagnosis).endswith(
        f" Of the simulation's own parameters {remark}: if the declared priors exclude this "
        "device, that may be all that is wrong."
    )
    diagnosis.decision = Decision(Status.UNKNOWN, None)
    assert not any("bound" in text for text in remarks(diagnosis))


def test_it_is_told_that_the_presence_is_against_what_predicts_best():
    """Of the cascaded tanks: a bent reading of many weights beside a stop."""
    first, second = ("end_stop", "sensor_nonlinearity"), ("charge_leakage", "end_stop")
    given = {"rivals": [second], "weighed": [second, first], "reason": Reason.RIVAL}
    present = {"end_stop": 0.95, "charge_leakage": 0.92, "sensor_nonlinearity": 0.0005}
    [text] = remarks(found(Status.AMBIGUOUS, *first, effects=present, **given))
    assert text == (
        "The first explanation leads by what it predicts on blocks left out, but "
        "`sensor_nonlinearity` has a presence below 10 %: its law has more freedom than this "
        "record supports. With freedom taken into account, the most probable other explanation is "
        "`charge_leakage` and `end_stop`."
    )
    present["sensor_nonlinearity"] = 0.2
    assert remarks(found(Status.AMBIGUOUS, *first, effects=present, **given)) == ()
    present["sensor_nonlinearity"] = 0.0005
    assert remarks(found(Status.NAMED, *first, effects=present, **given)) == ()


def test_it_is_told_that_the_certified_samples_are_close_to_the_others():
    [text] = remarks(found(Status.NONE, apart=1.53))
    assert "its certified samples are 1.5 of the slowest time constants away" in text
    assert remarks(found(Status.NONE)) == ()


@pytest.mark.parametrize(
    ("records", "closest", "which"), [(1, 1, "The record"), (3, 2, "Record 2")]
)
def test_it_is_told_which_record_is_short_and_what_can_be_done(records, closest, which):
    """At 50 Hz the slowest time constant is 9 samples: 24 of them are 4.32 s, and half of it, which
    blocks 1.5 of it apart allow, is 0.09 s."""
    [text] = remarks(found(Status.NONE, apart=1.5, records=records, closest=closest))
    assert text.startswith(f"{which} is short for a device as slow as this: ")
    assert text.endswith(
        " 24 of them, 4.32 s, would be long enough; so is this record if the slowest is at most "
        "0.0899 s, which `slowest_time` states."
    )


def test_it_is_told_that_samples_are_too_far_apart():
    [text] = remarks(found(Status.NAMED, "sensor_lag", slowest=0.006))
    assert text == (
        "The samples are 1.7e+02 of the simulation's slowest time constants apart, so that they "
        "show the device only at rest: check the sampling rate."
    )
    assert remarks(found(Status.NAMED, "sensor_lag", slowest=0.1)) == ()
    assert remarks(found(Status.NAMED, "sensor_lag", slowest=0.0)) == ()


def test_samples_far_from_their_neighbours_are_counted():
    residual = SMOOTH.copy()
    residual[[30, 99, 200]] += [50.0, -60.0, 50.0]
    [text] = remarks(found(Status.UNKNOWN, reason=Reason.NO_EFFECT, residual=residual))
    assert text.startswith("3 samples lie far from both neighbours, ")
    assert remarks(found(Status.NONE, residual=residual, decimation=2)) == ()
    residual[30:] += 50.0
    residual[[99, 200]] = SMOOTH[[99, 200]] + 50.0
    [text] = remarks(found(Status.NONE, residual=residual)) or [""]
    assert text.startswith("1 sample lies")


def test_what_explains_little_is_neither_spoken_of_nor_an_error_to_live_with():
    little = SimpleNamespace(names=("end_stop",), rmse=0.28, finished=True)
    told = found(
        Status.UNKNOWN, reason=Reason.NO_EFFECT, left=0.28, effects={"end_stop": 0.9}, pool=[little]
    )
    assert "end_stop" not in sentence(told)
    assert "accuracy" not in sentence(told)
    told.above_white = 1.0
    assert "Most explanations hold `end_stop`; the best leaves 0.28 mm" in sentence(told)
    assert "accuracy=0.28)`" in sentence(told)
    assert "though it may be what is missing" in sentence(told)
    told.presence.effects["end_stop"] = 0.999
    assert "All likely explanations hold `end_stop`; the best leaves 0.28 mm" in sentence(told)


def test_it_is_told_that_certified_samples_dated_an_event():
    diagnosis = found(Status.NAMED, "step_fault")
    assert "certified samples, which" not in " ".join(remarks(diagnosis))
    diagnosis.certificate = replace(diagnosis.certificate, dated=True)
    assert (
        "When it happened was found on the certified samples, which do not certify that."
        in remarks(diagnosis)
    )


@pytest.mark.parametrize(
    ("at_bounds", "remark"),
    [
        (["dead_zone.slope"], "`dead_zone` has its slope at its bound, which counts against it."),
        (
            ["dead_zone@valve 1.2.slope"],
            "`dead_zone` at valve 1.2 has its slope at its bound, which counts against it.",
        ),
        (
            ["end_stop@upper_level>lower_level.upper_stop",
             "end_stop@upper_level>lower_level.stiffness"],
            "`end_stop` from upper level to lower level has its upper stop and stiffness at their "
            "bounds, which counts against it.",
        ),
        (
            ["baseline_drift@valve 1.2.record_2.mode_1"],
            "`baseline_drift` at valve 1.2 has its mode 1 of record 2 at its bound, which counts "
            "against it.",
        ),
        (
            ["dead_zone@left.slope", "sensor_lag.time_constant"],
            "`dead_zone` at left has its slope at its bound and `sensor_lag` has its time constant "
            "at its bound, which counts against them.",
        ),
    ],
)  # fmt: skip
def test_parameters_of_laws_at_their_bounds_are_told(at_bounds, remark):
    assert remarks(found(Status.NAMED, "dead_zone", at_bounds=at_bounds)) == (remark,)
    assert remarks(found(Status.UNKNOWN, "dead_zone", at_bounds=at_bounds)) == ()


@pytest.mark.parametrize(
    ("left", "accuracy", "reason", "told"),
    [
        (0.02, 0.0, None, True),
        (0.005, 0.0, None, False),  # half of the white noise
        (0.02, 0.03, None, False),  # more is stated already
        (0.02, 0.01, None, True),
        (0.02, 0.0, Reason.NOISE, False),  # the residual is said to be at the noise floor
        (0.02, 0.0, Reason.ACCURATE, False),
        (0.02, 0.0, Reason.COLOURED, True),
    ],
)
def test_coloured_error_is_told_where_the_sentence_does_not_deny_it(left, accuracy, reason, told):
    noise = (
        "The best explanation leaves 0.02 mm (RMS) of coloured error beyond the white noise of "
        "0.01 mm; `Simulation(…, accuracy=0.02)` counts it as known error."
    )
    diagnosis = found(Status.NONE, reason=reason, left=left, accuracy=accuracy)
    assert remarks(diagnosis) == ((noise,) if told else ())


def test_coloured_noise_that_counts_as_noise_is_told():
    diagnosis = found(Status.NONE, reason=Reason.COLOURED, left=0.02, coloured=0.019)
    assert remarks(diagnosis) == (
        "The best explanation leaves 0.019 mm (RMS) of coloured noise beyond the white noise of "
        "0.01 mm, which counts as noise.",
    )


def test_remarks_end_the_sentence():
    diagnosis = found(
        Status.NAMED, "dead_zone", coordinates=(3.0, 0.0, -1.25), at_bounds=["dead_zone.slope"]
    )
    texts = remarks(diagnosis)
    assert len(texts) == 3
    assert sentence(diagnosis).endswith(f"{BEFORE}. {' '.join(texts)}")


@pytest.mark.parametrize(
    ("status", "names", "equation", "part", "left"),
    [
        (Status.NAMED, ["dead_zone"], EQUATION, "50 %", "the answer leaves"),
        (Status.AMBIGUOUS, ["dead_zone"], EQUATION, "50 %", "the answer leaves"),
        (Status.UNKNOWN, ["dead_zone"], EQUATION, "50 %", "the simulation alone leaves"),
        (Status.NONE, [], NO_EQUATION, "none", "the simulation alone leaves"),
    ],
)
def test_how_much_of_the_rest_is_predictable_is_told_of_every_status(
    status, names, equation, part, left
):
    assert remainder(found(status, *names, equation=equation)) == (
        f"A flexible model of input, motion and time removes {part} of the error that {left}, on "
        "samples that it was not fitted to."
    )


@pytest.mark.parametrize("status", list(Status))
@pytest.mark.parametrize("reason", [None, *Reason])
def test_no_sentence_says_that_nothing_and_that_something_is_missing(status, reason):
    names = () if status is Status.NONE else ("dead_zone",)
    rivals = [("sensor_lag",)] if status is Status.AMBIGUOUS else []
    for whole in (True, False):
        text = sentence(
            found(status, *names, reason=reason, whole=whole, rivals=rivals, block=(0.2, 0.05),
                  left=0.03, effects={"dead_zone": 0.95}, families={"lag": 0.7})
        )  # fmt: skip
        nothing = "Nothing is missing" in text or "Nothing is named" in text
        something = "Something is missing" in text
        part, rival = "part of the answer" in text, ", or sensor_lag" in text
        full = "removes" in text and not part and not rival
        assert nothing + something + part + rival + full == 1
        assert ("What remains is not named" in text) == part
        # What is left is noise, an error of the law, or of another effect; never two of these.
        left = "too poor" in text, "is coloured noise" in text, "is not named" in text
        assert sum(left) <= 1
        assert ".." not in text
        assert "  " not in text


@pytest.mark.parametrize(
    ("label", "text"),
    [
        ("dead_zone", "`dead_zone`"),
        ("dead_zone@left wall", "`dead_zone` at left wall"),
        ("end_stop@upper_level", "`end_stop` at upper level"),
        ("end_stop@upper_level>lower_level", "`end_stop` from upper level to lower level"),
    ],
)
def test_a_label_is_told_with_its_place(label, text):
    assert label_in_words(label) == text


@pytest.mark.parametrize(
    ("status", "force", "told"),
    [
        (Status.UNKNOWN, UnknownForce(0.64, "the speed", "velocity"), True),
        (Status.UNKNOWN, UnknownForce(0.49, "the speed", "velocity"), False),
        (Status.UNKNOWN, None, False),
        (Status.NONE, UnknownForce(0.64, "the speed", "velocity"), False),
    ],
)
def test_a_force_that_no_effect_has_is_described_where_nothing_is_named(status, force, told):
    told_of = found(status, reason=Reason.NO_EFFECT, share=None, force=force, left=0.05)
    text = " ".join(remarks(told_of))
    expected = (
        "A smooth force at velocity that depends on the speed would remove 64 % of the residual of "
        "the simulation alone, on samples that it was not fitted to."
    )
    assert (expected in text) is told
    assert ("accuracy=0.05)`" in text) is not told


def test_a_wave_that_follows_the_motion_is_told_where_nothing_is_named():
    wave = ModulatedWave(("periodic_disturbance",), 2.3931)
    told_of = found(Status.UNKNOWN, reason=Reason.UNEXPLAINED, share=None, modulated=wave)
    assert (
        "What `periodic_disturbance` leaves is a wave of 2.39 Hz that grows and falls with input "
        "and motion: a property of the device may change at that frequency."
    ) in sentence(told_of)
