"""Joint diagnosis of several records of one device."""

import numpy as np
import pytest
import xarray as xr

from dea.discrepancy import Samples, Settings, diagnose
from dea.discrepancy.evidence.residual_model import dictionary
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.records import prepare, signals_of
from dea.errors import InputError
from dea.simulation import catalogue, measured_scales, prepared
from dea.store import signals
from made_carriage import CARRIAGE

INTERVAL, NOISE = 0.02, 4e-3
OFFERED = ("sensor_lag", "dead_zone", "baseline_drift")


def recorded(seed, start, interval=INTERVAL):
    """Return a record of a carriage whose sensor lags by 0.15 s, and which drifts as it likes."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-1, 1, 50), 25)
    extended = prepared(CARRIAGE, u, interval, 1e-5)
    values = extended.layout.prior_means
    values[extended.layout.names.index("initial.position")] = start
    samples = Samples(u, u, interval)
    lagging = extended.attach(catalogue()["sensor_lag"], measured_scales(extended, values, samples))
    y = lagging.simulate(
        np.concatenate([values, [0.15, 0.9, 0.0, 0.0, 0.0, 0.5, 1.0, 0.0, 1.0]]), u, interval
    )
    y += NOISE * rng.standard_normal(u.size)
    return xr.Dataset(
        {"input": ("time", u, {"units": "V"}), "output": ("time", y, {"units": "V"})},
        coords={"time": ("time", np.arange(u.size) * interval, {"units": "s"})},
        attrs={"contract": "imported_record"},
    )


@pytest.mark.slow
def test_records_of_one_device_share_their_law_and_not_their_start():
    settings = Settings(effects=OFFERED, warm_up=0.0)
    found = diagnose([recorded(1, 0.4), recorded(2, -0.3)], CARRIAGE, settings=settings)
    verdict = found.verdict
    assert (verdict.status, verdict.names) == ("named", ("sensor_lag",)), verdict.sentence
    estimate = verdict.effects[0].parameters["time_constant"]
    assert estimate.low <= 0.15 <= estimate.high
    final = found.final
    starts = [final.extended.layout.of_record(final.values, k)[3] for k in (0, 1)]
    np.testing.assert_allclose(starts, [0.4, -0.3], atol=0.08)
    for record in ("record_1", "record_2"):
        left_out = verdict.certified["records"][record]
        assert left_out["after"] < 1.3 * NOISE < left_out["before"]


def test_records_sampled_otherwise_are_refused():
    with pytest.raises(InputError, match=r"record 2 is sampled every 0\.03 s"):
        diagnose([recorded(1, 0.0), signals(recorded(2, 0.0, 0.03))], CARRIAGE)


def test_of_several_records_the_one_that_is_too_short_is_named():
    short = signals_of(recorded(2, 0.0).isel(time=slice(100)), CARRIAGE)
    with pytest.raises(InputError, match=r"^record 2: the record holds 2 s; .* at most 0\.2\d* s"):
        prepare(
            [signals_of(recorded(1, 0.0), CARRIAGE), short], CARRIAGE, Settings(slowest_time=0.5)
        )


def test_of_several_records_the_one_with_the_closest_blocks_is_told():
    short = recorded(2, 0.0).isel(time=slice(300))
    both = [signals_of(each, CARRIAGE) for each in (recorded(1, 0.0), short)]
    _, parts, _ = prepare(both, CARRIAGE, Settings(slowest_time=0.5, warm_up=0.0))
    assert parts.close
    assert parts.closest == 2
    longest = parts.largest_slowest * INTERVAL
    _, parts, _ = prepare(both, CARRIAGE, Settings(slowest_time=0.999 * longest, warm_up=0.0))
    assert not parts.close


def test_no_record_is_refused():
    with pytest.raises(InputError, match="there is no record"):
        diagnose([], CARRIAGE)


def joined(*records):
    """A problem of records (input, output) one after the other."""
    u, y = (np.concatenate(signals) for signals in zip(*records, strict=True))
    everything = np.ones(y.size, bool)
    return Problem(u, y, INTERVAL, everything, everything, ~everything,
                   lengths=tuple(len(own) for own, _ in records))  # fmt: skip


def test_no_memory_of_a_record_reaches_into_the_next():
    """What came before a record, forwards or backwards in time, changes no memory of its own."""
    rng = np.random.default_rng(4)
    before, own = (np.cumsum(rng.standard_normal((2, 300)), axis=1) for _ in range(2))

    def memories(other):
        problem = joined(other, own)
        names, columns = dictionary(problem, problem.y)
        return {
            name: column[300:]
            for name, column in zip(names, columns.T, strict=True)
            if name.startswith(("lag(", "play("))
        }

    forwards, backwards = memories(before), memories(before[:, ::-1])
    assert len(forwards) > 6
    for name, memory in forwards.items():
        np.testing.assert_allclose(memory, backwards[name], atol=1e-9, err_msg=name)


def test_no_block_holds_samples_of_two_records():
    problem = joined((np.zeros(300), np.zeros(300)), (np.zeros(200), np.zeros(200)))
    assert problem.blocks(1e9) == [slice(0, 300), slice(300, 500)]
    assert {block.stop for block in problem.blocks(100)} >= {300, 500}


def test_the_rate_of_a_signal_has_no_step_between_records():
    problem = joined((np.zeros(50), np.zeros(50)), (np.zeros(50), np.ones(50)))
    np.testing.assert_array_equal(problem.rate_of(problem.y), 0.0)
