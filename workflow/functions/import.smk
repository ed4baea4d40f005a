def record_settings(wildcards):
    case = CASE[wildcards.case]
    part, further = wildcards.get("part"), wildcards.get("further")
    if further:
        return case["records"][further]
    return case["test_records"][part] if part else case["record"]


def record_file(wildcards):
    """The file a case names. Where there is none, the message says what to do about it."""
    file = record_settings(wildcards)["file"]
    if not Path(file).exists():
        missing = InputError(
            f"the record {file} does not exist",
            file=CASES[wildcards.case],
            field="file",
            remedy="Correct the path, or fetch the public records with `make records`",
        )
        raise WorkflowError(str(missing))
    return file
