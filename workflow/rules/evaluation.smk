"""Time-accurate prediction: forecasts of the evaluation set, prediction horizons of events."""

stage(
    "evaluation/forecast",
    "forecast the evaluation set",
    inputs=files("forecaster evaluation_set"),
    outputs={"forecast": f"{FORECASTER}/forecast.nc"},
    settings="FORECASTER forecaster.divergence_bound forecasters.aware WINDOWS",
    cost="forecast",
    cached=True,
    constraints={"forecaster": f"{NO_CLASSIFIER}[^/]+"},
)
stage(
    "evaluation/external_forecasts",
    "read forecasts of another program",
    inputs={
        "files": stages.external_files,
        **files("ensemble evaluation_set events summary"),
    },
    outputs={
        "forecast": f"{FORECASTER}/forecast.nc",
        "horizon": f"{FORECASTER}/horizon.nc",
    },
    settings="TASK",
    cost="data",
    constraints={"forecaster": EXTERNAL},
    noise=of_case(Campaign.noise),
)
stage(
    "evaluation/horizon",
    "prediction horizons",
    inputs=files("forecaster events summary"),
    outputs={"horizon": f"{FORECASTER}/horizon.nc"},
    settings="FORECASTER HORIZON case.event_threshold washout_lt",
    cost="horizon",
    cached=True,
    constraints={"forecaster": f"{NO_CLASSIFIER}[^/]+"},
)
stage(
    "evaluation/long_term",
    "long-term runs",
    inputs=files("ensemble forecaster"),
    outputs={"long_term": f"{FORECASTER}/long_term.nc"},
    settings="LONG_TERM",
    cost="long_term",
    cached=True,
)
stage(
    "evaluation/lyapunov_spectrum",
    "Lyapunov exponents of its own flow",
    inputs=files("ensemble forecaster long_term"),
    outputs={"spectrum": f"{FORECASTER}/lyapunov_spectrum.nc"},
    settings="LONG_RUNS case.lyapunov.orthonormalisation_interval "
    "statistics.lyapunov_exponents statistics.lyapunov_runs",
    cost="spectrum",
    cached=True,
)
stage(
    "evaluation/examples",
    "example forecasts",
    inputs=files("ensemble summary evaluation_set events forecaster forecast horizon"),
    outputs={"examples": f"{FORECASTER}/examples.nc"},
    settings="FORECASTER HORIZON WINDOWS case.event_threshold case.training.series washout_lt "
    "figures.example_horizon_lt",
    cost="examples",
    prediction_time_lt=campaign.prediction_time(2),
)
stage(
    "evaluation/flow_event",
    "an event whose flow is worth seeing",
    inputs=files("ensemble summary forecaster"),
    outputs={"event": f"{FORECASTER}/flow_event.nc"},
    settings="FORECASTER OBSERVED case.test_series "
    "case.event_threshold washout_lt figures.flow_event",
    cost="examples",
)
