# Every figure as PNG and PDF: workflow/figures.yaml lists them, their groups are here. A group's job
# depends on the modules of all its members: an edit of one draws the whole group again.
FIRST = next(iter(ACTUATORS))
# Responses of more than six actuators go on further pages.
RESPONSES = pages(
    "responses", ["record", "gfrf"], "results/figures/{name}", list(ACTUATORS), 6
)
OF_EACH = ["record", "orders", "validation", "track"]
UNCONFIRMED = [name for name in ACTUATORS if name not in CONFIRMED]
FIGURES = filled(
    "figures",
    {
        "actuator": of_one([*OF_EACH, "confirmation"], "actuators", CONFIRMED),
        "unconfirmed": of_one(OF_EACH, "actuators", UNCONFIRMED),
        "case": of_one([*OF_EACH, "gfrf"], "cases", CASES),
        "control": of_one(["control"], "actuators", VIRTUAL),
        **RESPONSES,
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
# Figures that every actuator has.
OWN = list(FIGURES["unconfirmed"].members)
EVERY_FIGURE = (
    FIGURES["actuator"].files("png", "pdf", system=CONFIRMED)
    + FIGURES["unconfirmed"].files("png", "pdf", system=UNCONFIRMED)
    + expand("results/figures/{name}.{kind}", name=OWN, kind=["png", "pdf"])
    + [file for page in RESPONSES for file in FIGURES[page].files("png", "pdf")]
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
        wildcard_constraints:
            system=names(group.among),
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
        originals=expand(
            "results/figures/actuators/{name}_{first}.{kind}",
            name=OWN,
            first=FIRST,
            kind=["png", "pdf"],
        ),
        code=modules("dea.stages.copy_files"),
    output:
        copies=expand("results/figures/{name}.{kind}", name=OWN, kind=["png", "pdf"]),
    log:
        "results/figures/log/first_actuator.log",
    benchmark:
        "results/figures/benchmark/first_actuator.tsv"
    shell:
        stage(
            "copy_files --originals {input.originals:q}"
            " --copies {output.copies:q} 2> {log:q}"
        )
