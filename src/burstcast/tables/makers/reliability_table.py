"""Reliability of the probabilities: how often events follow those of each bin."""

from burstcast.base.declared import at, declaring, made_by
from burstcast.forecasts.scores import binned, consistency_bars
from burstcast.tables.makers._probabilities import CaseProbabilities, case_probabilities
from burstcast.tables.makers.registry import Rows


@declaring
def make(
    *, case: CaseProbabilities = made_by(case_probabilities), bins: int = at("probability.bins")
) -> dict[str, Rows]:
    """A row for each bin, of committees and of all forecasters but single networks."""
    in_bins: Rows = []
    for time in case.times:
        weights = case.weights(time)
        for alarm in case.compared:
            for probability, (outcomes, _) in case.probabilities(alarm, time).items():
                keys = {**case.keys(alarm), "probability": probability, "prediction_time_lt": time}
                whole = binned(outcomes.total(), bins)
                low, high = consistency_bars(
                    outcomes,
                    bins,
                    weights,
                    case.confidence,
                    case.stream("reliability", time, alarm.identifier, probability),
                )
                in_bins += [
                    {
                        **keys,
                        "bin": number,
                        "forecasts": int(whole.points[number]),
                        "mean_probability": whole.mean_probability[number],
                        "observed_frequency": whole.frequency[number],
                        "consistency_low": low[number],
                        "consistency_high": high[number],
                    }
                    for number in range(bins)
                ]
    return {"reliability": in_bins}
