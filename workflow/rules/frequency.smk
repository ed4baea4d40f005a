# Frequency responses of the tracked model.
rule gfrf:
    input:
        record="results/{system}/record.nc",
        model="results/{system}/model.nc",
        track="results/{system}/track.nc",
        code=modules("dea.stages.gfrf"),
    output:
        gfrf="results/{system}/gfrf.nc",
    log:
        "results/{system}/log/gfrf.log",
    benchmark:
        "results/{system}/benchmark/gfrf.tsv"
    priority: 1
    params:
        settings=settings("gfrf"),
    shell:
        stage(
            "gfrf --settings {params.settings:q} --record {input.record:q}"
            " --model {input.model:q} --track {input.track:q} --gfrf {output.gfrf:q} 2> {log:q}"
        )


# The same responses measured without a model, from multisines that the actuator answered.
rule confirm:
    input:
        probed="results/{actuator}/probed_record.nc",
        model="results/{actuator}/model.nc",
        track="results/{actuator}/track.nc",
        gfrf="results/{actuator}/gfrf.nc",
        code=modules("dea.stages.confirm"),
    output:
        confirmation="results/{actuator}/confirmation.nc",
    log:
        "results/{actuator}/log/confirm.log",
    benchmark:
        "results/{actuator}/benchmark/confirm.tsv"
    priority: 1
    params:
        settings=settings("gfrf.tracker", "confirmation"),
    shell:
        stage(
            "confirm --settings {params.settings:q} --probed {input.probed:q}"
            " --model {input.model:q} --track {input.track:q} --gfrf {input.gfrf:q}"
            " --confirmation {output.confirmation:q} 2> {log:q}"
        )
