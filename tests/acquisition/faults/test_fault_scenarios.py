"""Named faults, one at a time, at every stage of an acquisition."""

import time
import zlib

import numpy as np
import pytest
from fault_proxy import FAULTS, Fault
from fault_trial import SETTINGS, check, run_trial

from dea.acquisition import BrokenRecordError, Quality, ZeroNotVerifiedError

pytestmark = pytest.mark.faults

EXCHANGES = 33  # of a buffered acquisition: 18 to check and claim, 10 for blocks, 5 to stop
REPAIRED = [kind for kind in FAULTS if kind not in ("restart", "garble")]


@pytest.mark.parametrize("way", ["request", "reply"])
@pytest.mark.parametrize("kind", REPAIRED)
def test_one_fault_costs_no_sample(serve_bench, tmp_path, kind, way):
    first = zlib.crc32(f"{kind} {way}".encode()) % 6
    for number in range(first, EXCHANGES, 6):
        bench = serve_bench(watchdog_time=1.0)
        trial = run_trial(bench, [Fault(way, number, kind)], tmp_path)
        check(trial)
        assert [fault.kind for fault in trial.happened] == [kind]
        assert trial.failure is None, (number, trial.failure)
        assert bench.player.trips == 0
