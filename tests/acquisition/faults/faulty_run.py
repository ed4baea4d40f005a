"""One acquisition under faults, and the laws its outcome must keep whatever happened."""

import signal
import time
from collections.abc import Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr
from fault_proxy import TIMEOUT, Fault, FaultProxy

from dea.acquisition import (
    AcquisitionSettings,
    BrokenRecordError,
    DeviceRefusedError,
    DrivenSamples,
    LinkError,
    Quality,
    ZeroNotVerifiedError,
    acquire,
    recover,
)
from dea.acquisition.voltage_plan import ramp
from dea.errors import InputError
from dea.modbus import limit_counts, to_counts
from served_bench import ServedBench

PATIENCE = 30.0  # s, after which an acquisition is taken to hang
# Every sample asks for another voltage, so that none can stand in another's place unnoticed.
VOLTS = np.random.default_rng(6).permutation(np.linspace(1.1, 3.7, 300))
SETTINGS = AcquisitionSettings(
    ramp_rate=60.0, timeout=TIMEOUT, retries=6, reconnect_time=1.0, paced=False
)
FAILURES = (
    BrokenRecordError, LinkError, DeviceRefusedError, ZeroNotVerifiedError, InputError,
)  # fmt: skip


@dataclass(frozen=True)
class FaultyRun:
    """What came of an acquisition: a record or a failure, and the samples on the disk."""

    bench: ServedBench
    sequence: np.ndarray
    record: xr.Dataset | None
    failure: Exception | None
    samples: DrivenSamples
    happened: Sequence[Fault]
    repeats: bool  # whether a broken record is begun again


def run_with_faults(
    bench: ServedBench,
    faults: Sequence[Fault],
    folder: Path,
    settings: AcquisitionSettings = SETTINGS,
) -> FaultyRun:
    """Acquire ``VOLTS`` from ``bench`` through a proxy with ``faults``."""
    partial = folder / f"{len(list(folder.iterdir()))}.partial"
    record = failure = None
    target = ("127.0.0.1", bench.endpoint.port)
    with FaultProxy(target, faults, bench.restart, bench.description) as proxy:
        device = replace(bench.endpoint, port=proxy.port)
        with _ends_within(PATIENCE):
            try:
                record = acquire(device, VOLTS, partial, settings).record
            except FAILURES as error:
                failure = error
    output = to_counts(device["output"], VOLTS)
    lead = ramp(device, 0.0, VOLTS[0], settings.ramp_rate)
    tail = ramp(device, VOLTS[-1], 0.0, settings.ramp_rate)
    sequence = np.concatenate([lead, output, tail, [0]])
    nothing = DrivenSamples.lost(0, 0, np.empty(0, np.int64))
    samples = recover(partial).samples if partial.exists() else nothing
    repeats = settings.on_break == "restart"
    return FaultyRun(bench, sequence, record, failure, samples, proxy.done, repeats)


def check(run: FaultyRun) -> None:
    """Stop the bench and fail where the outcome breaks a law."""
    _ends_at_zero(run)
    run.bench.stop()
    _voltage_within_limits(run)
    _every_sample_is_what_the_bench_measured(run)
    _in_order(run.samples)
    if run.record is not None:
        _record_is_complete(run)
    else:
        _says_what_is_missing(run)


def _voltage_within_limits(run: FaultyRun) -> None:
    low, high = limit_counts(run.bench.description)
    assert np.all((run.bench.applied >= low) & (run.bench.applied <= high))


def _every_sample_is_what_the_bench_measured(run: FaultyRun) -> None:
    s = run.samples
    have = (s.quality & Quality.LOST) == 0
    index = s.device_index[have]
    assert any(
        index.size == 0
        or (
            index.max() < applied.size
            and np.array_equal(s.applied[have], applied[index])
            and np.array_equal(s.displacement[have], displacement[index])
        )
        for applied, displacement in run.bench.boots()
    ), "the samples are not what the bench applied and measured"


def _in_order(s: DrivenSamples) -> None:
    assert np.all(np.diff(s.device_index) == 1), "samples are missing and not marked"
    good = (s.quality & ~Quality.LATE) == Quality.GOOD
    assert np.array_equal(s.applied[good], s.requested[good]), "a sample is out of its place"
    driven = s.position[(s.quality & (Quality.HELD | Quality.UNDRIVEN | Quality.LOST)) == 0]
    assert np.array_equal(driven, np.arange(driven.size)), "a position is missing or repeated"


def _record_is_complete(run: FaultyRun) -> None:
    s = run.samples
    played = (s.quality & ~Quality.LATE) == Quality.GOOD
    assert np.array_equal(s.requested[played], run.sequence)
    held = ~played
    assert np.all((s.quality[held] & ~Quality.LOST) == Quality.HELD)
    read = held[1:] & (s.quality[1:] == Quality.HELD)
    assert np.array_equal(s.applied[1:][read], s.applied[:-1][read])
    record = run.record
    assert record is not None
    kept = (record.quality.values & Quality.HELD) == 0
    counts = to_counts(run.bench.description["output"], VOLTS)
    assert np.array_equal(record.voltage_counts.values[kept], counts)
    lost = (record.quality.values & Quality.LOST) != 0
    assert not np.any(lost & kept)
    assert np.array_equal(np.isfinite(record.displacement.values), ~lost)


def _says_what_is_missing(run: FaultyRun) -> None:
    """Nothing before the first sample named is missing, and nothing from there on passes as good.

    Where a failure to read back zero has overtaken the reason, that is in its context.
    """
    s, failure = run.samples, run.failure
    assert failure is not None
    assert str(failure)
    if isinstance(failure, InputError) and not run.repeats:
        assert not run.bench.applied.any(), "refused, and yet there was voltage"
    broken = broken_record(failure)
    if broken is not None:
        assert broken.count > 0
        good = (s.quality & (Quality.LOST | Quality.UNDRIVEN)) == 0
        assert np.array_equal(np.unique(s.position[good]), np.arange(broken.first))
        assert s.quality[-1] & (Quality.LOST | Quality.UNDRIVEN)


def broken_record(failure: BaseException | None) -> BrokenRecordError | None:
    """The broken record that led to ``failure``, or is it."""
    while failure is not None and not isinstance(failure, BrokenRecordError):
        failure = failure.__context__
    return failure


def _ends_at_zero(run: FaultyRun) -> None:
    bench, failure = run.bench, run.failure
    if isinstance(failure, ZeroNotVerifiedError | LinkError):
        # The client has said that it could not see to it: the device does.
        deadline = time.monotonic() + bench.player.watchdog.timeout + 2.0
        while bench.player.driven and time.monotonic() < deadline:
            time.sleep(0.01)
    assert not bench.player.driven, "the output is not at zero"


@contextmanager
def _ends_within(seconds: float):
    def hangs(*_: object) -> None:
        raise TimeoutError("the acquisition hangs")

    before = signal.signal(signal.SIGALRM, hangs)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
