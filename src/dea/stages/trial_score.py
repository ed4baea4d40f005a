"""Open the seals of a campaign, after all verdicts exist, and score."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dea.stages.command import run

if TYPE_CHECKING:
    from dea import trials
    from dea.plant import Trial


def trial_score(
    settings: Mapping[str, Any],
    commitment: list[Path],
    sealed: list[Path],
    records: list[Path],
    truth: list[Path],
    log_truth: list[Path],
    verdicts: list[Path],
    scores: Path,
) -> None:
    """Write the scores of all batches; a batch's files stand at the same place of each list.

    ``settings`` holds the name of the ``set`` of trials and its ``seed``.
    """
    import json

    from dea import store, trials
    from dea.plant import Trial
    from dea.simulation import catalogue

    family = {name: str(effect.family) for name, effect in catalogue().items()}
    labels, said = {}, {}
    batches = zip(commitment, sealed, records, truth, log_truth, verdicts, strict=True)
    for committed, labels_of, records_of, truth_of, log_truth_of, verdicts_of in batches:
        rankings = json.loads((verdicts_of / "rankings.json").read_text())
        for name, public in json.loads(committed.read_text()).items():
            file = labels_of / f"{name}.json"
            trials.open_seal(file, public["sha256"])
            trial = Trial.read(file)
            first, start = begun(trial, records_of)
            true = (truth_of if trial.device == "film" else log_truth_of) / f"{name}.npy"
            labels[name] = trials.Label.of(trial.label(), start)
            said[name] = _said(trial, verdicts_of, rankings[name], true, first)
    store.write(
        trials.scores(labels, said, family).assign_attrs(contract="scores"),
        scores,
        title=f"Blind trials: {settings['set']} set",
        inputs={f"commitment_{file.parent.name}": file for file in commitment},
        settings=settings,
        seed=settings["seed"],
    )


def begun(trial: "Trial", records: Path) -> tuple[int, float]:
    """Return where a trial's record begins in its truth, and when on the clock of its laws (s).

    The truth of a film begins with its plant; that of a device that is logged begins with the
    record, when the plant has settled.
    """
    from dea import store

    if trial.device != "film":
        return 0, trial.kind.settling
    first = int(store.read(records / f"{trial.name}.nc")["device_index"][0])
    return first, first / trial.sampling_rate


def _said(
    trial: "Trial", verdicts: Path, ranking: list[dict[str, Any]], truth: Path, first: int
) -> "trials.Said":
    """Return the verdict on a trial; its record begins at reading ``first`` of ``truth``."""
    import numpy as np

    from dea import store, trials
    from dea.discrepancy import read_verdict

    verdict = read_verdict(verdicts / f"{trial.name}.json")
    certificate = store.read(verdicts / f"{trial.name}.nc")
    certified = certificate["role"].values == store.Role.CERTIFY
    samples = np.rint(certificate["time"].values * trial.sampling_rate).astype(int)[certified]
    wrong = certificate["extended"].values[certified] - np.load(truth)[first + samples]
    return trials.Said(
        status=verdict.status,
        effects=trials.effect_set(verdict.names),
        rivals=tuple(trials.effect_set(rival) for rival in verdict.rivals),
        ranking=tuple((trials.effect_set(one["effects"]), one["error"]) for one in ranking),
        error_before=verdict.certified["rmse_before"],
        error_after=verdict.certified["rmse_after"],
        noise_floor=verdict.noise_floor,
        whole=bool(verdict.whole),
        truth_error=float(np.sqrt(np.mean(wrong**2))) / trial.label()["noise_rms"],
        intervals={
            (effect.name, parameter): (estimate.low, estimate.high)
            for effect in verdict.effects
            for parameter, estimate in effect.parameters.items()
        },
    )


if __name__ == "__main__":
    run(
        trial_score,
        inputs=("commitment*", "sealed*", "records*", "truth*", "log_truth*", "verdicts*"),
        outputs=("scores",),
    )
