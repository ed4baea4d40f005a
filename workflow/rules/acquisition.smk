include: "../functions/acquisition.smk"


# Every actuator is driven twice over Modbus: the study's record, and a second one with another
# excitation that certifies what was learnt from the first.


rule acquire:
    input:
        device=lambda wildcards: ACTUATORS[wildcards.actuator]["device"],
        bench=lambda wildcards: BENCH if virtual(wildcards) else [],
        code=lambda wildcards: modules(
            "dea.stages.acquire", *["dea.bench.__main__"] * bool(virtual(wildcards))
        ),
    output:
        record="results/{actuator}/record.nc",
        link="results/{actuator}/link.nc",
    log:
        "results/{actuator}/log/acquire.log",
    benchmark:
        "results/{actuator}/benchmark/acquire.tsv"
    params:
        settings=acquisition_settings("record"),
    shell:
        stage(
            "acquire --settings {params.settings:q} --device {input.device:q}"
            " --record {output.record:q} --link {output.link:q} 2> {log:q}"
        )


use rule acquire as acquire_second with:
    output:
        record="results/{actuator}/second_record.nc",
        link="results/{actuator}/second_link.nc",
    log:
        "results/{actuator}/log/acquire_second.log",
    benchmark:
        "results/{actuator}/benchmark/acquire_second.tsv"
    params:
        settings=acquisition_settings("second"),
