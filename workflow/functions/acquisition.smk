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
