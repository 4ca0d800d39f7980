"""Control of extreme events by all controllers: forecasters, committees, none, and at random."""

CONTROL = f"{CASE}/control/{{controller}}/{{strategy}}"
controlling = {**files("ensemble summary"), "forecasters": stages.controlling}
stage(
    "control/control",
    "control",
    inputs={
        **controlling,
        "encoder": stages.encoder_of_observed,
        "matched": stages.matched_flows,
    },
    outputs={"flows": f"{CONTROL}/flows.nc"},
    settings="CONTROL case.controlled_density forecaster.options forecasters.aware "
    "control.cost control.sensor",
    cost="control",
    cached=True,
)
stage(
    "control/suppressed_event",
    "a suppressed event",
    inputs=controlling,
    outputs={"event": f"{CONTROL}/suppressed_event.nc"},
    settings="CONTROL forecaster.options",
    cost="control",
)
