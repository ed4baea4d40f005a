from snakemake.utils import min_version

min_version("9.27")


configfile: "config/config.yaml"


# Only for `--software-deployment-method apptainer`, after `make container`; else .venv serves.
container: "workflow/container.sif"


include: "workflow/functions/common.smk"
include: "workflow/rules/acquisition.smk"
include: "workflow/rules/import.smk"
include: "workflow/rules/identification.smk"
include: "workflow/rules/recovery.smk"
include: "workflow/rules/tracking.smk"
include: "workflow/rules/frequency.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/discrepancy.smk"
include: "workflow/rules/trials.smk"
include: "workflow/rules/cases.smk"


# The profile keeps quiet about rules, and with them about why one failed.
onerror:
    print(failures("results", STARTED), file=sys.stderr)


rule study:
    default_target: True
    input:
        EVERY_FIGURE,
        EVERY_TABLE,
