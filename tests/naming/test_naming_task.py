"""The record that methods are given, and the runs that are compared with it."""

from dataclasses import replace

import numpy as np
from made_tasks import RATE, excitation, pose

from dea.discrepancy.fitting.fit import at
from dea.store import Record


def test_a_dense_record_is_not_decimated_and_runs_are_at_its_own_rate():
    u = excitation(13_000)
    y = u + 1e-3 * np.random.default_rng(2).standard_normal(u.size)
    task = pose(Record.of(u, y, RATE, units=("V", "mm"))).task
    assert task.problem.size == task.seen.size == 10_400

    # A diagnosis decimates it, and takes its input for smooth.
    bare = task._prepared[1]
    smooth = replace(bare, interpolation="smooth")
    found = at(task.problem, smooth, np.zeros(smooth.layout.free.size))
    expected = bare.simulate(found.values, u, 1.0 / RATE)
    np.testing.assert_array_equal(task.simulated(found), expected)
