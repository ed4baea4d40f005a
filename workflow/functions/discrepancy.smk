def test_records(wildcards):
    """Records of the same system under another excitation."""
    if wildcards.system in ACTUATORS:
        return [f"results/{wildcards.system}/second_record.nc"]
    parts = CASE[wildcards.system].get("test_records", {})
    return [f"results/{wildcards.system}/test/{part}.nc" for part in parts]


def further_records(wildcards):
    """Records of the same device that are explained together with the first."""
    parts = CASE.get(wildcards.system, {}).get("records", {})
    return [f"results/{wildcards.system}/further/{part}.nc" for part in parts]


def simulation_of(system):
    return CASE.get(system, {}).get("simulation", config["discrepancy"]["simulation"])


def simulation_file(wildcards):
    """A user's own simulation is an input; those of the study are code."""
    name = simulation_of(wildcards.system)
    return [name] if name.endswith(".py") else []


def discrepancy_settings(wildcards):
    return json.dumps(
        {
            "seed": config["seed"],
            "system": wildcards.system,
            "simulation": simulation_of(wildcards.system),
            "split": CASE.get(wildcards.system, {}).get("split", {}),
            "discrepancy": config["discrepancy"],
        },
        sort_keys=True,
    )
