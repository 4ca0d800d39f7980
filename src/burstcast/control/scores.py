"""Names of the scores of control: properties of what is counted (`burstcast.control`)."""

COUNT_SCORES = (
    "exceedance_uncontrolled",
    "exceedance_controlled",
    "exceedance_free",
    "reduction",
    "control_fraction",
    "alarm_rate",
)
