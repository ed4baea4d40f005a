"""Named faults, one at a time, at every stage of an acquisition."""

import zlib
from dataclasses import replace

import numpy as np
import pytest
from fault_proxy import FAULTS, TIMEOUT, Fault
from faulty_run import SETTINGS, broken_record, check, run_with_faults

from dea.acquisition import BrokenRecordError, Quality, ZeroNotVerifiedError
from dea.modbus import read_device
from served_bench import DESCRIPTION

pytestmark = pytest.mark.faults

EXCHANGES = 33  # of a buffered acquisition: 18 to check and claim, 10 for blocks, 5 to stop
PATIENTLY_POLLED = replace(SETTINGS, mode="polled", timeout=0.5)  # where nothing is repeated
REPAIRED = [kind for kind in FAULTS if kind not in ("restart", "garble")]


@pytest.mark.parametrize("way", ["request", "reply"])
@pytest.mark.parametrize("kind", REPAIRED)
def test_one_fault_costs_no_sample(serve_bench, tmp_path, kind, way):
    first = zlib.crc32(f"{kind} {way}".encode()) % 6
    for number in range(first, EXCHANGES, 6):
        bench = serve_bench(watchdog_time=1.0)
        run = run_with_faults(bench, [Fault(way, number, kind)], tmp_path)
        check(run)
        assert [fault.kind for fault in run.happened] == [kind]
        assert run.failure is None, (number, run.failure)
        assert bench.player.watchdog.trips == 0


@pytest.mark.parametrize("way", ["request", "reply"])
def test_a_connection_cut_at_every_second_frame_plays_every_block_once(serve_bench, tmp_path, way):
    bench = serve_bench(watchdog_time=1.0)
    faults = [Fault(way, number, "cut after") for number in range(3, 200, 3)]
    run = run_with_faults(bench, faults, tmp_path)
    check(run)
    assert run.failure is None
    assert len(run.happened) > 10
    assert np.array_equal(bench.applied[: run.sequence.size], run.sequence)
    assert not bench.applied[run.sequence.size :].any()


@pytest.mark.parametrize("way", ["request", "reply"])
def test_a_block_garbled_anywhere_is_noticed_and_sent_again(serve_bench, tmp_path, way):
    for place in range(8, 256, 31):  # the length of a block's request and reply, in bytes
        bench = serve_bench(watchdog_time=1.0)
        run = run_with_faults(bench, [Fault(way, 1, "garble", place / 256, driven=True)], tmp_path)
        check(run)
        assert len(run.happened) == 1
        assert run.failure is None


def test_a_device_restarted_while_it_plays_breaks_the_record(serve_bench, tmp_path):
    run = run_with_faults(
        serve_bench(watchdog_time=1.0), [Fault("request", 4, "restart", driven=True)], tmp_path
    )
    check(run)
    assert isinstance(run.failure, BrokenRecordError)
    assert "has been restarted" in str(run.failure)


def test_a_restart_before_the_first_block_is_taken_loses_nothing_unnoticed(serve_bench, tmp_path):
    restarted = []
    for number in range(16, 26):  # about where the host asks for the first index and sends block 1
        bench = serve_bench(
            watchdog_time=1.0, virtual_clock=False, sampling_rate=500.0,
            fifo_length=128, ring_length=256,
        )  # fmt: skip
        run = run_with_faults(bench, [Fault("request", number, "restart")], tmp_path)
        check(run)
        assert len(run.happened) == 1
        restarted.append(bench.boots())
    assert any(not boots[0][0].any() for boots in restarted)  # before a block was played


def test_a_device_restarted_is_driven_again_from_the_start_where_so_configured(
    serve_bench, tmp_path
):
    bench = serve_bench(watchdog_time=1.0)
    settings = replace(SETTINGS, on_break="restart")
    run = run_with_faults(bench, [Fault("request", 4, "restart", driven=True)], tmp_path, settings)
    check(run)
    assert run.record is not None
    assert not run.record.quality.any()
    assert np.array_equal(bench.boots()[-1][0][: run.sequence.size], run.sequence)


def outlast(seconds):
    """A freeze of that many seconds while blocks are played."""
    return Fault("reply", 4, "freeze", seconds / (8 * TIMEOUT), driven=True)


def test_a_host_cut_off_longer_than_the_watchdog_waits_finds_the_film_undriven(
    serve_bench, tmp_path
):
    bench = serve_bench(watchdog_time=0.2, virtual_clock=False, sampling_rate=200.0)
    run = run_with_faults(bench, [outlast(0.5)], tmp_path)
    check(run)
    assert isinstance(run.failure, BrokenRecordError)
    assert "undriven" in str(run.failure)
    assert bench.player.watchdog.latched
    assert bench.player.watchdog.trips == 1


def test_samples_that_the_device_held_are_flagged_and_none_is_lost(serve_bench, tmp_path):
    bench = serve_bench(
        watchdog_time=1.0, virtual_clock=False, sampling_rate=500.0, fifo_length=128
    )
    run = run_with_faults(bench, [outlast(0.5)], tmp_path)
    check(run)
    assert run.failure is None
    assert bench.player.underruns > 50
    assert np.count_nonzero(run.samples.quality == Quality.HELD) == bench.player.underruns


def test_samples_that_the_device_overwrote_are_named(serve_bench, tmp_path):
    bench = serve_bench(
        watchdog_time=1.0, virtual_clock=False, sampling_rate=500.0,
        fifo_length=128, ring_length=128,
    )  # fmt: skip
    run = run_with_faults(bench, [outlast(0.6)], tmp_path)
    check(run)
    assert isinstance(run.failure, BrokenRecordError)
    assert "overwritten" in str(run.failure)
    lost = run.samples.position[run.samples.quality == Quality.LOST]
    assert lost[0] == run.failure.first
    assert bench.player.overruns > 0


@pytest.mark.parametrize("kind", ["cut after", "lose", "half-open", "wrong transaction"])
def test_a_polled_sample_without_its_reply_is_named(serve_bench, tmp_path, kind):
    bench = serve_bench(watchdog_time=1.0)
    run = run_with_faults(
        bench, [Fault("request", 70, kind, driven=True)], tmp_path, PATIENTLY_POLLED
    )
    check(run)
    assert isinstance(run.failure, BrokenRecordError)
    assert run.samples.quality[-1] == Quality.LOST
    assert 30 < run.failure.first <= 71


@pytest.mark.parametrize("mode", ["buffered", "polled"])
def test_a_connection_that_never_comes_back_names_what_is_missing(serve_bench, tmp_path, mode):
    bench = serve_bench(watchdog_time=1.0)
    faults = [Fault("request", number, "lose", driven=True) for number in range(4, 42)]
    run = run_with_faults(bench, faults, tmp_path, replace(SETTINGS, mode=mode))
    check(run)
    assert isinstance(run.failure, ZeroNotVerifiedError)
    assert "never driven or read" in str(broken_record(run.failure))
    assert bench.player.watchdog.latched


@pytest.mark.parametrize("kind", ["duplicate", "garble", "truncate", "cut after", "split"])
def test_rtu_over_tcp_is_repaired_though_it_numbers_nothing(serve_bench, tmp_path, kind):
    for number in range(0, 30, 4):
        rtu = replace(read_device(DESCRIPTION), framing="rtu_over_tcp")
        bench = serve_bench(watchdog_time=1.0, description=rtu)
        run = run_with_faults(bench, [Fault("reply", number, kind, amount=0.4)], tmp_path)
        check(run)
        assert run.failure is None, (number, run.failure)


@pytest.mark.parametrize("kind", ["garble", "truncate"])
def test_a_garbled_polled_sample_is_named_where_frames_have_a_checksum(serve_bench, tmp_path, kind):
    rtu = replace(read_device(DESCRIPTION), framing="rtu_over_tcp")
    bench = serve_bench(watchdog_time=1.0, description=rtu)
    run = run_with_faults(bench, [Fault("reply", 100, kind)], tmp_path, PATIENTLY_POLLED)
    check(run)
    assert isinstance(run.failure, BrokenRecordError)
    assert 0 < run.failure.first < 100
