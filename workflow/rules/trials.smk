include: "../functions/trials.smk"


# Blind trials: the bench hides an effect, the diagnosis names it from the record alone, and the
# seals are opened when all verdicts exist. Trials go in batches, a job each, so that starting
# Python does not cost more than the work.
TRIALS = config["trials"]
COUNT, BATCH = TRIALS["count"], TRIALS["batch"]


wildcard_constraints:
    set="|".join(TRIALS["seeds"]),
    suffix="|_tuning",
    first=r"\d{4}",
    last=r"\d{4}",


rule trials:
    input:
        trial_results("" if TRIALS["set"] == "reporting" else f"_{TRIALS['set']}"),


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
        "python -m dea.stages.trial_draw --settings {params.settings:q} --bench {input.bench:q}"
        " --sealed {output.sealed:q} --commitment {output.commitment:q} 2> {log:q}"


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
        "python -m dea.stages.trial_acquire --settings {params.settings:q}"
        " --device {input.device:q} --bench {input.bench:q} --sealed {input.sealed:q}"
        " --commitment {input.commitment:q} --records {output.records:q} 2> {log:q}"


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
        "python -m dea.stages.trial_diagnose --settings {params.settings:q}"
        " --records {input.records:q} --verdicts {output.verdicts:q} 2> {log:q}"


rule trial_score:
    input:
        commitment=every_batch("commitment.json"),
        sealed=every_batch("sealed"),
        verdicts=every_batch("verdicts"),
        code=modules("dea.stages.trial_score"),
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
        "python -m dea.stages.trial_score --settings {params.settings:q}"
        " --commitment {input.commitment:q} --sealed {input.sealed:q}"
        " --verdicts {input.verdicts:q} --scores {output.scores:q} 2> {log:q}"


rule trials_confusion:
    input:
        scores=scores_of,
        code=modules("dea.stages.trials_confusion"),
    output:
        png=report(
            "results/figures/trials_confusion{suffix}.png",
            caption="../report/trials_confusion.rst",
            category="Blind trials",
            labels={"figure": "hidden against named", "system": "trials{suffix}"},
        ),
        pdf="results/figures/trials_confusion{suffix}.pdf",
    log:
        "results/figures/log/trials_confusion{suffix}.log",
    benchmark:
        "results/figures/benchmark/trials_confusion{suffix}.tsv"
    params:
        settings=settings("figures"),
        stage="trials_confusion",
    shell:
        "python -m dea.stages.{params.stage} --settings {params.settings:q}"
        " --scores {input.scores:q} --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


use rule trials_confusion as trials_risk_coverage with:
    input:
        scores=scores_of,
        code=modules("dea.stages.trials_risk_coverage"),
    output:
        png=report(
            "results/figures/trials_risk_coverage{suffix}.png",
            caption="../report/trials_risk_coverage.rst",
            category="Blind trials",
            labels={"figure": "risk and coverage", "system": "trials{suffix}"},
        ),
        pdf="results/figures/trials_risk_coverage{suffix}.pdf",
    log:
        "results/figures/log/trials_risk_coverage{suffix}.log",
    benchmark:
        "results/figures/benchmark/trials_risk_coverage{suffix}.tsv"
    params:
        settings=settings("figures"),
        stage="trials_risk_coverage",


use rule trials_confusion as trials_strength with:
    input:
        scores=scores_of,
        code=modules("dea.stages.trials_strength"),
    output:
        png=report(
            "results/figures/trials_strength{suffix}.png",
            caption="../report/trials_strength.rst",
            category="Blind trials",
            labels={
                "figure": "by strength and excitation",
                "system": "trials{suffix}",
            },
        ),
        pdf="results/figures/trials_strength{suffix}.pdf",
    log:
        "results/figures/log/trials_strength{suffix}.log",
    benchmark:
        "results/figures/benchmark/trials_strength{suffix}.tsv"
    params:
        settings=settings("figures"),
        stage="trials_strength",


use rule trials_confusion as trials_gap with:
    input:
        scores=scores_of,
        code=modules("dea.stages.trials_gap"),
    output:
        png=report(
            "results/figures/trials_gap{suffix}.png",
            caption="../report/trials_gap.rst",
            category="Blind trials",
            labels={"figure": "gap before and after", "system": "trials{suffix}"},
        ),
        pdf="results/figures/trials_gap{suffix}.pdf",
    log:
        "results/figures/log/trials_gap{suffix}.log",
    benchmark:
        "results/figures/benchmark/trials_gap{suffix}.tsv"
    params:
        settings=settings("figures"),
        stage="trials_gap",


rule table_trials:
    input:
        scores=scores_of,
        code=modules("dea.stages.table_trials"),
    output:
        csv=report(
            "results/tables/trials{suffix}.csv",
            caption="../report/table_trials.rst",
            category="Blind trials",
            labels={"figure": "rates", "system": "trials{suffix}"},
        ),
        md="results/tables/trials{suffix}.md",
        tex="results/tables/trials{suffix}.tex",
    log:
        "results/tables/log/trials{suffix}.log",
    benchmark:
        "results/tables/benchmark/trials{suffix}.tsv"
    params:
        stage="table_trials",
    shell:
        "python -m dea.stages.{params.stage} --scores {input.scores:q}"
        " --csv {output.csv:q} --md {output.md:q} --tex {output.tex:q} 2> {log:q}"


use rule table_trials as table_trials_effects with:
    input:
        scores=scores_of,
        code=modules("dea.stages.table_trials_effects"),
    output:
        csv=report(
            "results/tables/trials_effects{suffix}.csv",
            caption="../report/table_trials_effects.rst",
            category="Blind trials",
            labels={"figure": "outcomes by effect", "system": "trials{suffix}"},
        ),
        md="results/tables/trials_effects{suffix}.md",
        tex="results/tables/trials_effects{suffix}.tex",
    log:
        "results/tables/log/trials_effects{suffix}.log",
    benchmark:
        "results/tables/benchmark/trials_effects{suffix}.tsv"
    params:
        stage="table_trials_effects",
