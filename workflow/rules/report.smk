"""The report: all figures and tables of a campaign on one page."""

from burstcast_workflow.figures.report import report_of


rule report_page:
    input:
        figures=expand(
            f"{RESULTS}/figures/{{figure}}.png", figure=figure_names(campaign)
        ),
        tables=expand(f"{TABLES}/{{table}}.csv", table=table_names(campaign)),
        template=local(beside("../report/page.html")),
    output:
        page=f"{RESULTS}/report.html",
    log:
        f"{LOGS}/report_page.log",
    conda:
        "../envs/burstcast.yaml"
    resources:
        **resources_of("short"),
    params:
        *of_script("report/report_page.py", report=report_of(campaign)),
    script:
        "../scripts/report/report_page.py"
