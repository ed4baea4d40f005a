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
    params:
        settings=settings("gfrf"),
    shell:
        stage(
            "gfrf --settings {params.settings:q} --record {input.record:q}"
            " --model {input.model:q} --track {input.track:q} --gfrf {output.gfrf:q} 2> {log:q}"
        )
