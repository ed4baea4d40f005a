"""Let controllers follow a reference with a virtual actuator, and keep how well they did."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dea.stages.command import run

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from dea.control import Controller, ControllerDesign, Gains, Task

MINUTE = 60.0  # s


class Followed(NamedTuple):
    """What came of one controller: its record, or why it was stopped."""

    record: "xr.Dataset | None"
    reference: "np.ndarray"
    outcome: str
    fallbacks: int
    scheme: "ControlScheme"


def control(
    settings: Mapping[str, Any], device: Path, record: Path, model: Path, nominal: Path,
    extended: Path, control: Path,
) -> None:  # fmt: skip
    """Try every controller on the actuator, each from the same rest and with the same reference.

    ``settings`` holds ``control``, ``acquisition`` and ``bench`` as :mod:`dea.stages.acquire` has
    it. ``nominal`` and ``extended`` are the simulation fitted without and with the effects that
    the record's diagnosis named.
    """
    from dea import modbus, seeds, store
    from dea.control import ControllerDesign
    from dea.narx import NarxModel
    from dea.progress import tell

    tell("references and inverses")
    rate = modbus.read_device(device).sampling_rate
    signals = store.signals(store.read_record(record))
    units = signals.unit_of_one_input("A trial of controllers")
    generator = seeds.generator(settings["seed"], settings["system"], "control")
    seed, noise_seed = (int(n) for n in generator.integers(2**31, size=2))
    design = ControllerDesign.of_record(
        NarxModel.load(model), signals.u, signals.y, rate, settings["control"], seed
    )
    found = {}
    for name, scheme in _controllers(design, nominal, extended).items():
        tell(f"with the {name}")
        found[name] = _follow(design, scheme, settings, device, noise_seed)
    store.write(
        _dataset(found, design, units, signals.y_units),
        control,
        title=f"Controllers tried on {settings['system']}",
        inputs={"device": device, "record": record, "model": model, "nominal": nominal,
                "extended": extended},
        settings=settings,
        seed=settings["seed"],
    )  # fmt: skip


class ControlScheme(NamedTuple):
    """What makes a controller, or the voltages of an inverse that is played.

    A controller has gains; the inverse of a simulation, an error that is left with it, and the
    effects that are attached to it.
    """

    new: "Callable[[], Controller] | None" = None
    voltage: "np.ndarray | None" = None
    gains: "Gains | None" = None
    error: float = float("nan")
    effects: str = ""


def _controllers(
    design: "ControllerDesign", nominal: Path, extended: Path
) -> dict[str, ControlScheme]:
    gains = design.gains()
    own = design.proportional_integral()
    found = {
        "adaptive inverse": ControlScheme(lambda: design.adaptive(gains), gains=gains),
        "fixed inverse with feedback": ControlScheme(lambda: design.fixed(gains), gains=gains),
        "fixed inverse": ControlScheme(voltage=design.feedforward()),
        "PI": ControlScheme(lambda: design.follower(own), gains=own),
        "inverse of the physics": _inverse(design, nominal),
    }
    with_effects = _inverse(design, extended)
    if with_effects.effects:
        found["inverse of the physics with effects"] = with_effects
    return found


def _inverse(design: "ControllerDesign", path: Path) -> ControlScheme:
    """Return the inverse of a saved simulation."""
    from dea.simulation import load_extended

    simulation, values, interval = load_extended(path)
    inverse = design.inverse_of_simulation(lambda u: simulation.simulate(values, u, interval))
    effects = ", ".join(attached.effect.name for attached in simulation.attached)
    return ControlScheme(voltage=inverse.inputs, error=inverse.error, effects=effects)


def _follow(
    design: "ControllerDesign",
    scheme: ControlScheme,
    settings: Mapping[str, Any],
    device: Path,
    noise_seed: int,
) -> Followed:
    """Drive a fresh bench with one controller; what stops it is its outcome."""
    from dataclasses import replace
    from tempfile import TemporaryDirectory

    import numpy as np

    from dea import acquisition
    from dea.control import LostError
    from dea.stages.bench_process import as_planned, bench_process

    options = acquisition.AcquisitionSettings.from_mapping(settings["acquisition"])
    task, bench = design.task, as_planned(settings["bench"])
    played: acquisition.ClosedLoop | np.ndarray
    controller = None
    if scheme.new is None:
        assert scheme.voltage is not None
        played, options = scheme.voltage, replace(options, mode="buffered")
    else:
        _rehearse(scheme.new(), task)
        controller = scheme.new()
        played = acquisition.ClosedLoop(
            controller, task.reference.size, task.start, settings["control"]["rate"]
        )
        options = replace(options, mode="polled", paced=False, on_break="stop")
    record, outcome = None, "to the end"
    # Files of a drive that fails are kept nowhere: a run of the workflow begins anew.
    with (
        TemporaryDirectory() as folder,
        bench_process(**bench, device=device, seed=noise_seed) as answering,
    ):
        partial = Path(folder) / "partial"
        try:
            record = acquisition.acquire(answering, played, partial, options).record
        except (LostError, acquisition.ControllerError) as error:
            outcome = str(error)
    own = getattr(controller, "reference", np.empty(0))
    return Followed(
        record, own if own.size else task.reference, outcome,
        getattr(controller, "fallbacks", 0), scheme,
    )  # fmt: skip


def _rehearse(controller: "Controller", task: "Task") -> None:
    """Let a controller that drives nothing begin the reference: what it needs is then compiled."""
    for _ in range(task.run_in.hold + 2):
        controller(float(task.reference[0]))


def _dataset(
    found: Mapping[str, Followed], design: "ControllerDesign", u_units: str, y_units: str
) -> "xr.Dataset":
    import numpy as np
    import xarray as xr

    from dea.store import variable

    lead = sum(design.task.run_in)
    reference = design.task.reference[lead:]
    size = reference.size
    rows: dict[str, list[np.ndarray]] = {"displacement": [], "voltage": [], "quality": []}
    for followed in found.values():
        for name, kept in rows.items():
            missing = 2.0 if name == "quality" else np.nan  # lost
            kept.append(
                np.full(size, missing)
                if followed.record is None
                else followed.record[name].values[lead:]
            )
    measured = np.array(rows["displacement"])
    rms = _by_minute(measured - reference, design.sampling_rate)

    each, schemes = "controller", [one.scheme for one in found.values()]
    gains = [scheme.gains for scheme in schemes]
    of_all = (each, "time")
    return xr.Dataset(
        {
            "reference": variable("time", reference, y_units, "displacement wanted"),
            "measured": variable(of_all, measured, y_units, "displacement"),
            "voltage": variable(of_all, np.array(rows["voltage"]), u_units, "applied output"),
            "quality": variable(
                of_all, np.array(rows["quality"]).astype(np.uint8), "1", "quality flags, 0 is good"
            ),
            "rms_error": variable(
                (each, "minute"),
                rms,
                y_units, "root mean square of measured minus wanted",
            ),
            "stroke": variable((), design.task.stroke, y_units, "reference from end to end"),
            "outcome": variable(
                each, np.array([one.outcome for one in found.values()], dtype=object), "1",
                "whether the controller came to the end, or what stopped it",
            ),
            "fallbacks": variable(
                each, [one.fallbacks for one in found.values()], "1",
                "times that the model's own parameters replaced the tracked ones",
            ),
            "proportional": variable(
                each, [np.nan if one is None else one.proportional for one in gains],
                "1", "K: of PI in input units per output unit, of an inverse a number",
            ),
            "integral_time": variable(
                each, [np.nan if one is None else one.integral_time for one in gains], "s", "Ti"
            ),
            "inverse_error": variable(
                each, [scheme.error for scheme in schemes], y_units,
                "root mean square error that the simulation itself has with its inverse",
            ),
            "effects": variable(
                each, np.array([scheme.effects for scheme in schemes], dtype=object), "1",
                "effects attached to the simulation that is inverted",
            ),
        },
        coords={
            each: (each, np.array(list(found), dtype=object)),
            "minute": variable("minute", 1 + np.arange(rms.shape[1]), "1", "number of the minute"),
            "time": variable("time", np.arange(size) / design.sampling_rate, "s", "time"),
        },
        attrs={"contract": "control", "sampling_rate": design.sampling_rate},
    )  # fmt: skip


def _by_minute(error: "np.ndarray", rate: float) -> "np.ndarray":
    """Return the root mean square of errors (rows, samples) over (rows, minutes).

    Minutes count from the first sample on. The last one ends with the last sample: of an error that
    does not last whole minutes, it begins within the minute before. A shorter error is one minute.
    """
    import numpy as np

    size, minute = error.shape[1], MINUTE * rate
    length = min(round(minute), size)
    before = math.ceil((size - 0.5) / minute) - 1  # half a sample, by which sizes are rounded
    starts = [*(round(number * minute) for number in range(before)), size - length]
    parts = [error[:, start : start + length] for start in starts]
    rms: np.ndarray = np.sqrt(np.mean(np.stack(parts, axis=1) ** 2, axis=2))
    return rms


if __name__ == "__main__":
    run(
        control,
        inputs=("device", "record", "model", "nominal", "extended"),
        outputs=("control",),
    )
