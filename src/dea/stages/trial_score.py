"""Open the seals of a campaign, after all verdicts exist, and score."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trial_score(
    settings: Mapping[str, Any],
    commitment: list[Path],
    sealed: list[Path],
    verdicts: list[Path],
    scores: Path,
) -> None:
    """Write the scores of all batches; a batch's files stand at the same place of each list.

    ``settings`` holds the name of the ``set`` of trials and its ``seed``.
    """
    import json

    from dea import store, trials
    from dea.discrepancy import read_verdict
    from dea.plant import Trial
    from dea.simulation import catalogue

    family = {name: str(effect.family) for name, effect in catalogue().items()}
    labels, said = {}, {}
    for committed, labels_of, verdicts_of in zip(commitment, sealed, verdicts, strict=True):
        rankings = json.loads((verdicts_of / "rankings.json").read_text())
        for name, trial in json.loads(committed.read_text()).items():
            file = labels_of / f"{name}.json"
            trials.open_seal(file, trial["sha256"])
            label = Trial.read(file).label()
            labels[name] = trials.Label(
                effects=frozenset(effect["name"] for effect in label["effects"]),
                outside=any(effect["name"] not in family for effect in label["effects"]),
                strength=label["strength"],
                excitation=label["excitation"],
            )
            verdict = read_verdict(verdicts_of / f"{name}.json")
            rivals = verdict.effects[0].rivals if verdict.effects else ()
            said[name] = trials.Said(
                status=verdict.status,
                effects=frozenset(verdict.names),
                rivals=tuple(frozenset(rival) for rival in rivals),
                ranking=tuple((frozenset(r["effects"]), r["error"]) for r in rankings[name]),
                error_before=verdict.certified["rmse_before"],
                error_after=verdict.certified["rmse_after"],
                noise_floor=verdict.noise_floor,
            )
    store.write(
        trials.scores(labels, said, family).assign_attrs(contract="scores"),
        scores,
        title=f"Blind trials: {settings['set']} set",
        inputs={f"commitment_{file.parent.name}": file for file in commitment},
        settings=settings,
        seed=settings["seed"],
    )


if __name__ == "__main__":
    run(
        trial_score,
        inputs=("commitment*", "sealed*", "verdicts*"),
        outputs=("scores",),
    )
