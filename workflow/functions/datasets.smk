# Every dataset that a target rests on is asked for by name, so that one that is deleted comes back;
# Snakemake itself makes a file between others again only where a later one is to be made.
OF_EVERY_SYSTEM = ["record", "orders", "model", "validation", "track", "gfrf"]
EVERY_DATASET = (
    expand(
        "results/{actuator}/{dataset}.nc",
        actuator=ACTUATORS,
        dataset=[*OF_EVERY_SYSTEM, "link", "forecast"],
    )
    + expand(
        "results/{actuator}/{dataset}.nc",
        actuator=CONFIRMED,
        dataset=["probed_record", "probed_link", "confirmation"],
    )
    + ["results/common_model.nc", "results/recovery.nc"]
)


def of_case(name):
    """What one case asks for: its datasets and figures, and the scores of its test records."""
    parts = CASE[name].get("test_records", {})
    return (
        expand("results/{case}/{dataset}.nc", case=name, dataset=OF_EVERY_SYSTEM)
        + FIGURES["case"].files("png", "pdf", system=name)
        + [f"results/{name}/test/{part}.nc" for part in parts]
        + [f"results/{name}/test_scores.nc"] * (name in TESTED_CASES)
    )


def of_diagnosis(system):
    """What the diagnosis of one system asks for: what it found, and its figure."""
    return [
        f"results/discrepancy/{system}/{file}"
        for file in (
            "localisation.nc",
            "candidates.nc",
            "verdict.json",
            "nominal_simulation.yaml",
            "extended_simulation.yaml",
            "certificate.nc",
        )
    ] + FIGURES["discrepancy"].files("png", "pdf", system=system)
