include: "../functions/trials.smk"


# Blind trials: the bench hides an effect, the diagnosis names it from the record alone, and the
# seals are opened when all verdicts exist. A job runs a batch of trials: for a single one, starting
# Python would take longer than the work.
TRIALS = config["trials"]
COUNT, BATCH = TRIALS["count"], TRIALS["batch"]


wildcard_constraints:
    set="|".join(TRIALS["seeds"]),
    suffix="|_tuning",
    first=r"\d{4}",
    last=r"\d{4}",


rule trial_draw:
    input:
        bench=BENCH,
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
                "seed": TRIALS["seeds"][wildcards.set],
                "first": int(wildcards.first),
                "last": int(wildcards.last),
            }
        ),
    shell:
        stage(
            "trial_draw --settings {params.settings:q} --bench {input.bench:q}"
            " --sealed {output.sealed:q} --commitment {output.commitment:q} 2> {log:q}"
        )


rule trial_acquire:
    input:
        device=TRIALS["device"],
        bench=BENCH,
        sealed=rules.trial_draw.output.sealed,
        commitment=rules.trial_draw.output.commitment,
        code=modules("dea.stages.trial_acquire", "dea.bench.__main__"),
    output:
        records=directory("results/trials/{set}/{first}-{last}/records"),
    log:
        "results/trials/{set}/{first}-{last}/log/acquire.log",
    benchmark:
        "results/trials/{set}/{first}-{last}/benchmark/acquire.tsv"
    params:
        settings=json.dumps(
            {
                "acquisition": config["acquisition"],
                "watchdog_time": config["bench"]["watchdog_time"],
            },
            sort_keys=True,
        ),
    shell:
        stage(
            "trial_acquire --settings {params.settings:q}"
            " --device {input.device:q} --bench {input.bench:q} --sealed {input.sealed:q}"
            " --commitment {input.commitment:q} --records {output.records:q} 2> {log:q}"
        )


rule trial_diagnose:
    input:
        records=rules.trial_acquire.output.records,
        code=modules("dea.stages.trial_diagnose", *CATALOGUE),
    output:
        verdicts=directory("results/trials/{set}/{first}-{last}/verdicts"),
    log:
        "results/trials/{set}/{first}-{last}/log/diagnose.log",
    benchmark:
        "results/trials/{set}/{first}-{last}/benchmark/diagnose.tsv"
    params:
        settings=json.dumps(
            {"seed": config["seed"], "discrepancy": config["discrepancy"]},
            sort_keys=True,
        ),
    shell:
        stage(
            "trial_diagnose --settings {params.settings:q}"
            " --records {input.records:q} --verdicts {output.verdicts:q} 2> {log:q}"
        )


rule trial_score:
    input:
        commitment=every_batch("commitment.json"),
        sealed=every_batch("sealed"),
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
            " --verdicts {input.verdicts:q} --scores {output.scores:q} 2> {log:q}"
        )
