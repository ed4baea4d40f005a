def test_parts(wildcards):
    """The imported test records of a case."""
    parts = CASE[wildcards.case]["test_records"]
    return [f"results/{wildcards.case}/test/{part}.nc" for part in parts]


def of_case(name):
    """What one case asks for: its figures and, where it has test records, their scores."""
    scores = f"results/{name}/test_scores.nc"
    return expand(FIGURES_OF_CASE, case=name) + [scores] * (name in TESTED_CASES)
