"""Figures: one rule for all of them; `burstcast_workflow.figure_registry` says what each is made of."""

import os

from burstcast_workflow.figure_registry import FIGURES as ALL_FIGURES
from burstcast_workflow.figure_registry import figure_case, figure_names

# The report reads captions from the config, where they are no setting of any job.
config["captions"] = {name: figure.caption for name, figure in ALL_FIGURES.items()}
PUBLISHED = os.path.relpath(PROJECT / "resources" / "published_percentiles.csv")


def case_of_figure(wildcards):
    """The case that a figure shows."""
    return figure_case(campaign, wildcards.figure, wildcards.of_case)


@of_job
def files_of_figure(wildcards):
    """What a figure is drawn from."""
    figure = ALL_FIGURES[wildcards.figure]
    files = figure.files(campaign, case_of_figure(wildcards))
    found = {
        name: (
            f"{RESULTS}/{paths}"
            if isinstance(paths, str)
            else [f"{RESULTS}/{path}" for path in paths]
        )
        for name, paths in files.items()
    }
    overlay = figure.published and config["figures"]["published_overlay"]
    return {**found, "published": PUBLISHED} if overlay else found


@of_job
def settings_of_figure(wildcards):
    """What a figure's script reads."""
    figure, case = ALL_FIGURES[wildcards.figure], case_of_figure(wildcards)
    return campaign.settings(
        figure.reads, {"case": case}, figure.values(campaign, case)
    )


@of_job
def code_of_figure(wildcards):
    """What a figure's script runs."""
    modules = campaign.modules({"case": case_of_figure(wildcards)})
    return sources.fingerprint(f"figures/{wildcards.figure}.py", modules)


def labels_of_figure(wildcards):
    """What the report calls a figure."""
    name = wildcards.figure.replace("_", " ")
    return {"figure": name, "case": case_of_figure(wildcards)}


rule figure:
    input:
        unpack(files_of_figure),
    output:
        pdf=f"{FIGURES}/{{figure}}{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/{{figure}}{{of_case}}.png",
            caption="../report/figure.rst",
            category="Figures",
            labels=labels_of_figure,
        ),
    log:
        f"{LOGS}/figure/{{figure}}{{of_case}}.log",
    benchmark:
        f"{TIMES}/figure/{{figure}}{{of_case}}.tsv"
    wildcard_constraints:
        figure="|".join(ALL_FIGURES),
        # nothing for the case that figures show by default
        of_case=r"(_[A-Za-z][A-Za-z0-9_.-]*)?",
    group:
        "figures"
    conda:
        ENVIRONMENT
    resources:
        **needs("figure"),
    params:
        settings=settings_of_figure,
        code=code_of_figure,
    message:
        "figure: {wildcards.figure}{wildcards.of_case}"
    script:
        "../scripts/figures/{wildcards.figure}.py"


rule figures:
    input:
        expand(
            f"{FIGURES}/{{figure}}.{{suffix}}",
            figure=figure_names(campaign),
            suffix=["pdf", "png"],
        ),
    localrule: True
