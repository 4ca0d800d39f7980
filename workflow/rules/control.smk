"""Control of extreme events: strategies with a forecaster, several, or none, and at random."""


def files_of_control(directory):
    """What every run of control writes."""
    names = {
        "counts": "counts.json",
        "histograms": "histograms.nc",
        "flows": "flows.nc",
    }
    return {name: f"{directory}/{{strategy}}/{file}" for name, file in names.items()}


stage(
    "control/control",
    "control",
    inputs=files("ensemble summary time_unit forecaster"),
    outputs=files_of_control(f"{FORECASTER}/control"),
    settings="CONTROL case.controlled_density forecaster.options",
    cost="control",
    cached=True,
)
stage(
    "control/control_committee",
    "control by a vote",
    inputs={**files("ensemble summary time_unit"), "forecasters": stages.voters_of_job},
    outputs=files_of_control(f"{FORECASTER}/control_committee"),
    settings="CONTROL case.controlled_density forecaster.options",
    cost="control",
    cached=True,
)
stage(
    "control/control_without_forecast",
    "control without a forecast",
    inputs=files("ensemble summary time_unit"),
    outputs=files_of_control(f"{CASE}/control"),
    settings="CONTROL case.controlled_density",
    cost="integration",
    cached=True,
)
stage(
    "control/control_random",
    "actuation at random, as often as it",
    inputs={
        **files("ensemble summary time_unit"),
        "rate": f"{FORECASTER}/control/{{strategy}}/counts.json",
    },
    outputs=files_of_control(f"{FORECASTER}/control_random"),
    settings="CONTROL case.controlled_density",
    cost="integration",
    cached=True,
)
stage(
    "control/suppressed_event",
    "a suppressed event",
    inputs=files("ensemble summary time_unit forecaster"),
    outputs={"event": f"{FORECASTER}/control/{{strategy}}/suppressed_event.nc"},
    settings="CONTROL forecaster.options",
    cost="control",
)
