"""Draw a batch of blind trials, seal what each hides, and commit to it in public."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trial_draw(settings: Mapping[str, Any], sealed: Path, commitment: Path) -> None:
    """Write ``sealed/NNNN.json`` for each trial and the commitment to all of them.

    ``settings`` holds the ``set`` of trials, its ``seed``, the numbers of the ``first`` and
    ``last`` trial, and the ``bench``. Sets for tuning hide forms for tuning, the others forms for
    reporting. The commitment names what an acquisition and a diagnosis may know (device, its
    simulation and the excitation) and the SHA-256 of the sealed file. The sealed file holds sizes
    to the last digit, so that nobody can find it by trying likely contents against the hash.
    """
    import json

    from dea import store
    from dea.plant import TRIAL_SETS, draw_trial
    from dea.stages.bench_process import plain_as_planned

    bench = plain_as_planned(settings["bench"])
    sealed.mkdir(parents=True)
    committed = {}
    use, ambiguous = TRIAL_SETS[settings["set"]]
    for index in range(settings["first"], settings["last"] + 1):
        trial = draw_trial(bench, settings["seed"], index, use, ambiguous=ambiguous)
        file = sealed / f"{trial.name}.json"
        trial.write(file)
        committed[trial.name] = {
            "device": trial.device,
            "simulation": trial.kind.simulation,
            "excitation": trial.excitation,
            "sha256": store.sha256(file),
        }
    with store.atomic(commitment) as partial:
        partial.write_text(json.dumps(committed, indent=2) + "\n")


if __name__ == "__main__":
    run(trial_draw, outputs=("sealed", "commitment"))
