"""Settings that several stages read, by one name for all of them."""

GROUPS = {
    "SYSTEM": "case.system case.parameters",
    # from which a Lyapunov time follows, if the config knows it
    "TIME": "case.ensemble.time_step case.ensemble.sampling_stride "
    "case.lyapunov.time_unit case.lyapunov.published_exponent",
    # what everybody observes: the true states with noise
    "OBSERVED": "random_seed case.training.noise case.training.series",
    # how forecasts are cut into windows
    "WINDOWS": "classification.resolution_lt classification.window_lt "
    "classification.longest_prediction_time_lt",
    "HORIZON": "horizon.longest_lead_time_lt horizon.lead_time_step_lt horizon.tolerance",
    # what scores of probabilities are made with
    "SCORED": "random_seed bootstrap classification.prediction_times_lt "
    "classification.window_lt classification.resolution_lt",
    "RESERVOIR": "random_seed forecasters.esn.connectivity forecasters.esn.input_bias "
    "forecasters.esn.backend",
    "SEARCH": "SYSTEM TIME OBSERVED RESERVOIR case.recycle_validation washout_lt "
    "search.interval_lt search.tikhonov search.spectral_radius search.input_scaling",
    "FORECASTER": "SYSTEM TIME forecaster.options",
    # long runs: where they start and how long they are
    "LONG_RUNS": "FORECASTER OBSERVED washout_lt statistics.starting_points "
    "statistics.start_spacing_lt statistics.duration",
    "LONG_TERM": "LONG_RUNS forecaster.divergence_bound case.density "
    "case.laminarisation_threshold case.fixed_point statistics.fixed_point_interval_lt",
    "CONTROL": "SYSTEM TIME random_seed case.training.series case.event_threshold "
    "case.laminarisation_threshold case.actuation washout_lt control.flows control.run",
}


def listed(text: str) -> list[str]:
    """Paths of settings that a text of paths and names of groups stands for, each once."""
    paths: list[str] = []
    for name in text.split():
        paths += listed(GROUPS[name]) if name in GROUPS else [name]
    return list(dict.fromkeys(paths))
