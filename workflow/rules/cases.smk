include: "../functions/cases.smk"


# Records made elsewhere: how their models do on records that identification never saw.
TESTED_CASES = [name for name, case in CASE.items() if case.get("test_records")]
CASES_TABLE = expand("results/tables/cases.{kind}", kind=["csv", "md", "tex"])


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
        "python -m dea.stages.score_tests --settings {params.settings:q} --model {input.model:q}"
        " --test {input.test:q} --scores {output.scores:q} 2> {log:q}"


rule table_cases:
    input:
        scores=expand("results/{case}/test_scores.nc", case=TESTED_CASES),
        published="config/published_errors.yaml",
        code=modules("dea.stages.table_cases"),
    output:
        csv=report(
            "results/tables/cases.csv",
            caption="../report/table_cases.rst",
            category="Identification",
            labels={"figure": "Free runs on test records", "system": "cases"},
        ),
        md="results/tables/cases.md",
        tex="results/tables/cases.tex",
    log:
        "results/tables/log/cases.log",
    benchmark:
        "results/tables/benchmark/cases.tsv"
    shell:
        "python -m dea.stages.table_cases --scores {input.scores:q}"
        " --published {input.published:q} --csv {output.csv:q} --md {output.md:q}"
        " --tex {output.tex:q} 2> {log:q}"


for name in CASES:

    rule:
        name:
            f"case_{name}"
        input:
            of_case(name),


rule cases:
    input:
        [file for name in CASES for file in of_case(name)],
        CASES_TABLE,
