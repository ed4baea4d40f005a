# Parameters that change with time, followed through the whole record.
rule track:
    input:
        record="results/{system}/record.nc",
        model="results/{system}/model.nc",
        code=modules("dea.stages.track"),
    output:
        track="results/{system}/track.nc",
    log:
        "results/{system}/log/track.log",
    benchmark:
        "results/{system}/benchmark/track.tsv"
    priority: 1
    params:
        settings=settings("tracking"),
    shell:
        stage(
            "track --settings {params.settings:q} --record {input.record:q}"
            " --model {input.model:q} --track {output.track:q} 2> {log:q}"
        )
