from snakemake.utils import min_version

min_version("9.27")


include: "workflow/functions/package.smk"


configfile: readable("config/config.yaml")


# Only for `--software-deployment-method apptainer`, after `make container`; else .venv serves.
container: "workflow/container.sif"


include: "workflow/functions/common.smk"
include: "workflow/functions/groups.smk"
include: "workflow/rules/acquisition.smk"
include: "workflow/rules/import.smk"
include: "workflow/rules/identification.smk"
include: "workflow/rules/recovery.smk"
include: "workflow/rules/tracking.smk"
include: "workflow/rules/frequency.smk"
include: "workflow/rules/handover.smk"
include: "workflow/rules/discrepancy.smk"
include: "workflow/rules/control.smk"
include: "workflow/rules/trials.smk"
include: "workflow/rules/cases.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/tables.smk"
include: "workflow/functions/datasets.smk"


# `make audit` compares the results with the manifest. A run that is killed leaves none.
onstart:
    withdraw()


onsuccess:
    collect().write()


# The profile keeps quiet about rules, and with them about why one failed.
onerror:
    collect().write()
    print(failures("results", STARTED), file=sys.stderr)


# Copies of files are too small for a job of a cluster.
localrules:
    first_actuator,


rule study:
    default_target: True
    input:
        EVERY_DATASET,
        EVERY_FIGURE,
        EVERY_TABLE,


# A record made elsewhere: `make case NAME=...`, and all of them with their table: `make cases`.
for name in CASES:

    rule:
        name:
            f"case_{name}"
        input:
            of_case(name),
            f"results/{name}/page.html",


rule cases:
    input:
        [file for name in CASES for file in of_case(name)],
        TABLES["cases"].files("csv", "md", "tex"),


# The records that `make resolve NAME=...` begins from, and those handed in since.
for name in [*ACTUATORS, *CASES]:

    rule:
        name:
            f"resolvable_{name}"
        input:
            f"results/{name}/record.nc",
            [
                f"results/{name}/further/{part}.nc"
                for part in CASE.get(name, {}).get("records", {})
            ],


rule discrepancy:
    input:
        [file for name in ACTUATORS for file in of_diagnosis(name)],


rule control_all:
    input:
        FIGURES["control"].files("png", "pdf", system=VIRTUAL),
        TABLES["control"].files("csv", "md", "tex"),


# The identified models that `make control-robustness` tries, and the records they are of.
rule control_models:
    input:
        expand(
            "results/{actuator}/{file}.nc", actuator=VIRTUAL, file=["record", "model"]
        ),


rule real_records:
    input:
        TABLES["real_records"].files("csv", "md", "tex"),
        [file for name in DIAGNOSED_CASES for file in of_diagnosis(name)],


rule trials:
    input:
        trial_results(),
