"""Figures: one rule for all of them; `burstcast_workflow.figure_registry` says what each is made of."""


rule figure:
    input:
        unpack(files_of_figure),
    output:
        pdf=f"{RESULTS}/figures/{{figure}}{{of_case}}.pdf",
        png=report(
            f"{RESULTS}/figures/{{figure}}{{of_case}}.png",
            caption="../report/figure.rst",
            category=category_of_figure,
            subcategory="Figures",
            labels=labels_of_figure,
        ),
    log:
        f"{LOGS}/figure/{{figure}}{{of_case}}.log",
    benchmark:
        f"{TIMES}/figure/{{figure}}{{of_case}}.tsv"
    wildcard_constraints:
        figure="|".join(FIGURES),
        # nothing for the case that figures show by default
        of_case=r"(_[A-Za-z][A-Za-z0-9_.-]*)?",
    group:
        "figures"
    conda:
        ENVIRONMENT
    resources:
        **needs("figure", "figure"),
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
            f"{RESULTS}/figures/{{figure}}.{{suffix}}",
            figure=figure_names(campaign),
            suffix=["pdf", "png"],
        ),
    localrule: True
