from snakemake.utils import min_version, validate

min_version("9.27")


configfile: "config/config.yaml"


validate(config, "workflow/schemas/config.schema.yaml")


include: "workflow/rules/common.smk"
include: "workflow/rules/acquisition.smk"
include: "workflow/rules/import.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/tables.smk"
