"""Data of a case: the ensemble, its exponents and statistics, what forecasters are judged on."""

from burstcast.data.training_realisations import realisation_of

stage(
    "data/simulate",
    "integrate the ensemble",
    outputs={"ensemble": f"{CASE}/ensemble.nc", "summary": f"{CASE}/dataset.json"},
    settings="SYSTEM random_seed case.ensemble case.laminarisation_threshold",
    cost="integration",
    cached=True,
    constraints={"case": INTEGRATED},
)
stage(
    "data/import_data",
    "check and copy measured series",
    inputs={"sources": stages.sources_of_data},
    outputs={"ensemble": f"{CASE}/ensemble.nc", "summary": f"{CASE}/dataset.json"},
    settings="SYSTEM STEPS case.data case.laminarisation_threshold case.training.series "
    "case.test_series",
    cost="data",
    constraints={"case": IMPORTED},
    noise=of_case(Campaign.noise_of_data),
)
stage(
    # what sensors see of another case, or an encoder makes of it
    "data/encode",
    "observe and encode the series of another case",
    inputs={
        "source": of_case(
            lambda campaign, case: f"{RESULTS}/{campaign.source_case(case)}/ensemble.nc"
        )
    },
    outputs={
        "ensemble": f"{CASE}/ensemble.nc",
        "summary": f"{CASE}/dataset.json",
        "encoder": f"{CASE}/encoder.nc",
    },
    settings="SYSTEM STEPS random_seed case.training.series case.sensors case.encoder",
    cost="data",
    constraints={"case": one_of(campaign.encoded_cases)},
    noise=of_case(Campaign.noise_of_data),
    source=of_case(Campaign.source_system),
)
stage(
    # the series of another case with other training series
    "data/training_realisation",
    "choose other training series",
    inputs={"source": stages.ensemble_of_source},
    outputs={"ensemble": f"{CASE}/ensemble.nc", "summary": f"{CASE}/dataset.json"},
    settings="SYSTEM STEPS random_seed case.training.series case.test_series "
    "probability.calibration_series",
    cost="data",
    constraints={"case": REALISED},
    realisation=of_case(lambda campaign, case: realisation_of(case)[1]),
    drawn=of_case(Campaign.drawn_shares),
)
stage(
    "data/event_threshold",
    "the event threshold, a quantile of the training series",
    inputs=files("ensemble"),
    outputs={"event_threshold": f"{CASE}/event_threshold.json"},
    settings="case.training.series",
    cost="data",
    quantile=of_case(Campaign.event_quantile),
)
stage(
    # what kinds of forecasters learn from that know the parameters
    "data/scheduled_series",
    "series with the parameters in force",
    inputs=files("ensemble"),
    outputs={"scheduled_series": f"{CASE}/scheduled_series.nc"},
    settings="SYSTEM TIME OBSERVED case.training.actuation case.actuation "
    "case.laminarisation_threshold",
    cost="data",
    constraints={"case": one_of([*campaign.simulated_cases, *campaign.known_cases])},
    parameters=campaign.config.forecasters.aware.parameters,
)
stage(
    "data/lyapunov",
    "Lyapunov exponents",
    inputs=files("ensemble"),
    outputs={
        "exponents": f"{CASE}/lyapunov.json",
        "spectrum": f"{CASE}/lyapunov_spectrum.nc",
    },
    settings="SYSTEM STEPS random_seed case.lyapunov.series case.lyapunov.perturbation "
    "case.lyapunov.saturation case.lyapunov.orthonormalisation_interval",
    cost="tangent",
    cached=True,
    constraints={"case": SIMULATED},
)
stage(
    "data/neighbour_divergence",
    "Lyapunov exponent, from how neighbours part",
    inputs=files("ensemble"),
    outputs={"exponents": f"{CASE}/lyapunov.json"},
    settings="STEPS random_seed bootstrap case.training.series",
    cost="data",
    constraints={"case": MEASURED},
    sets_time_unit=of_case(Campaign.estimates_time_unit),
)
stage(
    # what does not fit fails here at once, with one list
    "data/lengths",
    "compare what the config needs with the lengths of the series",
    inputs=files("ensemble"),
    outputs={"lengths": f"{CASE}/lengths.json"},
    settings="TIME washout_lt search.interval_lt search.single_shot_lead_steps WINDOWS "
    "classification.start_spacing_lt probability.start_spacing_lt "
    "horizon.longest_lead_time_lt horizon.lead_time_step_lt case.training.series "
    "case.recycle_validation statistics.fixed_point_interval_lt statistics.duration "
    "forecasters.quadratic.window_lt",
    cost="data",
    constraints={"case": one_of(campaign.computed_times)},
    priority=1,
    asked=of_case(Campaign.asked_of_series),
)
EVALUATION_SET = {"evaluation_set": f"{CASE}/evaluation_set.nc"}
EVALUATED = (
    "SYSTEM TIME OBSERVED WINDOWS case.test_series washout_lt "
    "classification.start_spacing_lt"
)
stage(
    "data/evaluation_set",
    "starting points of the forecasts",
    inputs=files("ensemble"),
    outputs=EVALUATION_SET,
    settings=EVALUATED,
    cost="data",
    constraints={"case": one_of({*campaign.cases} - {*campaign.switched_cases})},
)
stage(
    "data/switched_evaluation_set",
    "starting points of forecasts under actuation",
    inputs=files("ensemble"),
    outputs=EVALUATION_SET,
    settings=f"{EVALUATED} case.training.actuation case.actuation "
    "case.laminarisation_threshold",
    cost="data",
    constraints={"case": one_of(campaign.switched_cases)},
    parameters=campaign.config.forecasters.aware.parameters,
)
stage(
    "data/events",
    "extreme events",
    inputs=files("ensemble"),
    outputs={"events": f"{CASE}/events.nc", "events_summary": f"{CASE}/events.json"},
    settings="TIME OBSERVED case.event_threshold washout_lt horizon.events "
    "horizon.longest_lead_time_lt",
    cost="data",
)
stage(
    # a target for people whose programs forecast the case
    "data/forecast_task",
    "export the washouts for other programs",
    inputs=files("ensemble evaluation_set events summary"),
    outputs={
        "forecast_task": f"{CASE}/forecast_task.nc",
        "page_of_task": f"{CASE}/forecast_task.md",
    },
    settings="TASK",
    cost="data",
    noise=of_case(Campaign.noise),
)
stage(
    "data/reference_statistics",
    "long-term statistics of the data",
    inputs=files("ensemble summary"),
    outputs={
        "data": f"{CASE}/statistics_data.nc",
        "training": f"{CASE}/statistics_training.nc",
        "floor": f"{CASE}/statistics_floor.nc",
    },
    settings="SYSTEM random_seed case.density case.training.series "
    "statistics.profile_points statistics.floor_splits",
    cost="data",
)
