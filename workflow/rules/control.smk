# Controllers tried on each virtual actuator over Modbus: `make control`.
rule control:
    input:
        device=device_file,
        record="results/{actuator}/record.nc",
        model="results/{actuator}/model.nc",
        nominal="results/discrepancy/{actuator}/nominal_simulation.yaml",
        extended="results/discrepancy/{actuator}/extended_simulation.yaml",
        code=modules("dea.stages.control", "dea.bench.__main__", *CATALOGUE),
    output:
        control="results/{actuator}/control.nc",
    log:
        "results/{actuator}/log/control.log",
    benchmark:
        "results/{actuator}/benchmark/control.tsv"
    wildcard_constraints:
        actuator=names(VIRTUAL),
    params:
        settings=control_settings,
        content=device_content,
    shell:
        stage(
            "control --settings {params.settings:q} --device {input.device:q}"
            " --record {input.record:q} --model {input.model:q}"
            " --nominal {input.nominal:q} --extended {input.extended:q}"
            " --control {output.control:q} 2> {log:q}"
        )
