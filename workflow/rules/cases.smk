include: "../functions/cases.smk"


# Free runs of the models of records made elsewhere on records not used in identification.
rule score_tests:
    input:
        model="results/{case}/model.nc",
        test=test_parts,
        code=modules("dea.stages.score_tests"),
    output:
        scores="results/{case}/test_scores.nc",
    log:
        "results/{case}/log/score_tests.log",
    benchmark:
        "results/{case}/benchmark/score_tests.tsv"
    params:
        settings=settings(),
    shell:
        stage(
            "score_tests --settings {params.settings:q} --model {input.model:q}"
            " --test {input.test:q} --scores {output.scores:q} 2> {log:q}"
        )
