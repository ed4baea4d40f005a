include: "../functions/import.smk"


# Records made elsewhere are imported to the same contract as those of the bench.
rule import_record:
    input:
        file=record_file,
        code=modules("dea.stages.import_record"),
    output:
        record="results/{case}/record.nc",
    log:
        "results/{case}/log/import_record.log",
    benchmark:
        "results/{case}/benchmark/import_record.tsv"
    params:
        settings=lambda wildcards: json.dumps(
            record_settings(wildcards), sort_keys=True
        ),
        case=lambda wildcards: CASES[wildcards.case],
        content=lambda wildcards: imports.content(record_file(wildcards)),
        place=lambda wildcards: ".".join(record_place(wildcards)),
    shell:
        stage(
            "import_record --case {params.case:q} --place {params.place:q}"
            " --settings {params.settings:q} --record {output.record:q} 2> {log:q}"
        )


use rule import_record as import_test_record with:
    output:
        record="results/{case}/test/{part}.nc",
    log:
        "results/{case}/log/import_test_{part}.log",
    benchmark:
        "results/{case}/benchmark/import_test_{part}.tsv"


use rule import_record as import_further_record with:
    output:
        record="results/{case}/further/{further}.nc",
    log:
        "results/{case}/log/import_further_{further}.log",
    benchmark:
        "results/{case}/benchmark/import_further_{further}.tsv"
