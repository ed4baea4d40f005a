include: "../functions/discrepancy.smk"


# What each record says its simulation is missing. Candidates are fitted on threads of one job: the
# integrator releases the lock, and a job per candidate would import for longer than it fits.
# Effects and devices are found by their files, not by import statements.
CATALOGUE = [
    f"dea.simulation.{path.parent.name}.{path.stem}"
    for folder in ("effects", "devices")
    for path in sorted(Path("src/dea/simulation", folder).glob("[!_]*.py"))
]


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
    threads: 2
    params:
        settings=discrepancy_settings,
    shell:
        "python -m dea.stages.diagnose --threads {threads} --settings {params.settings:q}"
        " --record {input.record:q}"
        " --tests {input.tests:q} --localisation {output.localisation:q}"
        " --candidates {output.candidates:q} --verdict {output.verdict:q}"
        " --extended {output.extended:q} --certificate {output.certificate:q} 2> {log:q}"


rule discrepancy_figure:
    input:
        localisation=rules.diagnose.output.localisation,
        candidates=rules.diagnose.output.candidates,
        certificate=rules.diagnose.output.certificate,
        verdict=rules.diagnose.output.verdict,
        code=modules("dea.stages.discrepancy_figure"),
    output:
        png=report(
            "results/figures/discrepancy/{system}.png",
            caption="../report/discrepancy.rst",
            category="Discrepancy",
            labels={"figure": "missing effect", "system": "{system}"},
        ),
        pdf="results/figures/discrepancy/{system}.pdf",
    log:
        "results/discrepancy/{system}/log/figure.log",
    benchmark:
        "results/discrepancy/{system}/benchmark/figure.tsv"
    params:
        settings=lambda wildcards: json.dumps({"figures": config["figures"]}),
    shell:
        "python -m dea.stages.discrepancy_figure --settings {params.settings:q}"
        " --localisation {input.localisation:q} --candidates {input.candidates:q}"
        " --certificate {input.certificate:q} --verdict {input.verdict:q}"
        " --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


rule discrepancy:
    input:
        expand("results/discrepancy/{system}/verdict.json", system=ACTUATORS),
        expand(
            "results/figures/discrepancy/{system}.{kind}",
            system=ACTUATORS,
            kind=["png", "pdf"],
        ),


# Records made elsewhere whose case names a simulation.
DIAGNOSED_CASES = [name for name, case in CASE.items() if "simulation" in case]


rule table_real_records:
    input:
        verdicts=expand("results/discrepancy/{case}/verdict.json", case=DIAGNOSED_CASES),
        published="config/published_errors.yaml",
        code=modules("dea.stages.table_real_records"),
    output:
        csv=report(
            "results/tables/real_records.csv",
            caption="../report/table_real_records.rst",
            category="Discrepancy",
            labels={
                "figure": "Missing effects of measured records",
                "system": "cases",
            },
        ),
        md="results/tables/real_records.md",
        tex="results/tables/real_records.tex",
    log:
        "results/tables/log/real_records.log",
    benchmark:
        "results/tables/benchmark/real_records.tsv"
    shell:
        "python -m dea.stages.table_real_records --verdicts {input.verdicts:q}"
        " --published {input.published:q} --csv {output.csv:q} --md {output.md:q}"
        " --tex {output.tex:q} 2> {log:q}"


rule real_records:
    input:
        rules.table_real_records.output,
        expand(
            "results/figures/discrepancy/{case}.{kind}",
            case=DIAGNOSED_CASES,
            kind=["png", "pdf"],
        ),
