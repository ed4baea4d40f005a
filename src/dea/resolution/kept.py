"""Designs of records and what they have found, as files: what was made is not made again."""

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dea import archive, store
from dea.discrepancy import save_simulation
from dea.errors import InputError
from dea.resolution.design import Design
from dea.resolution.excitation import Limits
from dea.resolution.question import CERTIFICATE
from dea.resolution.rounds import ResolutionRound
from dea.strict_json import as_json, from_json

if TYPE_CHECKING:
    import xarray as xr

# Files of what a round has found.
_VERDICT, _SIMULATION, _POSTERIOR = "verdict.json", "extended_simulation.yaml", "posterior.json"


@dataclass
class Kept(ABC):
    """Designs and findings in ``results/resolve/NAME/round_N/``; nothing there is made twice.

    ``settings`` are what designs follow from besides the limits and the records.
    """

    folder: Path
    first: Path
    limits: Limits
    settings: Mapping[str, Any]

    def folder_of(self, number: int) -> Path:
        """Return the folder of a designed record."""
        return self.folder / ("certificate" if number == CERTIFICATE else f"round_{number}")

    @abstractmethod
    def file(self, number: int) -> Path:
        """Return the file of a designed record."""

    @abstractmethod
    def recorded(self, number: int) -> bool:
        """Return whether there is a record of the excitation that is kept."""

    def design(
        self,
        number: int,
        records: "Sequence[store.Record | xr.Dataset]",
        make: Callable[[], Design | None],
    ) -> Design | None:
        """Return the design that is kept, if it rests on the same first record, or make it.

        One that has not been driven yet is made anew where anything has changed that it follows
        from: limits, settings, or one of the ``records`` so far.
        """
        file = self.folder_of(number) / "design.json"
        follows_from = self._follows_from(records)
        if file.exists():
            kept, followed_from = self._read(number)
            if self.recorded(number) or followed_from == follows_from:
                return kept
        made = make()
        if made is None:
            return None
        table = file.with_name("excitation.csv")
        # Else an end between the two writes leaves a design that is not that of its excitation.
        file.unlink(missing_ok=True)
        self.write_table(table, made.u)
        said = asdict(made) | {
            "first_record": self.first_digest(),
            "sha256": store.sha256(table),
            "follows_from": follows_from,
        }
        del said["u"]
        _write_json(file, said)
        return self.kept(number)

    def _follows_from(self, records: "Sequence[store.Record | xr.Dataset]") -> Any:
        """Return what a design follows from, as it is read back from a file."""
        signals = [
            each if isinstance(each, store.Record) else store.signals(each) for each in records
        ]
        said = {
            "limits": asdict(self.limits),
            "records": list(map(_digest, signals)),
            **self.settings,
        }
        return json.loads(json.dumps(said))

    def kept(self, number: int) -> Design:
        """Return the design that is kept, if it rests on the same first record.

        Raises
        ------
        InputError
            If it rests on another or is damaged, or its excitation is not what was designed.
        """
        return self._read(number)[0]

    def _read(self, number: int) -> tuple[Design, Any]:
        """Return the design that is kept, and what it followed from."""
        folder = self.folder_of(number)
        file, table = folder / "design.json", folder / "excitation.csv"
        remedy = f"Bring it back from a backup, or delete {folder} to design it again"
        try:
            said = from_json(file.read_text())
            first, designed = said.pop("first_record"), said.pop("sha256")
            followed_from = said.pop("follows_from", None)
            kept = Design(**said | {"u": np.empty(0), "closest": tuple(said["closest"])})
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"it is no design ({error})", file=file, remedy=remedy) from error
        if not self.is_first(first):
            raise InputError(
                f"it was designed for another record than {self.first} holds now",
                file=file,
                remedy=f"Move {self.folder} away; records of hardware stay in {archive.ROOT}",
            )
        if not table.exists() or store.sha256(table) != designed:
            raise InputError(
                "it is not the excitation that was designed", file=table, remedy=remedy
            )
        return replace(kept, u=np.loadtxt(table, delimiter=",", skiprows=1)[:, 1]), followed_from

    def first_digest(self) -> str:
        """Return the SHA-256 of the first record's signals and units.

        Its file also holds what an update of the project, or another name, changes.
        """
        return _digest(store.read_record(self.first))

    def is_first(self, sha: str) -> bool:
        """Return whether this is the SHA-256 of the first record, or of its file.

        Archived records and designs may name either.
        """
        return sha in (self.first_digest(), store.sha256(self.first))

    def keep(self, found: ResolutionRound) -> None:
        """Write the verdict, its simulation and the probabilities after a round."""
        folder, known = self.folder_of(found.number), found.after
        known.verdict.write(folder / _VERDICT)
        fitted = known.diagnosis.nominal if known.withdrawn else known.diagnosis.final
        save_simulation(known.diagnosis, fitted, folder / _SIMULATION)
        posterior = {
            name: {
                "offered": float(np.exp(found.after.posterior.log_offered[name])),
                "before": found.before.posterior.now.get(name),
                "log_density": found.log_densities.get(name),
                "after": value,
            }
            for name, value in found.after.posterior.now.items()
        }
        _write_json(folder / _POSTERIOR, posterior)

    def withdraw(self) -> None:
        """Remove what the rounds of an earlier run have found; its designs and records stay."""
        for name in (_VERDICT, _POSTERIOR, _SIMULATION):
            for file in self.folder.glob(f"*/{name}"):
                file.unlink()

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


def _digest(record: "store.Record | xr.Dataset") -> str:
    """Return the SHA-256 of times, inputs, outputs and their units."""
    own = record if isinstance(record, store.Record) else store.signals(record)
    found = hashlib.sha256(json.dumps([own.u_units, own.y_units]).encode())
    for signal in (own.time, own.u, own.y):
        found.update(np.ascontiguousarray(signal, float).tobytes())
    return found.hexdigest()


def _write_json(path: Path, content: Mapping[str, Any]) -> None:
    with store.atomic(path) as partial:
        partial.write_text(as_json(content, 1) + "\n", encoding="utf-8")
