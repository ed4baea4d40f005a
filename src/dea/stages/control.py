"""Let controllers follow a reference with a virtual actuator, and keep how well they did."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dea.stages.command import run

if TYPE_CHECKING:
    from dea.control import Controller, ControllerDesign, ControlScheme, Followed, Task


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
    from dea.control import ControllerDesign, control_dataset
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
        control_dataset(found, design, units, signals.y_units),
        control,
        title=f"Controllers tried on {settings['system']}",
        inputs={"device": device, "record": record, "model": model, "nominal": nominal,
                "extended": extended},
        settings=settings,
        seed=settings["seed"],
    )  # fmt: skip


def _controllers(
    design: "ControllerDesign", nominal: Path, extended: Path
) -> "dict[str, ControlScheme]":
    from dea.control import ControlScheme

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


def _inverse(design: "ControllerDesign", path: Path) -> "ControlScheme":
    """Return the inverse of a saved simulation."""
    from dea.control import ControlScheme
    from dea.simulation import load_extended

    simulation, values, interval = load_extended(path)
    inverse = design.inverse_of_simulation(lambda u: simulation.simulate(values, u, interval))
    effects = ", ".join(attached.effect.name for attached in simulation.attached)
    return ControlScheme(voltage=inverse.inputs, error=inverse.error, effects=effects)


def _follow(
    design: "ControllerDesign",
    scheme: "ControlScheme",
    settings: Mapping[str, Any],
    device: Path,
    noise_seed: int,
) -> "Followed":
    """Drive a fresh bench with one controller; what stops it is its outcome."""
    from dataclasses import replace
    from tempfile import TemporaryDirectory

    import numpy as np

    from dea import acquisition
    from dea.control import Followed, LostError
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


if __name__ == "__main__":
    run(
        control,
        inputs=("device", "record", "model", "nominal", "extended"),
        outputs=("control",),
    )
