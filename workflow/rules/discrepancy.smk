include: "../functions/discrepancy.smk"


# What each record says its simulation is missing. Candidates are fitted on threads of one job: the
# integrator releases the lock, and a job per candidate would import for longer than it fits.
# Effects and devices are found by their files, not by import statements.
CATALOGUE = [f"dea.simulation.effects.{name}" for name in EFFECTS] + [
    f"dea.simulation.devices.{name}" for name in DEVICES
]


rule diagnose:
    input:
        record="results/{system}/record.nc",
        further=further_records,
        tests=test_records,
        simulation=simulation_file,
        code=modules("dea.stages.diagnose", *CATALOGUE),
    output:
        localisation="results/discrepancy/{system}/localisation.nc",
        candidates="results/discrepancy/{system}/candidates.nc",
        verdict="results/discrepancy/{system}/verdict.json",
        nominal="results/discrepancy/{system}/nominal_simulation.yaml",
        extended="results/discrepancy/{system}/extended_simulation.yaml",
        certificate="results/discrepancy/{system}/certificate.nc",
    log:
        "results/discrepancy/{system}/log/diagnose.log",
    benchmark:
        "results/discrepancy/{system}/benchmark/diagnose.tsv"
    threads: 2
    params:
        settings=discrepancy_settings,
        content=lambda wildcards: list(map(imports.content, simulation_file(wildcards))),
    shell:
        stage(
            "diagnose --threads {threads} --settings {params.settings:q}"
            " --record {input.record:q} --further {input.further:q}"
            " --tests {input.tests:q} --localisation {output.localisation:q}"
            " --candidates {output.candidates:q} --verdict {output.verdict:q}"
            " --nominal {output.nominal:q}"
            " --extended {output.extended:q} --certificate {output.certificate:q} 2> {log:q}"
        )
