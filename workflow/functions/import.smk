def record_place(wildcards):
    """The keys of the case below which the record is described."""
    part, further = wildcards.get("part"), wildcards.get("further")
    if further:
        return ["records", further]
    return ["test_records", part] if part else ["record"]


def record_settings(wildcards):
    described = CASE[wildcards.case]
    for key in record_place(wildcards):
        described = described[key]
    return described


def record_file(wildcards):
    """The file a case names. Where there is none, the message says what to do about it."""
    file = record_settings(wildcards)["file"]
    if not Path(file).is_file():
        missing = InputError(
            f"the record {file or repr(file)} does not exist",
            file=CASES[wildcards.case],
            field=".".join([*record_place(wildcards), "file"]),
            remedy="Correct the path, or fetch the public records with `make records`",
        )
        raise WorkflowError(str(missing))
    return file
