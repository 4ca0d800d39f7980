"""Control of extreme events, by any forecaster and by alarms at random."""

CONTROL = f"{FORECASTER}/control_PT{{prediction_time_lt}}"
RANDOM = f"{FORECASTER}/control_random_PT{{prediction_time_lt}}"

stage(
    "control/control",
    "control, so many Lyapunov times ahead",
    inputs=files("ensemble summary time_unit forecaster"),
    outputs={"counts": f"{CONTROL}.json", "histograms": f"{CONTROL}.nc"},
    settings="CONTROL OBSERVED case.controlled_density forecaster.options",
    cost="control",
    cached=True,
)
stage(
    "control/control_random",
    "actuation at random, as often as it",
    inputs={**files("ensemble summary time_unit"), "rate": f"{CONTROL}.json"},
    outputs={"counts": f"{RANDOM}.json", "histograms": f"{RANDOM}.nc"},
    settings="CONTROL case.controlled_density",
    cost="integration",
    cached=True,
)
stage(
    "control/suppressed_event",
    "a suppressed event",
    inputs=files("ensemble summary time_unit forecaster"),
    outputs={"event": f"{FORECASTER}/suppressed_event_PT{{prediction_time_lt}}.nc"},
    settings="CONTROL OBSERVED forecaster.options",
    cost="control",
)
