include: "../functions/identification.smk"


# One system's models: which orders, which terms, and how they hold on unseen windows.
rule orders:
    input:
        record="results/{system}/record.nc",
        code=modules("dea.stages.orders"),
    output:
        orders="results/{system}/orders.nc",
    log:
        "results/{system}/log/orders.log",
    benchmark:
        "results/{system}/benchmark/orders.tsv"
    priority: 1
    params:
        # The figure marks the degree that was chosen.
        settings=settings(
            *STRETCH,
            "identification.degree",
            "identification.even_in_input",
            "orders",
        ),
    shell:
        stage(
            "orders --record {input.record:q} --settings {params.settings:q}"
            " --orders {output.orders:q} 2> {log:q}"
        )


rule select:
    input:
        record="results/{system}/record.nc",
        code=modules("dea.stages.select"),
    output:
        model="results/{system}/model.nc",
    log:
        "results/{system}/log/select.log",
    benchmark:
        "results/{system}/benchmark/select.tsv"
    priority: 1
    params:
        settings=settings("identification"),
    shell:
        stage(
            "select --record {input.record:q} --settings {params.settings:q}"
            " --model {output.model:q} 2> {log:q}"
        )


# One structure for all actuators, each with its own parameters.
rule select_common:
    input:
        records=of_every_actuator("results/{actuator}/record.nc"),
        models=of_every_actuator("results/{actuator}/model.nc"),
        code=modules("dea.stages.select_common"),
    output:
        common="results/common_model.nc",
    log:
        "results/log/select_common.log",
    benchmark:
        "results/benchmark/select_common.tsv"
    params:
        settings=settings(*SELECTION, "orders.start", "orders.length"),
    shell:
        stage(
            "select_common --records {input.records:q} --models {input.models:q}"
            " --settings {params.settings:q} --common {output.common:q} 2> {log:q}"
        )


rule validate:
    input:
        record="results/{system}/record.nc",
        model="results/{system}/model.nc",
        code=modules("dea.stages.validate"),
    output:
        validation="results/{system}/validation.nc",
    log:
        "results/{system}/log/validate.log",
    benchmark:
        "results/{system}/benchmark/validate.tsv"
    priority: 1
    params:
        settings=settings(*STRETCH, "validation"),
    shell:
        stage(
            "validate --record {input.record:q} --model {input.model:q}"
            " --settings {params.settings:q} --validation {output.validation:q} 2> {log:q}"
        )


rule forecast:
    input:
        record="results/{actuator}/record.nc",
        model="results/{actuator}/model.nc",
        code=modules("dea.stages.forecast"),
    output:
        forecast="results/{actuator}/forecast.nc",
    log:
        "results/{actuator}/log/forecast.log",
    benchmark:
        "results/{actuator}/benchmark/forecast.tsv"
    params:
        settings=settings("forecast"),
    shell:
        stage(
            "forecast --record {input.record:q} --model {input.model:q}"
            " --settings {params.settings:q} --forecast {output.forecast:q} 2> {log:q}"
        )
