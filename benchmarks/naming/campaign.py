"""Every method on every trial and record; what is answered already is not answered again."""

import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cache, partial
from itertools import count
from math import nan
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.bars import progress_bars
from benchmarks.naming import measured, trials
from benchmarks.naming.code import digest, import_graph, imported
from benchmarks.naming.methods import methods
from benchmarks.naming.task import Posed
from benchmarks.stored import commit
from dea import store
from dea.errors import InputError
from dea.trials import Label

# What every answer may depend on, besides what is imported: effects and devices are found by name.
_SHARED = (
    "benchmarks/naming/campaign.py", "config/config.yaml", "config/simulations/*.py",
    "src/dea/simulation/**/*.py",
)  # fmt: skip
# Trials that are drawn at once, at least.
_AT_ONCE = 4


@dataclass(frozen=True)
class Settings:
    """Which trials, and how many.

    Parameters
    ----------
    count
        Trials, the first ones drawn whose records hold no more than ``longest`` samples.
    keep
        Folder of what is drawn and answered.
    """

    of_set: str
    seed: int
    count: int
    longest: int
    cores: int
    keep: Path


class Said(NamedTuple):
    """What a method said of a task, as it is kept.

    ``error`` is that of its prediction of what was kept back, in the output's unit; ``seconds``
    are of a processor. ``failed`` says why there is no answer, ``commit`` whence the program was.
    """

    status: str
    effects: frozenset[str]
    rivals: tuple[frozenset[str], ...]
    error: float
    seconds: float
    failed: str = ""
    commit: str = ""


class Tried(NamedTuple):
    """A trial or record: what was missing, and what each method said, by name."""

    name: str
    label: Label
    said: dict[str, Said]


def of_trials(settings: Settings) -> list[Tried]:
    """Draw the trials, let every method answer, and then open the seals."""
    with ExitStack() as stack:
        work = _workers(stack, settings.cores)
        drawn = _drawn(settings, work)
        files = list(work("records", trials.acquired, drawn))
        folders = [each.folder for each in drawn]
        said = list(work("trials answered", _on_trial, list(zip(folders, files, strict=True))))
    return [
        Tried(each.name, trials.label(each), answers)
        for each, answers in zip(drawn, said, strict=True)
    ]


def of_records(names: Sequence[str], keep: Path, cores: int) -> list[Tried]:
    """Let every method answer on these public records."""
    with ExitStack() as stack:
        work = _workers(stack, cores)
        said = list(work("records answered", partial(_on_record, keep), list(names)))
    return [
        Tried(name, measured.label(name), answers)
        for name, answers in zip(names, said, strict=True)
    ]


Work = Callable[[str, Callable[[Any], Any], list[Any]], Iterator[Any]]


def _workers(stack: ExitStack, cores: int) -> Work:
    """Return what does a task on each of many items in order, on so many cores, with a bar."""
    import_graph()  # for all workers: they are forked
    bars = stack.enter_context(progress_bars())
    each = stack.enter_context(ProcessPoolExecutor(cores)).map if cores > 1 else map

    def work(what: str, task: Callable[[Any], Any], items: list[Any]) -> Iterator[Any]:
        return iter(bars.track(each(task, items), total=len(items), description=what))

    return work


def _drawn(settings: Settings, work: Work) -> list[trials.Drawn]:
    """Draw trials until enough of them have records that are short enough."""
    found: list[trials.Drawn] = []
    indices = count()
    while len(found) < settings.count:
        wanted = [next(indices) for _ in range(max(settings.count - len(found), _AT_ONCE))]
        more = work("trials drawn", partial(_draw, settings), wanted)
        found += [each for each in more if each.samples <= settings.longest]
    return found[: settings.count]


def _draw(settings: Settings, index: int) -> trials.Drawn:
    folder = settings.keep / f"{settings.of_set}-{settings.seed}" / f"{index:04d}"
    return trials.draw(folder, settings.of_set, settings.seed, index)


def _on_trial(place: tuple[Path, Path]) -> dict[str, Said]:
    folder, file = place
    return _answers(folder, partial(trials.posed, file), trials.FILES)


def _on_record(keep: Path, name: str) -> dict[str, Said]:
    return _answers(keep / "records" / name, partial(measured.posed, name), measured.files(name))


def _answers(folder: Path, pose: Callable[[], Posed], sources: frozenset[Path]) -> dict[str, Said]:
    """Return what is kept of each method, or its answer; ``sources`` are files of the task."""
    found, posed = {}, cache(pose)
    for name in methods():
        file, code = folder / "answers" / f"{name}.json", _code(name, sources)
        kept = json.loads(file.read_text()) if file.exists() else {}
        if kept.get("code") != code:
            kept = {"code": code, "commit": commit(), **_answer(name, posed())}
            file.parent.mkdir(exist_ok=True, parents=True)
            with store.atomic(file) as partial_file:
                partial_file.write_text(json.dumps(kept, indent=1) + "\n")
        found[name] = Said(
            kept["status"],
            frozenset(kept["effects"]),
            tuple(frozenset(rival) for rival in kept["rivals"]),
            kept["error"],
            kept["seconds"],
            kept["failed"],
            kept["commit"],
        )
    return found


def _answer(name: str, posed: Posed) -> dict[str, Any]:
    """Let a method answer."""
    task = posed.task
    try:
        answer, seconds = task.shared.timed(lambda: methods()[name].answer(task))
    except InputError as error:
        nothing = {"status": "unknown", "effects": [], "rivals": []}
        return nothing | {"error": nan, "seconds": nan, "failed": str(error)}
    return {
        "status": str(answer.status),
        "effects": sorted(answer.effects),
        "rivals": [sorted(rival) for rival in answer.rivals],
        "error": posed.error(answer.ahead),
        "seconds": seconds,
        "failed": "",
    }


def _code(name: str, sources: frozenset[Path]) -> str:
    """Return a digest of all that a method's answers may depend on."""
    return digest(_SHARED, imported(f"benchmarks.naming.methods.{name}", "dea.store") | sources)
