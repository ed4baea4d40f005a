# Cases with test records, and cases whose simulation is diagnosed.
TESTED_CASES = [name for name, case in CASE.items() if case.get("test_records")]
DIAGNOSED_CASES = [name for name, case in CASE.items() if "simulation" in case]


def test_parts(wildcards):
    """The imported test records of a case."""
    parts = CASE[wildcards.case]["test_records"]
    return [f"results/{wildcards.case}/test/{part}.nc" for part in parts]


def of_case(name):
    """What one case asks for: its figures and, where it has test records, their scores."""
    scores = f"results/{name}/test_scores.nc"
    return FIGURES["case"].files("png", "pdf", system=name) + [scores] * (
        name in TESTED_CASES
    )
