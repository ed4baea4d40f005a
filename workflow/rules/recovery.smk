# The published models as plants with known parameters, identified from what they simulate.
rule recover:
    input:
        models=config["recovery"]["models"],
        code=modules("dea.stages.recover"),
    output:
        recovery="results/recovery.nc",
    log:
        "results/log/recover.log",
    benchmark:
        "results/benchmark/recover.tsv"
    # Beside the first record: what two jobs call for the first time at once, both compile.
    priority: 2
    params:
        settings=settings("recovery"),
    shell:
        stage(
            "recover --models {input.models:q} --settings {params.settings:q}"
            " --recovery {output.recovery:q} 2> {log:q}"
        )
