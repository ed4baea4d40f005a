# A model as C code and as a functional mock-up unit: `make handover NAME=...`.
rule handover:
    input:
        record="results/{system}/record.nc",
        model="results/{system}/model.nc",
        code=modules(
            "dea.stages.handover",
            files=expand(
                "src/dea/control/fmi/{file}", file=["fmi2.c", "fmi2.h", "unit.h"]
            ),
        ),
    output:
        header="results/{system}/handover/model.h",
        source="results/{system}/handover/model.c",
        unit="results/{system}/handover/model.fmu",
    log:
        "results/{system}/log/handover.log",
    benchmark:
        "results/{system}/benchmark/handover.tsv"
    params:
        settings=settings(),
    shell:
        stage(
            "handover --settings {params.settings:q} --record {input.record:q}"
            " --model {input.model:q} --header {output.header:q} --source {output.source:q}"
            " --unit {output.unit:q} 2> {log:q}"
        )
