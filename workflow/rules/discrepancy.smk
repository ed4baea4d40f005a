# What each record says its simulation is missing. Candidates are fitted on threads of one job: the
# integrator releases the lock, and a job per candidate would import for longer than it fits.
DIAGNOSED = [name for name in CASES if "simulation" in CASE[name]]
# Effects and simulations are found by their files, not by import statements.
CATALOGUE = [
    f"dea.discrepancy.{path.parent.name}.{path.stem}"
    for folder in ("effects", "simulations")
    for path in sorted(Path("src/dea/discrepancy", folder).glob("*.py"))
]


def test_records(wildcards):
    """Records of the same system under another excitation."""
    if wildcards.system in ACTUATORS:
        return [f"results/{wildcards.system}/second_record.nc"]
    parts = CASE[wildcards.system].get("test_records", {})
    return [f"results/{wildcards.system}/test/{part}.nc" for part in parts]


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


rule diagnose:
    input:
        record="results/{system}/record.nc",
        tests=test_records,
        simulation=simulation_file,
        code=modules("dea.stages.diagnose", *CATALOGUE),
    output:
        localisation="results/discrepancy/{system}/localisation.nc",
        candidates="results/discrepancy/{system}/candidates.nc",
        verdict="results/discrepancy/{system}/verdict.json",
        extended="results/discrepancy/{system}/extended_simulation.yaml",
        certificate="results/discrepancy/{system}/certificate.nc",
    log:
        "results/discrepancy/{system}/log/diagnose.log",
    benchmark:
        "results/discrepancy/{system}/benchmark/diagnose.tsv"
    params:
        settings=discrepancy_settings,
    threads: config["discrepancy"]["workers"]
    shell:
        "python -m dea.stages.diagnose --settings {params.settings:q} --record {input.record:q}"
        " --tests {input.tests:q} --localisation {output.localisation:q}"
        " --candidates {output.candidates:q} --verdict {output.verdict:q}"
        " --extended {output.extended:q} --certificate {output.certificate:q} 2> {log:q}"


rule discrepancy:
    input:
        expand("results/discrepancy/{system}/verdict.json", system=ACTUATORS),
