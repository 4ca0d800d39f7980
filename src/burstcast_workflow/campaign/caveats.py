"""What a campaign should not be expected to do: warnings before any job."""

from collections.abc import Iterator

import numpy as np

from burstcast.base import durations
from burstcast.data.starting_points import starting_points
from burstcast.statistics.warning_signs import FEW_POSITIVES
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.lengths import plans_of
from burstcast_workflow.config.case_checks import factors_of


def extrapolations(campaign: Campaign) -> Iterator[str]:
    """Warn of parameter values outside of those in training."""
    names = campaign.config.forecasters.aware.parameters
    for name in campaign.aware_cases:
        case = campaign.cases[name]
        sources = [campaign.cases[source] for source in campaign.sources(name)]
        factors = factors_of(campaign.config, sources)
        strengths: set[float] = set()
        for _, plan in plans_of(campaign.config, name):
            if case.actuation is not None and plan.strategy.informed:
                strengths.add(plan.strength)
                if dict(plan.settings).get("reversible"):
                    strengths.add(-plan.strength)
        if case.training.actuation and case.training.actuation.tested:
            strengths.add(case.training.actuation.strength)
        for strength in (0.0, *sorted(strengths)):
            if message := factors.outside(np.array([case.values_of(names, strength)])):
                yield f"{name}: {message}"


def few_points(campaign: Campaign) -> str:
    """Cases with fewer starting points than the events of any score, in words; "" without such."""
    config, lacking = campaign.config, []
    for name, case in campaign.cases.items():
        steps, samples = case.steps_per_lyapunov_time, case.samples
        if not case.has_equations or steps is None or samples is None:
            continue
        washout = durations.steps(config.washout_lt, steps)
        reach = durations.steps(config.classification.reach_lt, steps)
        calibration = config.probability.calibration_series or case.training.series
        few = []
        for use, series, spacing_lt in (
            ("score", case.test_series, config.classification.start_spacing_lt),
            ("calibrate with", calibration, config.probability.start_spacing_lt),
        ):
            spacing = durations.steps(spacing_lt, steps)
            points = len(starting_points(series, samples, spacing, washout, reach))
            few += [f"{points} to {use}"] if points < FEW_POSITIVES else []
        lacking += [f"{name} has {' and '.join(few)}"] if few else []
    if not lacking:
        return ""
    return (
        f"fewer than {FEW_POSITIVES} starting points of forecasts: {', '.join(lacking)}; raise "
        "test_series, training.series or ensemble.duration, or lower start_spacing_lt"
    )
