# Every table as CSV (exact numbers), Markdown and LaTeX (rounded).
TABLES = ["table1", "validation", "tracking", "recovery"]
EVERY_TABLE = expand(
    "results/tables/{name}.{kind}", name=TABLES, kind=["csv", "md", "tex"]
)


rule table1:
    input:
        model=of_every_actuator("results/{actuator}/model.nc"),
        validation=of_every_actuator("results/{actuator}/validation.nc"),
        code=modules("dea.stages.table1"),
    output:
        csv=report(
            "results/tables/table1.csv",
            caption="../report/table1.rst",
            category="Identification",
            labels={"figure": "Table 1: terms", "system": "all"},
        ),
        md="results/tables/table1.md",
        tex="results/tables/table1.tex",
    log:
        "results/tables/log/table1.log",
    benchmark:
        "results/tables/benchmark/table1.tsv"
    shell:
        "python -m dea.stages.table1 --model {input.model:q} --validation {input.validation:q}"
        " --csv {output.csv:q} --md {output.md:q} --tex {output.tex:q} 2> {log:q}"


rule table_validation:
    input:
        validation=of_every_actuator("results/{actuator}/validation.nc"),
        code=modules("dea.stages.table_validation"),
    output:
        csv=report(
            "results/tables/validation.csv",
            caption="../report/table_validation.rst",
            category="Identification",
            labels={"figure": "Validation scores", "system": "all"},
        ),
        md="results/tables/validation.md",
        tex="results/tables/validation.tex",
    log:
        "results/tables/log/validation.log",
    benchmark:
        "results/tables/benchmark/validation.tsv"
    shell:
        "python -m dea.stages.table_validation --validation {input.validation:q}"
        " --csv {output.csv:q} --md {output.md:q} --tex {output.tex:q} 2> {log:q}"


rule table_tracking:
    input:
        track=of_every_actuator("results/{actuator}/track.nc"),
        code=modules("dea.stages.table_tracking"),
    output:
        csv=report(
            "results/tables/tracking.csv",
            caption="../report/table_tracking.rst",
            category="Tracking",
            labels={
                "figure": "Free-run scores over the whole record",
                "system": "all",
            },
        ),
        md="results/tables/tracking.md",
        tex="results/tables/tracking.tex",
    log:
        "results/tables/log/tracking.log",
    benchmark:
        "results/tables/benchmark/tracking.tsv"
    shell:
        "python -m dea.stages.table_tracking --track {input.track:q}"
        " --csv {output.csv:q} --md {output.md:q} --tex {output.tex:q} 2> {log:q}"
