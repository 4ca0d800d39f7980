"""burstcast: forecasting and control of extreme events in chaotic flows."""

from snakemake.utils import min_version

min_version("9.20")


# beside this file, wherever the workflow runs; what is laid over it comes with --configfile
configfile: f"{workflow.current_basedir}/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/data.smk"
include: "workflow/rules/forecasters.smk"
include: "workflow/rules/evaluation.smk"
include: "workflow/rules/control.smk"
include: "workflow/rules/probabilities.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"


rule all:
    default_target: True
    input:
        # what tables are made from is asked for, too: Snakemake does not miss a file that only
        # something up to date depends on
        rules.forecasters.input,
        rules.tables.input,
        rules.figures.input,
    localrule: True
