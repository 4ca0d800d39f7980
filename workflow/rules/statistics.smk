"""Statistical prediction: the long-term statistics of the data and of the networks."""


rule reference_statistics:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
    output:
        data=f"{RESULTS}/{{case}}/statistics_data.nc",
        training=f"{RESULTS}/{{case}}/statistics_training.nc",
        floor=f"{RESULTS}/{{case}}/statistics_floor.nc",
    log:
        f"{RESULTS}/logs/reference_statistics/{{case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/reference_statistics/{{case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("reference_statistics"),
        runtime=runtime_of("reference_statistics"),
    params:
        settings=settings_of("reference_statistics"),
        code=code_of("reference_statistics"),
    message:
        "{wildcards.case}: long-term statistics of the data"
    script:
        "../scripts/reference_statistics.py"


rule climate:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        network=f"{NETWORK}/network.nc",
        lyapunov=time_unit,
    output:
        climate=f"{NETWORK}/climate.nc",
    log:
        f"{RESULTS}/logs/climate/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/climate/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("climate"),
        runtime=runtime_of("climate"),
    params:
        settings=settings_of("climate"),
        code=code_of("climate"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: long closed loops"
    script:
        "../scripts/climate.py"


rule statistics_table:
    input:
        data=of_cases("statistics_data.nc"),
        training=of_cases("statistics_training.nc"),
        floor=of_cases("statistics_floor.nc"),
        climates=of_networks("climate.nc", campaign.climate_networks),
    output:
        table=f"{TABLES}/statistics.csv",
    log:
        f"{RESULTS}/logs/statistics_table.log",
    benchmark:
        f"{RESULTS}/benchmarks/statistics_table.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("statistics_table"),
        runtime=runtime_of("statistics_table"),
    params:
        settings=settings_of("statistics_table"),
        code=code_of("statistics_table"),
    message:
        "table of the long-term statistics"
    script:
        "../scripts/statistics_table.py"


rule flow_event:
    input:
        ensemble=f"{RESULTS}/{{case}}/ensemble.nc",
        summary=f"{RESULTS}/{{case}}/dataset.json",
        network=f"{NETWORK}/network.nc",
        lyapunov=time_unit,
    output:
        event=f"{NETWORK}/flow_event.nc",
    log:
        f"{RESULTS}/logs/flow_event/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/flow_event/{{case}}-N{{neurons}}-{{validation}}-seed{{seed}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("flow_event"),
        runtime=runtime_of("flow_event"),
    params:
        settings=settings_of("flow_event"),
        code=code_of("flow_event"),
    message:
        "{wildcards.case}, {wildcards.neurons} neurons, {wildcards.validation}, seed {wildcards.seed}: an event whose flow is worth seeing"
    script:
        "../scripts/flow_event.py"


rule figure_energy_density:
    input:
        data=of_figure_case("statistics_data.nc"),
        training=of_figure_case("statistics_training.nc"),
        climates=statistics_candidates,
        percentiles=f"{TABLES}/statistics_percentiles.csv",
        published=published(),
    output:
        pdf=f"{FIGURES}/energy_density{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/energy_density{{of_case}}.png",
            caption="../report/energy_density.rst",
            category="Figures",
            labels=labels_of_figure("energy density"),
        ),
    log:
        f"{RESULTS}/logs/figure_energy_density{{of_case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_energy_density{{of_case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_energy_density"),
        runtime=runtime_of("figure_energy_density"),
    params:
        settings=settings_of("figure_energy_density"),
        code=code_of("figure_energy_density"),
    message:
        "figure: long-term density of the observable and its errors"
    script:
        "../scripts/figure_energy_density.py"


rule figure_profile_errors:
    input:
        data=of_figure_case("statistics_data.nc"),
        training=of_figure_case("statistics_training.nc"),
        climates=statistics_candidates,
        percentiles=f"{TABLES}/statistics_percentiles.csv",
        published=published(),
    output:
        pdf=f"{FIGURES}/profile_errors{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/profile_errors{{of_case}}.png",
            caption="../report/profile_errors.rst",
            category="Figures",
            labels=labels_of_figure("profile errors"),
        ),
    log:
        f"{RESULTS}/logs/figure_profile_errors{{of_case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_profile_errors{{of_case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_profile_errors"),
        runtime=runtime_of("figure_profile_errors"),
    params:
        settings=settings_of("figure_profile_errors"),
        code=code_of("figure_profile_errors"),
    message:
        "figure: velocity profiles and their errors"
    script:
        "../scripts/figure_profile_errors.py"


rule figure_midplane_mean_square:
    input:
        data=of_figure_case("statistics_data.nc"),
        training=of_figure_case("statistics_training.nc"),
        climates=statistics_candidates,
    output:
        pdf=f"{FIGURES}/midplane_mean_square{{of_case}}.pdf",
        png=report(
            f"{FIGURES}/midplane_mean_square{{of_case}}.png",
            caption="../report/midplane_mean_square.rst",
            category="Figures",
            labels=labels_of_figure("midplane mean square"),
        ),
    log:
        f"{RESULTS}/logs/figure_midplane_mean_square{{of_case}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_midplane_mean_square{{of_case}}.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_midplane_mean_square"),
        runtime=runtime_of("figure_midplane_mean_square"),
    params:
        settings=settings_of("figure_midplane_mean_square"),
        code=code_of("figure_midplane_mean_square"),
    message:
        "figure: mean square velocity in the midplane and its errors"
    script:
        "../scripts/figure_midplane_mean_square.py"


rule figure_midplane_planes:
    input:
        event=f"{EXAMPLE}/flow_event.nc",
    output:
        pdf=f"{FIGURES}/midplane_planes.pdf",
        png=report(
            f"{FIGURES}/midplane_planes.png",
            caption="../report/midplane_planes.rst",
            category="Figures",
            labels=labels_of_figure("midplane planes"),
        ),
    log:
        f"{RESULTS}/logs/figure_midplane_planes.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_midplane_planes.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_midplane_planes"),
        runtime=runtime_of("figure_midplane_planes"),
    params:
        settings=settings_of("figure_midplane_planes"),
        code=code_of("figure_midplane_planes"),
    message:
        "figure: velocity in the midplane during an event"
    script:
        "../scripts/figure_midplane_planes.py"


rule figure_vorticity_isosurfaces:
    input:
        event=f"{EXAMPLE}/flow_event.nc",
    output:
        pdf=f"{FIGURES}/vorticity_isosurfaces.pdf",
        png=report(
            f"{FIGURES}/vorticity_isosurfaces.png",
            caption="../report/vorticity_isosurfaces.rst",
            category="Figures",
            labels=labels_of_figure("vorticity isosurfaces"),
        ),
    log:
        f"{RESULTS}/logs/figure_vorticity_isosurfaces.log",
    benchmark:
        f"{RESULTS}/benchmarks/figure_vorticity_isosurfaces.tsv"
    conda:
        "../envs/burstcast.yaml"
    threads: 1
    resources:
        mem_mb=memory_of("figure_vorticity_isosurfaces"),
        runtime=runtime_of("figure_vorticity_isosurfaces"),
    params:
        settings=settings_of("figure_vorticity_isosurfaces"),
        code=code_of("figure_vorticity_isosurfaces"),
    message:
        "figure: vorticity and velocity before and after an event"
    script:
        "../scripts/figure_vorticity_isosurfaces.py"
