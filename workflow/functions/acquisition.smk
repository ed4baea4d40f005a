def check_virtual_actuators(served):
    """Every actuator that a bench is to answer for is one of ``served``."""
    for name, actuator in ACTUATORS.items():
        if "bench" in actuator and actuator["bench"] not in served:
            raise WorkflowError(
                f"config/config.yaml: actuators.bench: {name} is to be {actuator['bench']!r}, which"
                f" {BENCH} does not have. Name one of {', '.join(served)}, or add an entry there."
            )


def check_devices():
    """Every actuator's device description is there."""
    for name, actuator in ACTUATORS.items():
        if not Path(actuator["device"]).exists():
            raise WorkflowError(
                f"config/config.yaml: actuators.device: {actuator['device']} of {name} does not"
                " exist. Correct the path, or copy a description of config/devices there."
            )


def check_zoom(zoom, duration):
    """What Fig. 1 enlarges lies inside the record."""
    if not 0 <= zoom[0] < zoom[1] <= duration:
        raise WorkflowError(
            f"config/config.yaml: figures.zoom: {zoom} s lies outside the record of {duration} s"
            " (excitation.record.duration). Give the first and last second to enlarge."
        )


def virtual(wildcards):
    """The name in the bench's configuration of an actuator that is virtual, else None."""
    return ACTUATORS[wildcards.actuator].get("bench")


def acquisition_settings(excitation):
    """The settings of the job that plays ``excitation``, as JSON."""

    def resolve(wildcards):
        leaves = {
            "seed": config["seed"],
            "system": wildcards.actuator,
            "excitation": config["excitation"][excitation],
            "excitation_name": excitation,
            "acquisition": config["acquisition"],
        }
        if actuator := virtual(wildcards):
            leaves["bench"] = config["bench"] | {"actuator": actuator, "config": BENCH}
        return json.dumps(leaves, sort_keys=True)

    return resolve
