"""Draw a batch of blind trials, seal what each hides, and commit to it in public."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trial_draw(settings: Mapping[str, Any], bench: Path, sealed: Path, commitment: Path) -> None:
    """Write ``sealed/NNNN.json`` for each trial and the commitment to all of them.

    ``settings`` holds the campaign's ``seed`` and the numbers of the ``first`` and ``last`` trial.
    The commitment names what an acquisition may know, the excitation, and the SHA-256 of the
    sealed file. The sealed file holds sizes to the last digit, so that nobody can find it
    by trying likely contents against the hash.
    """
    import json

    from dea import store
    from dea.plant import draw_trial

    sealed.mkdir(parents=True)
    committed = {}
    for index in range(settings["first"], settings["last"] + 1):
        trial = draw_trial(bench, settings["seed"], index)
        file = sealed / f"{trial.name}.json"
        trial.write(file)
        committed[trial.name] = {"excitation": trial.excitation, "sha256": store.sha256(file)}
    with store.atomic(commitment) as partial:
        partial.write_text(json.dumps(committed, indent=2) + "\n")


if __name__ == "__main__":
    run(trial_draw, inputs=("bench",), outputs=("sealed", "commitment"))
