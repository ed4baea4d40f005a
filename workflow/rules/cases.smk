include: "../functions/cases.smk"


# Free runs of the models of records made elsewhere on records not used in identification.
rule score_tests:
    input:
        record="results/{case}/record.nc",
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
        settings=settings(*STRETCH),
    shell:
        stage(
            "score_tests --settings {params.settings:q} --model {input.model:q}"
            " --record {input.record:q} --test {input.test:q} --scores {output.scores:q} 2> {log:q}"
        )


# What a case found, on one page with its pictures, and the same in a few lines for the terminal.
rule page:
    input:
        sources=page_sources,
        pictures=page_pictures,
        code=modules("dea.stages.page"),
    output:
        page="results/{case}/page.html",
        summary="results/{case}/summary.txt",
    log:
        "results/{case}/log/page.log",
    benchmark:
        "results/{case}/benchmark/page.tsv"
    params:
        settings=lambda wildcards: json.dumps({"title": CASE[wildcards.case]["title"]}),
    shell:
        stage(
            "page --settings {params.settings:q} --sources {input.sources:q}"
            " --pictures {input.pictures:q} --page {output.page:q}"
            " --summary {output.summary:q} 2> {log:q}"
        )
