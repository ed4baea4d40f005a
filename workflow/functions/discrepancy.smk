# How records are diagnosed; each names its simulation.
DIAGNOSIS = {
    key: value for key, value in config["discrepancy"].items() if key != "simulation"
}


def test_records(wildcards):
    """Records of the same system under another excitation."""
    if wildcards.system in ACTUATORS:
        return [f"results/{wildcards.system}/second_record.nc"]
    case = CASE[wildcards.system]
    return [
        f"results/{wildcards.system}/test/{name}.nc"
        for name, test in case.get("test_records", {}).items()
        if not is_part_of(test, case["record"])
    ]


def further_records(wildcards):
    """Records of the same device that are explained together with the first."""
    parts = CASE.get(wildcards.system, {}).get("records", {})
    return [f"results/{wildcards.system}/further/{part}.nc" for part in parts]


def simulation_named(system):
    """What a record is compared with: the case's simulation, or that of the actuators."""
    if system in ACTUATORS:
        return config["discrepancy"]["simulation"]
    file = CASES[system]
    try:
        return simulation_of(_cases[file], file, DEVICES)
    except InputError as error:
        raise WorkflowError(str(error)) from None


def simulation_file(wildcards):
    """A user's own simulation is an input; those of the study are code."""
    name = simulation_named(wildcards.system)
    return [name] if name.endswith(".py") else []


def discrepancy_settings(wildcards):
    return json.dumps(
        {
            "seed": config["seed"],
            "system": wildcards.system,
            "simulation": simulation_named(wildcards.system),
            "split": CASE.get(wildcards.system, {}).get("split", {}),
            "discrepancy": DIAGNOSIS,
        },
        sort_keys=True,
    )
