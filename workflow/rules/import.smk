# Records made elsewhere enter at the same door as those of the bench.
def record_of_case(wildcards):
    return CASE[wildcards.case]["record"]["file"]


rule import_record:
    input:
        file=record_of_case,
        code=modules("dea.stages.import_record"),
    output:
        record="results/{case}/record.nc",
    params:
        settings=lambda wildcards: json.dumps(CASE[wildcards.case]["record"], sort_keys=True),
        case=lambda wildcards: CASES[wildcards.case],
    log:
        "results/{case}/log/import_record.log",
    benchmark:
        "results/{case}/benchmark/import_record.tsv"
    shell:
        "python -m dea.stages.import_record --case {params.case:q} --settings {params.settings:q}"
        " --record {output.record:q} 2> {log:q}"
