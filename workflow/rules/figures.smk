# Every figure as PNG and PDF: workflow/figures.yaml lists them, their groups are here. A group's job
# depends on the modules of all its members: an edit of one draws the whole group again.
FIRST = next(iter(ACTUATORS))
# Responses of more than six actuators go on further pages.
RESPONSES = pages(
    "responses", ["record", "gfrf"], "results/figures/{name}", list(ACTUATORS), 6
)
FIGURES = filled(
    "figures",
    {
        # Apart, since it alone shows a stretch that the config names.
        "measurement": Group(
            sources="results/{system}/record.nc",
            path="results/figures/actuators/{name}_{system}",
            system="{system}",
        ),
        "actuator": Group(
            sources=expand(
                "results/{{system}}/{dataset}.nc",
                dataset=["record", "orders", "validation", "track"],
            ),
            path="results/figures/actuators/{name}_{system}",
            system="{system}",
        ),
        "case": Group(
            sources=expand(
                "results/{{system}}/{dataset}.nc",
                dataset=["record", "orders", "validation", "track", "gfrf"],
            ),
            path="results/figures/cases/{name}_{system}",
            system="{system}",
        ),
        **RESPONSES,
        "confirmation": Group(
            sources="results/{system}/confirmation.nc",
            path="results/figures/actuators/{name}_{system}",
            system="{system}",
        ),
        "link": Group(
            sources=of_every_actuator("results/{actuator}/link.nc"),
            path="results/figures/{name}",
            system="all",
        ),
        "recovery": Group(
            sources="results/recovery.nc",
            path="results/figures/{name}",
            system="all",
        ),
        "control": Group(
            sources="results/{system}/control.nc",
            path="results/figures/actuators/{name}_{system}",
            system="{system}",
        ),
        "discrepancy": Group(
            sources=expand(
                "results/discrepancy/{{system}}/{file}",
                file=[
                    "localisation.nc",
                    "candidates.nc",
                    "certificate.nc",
                    "verdict.json",
                ],
            ),
            path="results/figures/discrepancy/{system}",
            system="{system}",
        ),
        "trials": Group(
            sources=scores_of,
            path="results/figures/{name}{suffix}",
            system="trials{suffix}",
        ),
    },
)
# Figures of each actuator.
OWN = [*FIGURES["measurement"].members, *FIGURES["actuator"].members]
EVERY_FIGURE = (
    FIGURES["measurement"].files("png", "pdf", system=ACTUATORS)
    + FIGURES["actuator"].files("png", "pdf", system=ACTUATORS)
    + expand("results/figures/{name}.{kind}", name=OWN, kind=["png", "pdf"])
    + [file for page in RESPONSES for file in FIGURES[page].files("png", "pdf")]
    + FIGURES["confirmation"].files("png", "pdf", system=CONFIRMED)
    + FIGURES["link"].files("png", "pdf")
    + FIGURES["recovery"].files("png", "pdf")
)


for name, group in FIGURES.items():

    rule:
        name:
            f"figures_{name}"
        input:
            sources=group.sources,
            code=modules("dea.stages.figures", *group.modules("figures")),
        output:
            png=group.reported("figures", "png"),
            pdf=group.files("pdf"),
        log:
            f"results/figures/log/{name}_{group.system}.log",
        benchmark:
            f"results/figures/benchmark/{name}_{group.system}.tsv"
        params:
            settings=figure_settings(group),
        shell:
            stage(
                "figures --settings {params.settings:q}"
                " --sources {input.sources:q} --png {output.png:q} --pdf {output.pdf:q} 2> {log:q}"
            )


# The paper shows its first actuator; so do the figures without a name.
rule first_actuator:
    input:
        png=f"results/figures/actuators/{{figure}}_{FIRST}.png",
        pdf=f"results/figures/actuators/{{figure}}_{FIRST}.pdf",
        code=modules("dea.stages.copy_files"),
    output:
        png="results/figures/{figure}.png",
        pdf="results/figures/{figure}.pdf",
    log:
        "results/figures/log/{figure}.log",
    benchmark:
        "results/figures/benchmark/{figure}.tsv"
    wildcard_constraints:
        figure="|".join(OWN),
    shell:
        stage(
            "copy_files --originals {input.png:q} {input.pdf:q}"
            " --copies {output.png:q} {output.pdf:q} 2> {log:q}"
        )
