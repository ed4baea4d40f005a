"""A sample of mutants, each tested in a copy of the project; what was done is kept."""

import json
import random
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from difflib import unified_diff
from hashlib import sha256
from pathlib import Path
from queue import SimpleQueue

from rich.progress import Progress

from benchmarks.bars import progress_bars
from benchmarks.mutants.sites import Mutant, mutants
from benchmarks.mutants.suite import Selection, Suite, read_suite, select
from benchmarks.mutants.workplace import Workplace, tracked
from dea.errors import InputError

# Rooms whose mistakes spoil a result or a device, as files and folders of src/dea.
ROOMS = {
    "narx": ("narx",),
    "tracking": ("tracking",),
    "gfrf": ("gfrf",),
    "nonparametric": ("nonparametric",),
    "terms": ("terms.py",),
    "excitation": ("excitation.py",),
    "probing": ("probing.py",),
    "least_squares": ("least_squares.py",),
    "autoregression": ("autoregression.py",),
    "autocovariance": ("autocovariance.py",),
    "simulation": ("simulation",),
    "discrepancy": (
        *(f"discrepancy/{part}" for part in ("decision", "evidence", "search")),
        *(f"discrepancy/{part}.py" for part in ("decimation", "diagnose", "estimation", "events")),
        *(f"discrepancy/{part}.py" for part in ("fit", "parabola", "rules", "sensitivity")),
    ),
    "resolution": ("resolution",),
    "control": ("control",),
    "plant": ("plant",),
    "bench": ("bench",),
    "acquisition": ("acquisition",),
    "modbus": ("modbus",),
    "store": ("store",),
}
DISPLAY = {"panel.py"}  # what is shown while a record is made
# Status of pytest: 1 where a test failed, 2 to 4 where none could be run.
OUTCOMES = {0: "survived", 1: "killed", 2: "incompetent", 3: "incompetent", 4: "incompetent",
            5: "survived", None: "timeout"}  # fmt: skip
RUN = (0, 1)  # status of pytest where all tests could be run
# A mutant has its tests' time this often, and the seconds that a start and a compilation take.
PATIENCE, START = 4.0, 90.0
# After so many mutants the tests of one are run on the code as it is: they must pass.
MUTANTS_PER_CONTROL = 20


@dataclass(frozen=True)
class Campaign:
    """How many mutants of which rooms are tried, and how long on each."""

    root: Path
    folder: Path  # for the copies of the project and the times of its tests
    rooms: Sequence[str]
    count: int
    seed: int
    budget: float  # s of tests for each mutant
    workers: int


def sample(campaign: Campaign) -> list[tuple[str, Mutant]]:
    """Draw places evenly from all of the rooms, and one mutant at each; the same for one seed."""
    places = [
        (room, place)
        for room in campaign.rooms
        for file in _modules(campaign.root, room)
        for place in mutants(campaign.root, file)
    ]
    rng = random.Random(campaign.seed)
    rng.shuffle(places)
    drawn: list[tuple[str, Mutant]] = []
    for room, place in places:
        if len(drawn) == campaign.count:
            break
        mutant = rng.choice(place)
        if mutant.is_another_program((campaign.root / mutant.file).read_text()):
            drawn.append((room, mutant))
    return drawn


def run(campaign: Campaign, results: Path) -> list[dict[str, object]]:
    """Test the sample and return a row for each mutant; rows already in ``results`` are kept.

    A row holds while the mutated module and the tests it is put before are what they were.

    Raises
    ------
    InputError
        If there is nothing to change, or the suite cannot be run on the code as it is.
    """
    drawn = sample(campaign)
    if not drawn:
        rooms = ", ".join(campaign.rooms)
        raise InputError(
            "no place of these rooms can be changed", field=rooms, remedy="Name others"
        )
    known = _known(results)
    workplaces: SimpleQueue[Workplace] = SimpleQueue()
    copies = [
        Workplace(campaign.root, campaign.folder / str(number))
        for number in range(campaign.workers)
    ]
    with progress_bars() as progress:
        suite = _suite(campaign, copies[0], progress)
        for copy in copies:
            workplaces.put(copy)
        rows: list[dict[str, object]] = []
        bar = progress.add_task("mutants", total=len(drawn))
        with ThreadPoolExecutor(campaign.workers) as pool:
            tried = [
                pool.submit(_row, campaign, room, mutant, index, suite, known, workplaces)
                for index, (room, mutant) in enumerate(drawn)
            ]
            try:
                for done in as_completed(tried):
                    rows.append(done.result())
                    _keep(results, known, rows)
                    progress.advance(bar)
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                for copy in copies:
                    copy.stop()
                raise
    order = {mutant: index for index, (_, mutant) in enumerate(drawn)}
    rows.sort(key=lambda row: order[_mutant(row)])
    return rows


def _row(
    campaign: Campaign,
    room: str,
    mutant: Mutant,
    index: int,
    suite: Suite,
    known: dict[str, dict[str, object]],
    workplaces: "SimpleQueue[Workplace]",
) -> dict[str, object]:
    source = (campaign.root / mutant.file).read_text()
    chosen = select(mutant, source, room, suite, campaign.budget)
    key = mutant.key(sha256(source.encode()).hexdigest() + chosen.state)
    if key in known:
        return known[key]
    mutated = mutant.apply(source)
    workplace = workplaces.get()
    try:
        outcome = _outcome(workplace, mutant, mutated, chosen)
        control = None
        if index % MUTANTS_PER_CONTROL == 0:
            control = _outcome(workplace, mutant, source + "\n", chosen)
    finally:
        workplaces.put(workplace)
    lines = unified_diff(source.splitlines(), mutated.splitlines(), n=0, lineterm="")
    diff = [line.rstrip() for line in lines][3:]
    return {
        "key": key,
        "room": room,
        "outcome": outcome,
        "control": control,
        **asdict(mutant),
        "diff": diff,
        "tests": len(chosen.tests),
        "seconds": round(chosen.seconds, 1),
    }


def _outcome(workplace: Workplace, mutant: Mutant, mutated: str, chosen: Selection) -> str:
    if not chosen.tests:
        return "survived"
    timeout = START + PATIENCE * chosen.seconds
    return judged(workplace.test(mutant.file, mutated, chosen.tests, timeout))


def judged(status: int | None) -> str:
    """Return the outcome of a status of pytest; none is one that took too long.

    A signal ends the interpreter where compiled code leaves its arrays: it was noticed.
    """
    return "killed" if status is not None and status < 0 else OUTCOMES[status]


def _suite(campaign: Campaign, copy: Workplace, progress: Progress) -> Suite:
    """Return the tests, their times and the lines they run, from one run on the code as it is.

    So no mutant is blamed for a test that fails anyway. The run is kept for as long as all that the
    tests may run stays what it is.
    """
    kept = (campaign.folder / f"suite-{_state(campaign.root)[:16]}").resolve()
    report, ran = kept / "report.xml", kept / "ran.sqlite"
    if not report.exists():
        kept.mkdir(parents=True, exist_ok=True)
        bar = progress.add_task("the suite on the code as it is", total=None)
        made = report.with_suffix(".partial")
        status = copy.run_all(campaign.workers, made, ran)
        if made.exists():
            suite = read_suite(campaign.root, made, ran)
        if status not in RUN or not made.exists():
            remedy = f"See what it says in {copy.folder}."
            raise InputError(f"pytest ended with status {status}", field="suite", remedy=remedy)
        made.replace(report)
        progress.update(bar, total=1, completed=1)
        return suite
    return read_suite(campaign.root, report, ran)


def _state(root: Path) -> str:
    """Return a digest of the project's files but its pages, on which no test spends its time."""
    state = sha256()
    for name in tracked(root):
        if name.parts[0] != "docs" and name.suffix != ".md":
            state.update(f"{name}\0".encode() + (root / name).read_bytes())
    return state.hexdigest()


def _modules(root: Path, room: str) -> Iterator[Path]:
    for part in ROOMS[room]:
        path = root / "src" / "dea" / part
        found = sorted(path.rglob("*.py")) if path.is_dir() else [path] * path.exists()
        yield from (file for file in found if file.name not in DISPLAY)


def _mutant(row: dict[str, object]) -> Mutant:
    return Mutant(**{name: row[name] for name in Mutant.__dataclass_fields__})  # type: ignore[arg-type]


def _known(results: Path) -> dict[str, dict[str, object]]:
    if not results.exists():
        return {}
    return {row["key"]: row for row in json.loads(results.read_text())["tried"]}


def _keep(
    results: Path, known: dict[str, dict[str, object]], rows: Sequence[dict[str, object]]
) -> None:
    """Write what is known so far, whole or not at all."""
    tried = known | {str(row["key"]): row for row in rows}
    results.parent.mkdir(parents=True, exist_ok=True)
    partial = results.with_suffix(".partial")
    partial.write_text(json.dumps({"tried": list(tried.values())}, indent=1) + "\n")
    partial.replace(results)
