"""One blind trial: its actuator with hidden effects, its excitation, and the sealed label."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from dea.errors import InputError
from dea.plant.hidden.catalogue import EFFECTS
from dea.plant.hidden.effect import Conditions
from dea.plant.parameters import read_plain
from dea.plant.rig import Law, Rig


@dataclass(frozen=True)
class HiddenEffect:
    """An effect at a size (in the effect's own unit), with the seed of its law's shape.

    ``strength`` is the RMS residual of the refitted plain actuator over the RMS noise with this
    effect alone.
    """

    name: str
    size: float
    seed: int
    strength: float

    def law(self, conditions: Conditions) -> Law:
        """Return a new law with its initial memory."""
        return EFFECTS[self.name].build(self.size, conditions, np.random.default_rng(self.seed))


@dataclass(frozen=True)
class Trial:
    """A plain actuator with hidden effects, and the excitation it is driven with.

    Attributes
    ----------
    name
        Of the trial; tells nothing of the effects.
    film
        Parameters of the film that replace the plain actuator's (SI units).
    excitation
        Arguments of :func:`dea.excitation.design`; the acquisition knows these alone.
    conditions
        The actuator under the excitation without the effects.
    effects
        None, one or two.
    strength
        Of all effects together, as of one.
    seed
        Of the measurement noise.
    """

    name: str
    film: dict[str, float]
    excitation: dict[str, Any]
    conditions: Conditions
    effects: tuple[HiddenEffect, ...]
    strength: float
    seed: int

    def rig(self, config: Path) -> Rig:
        """Return the rig of this trial for the bench configuration at ``config``."""
        return Rig(
            read_plain(config, self.film),
            self.seed,
            effects=[effect.law(self.conditions) for effect in self.effects],
        )

    def label(self) -> dict[str, Any]:
        """Return the label that a verdict is scored against."""
        return {
            "name": self.name,
            "effects": [
                {
                    "name": effect.name,
                    "port": EFFECTS[effect.name].port,
                    "size": effect.size,
                    "unit": EFFECTS[effect.name].unit,
                    "strength": effect.strength,
                }
                for effect in self.effects
            ],
            "strength": self.strength,
            "excitation": self.excitation["kind"],
        }

    def write(self, path: Path) -> None:
        """Write the whole trial, label and all, as JSON: a sealed file."""
        content = {**asdict(self), "conditions": self.conditions._asdict()}
        path.write_text(json.dumps(content, indent=2) + "\n")

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a trial that :meth:`write` has written.

        Raises
        ------
        InputError
            The file cannot be read or is no trial.
        """
        try:
            content = json.loads(Path(path).read_text())
            content["conditions"] = Conditions(**content["conditions"])
            content["effects"] = tuple(HiddenEffect(**effect) for effect in content["effects"])
            return cls(**content)
        except (OSError, ValueError, TypeError, KeyError) as error:
            raise InputError(
                f"this is not a trial: {error}", file=path, remedy="Draw the trial again."
            ) from error
