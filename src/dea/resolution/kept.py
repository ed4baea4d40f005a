"""Designs of records and what they have found, as files: what was made is not made again."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dea import archive, store
from dea.errors import InputError
from dea.resolution.design import Design
from dea.resolution.excitation import Limits
from dea.resolution.question import CERTIFICATE
from dea.resolution.rounds import ResolutionRound


@dataclass
class Kept:
    """Designs and findings in ``results/resolve/NAME/round_N/``; nothing there is made twice."""

    folder: Path
    first: Path
    limits: Limits

    def place(self, number: int) -> Path:
        """Return the folder of a designed record."""
        return self.folder / ("certificate" if number == CERTIFICATE else f"round_{number}")

    def file(self, number: int) -> Path:
        """Return the file of a designed record."""
        raise NotImplementedError

    def recorded(self, number: int) -> bool:
        """Return whether there is a record of the excitation that is kept."""
        raise NotImplementedError

    def design(self, number: int, make: Callable[[], Design | None]) -> Design | None:
        """Return the design that is kept, if it rests on the same record, or make it.

        One that has not been driven yet is made anew where today's limits forbid it.
        """
        file = self.place(number) / "design.json"
        kept = self.kept(number) if file.exists() else None
        if kept is not None and (self.recorded(number) or self.limits.allows(kept.u)):
            return kept
        made = make()
        if made is None:
            return None
        table = file.with_name("excitation.csv")
        # Else an end between the two writes leaves a design that is not that of its excitation.
        file.unlink(missing_ok=True)
        self.write_table(table, made.u)
        said = asdict(made) | {
            "first_record": store.sha256(self.first),
            "sha256": store.sha256(table),
        }
        del said["u"]
        _write_json(file, said)
        return self.kept(number)

    def kept(self, number: int) -> Design:
        """Return the design that is kept, if it rests on the same record."""
        file = self.place(number) / "design.json"
        table = file.with_name("excitation.csv")
        said = json.loads(file.read_text())
        begun = store.sha256(self.first)
        if said.pop("first_record") != begun or said.pop("sha256") != store.sha256(table):
            raise InputError(
                "it was designed for another record, or its excitation was changed",
                file=file,
                remedy=f"Move {self.folder} away; records of hardware stay in {archive.ROOT}",
            )
        u = np.loadtxt(table, delimiter=",", skiprows=1)[:, 1]
        return Design(**said | {"u": u, "closest": tuple(said["closest"])})

    def keep(self, found: ResolutionRound) -> None:
        """Write the verdict and the probabilities after a round."""
        place = self.place(found.number)
        found.after.verdict.write(place / "verdict.json")
        posterior = {
            name: {
                "offered": float(np.exp(found.after.posterior.log_offered[name])),
                "before": found.before.posterior.now.get(name),
                "log_density": found.log_densities.get(name),
                "after": value,
            }
            for name, value in found.after.posterior.now.items()
        }
        _write_json(place / "posterior.json", posterior)

    def write_table(self, path: Path, u: np.ndarray) -> None:
        """Write an excitation in the units of the first record's input."""
        first = store.signals(store.read_record(self.first))
        units = first.unit_of_one_input("the design of a further record")
        with store.atomic(path) as partial:
            partial.write_text(
                excitation_table(u, self.limits.sampling_rate, units), encoding="utf-8"
            )


def excitation_table(u: np.ndarray, sampling_rate: float, units: str) -> str:
    """Return the excitation as CSV with times in s; reading it back gives the same numbers."""
    rows = (f"{k / sampling_rate:.9g},{value!r}" for k, value in enumerate(u.tolist()))
    return "\n".join([f"time (s),input ({units})", *rows]) + "\n"


def _write_json(path: Path, content: Mapping[str, Any]) -> None:
    with store.atomic(path) as partial:
        partial.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
