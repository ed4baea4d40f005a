# Every figure as PNG and PDF. Those of one system carry its name; those of all compare actuators.
FIRST = next(iter(ACTUATORS))
KINDS = ["png", "pdf"]
OWN_FIGURES = ["fig1", "fig2", "tracked_parameters", "residual_tests"]
COMMON_FIGURES = ["fig3", "fig3_phase", "fig4_h2", "link", "recovery"]
CASE_FIGURES = ["fig2", "tracked_parameters", "residual_tests", "fig3", "fig4_h2"]
EVERY_FIGURE = expand(
    "results/figures/{name}.{kind}", name=OWN_FIGURES + COMMON_FIGURES, kind=KINDS
) + expand(
    "results/figures/actuators/{name}_{actuator}.{kind}",
    name=OWN_FIGURES,
    actuator=ACTUATORS,
    kind=KINDS,
)
FIGURES_OF_CASE = expand(
    "results/figures/cases/{name}_{{case}}.{kind}", name=CASE_FIGURES, kind=KINDS
)


wildcard_constraints:
    group="actuators|cases",


rule fig1:
    input:
        record="results/{system}/record.nc",
        code=modules("dea.stages.fig1"),
    output:
        png=report(
            "results/figures/actuators/fig1_{system}.png",
            caption="../report/fig1.rst",
            category="Measurement",
            labels={"figure": "record", "system": "{system}"},
        ),
        pdf="results/figures/actuators/fig1_{system}.pdf",
    log:
        "results/figures/log/fig1_{system}.log",
    benchmark:
        "results/figures/benchmark/fig1_{system}.tsv"
    params:
        settings=settings("figures"),
    shell:
        "python -m dea.stages.fig1 --settings {params.settings:q} --record {input.record:q}"
        " --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


rule fig2:
    input:
        orders="results/{system}/orders.nc",
        validation="results/{system}/validation.nc",
        code=modules("dea.stages.fig2"),
    output:
        png=report(
            "results/figures/{group}/fig2_{system}.png",
            caption="../report/fig2.rst",
            category="Identification",
            labels={"figure": "orders and validation", "system": "{system}"},
        ),
        pdf="results/figures/{group}/fig2_{system}.pdf",
    log:
        "results/figures/log/{group}_fig2_{system}.log",
    benchmark:
        "results/figures/benchmark/{group}_fig2_{system}.tsv"
    params:
        settings=settings("figures"),
    shell:
        "python -m dea.stages.fig2 --settings {params.settings:q} --orders {input.orders:q}"
        " --validation {input.validation:q}"
        " --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


rule residual_tests:
    input:
        validation="results/{system}/validation.nc",
        code=modules("dea.stages.residual_tests"),
    output:
        png=report(
            "results/figures/{group}/residual_tests_{system}.png",
            caption="../report/residual_tests.rst",
            category="Identification",
            labels={"figure": "residual tests", "system": "{system}"},
        ),
        pdf="results/figures/{group}/residual_tests_{system}.pdf",
    log:
        "results/figures/log/{group}_residual_tests_{system}.log",
    benchmark:
        "results/figures/benchmark/{group}_residual_tests_{system}.tsv"
    params:
        settings=settings("figures"),
    shell:
        "python -m dea.stages.residual_tests --settings {params.settings:q}"
        " --validation {input.validation:q}"
        " --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


rule tracked_parameters:
    input:
        record="results/{system}/record.nc",
        track="results/{system}/track.nc",
        code=modules("dea.stages.tracked_parameters"),
    output:
        png=report(
            "results/figures/{group}/tracked_parameters_{system}.png",
            caption="../report/tracked_parameters.rst",
            category="Tracking",
            labels={"figure": "tracked parameters", "system": "{system}"},
        ),
        pdf="results/figures/{group}/tracked_parameters_{system}.pdf",
    log:
        "results/figures/log/{group}_tracked_parameters_{system}.log",
    benchmark:
        "results/figures/benchmark/{group}_tracked_parameters_{system}.tsv"
    params:
        settings=settings("figures"),
    shell:
        "python -m dea.stages.tracked_parameters --settings {params.settings:q}"
        " --record {input.record:q} --track {input.track:q}"
        " --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


# The paper shows its first actuator; so do the figures without a name.
rule first_actuator:
    input:
        lambda wildcards: f"results/figures/actuators/{wildcards.figure}_{FIRST}.{wildcards.kind}",
    output:
        "results/figures/{figure}.{kind}",
    log:
        "results/figures/log/{figure}_{kind}.log",
    benchmark:
        "results/figures/benchmark/{figure}_{kind}.tsv"
    wildcard_constraints:
        figure="|".join(OWN_FIGURES),
        kind="png|pdf",
    shell:
        "cp {input:q} {output:q} 2> {log:q}"


rule fig3:
    input:
        record=of_every_actuator("results/{actuator}/record.nc"),
        gfrf=of_every_actuator("results/{actuator}/gfrf.nc"),
        code=modules("dea.stages.fig3"),
    output:
        png=report(
            "results/figures/fig3.png",
            caption="../report/fig3.rst",
            category="Frequency responses",
            labels={"figure": "gain of H1 over time", "system": "all"},
        ),
        pdf="results/figures/fig3.pdf",
    log:
        "results/figures/log/fig3.log",
    benchmark:
        "results/figures/benchmark/fig3.tsv"
    params:
        settings=settings("figures", quantity="gain"),
    shell:
        "python -m dea.stages.fig3 --settings {params.settings:q} --record {input.record:q}"
        " --gfrf {input.gfrf:q} --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


use rule fig3 as fig3_phase with:
    output:
        png=report(
            "results/figures/fig3_phase.png",
            caption="../report/fig3_phase.rst",
            category="Frequency responses",
            labels={"figure": "phase of H1 over time", "system": "all"},
        ),
        pdf="results/figures/fig3_phase.pdf",
    log:
        "results/figures/log/fig3_phase.log",
    benchmark:
        "results/figures/benchmark/fig3_phase.tsv"
    params:
        settings=settings("figures", quantity="phase"),


use rule fig3 as fig3_case with:
    input:
        record="results/{system}/record.nc",
        gfrf="results/{system}/gfrf.nc",
        code=modules("dea.stages.fig3"),
    output:
        png=report(
            "results/figures/cases/fig3_{system}.png",
            caption="../report/fig3.rst",
            category="Frequency responses",
            labels={"figure": "gain of H1 over time", "system": "{system}"},
        ),
        pdf="results/figures/cases/fig3_{system}.pdf",
    log:
        "results/figures/log/fig3_{system}.log",
    benchmark:
        "results/figures/benchmark/fig3_{system}.tsv"


rule fig4_h2:
    input:
        gfrf=of_every_actuator("results/{actuator}/gfrf.nc"),
        code=modules("dea.stages.fig4_h2"),
    output:
        png=report(
            "results/figures/fig4_h2.png",
            caption="../report/fig4_h2.rst",
            category="Frequency responses",
            labels={"figure": "magnitude of H2", "system": "all"},
        ),
        pdf="results/figures/fig4_h2.pdf",
    log:
        "results/figures/log/fig4_h2.log",
    benchmark:
        "results/figures/benchmark/fig4_h2.tsv"
    params:
        settings=settings("figures"),
    shell:
        "python -m dea.stages.fig4_h2 --settings {params.settings:q} --gfrf {input.gfrf:q}"
        " --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


use rule fig4_h2 as fig4_h2_case with:
    input:
        gfrf="results/{system}/gfrf.nc",
        code=modules("dea.stages.fig4_h2"),
    output:
        png=report(
            "results/figures/cases/fig4_h2_{system}.png",
            caption="../report/fig4_h2.rst",
            category="Frequency responses",
            labels={"figure": "magnitude of H2", "system": "{system}"},
        ),
        pdf="results/figures/cases/fig4_h2_{system}.pdf",
    log:
        "results/figures/log/fig4_h2_{system}.log",
    benchmark:
        "results/figures/benchmark/fig4_h2_{system}.tsv"


rule link_quality:
    input:
        link=of_every_actuator("results/{actuator}/link.nc"),
        code=modules("dea.stages.link_quality"),
    output:
        png=report(
            "results/figures/link.png",
            caption="../report/link.rst",
            category="Measurement",
            labels={"figure": "quality of the links", "system": "all"},
        ),
        pdf="results/figures/link.pdf",
    log:
        "results/figures/log/link.log",
    benchmark:
        "results/figures/benchmark/link.tsv"
    params:
        settings=settings("figures"),
    shell:
        "python -m dea.stages.link_quality --settings {params.settings:q} --link {input.link:q}"
        " --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"


rule recovery_figure:
    input:
        recovery="results/recovery.nc",
        code=modules("dea.stages.recovery_figure"),
    output:
        png=report(
            "results/figures/recovery.png",
            caption="../report/recovery.rst",
            category="Identification",
            labels={"figure": "published models recovered", "system": "all"},
        ),
        pdf="results/figures/recovery.pdf",
    log:
        "results/figures/log/recovery.log",
    benchmark:
        "results/figures/benchmark/recovery.tsv"
    params:
        settings=settings("figures"),
    shell:
        "python -m dea.stages.recovery_figure --settings {params.settings:q}"
        " --recovery {input.recovery:q} --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"
