include: "../functions/trials.smk"


# Blind trials: a device hides an effect, the diagnosis names it from the record alone, and the
# seals are opened when all verdicts exist. The film is driven over Modbus; the other devices have
# data loggers of their own. A job runs a batch of trials: for a single one, starting Python would
# take longer than the work.
TRIALS = config["trials"]
NUMBERS = range(TRIALS["first"], TRIALS["first"] + TRIALS["count"])
# Of what the bench's file says, trials depend on the plain actuator alone.
BENCH_OF_TRIALS = plain_settings(BENCH, VIRTUAL_BENCH)
# What the devices with loggers are compared with, as a user of theirs would write it.
SIMULATIONS_OF_TRIALS = sorted(
    str(path) for path in Path("config/simulations").glob("[!.]*.py")
)


wildcard_constraints:
    set="|".join(TRIALS["seeds"]),
    suffix="|_tuning|_ambiguous|_ambiguous_tuning",
    first=r"\d{4}",
    last=r"\d{4}",


rule trial_draw:
    input:
        code=modules("dea.stages.trial_draw"),
    output:
        sealed=directory("results/trials/{set}/{first}-{last}/sealed"),
        commitment="results/trials/{set}/{first}-{last}/commitment.json",
    log:
        "results/trials/{set}/{first}-{last}/log/draw.log",
    benchmark:
        "results/trials/{set}/{first}-{last}/benchmark/draw.tsv"
    params:
        settings=lambda wildcards: json.dumps(
            {
                "set": wildcards.set,
                "seed": TRIALS["seeds"][wildcards.set],
                "first": int(wildcards.first),
                "last": int(wildcards.last),
                "bench": BENCH_OF_TRIALS,
            },
            sort_keys=True,
        ),
    shell:
        stage(
            "trial_draw --settings {params.settings:q}"
            " --sealed {output.sealed:q} --commitment {output.commitment:q} 2> {log:q}"
        )


rule trial_acquire:
    input:
        device=TRIALS["device"],
        sealed=rules.trial_draw.output.sealed,
        commitment=rules.trial_draw.output.commitment,
        code=modules("dea.stages.trial_acquire", "dea.bench.__main__"),
    output:
        records=directory("results/trials/{set}/{first}-{last}/records"),
        truth=directory("results/trials/{set}/{first}-{last}/truth"),
    log:
        "results/trials/{set}/{first}-{last}/log/acquire.log",
    benchmark:
        "results/trials/{set}/{first}-{last}/benchmark/acquire.tsv"
    params:
        settings=json.dumps(
            {
                "acquisition": PLAYED,
                "watchdog_time": config["bench"]["watchdog_time"],
                "bench": BENCH_OF_TRIALS,
            },
            sort_keys=True,
        ),
    shell:
        stage(
            "trial_acquire --settings {params.settings:q}"
            " --device {input.device:q} --sealed {input.sealed:q}"
            " --commitment {input.commitment:q} --records {output.records:q}"
            " --truth {output.truth:q} 2> {log:q}"
        )


rule trial_log:
    input:
        sealed=rules.trial_draw.output.sealed,
        commitment=rules.trial_draw.output.commitment,
        code=modules("dea.stages.trial_log"),
    output:
        logs=directory("results/trials/{set}/{first}-{last}/logs"),
        log_truth=directory("results/trials/{set}/{first}-{last}/log_truth"),
    log:
        "results/trials/{set}/{first}-{last}/log/log.log",
    benchmark:
        "results/trials/{set}/{first}-{last}/benchmark/log.tsv"
    params:
        settings=json.dumps({"bench": BENCH_OF_TRIALS}, sort_keys=True),
    shell:
        stage(
            "trial_log --settings {params.settings:q} --sealed {input.sealed:q}"
            " --commitment {input.commitment:q} --logs {output.logs:q}"
            " --log-truth {output.log_truth:q} 2> {log:q}"
        )


rule trial_diagnose:
    input:
        records=rules.trial_acquire.output.records,
        logs=rules.trial_log.output.logs,
        simulations=SIMULATIONS_OF_TRIALS,
        code=modules("dea.stages.trial_diagnose", *CATALOGUE),
    output:
        verdicts=directory("results/trials/{set}/{first}-{last}/verdicts"),
    log:
        "results/trials/{set}/{first}-{last}/log/diagnose.log",
    benchmark:
        "results/trials/{set}/{first}-{last}/benchmark/diagnose.tsv"
    params:
        settings=json.dumps(
            {"seed": config["seed"], "discrepancy": DIAGNOSIS},
            sort_keys=True,
        ),
    shell:
        stage(
            "trial_diagnose --settings {params.settings:q}"
            " --records {input.records:q} --logs {input.logs:q}"
            " --simulations {input.simulations:q}"
            " --verdicts {output.verdicts:q} 2> {log:q}"
        )


rule trial_score:
    input:
        commitment=every_batch("commitment.json"),
        sealed=every_batch("sealed"),
        records=every_batch("records"),
        truth=every_batch("truth"),
        log_truth=every_batch("log_truth"),
        verdicts=every_batch("verdicts"),
        code=modules("dea.stages.trial_score", *CATALOGUE),
    output:
        scores="results/trials/{set}/scores.nc",
    log:
        "results/trials/{set}/log/score.log",
    benchmark:
        "results/trials/{set}/benchmark/score.tsv"
    params:
        settings=lambda wildcards: json.dumps(
            {"seed": TRIALS["seeds"][wildcards.set], "set": wildcards.set}
        ),
    shell:
        stage(
            "trial_score --settings {params.settings:q}"
            " --commitment {input.commitment:q} --sealed {input.sealed:q}"
            " --records {input.records:q} --truth {input.truth:q}"
            " --log-truth {input.log_truth:q} --verdicts {input.verdicts:q}"
            " --scores {output.scores:q} 2> {log:q}"
        )
