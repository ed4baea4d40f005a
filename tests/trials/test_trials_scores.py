"""Scores of made-up campaigns against counts by hand and other implementations."""

from math import inf, isnan, log
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_trials import FAMILY, campaign, label, said
from scipy.stats import binomtest

from dea import trials
from dea.errors import InputError
from dea.number_format import DASH
from dea.store import CONTRACTS
from dea.tables.trials import rates as tabulated
from dea.trials.confidence import acceptable, confidence, risk_coverage


@given(st.integers(1, 400).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_interval_is_wilsons(counts):
    successes, count = counts
    share = trials.wilson(successes, count)
    expected = binomtest(successes, count).proportion_ci(method="wilson")
    assert share.value == successes / count
    assert share.low == pytest.approx(expected.low, abs=1e-12)
    assert share.high == pytest.approx(expected.high, abs=1e-12)


def test_the_interval_of_a_part_of_a_trial_ends_where_the_score_test_does():
    """At either end the share is 1.96 standard deviations of a mean of trials away."""
    share = trials.wilson(6.3, 7.25)
    for end in (share.low, share.high):
        assert (share.value - end) ** 2 == pytest.approx(1.959964**2 * end * (1.0 - end) / 7.25)


def test_no_trials_give_no_share():
    share = trials.wilson(0, 0)
    assert share.trials == 0
    assert all(isnan(value) for value in share[:3])


def test_a_label_counts_times_from_the_start_of_the_record():
    step = {"name": "step_fault", "form": "jump", "port": "input",
            "defining": {"time": 12.0, "size": 0.5}}  # fmt: skip
    told = {"effects": [step], "strength": 4.0, "excitation": "bursts", "device": "film",
            "noise": "white"}  # fmt: skip
    found = trials.Label.of(told, start=2.5)
    assert found == trials.Label(
        frozenset({"step_fault"}), False, 4.0, "bursts", forms={"step_fault": "jump"},
        defining={("step_fault", "time"): 9.5, ("step_fault", "size"): 0.5},
    )  # fmt: skip
    assert trials.Label.of({**told, "effects": [step | {"port": "outside"}]}).outside


def test_an_effect_that_is_named_at_another_port_too_is_one_too_many():
    twice = trials.effect_set(["sensor_lag", "dead_zone", "sensor_lag"])
    assert twice == {"sensor_lag", "dead_zone", "sensor_lag 2"}
    for hidden, names in ((SINGLE, ["sensor_lag"] * 2), (PAIR, ["dead_zone", "end_stop"] * 2)):
        verdict = said("named", *trials.effect_set(names))
        assert trials.outcome(hidden, verdict, FAMILY) == "wrong name"
        assert not acceptable(hidden, verdict.effects)


SINGLE, PAIR = label("sensor_lag"), label("dead_zone", "end_stop")
NOTHING, FOREIGN = label(), label("sticking_sensor", outside=True)


@pytest.mark.parametrize(
    ("hidden", "verdict", "expected"),
    [
        (SINGLE, said("named", "sensor_lag"), "right name"),
        (SINGLE, said("named", "electrode_lag"), "right class"),
        (SINGLE, said("named", "end_stop"), "wrong name"),
        (SINGLE, said("named", "sensor_lag", "end_stop"), "wrong name"),
        (SINGLE, said("ambiguous", "sensor_lag", rivals=[{"electrode_lag"}]), "right class"),
        (SINGLE, said("ambiguous", "sensor_lag", rivals=[{"end_stop"}]), "abstained"),
        (SINGLE, said("unknown"), "abstained"),
        (SINGLE, said("none"), "missed"),
        (PAIR, said("named", "dead_zone", "end_stop"), "right name"),
        (PAIR, said("named", "dead_zone"), "one of two"),
        (PAIR, said("named", "sensor_lag"), "wrong name"),
        (NOTHING, said("none"), "right none"),
        (NOTHING, said("named", "dead_zone"), "wrong name"),
        (NOTHING, said("ambiguous", "dead_zone", rivals=[{"end_stop"}]), "abstained"),
        (FOREIGN, said("unknown"), "abstained"),
        (FOREIGN, said("named", "dead_zone"), "wrong name"),
        (FOREIGN, said("none"), "missed"),
    ],
)
def test_what_a_verdict_is_worth(hidden, verdict, expected):
    assert trials.outcome(hidden, verdict, FAMILY) == expected


def test_every_trial_is_of_one_kind():
    kinds = [trials.kind_of(each) for each in (SINGLE, PAIR, FOREIGN, NOTHING)]
    assert kinds == list(trials.KINDS)


def test_confidence_compares_misfits_of_equally_many_effects():
    one, other, both = (frozenset(names) for names in ("a", "b", "ab"))
    ranking = ((one, 2.0), (both, 1.01), (other, 8.0))
    verdict = said("unknown", ranking=ranking, floor=1.0)
    assert confidence(verdict) == pytest.approx(0.5 * log(63 / 3))
    assert confidence(said("none", ranking=(), floor=1.0)) == -inf
    assert confidence(said("none", ranking=ranking[:2], floor=1.0)) == inf


@given(st.integers(1, 60), st.integers(0, 1000))
def test_the_risk_of_every_coverage_is_what_counting_gives(count, seed):
    labels, verdicts = (list(each.values()) for each in campaign(count, seed))
    sureness, coverage, risk = risk_coverage(labels, verdicts)
    assert list(sureness) == sorted(sureness, reverse=True)
    sure = [confidence(verdict) for verdict in verdicts]
    for least in set(sure):
        chosen = [i for i in range(count) if sure[i] >= least]
        wrong = sum(not acceptable(labels[i], verdicts[i].ranking[0][0]) for i in chosen)
        at = len(chosen) - 1
        assert coverage[at] == pytest.approx(len(chosen) / count)
        assert risk[at] == pytest.approx(wrong / len(chosen))


@given(st.integers(1, 80), st.integers(0, 1000))
def test_the_dataset_counts_every_trial_once(count, seed):
    scores = trials.scores(*campaign(count, seed), FAMILY)
    CONTRACTS["scores"].check(scores, Path("scores.nc"))
    assert scores["confusion"].sum() == scores["effect_outcomes"].sum() == count
    singles = int((scores["kind"] == "single").sum())
    assert scores["strength_bin_outcomes"].sum() == singles
    assert scores["excitation_kind_outcomes"].sum() == singles
    right = int((scores["outcome"] == "right name").sum())
    assert scores["effect_outcomes"].sel(possible_outcome="right name").sum() == right


def rates(labels, verdicts):
    scores = trials.scores(labels, verdicts, FAMILY)
    measures = scores["measure"].values
    return scores, {str(m): float(scores["rate"].sel(measure=m)) for m in measures}


def test_rates_are_shares_of_their_own_kind():
    labels = {"0": SINGLE, "1": SINGLE, "2": NOTHING, "3": FOREIGN, "4": PAIR, "5": FOREIGN}
    verdicts = {
        "0": said("named", "sensor_lag", truth_error=0.3),
        "1": said("named", "electrode_lag"),
        "2": said("none"),
        "3": said("named", "end_stop"),
        "4": said("named", "dead_zone", "end_stop", truth_error=0.5),
        "5": said("ambiguous", "end_stop", rivals=[{"dead_zone"}]),
    }
    scores, rate = rates(labels, verdicts)
    assert rate["right name"] == 0.5
    assert rate["right class"] == 1.0
    assert rate["wrong name"] == 0.0
    assert rate["both of two"] == rate["one or both of two, nothing wrong"] == 1.0
    assert rate["name given on nothing, white noise"] == 0.0
    assert rate["name given on a foreign effect"] == 0.5
    assert rate["names given that are right"] == 0.5
    assert rate["close to the truth after a right name"] == 0.5
    pairs = scores["confusion"].sel(hidden_effect="two effects")
    assert int(pairs.sel(said_effect="two effects")) == int(pairs.sum()) == 1
    assert float(scores["risk_of_names"]) == 0.5
    assert float(scores["coverage_of_names"]) == pytest.approx(4 / 6)


def test_a_name_that_leaves_a_rest_unnamed_is_a_name():
    labels = {"0": SINGLE, "1": SINGLE, "2": PAIR, "3": NOTHING}
    verdicts = {
        "0": said("named", "sensor_lag", whole=False),
        "1": said("named", "sensor_lag"),
        "2": said("named", "dead_zone", whole=False),
        "3": said("named", "dead_zone", whole=False),
    }
    _, rate = rates(labels, verdicts)
    assert rate["right name"] == 1.0
    assert rate["right name, and nothing further missing"] == 0.5
    assert rate["both of two"] == 0.0
    assert rate["one or both of two, nothing wrong"] == 1.0
    assert rate["name given on nothing, white noise"] == 1.0


@pytest.mark.parametrize(
    ("noise", "measure"),
    [
        ("white", "white noise"),
        ("coloured", "coloured noise"),
        ("flicker", "coloured noise"),
        ("drifting", "drifting readings"),
        ("quantised", "quantised readings"),
        ("shifted", "shifted readings"),
        ("a new kind", "a new kind readings"),
    ],
)
def test_names_on_nothing_are_counted_by_the_kind_of_noise(noise, measure):
    _, rate = rates({"0": label(noise=noise)}, {"0": said("named", "dead_zone")})
    found = {name for name, value in rate.items() if "on nothing" in name and value == 1.0}
    assert found == {f"name given on nothing, {measure}"}


def test_targets_of_wrong_and_undue_names_are_upper_ones():
    scores, _ = rates({"0": label(noise="white")}, {"0": said("none")})
    table = tabulated(scores).shown.set_index("measure")["target (%)"]
    upper = {measure for measure, target in table.items() if target.startswith("at most")}
    assert upper == {
        name for name in table.index if name.startswith(("wrong name", "name given on"))
    }
    assert table["right name"] == "at least 88"
    assert table["names given that are right"] == DASH


def test_an_effect_that_the_catalogue_lacks_is_still_of_no_other_class():
    assert trials.outcome(label("stress_relaxation"), said("named", "end_stop"), FAMILY) == (
        "wrong name"
    )
    scores, rate = rates({"0": label("stress_relaxation")}, {"0": said("unknown")})
    assert rate["right name"] == 0.0
    assert int(scores["confusion"].sel(hidden_effect="stress_relaxation").sum()) == 1


def test_defining_parameters_with_a_counterpart_are_looked_for_in_their_intervals(monkeypatch):
    known = {("sensor_lag", "lag"): "time_constant"}
    monkeypatch.setattr("dea.trials.opened.COUNTERPARTS", known)
    hidden = label("sensor_lag", defining={("sensor_lag", "lag"): 0.2, ("sensor_lag", "q"): 7.0})
    inside = said("named", "sensor_lag", intervals={("sensor_lag", "time_constant"): (0.1, 0.3)})
    outside = said("named", "sensor_lag", intervals={("sensor_lag", "time_constant"): (0.3, 0.4)})
    scores, rate = rates({"0": hidden, "1": hidden}, {"0": inside, "1": outside})
    assert rate["defining parameter within its interval"] == 0.5
    measure = "defining parameter within its interval"
    assert int(scores["rate_trials"].sel(measure=measure)) == 2


def test_outcomes_are_counted_by_form_device_and_noise():
    hidden = label("sensor_lag", forms={"sensor_lag": "bessel_filter"}, device="drive")
    scores, _ = rates({"0": hidden}, {"0": said("named", "sensor_lag")})
    assert scores["form"].values.tolist() == ["bessel_filter"]
    assert scores["form_effect"].values.tolist() == ["sensor_lag"]
    for counts in ("form_outcomes", "device_kind_outcomes", "noise_kind_outcomes"):
        assert int(scores[counts].sel(possible_outcome="right name").sum()) == 1
    assert scores["device_kind"].values.tolist() == ["drive"]


def test_a_seal_opens_on_what_was_committed_to_and_nothing_else(tmp_path):
    import hashlib

    sealed = tmp_path / "0001.json"
    sealed.write_text("a label")
    committed = hashlib.sha256(b"a label").hexdigest()
    assert trials.open_seal(sealed, committed) == b"a label"
    sealed.write_text("another label")
    with pytest.raises(InputError, match="changed after it was sealed"):
        trials.open_seal(sealed, committed)
    sealed.unlink()
    with pytest.raises(InputError, match="missing"):
        trials.open_seal(sealed, committed)
