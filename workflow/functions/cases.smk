# Cases with test records, and cases whose simulation is diagnosed.
TESTED_CASES = [name for name, case in CASE.items() if case.get("test_records")]
DIAGNOSED_CASES = [name for name, case in CASE.items() if "simulation" in case]


def test_parts(wildcards):
    """The imported test records of a case."""
    parts = CASE[wildcards.case]["test_records"]
    return [f"results/{wildcards.case}/test/{part}.nc" for part in parts]
