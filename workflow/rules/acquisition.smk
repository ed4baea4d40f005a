include: "../functions/acquisition.smk"


# Every actuator has three records: the study's, a second one with another excitation that certifies
# what was learnt from the first, and a probed one, the study's with multisines in three places, that
# confirms frequency responses. A virtual actuator is driven by a rule. A record of
# hardware is made by `make record` and is no output of a rule, so that nothing here deletes it.
# The longest chains of jobs lead from records over model and track to figures: they go first, so
# that no core waits for their last jobs.


rule acquire:
    input:
        device=device_file,
        code=modules("dea.stages.acquire", "dea.bench.__main__"),
    output:
        record="results/{actuator}/record.nc",
        link="results/{actuator}/link.nc",
    log:
        "results/{actuator}/log/acquire.log",
    benchmark:
        "results/{actuator}/benchmark/acquire.tsv"
    wildcard_constraints:
        actuator=names(VIRTUAL),
    priority: 1
    params:
        settings=acquisition_settings("record"),
        content=device_content,
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
    priority: 0
    params:
        settings=acquisition_settings("second"),


use rule acquire as acquire_probed with:
    output:
        record="results/{actuator}/probed_record.nc",
        link="results/{actuator}/probed_link.nc",
    log:
        "results/{actuator}/log/acquire_probed.log",
    benchmark:
        "results/{actuator}/benchmark/acquire_probed.tsv"
    params:
        settings=acquisition_settings("probed"),


rule take_record:
    input:
        manifest=lambda wildcards: recorded(wildcards, "record"),
        code=modules("dea.stages.take_record"),
    output:
        record="results/{actuator}/record.nc",
        link="results/{actuator}/link.nc",
    log:
        "results/{actuator}/log/take_record.log",
    benchmark:
        "results/{actuator}/benchmark/take_record.tsv"
    wildcard_constraints:
        actuator=names(RECORDED),
    shell:
        stage(
            "take_record --manifest {input.manifest:q}"
            " --record {output.record:q} --link {output.link:q} 2> {log:q}"
        )


use rule take_record as take_second_record with:
    input:
        manifest=lambda wildcards: recorded(wildcards, "second"),
        code=modules("dea.stages.take_record"),
    output:
        record="results/{actuator}/second_record.nc",
        link="results/{actuator}/second_link.nc",
    log:
        "results/{actuator}/log/take_second_record.log",
    benchmark:
        "results/{actuator}/benchmark/take_second_record.tsv"


use rule take_record as take_probed_record with:
    input:
        manifest=lambda wildcards: recorded(wildcards, "probed"),
        code=modules("dea.stages.take_record"),
    output:
        record="results/{actuator}/probed_record.nc",
        link="results/{actuator}/probed_link.nc",
    log:
        "results/{actuator}/log/take_probed_record.log",
    benchmark:
        "results/{actuator}/benchmark/take_probed_record.tsv"
