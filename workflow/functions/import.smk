def record_settings(wildcards):
    case = CASE[wildcards.case]
    part = wildcards.get("part")
    return case["test_records"][part] if part else case["record"]
