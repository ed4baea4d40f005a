"""Name what a simulation is missing, from a record of the device it describes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from dea.discrepancy.choose import best_extension, proven_alone
from dea.discrepancy.decision import Decision, Evidence, Rules, confirmed, decide
from dea.discrepancy.evidence import certificate as proof
from dea.discrepancy.evidence.confusion import confusion
from dea.discrepancy.evidence.experiment import Experiment, separating_experiment
from dea.discrepancy.evidence.gain import Gains, HeldOut, gains, null_gain
from dea.discrepancy.evidence.identifiability import signature
from dea.discrepancy.evidence.localisation import Localisation, localise
from dea.discrepancy.evidence.noise import white_level
from dea.discrepancy.evidence.residual_model import ResidualModel, residual_model
from dea.discrepancy.evidence.split import Split, split
from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem
from dea.discrepancy.report.sentence import verdict_of
from dea.discrepancy.search.rounds import Budget, Candidate, Round
from dea.discrepancy.search.screening import in_parallel
from dea.discrepancy.search.search import Search, noise_floor, pool_of
from dea.discrepancy.search.starts import bases, fit_near_prior, fit_nominal
from dea.errors import InputError
from dea.seeds import generator
from dea.simulation import (
    Effect,
    ExtendedSimulation,
    Simulation,
    catalogue,
    load_simulation,
    prepared,
    slowest_time,
)

if TYPE_CHECKING:
    import xarray as xr

    from dea.discrepancy.report.verdict import Verdict

_BLOCKS = 48
_NOISE_MARGIN = 1.5
# Error of integration, in noise deviations; the refit takes up most of it.
_STEP_ERROR = 0.5
# The same, as a part of the output's deviation: no simulation is that good.
_RELATIVE_ERROR = 1e-3
# Times that the steps of the simulation alone may be cut for an effect; laws with corners would
# never have enough.
_SHORTER = 4


@dataclass(frozen=True)
class Settings:
    """How a diagnosis is made.

    Parameters
    ----------
    effects
        Names of the effects offered; all of the catalogue if empty.
    slowest_time
        Slowest time constant (s) for the gaps of the split; the simulation's own if ``None``.
    warm_up
        Time (s) at the start of the record that no error counts; at most a fiftieth of it.
    workers
        Threads that candidates are fitted on.
    """

    effects: tuple[str, ...] = ()
    slowest_time: float | None = None
    warm_up: float = 1.0
    workers: int = 1
    budget: Budget = field(default_factory=Budget)
    rules: Rules = field(default_factory=Rules)
    seed: int = 0
    name: str = "case"

    @classmethod
    def of(cls, leaves: Mapping[str, Any]) -> "Settings":
        """Return the settings that the config's ``discrepancy`` and a case's ``split`` hold."""
        own, parts = leaves["discrepancy"], leaves.get("split", {})
        return cls(
            effects=tuple(own["effects"]),
            slowest_time=parts.get("slowest_time"),
            warm_up=parts.get("warm_up", own["warm_up"]),
            budget=Budget(**own["budget"]),
            rules=Rules(**own["rules"]),
            seed=leaves["seed"],
            name=leaves["system"],
        )


@dataclass(frozen=True)
class Diagnosis:
    """Everything a diagnosis found; ``verdict`` is the short of it."""

    verdict: "Verdict"
    problem: Problem
    split: Split
    units: tuple[str, str]
    nominal: Fit
    extended: Fit
    before: Localisation
    after: Localisation
    first: Round
    gains: Gains
    pool: tuple[Candidate, ...]
    decision: Decision
    confusion_of: tuple[Candidate, ...]
    confusion: np.ndarray
    elsewhere: Mapping[str, tuple[proof.Certified, np.ndarray, np.ndarray]]
    floor: float
    unexplained: ResidualModel
    signatures: Mapping[str, tuple[float, float]]


def diagnose(
    record: "xr.Dataset",
    simulation: Simulation | str,
    *,
    test_records: "Mapping[str, xr.Dataset] | None" = None,
    settings: Settings | None = None,
) -> Diagnosis:
    """Compare a record with a simulation and name the effect, or effects, that are missing.

    Parameters
    ----------
    record
        Time (s), voltage and displacement, or input and output, in the simulation's units.
    simulation
        A simulation, the name of one that comes with the study, or a Python file.
    test_records
        Records of the same device under other excitations, to certify on.

    Raises
    ------
    InputError
        If units do not match, the record is too short for the split, or the simulation runs away.
    """
    settings = settings or Settings()
    own = simulation if isinstance(simulation, Simulation) else load_simulation(simulation)
    rng = generator(settings.seed, settings.name, "diagnose")
    u, y, interval = signals_of(record, own)
    others = {
        name: proof.OtherRecord(*signals_of(other, own))
        for name, other in (test_records or {}).items()
    }
    units = (own.input_unit, own.output_unit)
    offered = _offered(settings.effects)

    budget = settings.budget.of(u.size)
    problem, parts, extended = _prepare(u, y, interval, own, settings)
    nominal = fit_nominal(problem, extended, budget.starts, rng, settings.workers)
    near = fit_near_prior(problem, nominal)
    # Blocks much shorter than the device's memory would pass for more evidence than they are.
    length = max(problem.u.size / _BLOCKS, parts.gap)
    blocks = parts.blocks(problem.seen, length)

    starts = bases(problem, nominal, near, rng)
    rounds = Search(problem, starts, offered, budget, settings.rules, settings.workers).rounds()
    floor = noise_floor(rounds, parts.blocks(problem.seen, max(problem.u.size / 8, 64)))
    singles = list(rounds[0].candidates)
    if not singles:
        raise InputError(
            "none of the effects offered can attach to this simulation and stay stable",
            file=own.source or f"simulation {own.name}",
            field="force_ports",
            remedy="Declare its force ports, or offer effects of other ports",
        )
    null = null_gain(
        problem, nominal, [c.fit for c in singles], singles[0].fit.residual, blocks, rng
    )
    held_out = HeldOut(problem)
    after = in_parallel(
        lambda c: held_out.residual(c.fit) if c.finished else c.fit.residual,
        singles,
        settings.workers,
    )
    gained = gains(held_out.residual(nominal), after, blocks, null, rng)
    evidence = Evidence(
        problem, held_out, blocks, problem.seen_rmse(nominal.residual), floor, own.accuracy,
        settings.rules, rng,
    )  # fmt: skip
    proven = proven_alone(rounds, gained, settings.rules)
    chosen = best_extension(evidence, rounds, proven)
    pool = pool_of(rounds)
    unexplained = residual_model(problem, (chosen.fit if chosen else nominal).residual)
    decision = confirmed(decide(evidence, chosen, pool, proven, unexplained), evidence, nominal)
    answer = decision.chosen if decision.status in ("named", "ambiguous") else None
    final = answer.fit if answer else nominal

    where_before = localise(problem, near.residual, units, problem.seen, rng)
    where_after = localise(problem, final.residual, units, problem.seen, rng)
    rivals = _rivals_to_show(decision, pool)
    noisy = problem.with_noise(evidence.floor)
    experiment = _experiment(noisy, decision, settings.seed)
    elsewhere = proof.certify_elsewhere(
        others if proof.transferable(final.extended) else {}, nominal, final
    )
    signatures = {"+".join(c.labels): signature(noisy, nominal, c.fit) for c in singles}
    verdict = verdict_of(
        problem=problem, nominal=nominal, decision=decision, first=rounds[0], gained=gained,
        held_out=held_out, before=where_before, after=where_after, floor=floor,
        unexplained=unexplained, experiment=experiment,
        signatures=signatures, elsewhere={name: e[0] for name, e in elsewhere.items()},
        unit=own.output_unit, blocks=blocks, rng=rng,
    )  # fmt: skip
    return Diagnosis(
        verdict=verdict, problem=noisy, split=parts, units=units, nominal=nominal, extended=final,
        before=where_before, after=where_after, first=rounds[0], gains=gained, pool=tuple(pool),
        decision=decision, confusion_of=rivals,
        confusion=confusion(noisy, [c.fit for c in rivals]), elsewhere=elsewhere, floor=floor,
        unexplained=unexplained, signatures=signatures,
    )  # fmt: skip


def signals_of(
    record: "xr.Dataset", simulation: Simulation
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return input, output and interval (s) of a record whose units are the simulation's."""
    from dea.store import signals

    found = signals(record)
    for role, unit, expected in (
        ("input", found.u_units, simulation.input_unit),
        ("output", found.y_units, simulation.output_unit),
    ):
        if unit != expected:
            raise InputError(
                f"the record's {role} is in {unit!r}, the simulation {simulation.name} "
                f"expects {expected!r}",
                field=role,
                remedy="Convert the record, or use a simulation in its units",
            )
    return found.u, found.y, 1.0 / found.sampling_rate


def _offered(names: Sequence[str]) -> list[Effect]:
    unknown = sorted(set(names) - set(catalogue()))
    if unknown:
        raise InputError(
            f"there is no effect {unknown[0]!r}",
            field="effects",
            remedy=f"Known are {', '.join(catalogue())}",
        )
    return [effect for name, effect in catalogue().items() if not names or name in names]


def _prepare(
    u: np.ndarray, y: np.ndarray, interval: float, simulation: Simulation, settings: Settings
) -> tuple[Problem, Split, ExtendedSimulation]:
    """Split the record, estimate its noise, and choose the integration step to match."""
    noise = white_level(y, [slice(0, y.size)])
    tolerance = max(_STEP_ERROR * noise, _RELATIVE_ERROR * float(np.std(y)))
    extended = prepared(simulation, u, interval, tolerance)
    slowest = settings.slowest_time
    if slowest is None:
        slowest = slowest_time(extended, u)
    parts = split(u, interval, slowest, min(settings.warm_up, 0.02 * u.size * interval))
    problem = Problem(
        u, y, interval, parts.fit, parts.select, parts.certify, _NOISE_MARGIN * noise, tolerance,
        _SHORTER * extended.substeps,
    )  # fmt: skip
    return problem, parts, extended


def _rivals_to_show(
    decision: Decision, pool: Sequence[Candidate], most: int = 8
) -> tuple[Candidate, ...]:
    """Return the finished candidates of as many effects as the chosen one, best first."""
    count = len(decision.chosen.names) if decision.chosen else 1
    shown: dict[frozenset[str], Candidate] = {}
    for c in pool:
        if c.finished and len(c.names) == count:
            shown.setdefault(frozenset(c.names), c)
    return tuple(shown.values())[:most]


def _experiment(problem: Problem, decision: Decision, seed: int) -> Experiment | None:
    if decision.status != "ambiguous" or decision.chosen is None:
        return None
    return separating_experiment(problem, decision.chosen.fit, decision.rivals[0].fit, seed)
