"""All cells of a campaign, each some records of one plant with one input and one noise."""

import itertools
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from benchmarks.bars import progress_bars
from benchmarks.coverage.judged import TRACKERS, Judged, judge, judge_track
from benchmarks.coverage.plants import plants
from benchmarks.coverage.records import INPUTS, NOISES, generators, records

_Job = TypeVar("_Job")
_Done = TypeVar("_Done")
ESTIMATES = ("refined", "least squares")
DRIFTS = ("random walk", "ramp")
BATCH = 10  # records of one job


@dataclass(frozen=True)
class Cell:
    """One combination that is counted by itself."""

    plant: str
    kind: str  # of the input
    noise: str
    estimate: str  # refined, least squares, or a tracker
    drifting: str = ""

    @property
    def name(self) -> str:
        """What the records follow from: estimates of one cell see the same ones."""
        return f"{self.plant} {self.kind} {self.noise} {self.drifting}"


@dataclass(frozen=True)
class Settings:
    """How much of what is done."""

    count: int = 100  # records of a cell
    samples: int = 4000
    seed: int = 1
    cores: int = 1
    plants: Sequence[str] = ("DEA1", "DEA3", "DEA5", "wei_billings", "two_poles")
    drifting: Sequence[str] = ("DEA2", "two_poles")


@dataclass(frozen=True)
class Counted:
    """A cell, with the points of each quantity inside (records, points) and what was withheld."""

    cell: Cell
    inside: dict[str, np.ndarray]
    withheld: float  # share of the records
    reason: str  # one of those given


def cells(settings: Settings) -> list[Cell]:
    """Return every cell."""
    still = itertools.product(settings.plants, INPUTS, NOISES, ESTIMATES)
    moving = itertools.product(settings.drifting, INPUTS, NOISES, TRACKERS, DRIFTS)
    return [Cell(*cell) for cell in itertools.chain(still, moving)]


def run(settings: Settings) -> list[Counted]:
    """Judge every cell; the result does not depend on the number of cores."""
    wanted = cells(settings)
    jobs = [
        (cell, range(first, min(first + BATCH, settings.count)))
        for cell in wanted
        for first in range(0, settings.count, BATCH)
    ]
    arguments = [(cell, numbers, settings.samples, settings.seed) for cell, numbers in jobs]
    done = each_done(_batch, arguments, settings.cores, "batches of records")
    found: dict[Cell, list[Judged]] = {cell: [] for cell in wanted}
    for (cell, _), judged in zip(jobs, done, strict=True):
        found[cell] += judged
    return [counted(cell, judged) for cell, judged in found.items()]


def each_done(
    function: Callable[[_Job], _Done], jobs: Sequence[_Job], cores: int, description: str
) -> list[_Done]:
    """Return what a function makes of each job, in their order, on several processes at a time."""
    with ExitStack() as stack:
        progress = stack.enter_context(progress_bars())
        done: Iterator[_Done] = map(function, jobs)
        if cores > 1:
            pool = stack.enter_context(ProcessPoolExecutor(cores))
            done = pool.map(function, jobs)
        return list(progress.track(done, total=len(jobs), description=description))


def _batch(arguments: tuple[Cell, range, int, int]) -> list[Judged]:
    cell, numbers, samples, seed = arguments
    plant = plants()[cell.plant]
    drawn = generators(seed, cell.name, numbers)
    made = records(plant, cell.kind, cell.noise, samples, drawn, cell.drifting)
    if made.parameters is not None:
        each = zip(made.u, made.y, made.clean, made.parameters, strict=True)
        return [judge_track(plant, cell.kind, *record, cell.estimate) for record in each]
    refined = cell.estimate == "refined"
    return [judge(plant, cell.kind, u, y, refined) for u, y in zip(made.u, made.y, strict=True)]


def counted(cell: Cell, judged: list[Judged]) -> Counted:
    reasons = [one.withheld for one in judged if one.withheld]
    inside = {
        quantity: np.stack([one.inside[quantity] for one in judged])
        for quantity in judged[0].inside
    }
    return Counted(cell, inside, len(reasons) / len(judged), reasons[0] if reasons else "")
