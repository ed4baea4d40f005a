from dea import archive
from dea.configuration.excitation import PROBED, sections

VIRTUAL = [name for name, actuator in ACTUATORS.items() if actuator.get("bench")]
RECORDED = [name for name in ACTUATORS if name not in VIRTUAL]


def confirmed(name):
    """Whether there is a probed record, or a rule makes it, to confirm responses with."""
    if name in VIRTUAL and "probing" in config["excitation"]:
        return True
    try:
        return bool(archive.finished(name, PROBED))
    except InputError as error:
        raise WorkflowError(str(error)) from None


CONFIRMED = list(filter(confirmed, ACTUATORS))


def names(actuators):
    """The constraint of a wildcard that stands for one of ``actuators``."""
    return "|".join(actuators) or "no-actuator"


def recorded(wildcards, excitation):
    """The manifest of the record of hardware to study; where there is none, how to make it."""
    actuator = ACTUATORS[wildcards.actuator]
    key = "record" if excitation == "record" else f"{excitation}_record"
    try:
        folder = archive.chosen(wildcards.actuator, excitation, actuator.get(key))
    except InputError as error:
        raise WorkflowError(str(error)) from None
    return folder / archive.MANIFEST


def of_virtual(*unread):
    """How a virtual actuator is driven. Nobody arms it, and its clock is not compared."""
    others = {"armed_by", "clock_tolerance", *unread}
    return {
        key: value for key, value in config["acquisition"].items() if key not in others
    }


# Where a sequence is played, from the device's own buffer no sample is late.
BUFFERED = config["acquisition"]["mode"] == "buffered"
PLAYED = of_virtual("late_after") if BUFFERED else of_virtual()


def acquisition_settings(excitation):
    """The settings of the job that plays ``excitation``, as JSON."""

    def resolve(wildcards):
        leaves = {
            "seed": config["seed"],
            "system": wildcards.actuator,
            "excitation_name": excitation,
            "acquisition": PLAYED,
        } | sections(config["excitation"], excitation)
        leaves["bench"] = bench_settings(wildcards.actuator)
        return json.dumps(leaves, sort_keys=True)

    return resolve


def control_settings(wildcards):
    """The settings of the job that tries controllers on an actuator, as JSON."""
    leaves = {
        "seed": config["seed"],
        "system": wildcards.actuator,
        # Controllers are polled and what is played is buffered, whatever the mode.
        "acquisition": of_virtual("mode"),
        "bench": bench_settings(wildcards.actuator),
        "control": config["control"],
    }
    return json.dumps(leaves, sort_keys=True)


def bench_settings(actuator):
    """What serves a virtual actuator, and the parameters that its plant has."""
    served = ACTUATORS[actuator]["bench"]
    return served_settings(config["bench"], served, BENCH, VIRTUAL_BENCH)
