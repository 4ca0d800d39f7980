"""Figures: one rule for all of them; each module of `burstcast.figures` says what it is made of."""

from burstcast_workflow.figures.jobs import FigureJobs
from burstcast_workflow.figures.registry import FIGURES, figure_names, keep_figures

drawn = FigureJobs(stages, started.beside("../../resources/published_percentiles.csv"))


rule figure:
    input:
        unpack(drawn.files),
    output:
        pdf="<results>/figures/{figure}{of_case}.pdf",
        png=report(
            "<results>/figures/{figure}{of_case}.png",
            caption="../report/figure.rst",
            category=drawn.category,
            subcategory="Figures",
            labels=drawn.labels,
        ),
    log:
        "<logs>/figure/{figure}{of_case}.log",
    wildcard_constraints:
        figure=any_of_regex(FIGURES),
        # nothing for the case that figures show by default
        of_case="(_[^/]+)?",
    group:
        "figures"
    resources:
        **resources_of("short"),
    params:
        settings=drawn.settings,
        code=drawn.code,
    script:
        "../scripts/figures/figure.py"


rule figures:
    input:
        expand(
            "<results>/figures/{figure}.{suffix}",
            figure=figure_names(campaign),
            suffix=["pdf", "png"],
        ),
    localrule: True
