"""One blind trial: its device with hidden effects, its excitation, and the sealed label."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from dea.arrays import Array
from dea.errors import InputError
from dea.plant.hidden.catalogue import EFFECTS
from dea.plant.hidden.devices import DEVICES, DeviceKind
from dea.plant.hidden.effect import Built, Conditions, Port
from dea.plant.hidden.noise import Noise, NoiseKind, NoiseSource
from dea.plant.hidden.rig import ServedRig, TrialRig
from dea.plant.parameters import read_plain


@dataclass(frozen=True)
class HiddenEffect:
    """An effect in one form at a size (in the effect's own unit), with the seed of its shape.

    ``strength`` is the RMS residual of the refitted plain device over the RMS noise with this
    effect alone.
    """

    name: str
    form: str
    size: float
    seed: int
    strength: float

    def build(self, conditions: Conditions) -> Built:
        """Return a new law with its initial memory, and the values that define it."""
        form = EFFECTS[self.name].form(self.form)
        return form.build(self.size, conditions, np.random.default_rng(self.seed))


@dataclass(frozen=True)
class Trial:
    """A plain device with hidden effects, and the excitation it is driven with.

    Attributes
    ----------
    name
        Of the trial; tells nothing of the effects.
    device
        A name of the devices that trials run on.
    factors
        On the parameters of the plain device.
    excitation
        Arguments of :func:`dea.excitation.design`; the acquisition knows these alone.
    conditions
        The device under the excitation without the effects.
    effects
        None, one or two.
    strength
        Of all effects together, as of one.
    noise
        Of the readings.
    seed
        Of the noise.
    """

    name: str
    device: str
    factors: dict[str, float]
    excitation: dict[str, Any]
    conditions: Conditions
    effects: tuple[HiddenEffect, ...]
    strength: float
    noise: Noise
    seed: int

    @property
    def kind(self) -> DeviceKind:
        """The device's kind."""
        return DEVICES[self.device]

    @property
    def sampling_rate(self) -> float:
        """In Hz."""
        return float(self.excitation["sampling_rate"])

    def rig(self, bench: Path) -> TrialRig:
        """Return the device of this trial for the bench configuration at ``bench``."""
        return TrialRig(
            self.kind.plain(bench, self.factors),
            [effect.build(self.conditions).law for effect in self.effects],
            self.sampling_rate,
            self.noise.shift,
        )

    def served(self, bench: Path) -> ServedRig:
        """Return the device behind the converters of the bench configuration at ``bench``."""
        converters = read_plain(bench)
        return ServedRig(
            self.rig(bench), self.noise, self.seed,
            converters.output_converter, converters.displacement_converter, self.kind.scale,
        )  # fmt: skip

    def readings(self, bench: Path, commands: Array) -> tuple[Array, Array]:
        """Return readings with and without noise, in the unit of records, for commands in V.

        The device has settled at the first command.
        """
        settling = round(self.kind.settling * self.sampling_rate)
        played = np.concatenate([np.repeat(commands[:1], settling), commands])
        truth = self.rig(bench).respond(played)[settling:]
        scale = self.kind.scale
        return scale * NoiseSource(self.noise, self.seed).read(truth), scale * truth

    def label(self) -> dict[str, Any]:
        """Return the label that a verdict is scored against."""
        return {
            "name": self.name,
            "device": self.device,
            "noise": self.noise.kind,
            "noise_rms": self.kind.scale * self.noise.rms,
            "effects": [
                {
                    "name": effect.name,
                    "form": effect.form,
                    "use": EFFECTS[effect.name].form(effect.form).use,
                    "port": EFFECTS[effect.name].port,
                    "size": effect.size,
                    "unit": EFFECTS[effect.name].unit,
                    "strength": effect.strength,
                    "defining": self._defining(effect),
                }
                for effect in self.effects
            ],
            "strength": self.strength,
            "excitation": self.excitation["kind"],
        }

    def _defining(self, effect: HiddenEffect) -> dict[str, float]:
        """Return the values that define an effect, lengths of the output in the unit of records."""
        values = effect.build(self.conditions).defining
        if EFFECTS[effect.name].port is Port.INPUT:
            return values
        lengths = {"limit", "gap"}
        return {n: self.kind.scale * v if n in lengths else v for n, v in values.items()}

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
            noise = content["noise"]
            content["noise"] = Noise(**{**noise, "kind": NoiseKind(noise["kind"])})
            return cls(**content)
        except (OSError, ValueError, TypeError, KeyError) as error:
            raise InputError(
                f"this is not a trial: {error}", file=path, remedy="Draw the trial again."
            ) from error
