"""What to try where a sign of `burstcast.warning_signs` was found, in terms of the settings."""

ADVICE = {
    "optimum_on_edge": "search beyond it: its entry in the section search",
    "few_events": "lower event_threshold, or raise ensemble.series or ensemble.duration",
    "few_positives": "raise test_series (and ensemble.series); read F with its interval "
    "in classification_intervals.csv",
    "lost_long_runs": "try other seeds, more neurons or more noise (training.noise); read the "
    "statistics beside survival.csv",
    "ill_conditioned_readout": "leave out the smallest values of search.tikhonov",
    "exponents_differ": "raise lyapunov.series, check lyapunov.saturation and perturbation; set "
    "lyapunov.time_unit to computed where the published exponent is of something else",
    "own_exponents_differ": "if the statistics of these forecasters are those of the data "
    "(statistics.csv), count in their Lyapunov time: their exponent as lyapunov.published_exponent",
    "outside_bins": "widen density.range",
    "noise_drowns_components": "lower training.noise, or raise ensemble.sampling_stride",
}
"""By the sign."""
