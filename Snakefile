"""burstcast: forecasting and control of extreme events in chaotic flows."""


include: "workflow/Snakefile"


# Snakemake forgets the default target of files that are included
workflow.default_target = rules.all.rule.name
