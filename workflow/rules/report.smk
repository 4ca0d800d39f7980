"""The report: all figures and tables of a campaign on one page."""

from burstcast_workflow.figures.report import report_of


rule report_page:
    input:
        figures=expand("<results>/figures/{figure}.png", figure=figure_names(campaign)),
        tables=expand("<results>/tables/{table}.csv", table=table_names(campaign)),
        template=local(started.beside("../report/page.html")),
    output:
        page="<results>/report.html",
    log:
        "<logs>/report_page.log",
    group:
        "figures"
    resources:
        **resources_of("short"),
    params:
        settings=settings(report=report_of(campaign)),
    script:
        "../scripts/report/report_page.py"
