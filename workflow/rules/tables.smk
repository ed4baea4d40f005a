# Every table as CSV (exact numbers), Markdown and LaTeX (rounded): workflow/tables.yaml lists them,
# their groups are here.
PUBLISHED = ["config/published_errors.yaml"]
TABLES = filled(
    "tables",
    {
        "actuators": Group(
            sources=[
                file
                for dataset in ("model", "validation", "track")
                for file in of_every_actuator(f"results/{{actuator}}/{dataset}.nc")
            ]
            + ["results/common_model.nc"],
            path="results/tables/{name}",
            system="all",
        ),
        "confirmation": Group(
            sources=expand("results/{actuator}/confirmation.nc", actuator=CONFIRMED),
            path="results/tables/{name}",
            system="all",
        ),
        "forecast": Group(
            sources=of_every_actuator("results/{actuator}/forecast.nc"),
            path="results/tables/{name}",
            system="all",
        ),
        "control": Group(
            sources=expand("results/{actuator}/control.nc", actuator=VIRTUAL),
            path="results/tables/{name}",
            system="all",
        ),
        "recovery": Group(
            sources="results/recovery.nc",
            path="results/tables/{name}",
            system="all",
        ),
        "cases": Group(
            sources=expand("results/{case}/test_scores.nc", case=TESTED_CASES)
            + PUBLISHED,
            path="results/tables/{name}",
            system="cases",
        ),
        "real_records": Group(
            sources=expand(
                "results/discrepancy/{case}/verdict.json", case=DIAGNOSED_CASES
            )
            + PUBLISHED,
            path="results/tables/{name}",
            system="cases",
        ),
        "trials": Group(
            sources=scores_of,
            path="results/tables/{name}{suffix}",
            system="trials{suffix}",
        ),
    },
)
EVERY_TABLE = [
    file
    for group in (
        "actuators",
        "forecast",
        "recovery",
        *["confirmation"] * bool(CONFIRMED),
    )
    for file in TABLES[group].files("csv", "md", "tex")
]


for name, group in TABLES.items():

    rule:
        name:
            f"tables_{name}"
        input:
            sources=group.sources,
            code=modules("dea.stages.tables", *group.modules("tables")),
        output:
            csv=group.reported("tables", "csv"),
            md=group.files("md"),
            tex=group.files("tex"),
        log:
            f"results/tables/log/{name}_{group.system}.log",
        benchmark:
            f"results/tables/benchmark/{name}_{group.system}.tsv"
        params:
            settings=json.dumps({"tables": list(group.members)}),
        shell:
            stage(
                "tables --settings {params.settings:q} --sources {input.sources:q}"
                " --csv {output.csv:q} --md {output.md:q} --tex {output.tex:q} 2> {log:q}"
            )
