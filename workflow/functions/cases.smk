# Cases with test records, and cases whose simulation is diagnosed.
TESTED_CASES = [name for name, case in CASE.items() if case.get("test_records")]
DIAGNOSED_CASES = [name for name, case in CASE.items() if "simulation" in case]


def test_parts(wildcards):
    """The imported test records of a case."""
    parts = CASE[wildcards.case]["test_records"]
    return [f"results/{wildcards.case}/test/{part}.nc" for part in parts]


def page_sources(wildcards):
    """What the page of a case tells: its datasets, and the verdict on its simulation."""
    name = wildcards.case
    files = expand(
        "results/{case}/{dataset}.nc",
        case=name,
        dataset=["record", "model", "validation", "gfrf"]
        + ["test_scores"] * (name in TESTED_CASES),
    )
    return files + [f"results/discrepancy/{name}/verdict.json"] * (
        name in DIAGNOSED_CASES
    )


def page_pictures(wildcards):
    """The pictures on it."""
    name = wildcards.case
    pictures = FIGURES["case"].files("png", system=name)
    if name in DIAGNOSED_CASES:
        pictures += FIGURES["discrepancy"].files("png", system=name)
    return pictures
