# Known answers: the published models as plants, identified from what they simulate.
rule recover:
    input:
        models=config["recovery"]["models"],
        code=modules("dea.stages.recover", "dea.gfrf.response"),
    output:
        recovery="results/recovery.nc",
    log:
        "results/log/recover.log",
    benchmark:
        "results/benchmark/recover.tsv"
    params:
        settings=settings("identification", "recovery"),
    shell:
        "python -m dea.stages.recover --models {input.models:q} --settings {params.settings:q}"
        " --recovery {output.recovery:q} 2> {log:q}"


rule table_recovery:
    input:
        recovery="results/recovery.nc",
        code=modules("dea.stages.table_recovery"),
    output:
        csv=report(
            "results/tables/recovery.csv",
            caption="../report/table_recovery.rst",
            category="Identification",
            labels={"figure": "Published models recovered", "system": "all"},
        ),
        md="results/tables/recovery.md",
        tex="results/tables/recovery.tex",
    log:
        "results/tables/log/recovery.log",
    benchmark:
        "results/tables/benchmark/recovery.tsv"
    shell:
        "python -m dea.stages.table_recovery --recovery {input.recovery:q}"
        " --csv {output.csv:q} --md {output.md:q} --tex {output.tex:q} 2> {log:q}"
