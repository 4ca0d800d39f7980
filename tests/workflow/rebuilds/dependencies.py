"""What each rule depends on, written by hand: the oracle of the tests of selective rebuilds.

Nothing here comes from the workflow's own code. ``case.x`` stands for the setting x of a case,
wherever the config says it. Jobs of one rule that depend on different things are told apart, as
``rule/what``: those of forecasters by the kind that forecasts, those of control by the controller.
What other strategies of control than the paper's do is by the strategy, too: only the paper's has
alarms at random beside it.
"""

from fnmatch import fnmatchcase

# the Reynolds number, a column of tables
_KEYS = "case.parameters.*"
_SYSTEM = f"case.system {_KEYS}"
_TIME = """case.ensemble.time_step case.ensemble.sampling_stride
    case.lyapunov.time_unit case.lyapunov.published_exponent"""
_OBSERVED = "random_seed case.training.*"
_RESERVOIR = """random_seed forecasters.esn.connectivity forecasters.esn.input_bias
    forecasters.esn.readout forecasters.esn.input_range forecasters.esn.input_offset
    forecasters.esn.backend"""
_WINDOWS = """classification.resolution_lt classification.longest_prediction_time_lt
    classification.window_lt"""
_SEARCH = f"""{_SYSTEM} {_TIME} {_OBSERVED} {_RESERVOIR} case.recycle_validation.* washout_lt
    search.spectral_radius search.input_scaling search.tikhonov search.interval_lt
    search.single_shot_lead_steps forecasters.esn.leak_rate"""
_HORIZON = f"""{_SYSTEM} {_TIME} case.event_threshold washout_lt
    horizon.longest_lead_time_lt horizon.lead_time_step_lt horizon.tolerance"""
_LONG_RUNS = f"""{_SYSTEM} {_TIME} {_OBSERVED} washout_lt statistics.starting_points
    statistics.start_spacing_lt statistics.duration"""
_LONG_TERM = f"""{_LONG_RUNS} case.density.* case.laminarisation_threshold case.fixed_point.*
    statistics.fixed_point_interval_lt"""
_SPECTRUM = f"""{_LONG_RUNS} case.lyapunov.orthonormalisation_interval
    statistics.lyapunov_exponents statistics.lyapunov_runs"""
_CONTROL = f"""{_SYSTEM} {_TIME} random_seed case.training.series
    case.event_threshold case.laminarisation_threshold case.actuation.*
    washout_lt control.window_lt control.flows control.span_lt"""
_OTHER_CONTROL = _CONTROL.replace("control.window_lt", "")
_PAPERS_CONTROL = f"{_CONTROL} case.controlled_density.*"
# A forecaster is restored with the settings of its kind; the equations have none, and see no noise.
# Whether forecasts have diverged is asked by those who judge them as a whole.
_NETWORK = """forecasters.esn.connectivity forecasters.esn.input_bias forecasters.esn.readout
    forecasters.esn.leak_rate forecasters.esn.input_range forecasters.esn.input_offset
    forecasters.esn.backend"""
_JUDGED = "forecasters.esn.divergence_bound"
_LEARNT = "forecasters.observation.* forecasters.quadratic.* forecasters.filter.*"
_TRUE = "random_seed case.training.series"

_SCORED = f"""{_KEYS} random_seed case.event_threshold bootstrap.*
    classification.prediction_times_lt classification.window_lt classification.resolution_lt"""
_CALIBRATION_FORECAST = f"""{_SYSTEM} {_TIME} {_WINDOWS} washout_lt
    probability.calibration_series"""

READS = {
    "simulate": f"{_SYSTEM} random_seed case.ensemble.* case.laminarisation_threshold",
    "lyapunov": f"""{_SYSTEM} random_seed case.ensemble.time_step case.ensemble.sampling_stride
        case.lyapunov.series case.lyapunov.orthonormalisation_interval
        case.lyapunov.perturbation case.lyapunov.saturation""",
    "evaluation_set": f"""{_SYSTEM} {_TIME} {_OBSERVED} {_WINDOWS} case.test_series washout_lt
        classification.start_spacing_lt""",
    "events": f"""{_TIME} {_OBSERVED} case.event_threshold washout_lt
        horizon.events horizon.longest_lead_time_lt""",
    "reference_statistics": f"""{_SYSTEM} random_seed case.density.* case.training.series
        statistics.profile_points statistics.floor_splits""",
    "scan": f"{_SEARCH} search.grid",
    "search": f"{_SEARCH} search.bayesian_points search.surrogate.*",
    "train": f"{_TIME} {_OBSERVED} {_RESERVOIR} washout_lt",
    "fit/equations": f"{_SYSTEM} {_TIME} {_TRUE}",
    "fit/equations_noisy": f"{_SYSTEM} {_TIME} {_OBSERVED}",
    "fit/quadratic_filtered": f"{_SYSTEM} {_TIME} {_OBSERVED} {_LEARNT}",
    "forecast/esn": f"{_SYSTEM} {_TIME} {_WINDOWS} {_NETWORK} {_JUDGED}",
    "forecast/equations": f"{_SYSTEM} {_TIME} {_WINDOWS}",
    "forecast/equations_noisy": f"{_SYSTEM} {_TIME} {_WINDOWS}",
    "forecast/quadratic_filtered": f"{_SYSTEM} {_TIME} {_WINDOWS} {_LEARNT}",
    "horizon/esn": f"{_HORIZON} {_NETWORK}",
    "horizon/equations": _HORIZON,
    "horizon/equations_noisy": _HORIZON,
    "horizon/quadratic_filtered": f"{_HORIZON} {_LEARNT}",
    "long_term/esn": f"{_LONG_TERM} {_NETWORK} {_JUDGED}",
    "lyapunov_spectrum/esn": f"{_SPECTRUM} {_NETWORK}",
    "control/esn": f"{_PAPERS_CONTROL} case.training.noise {_NETWORK}",
    "control/esn/receding_horizon": f"{_OTHER_CONTROL} case.training.noise {_NETWORK}",
    "control/equations": _PAPERS_CONTROL,
    "control/esn-random": _PAPERS_CONTROL,
    # what reacts looks at noisy observations
    "control/none": f"{_OTHER_CONTROL} case.training.noise",
    "control/esn-committee": f"{_OTHER_CONTROL} case.training.noise {_NETWORK}",
    "control/quadratic_filtered-committee": f"{_OTHER_CONTROL} case.training.noise {_LEARNT}",
    "statistics_table": f"{_SYSTEM} random_seed bootstrap.* statistics.profile_points",
    "survival_table": f"""{_KEYS} case.ensemble.time_step case.ensemble.sampling_stride
        statistics.duration bootstrap.confidence""",
    "lyapunov_spectrum_table": f"{_KEYS} random_seed bootstrap.*",
    "control_table": _KEYS,
    "control_density_table": f"{_KEYS} random_seed bootstrap.*",
    "warnings_table": f"""{_KEYS} case.event_threshold case.training.series case.training.noise
        horizon.events search.spectral_radius search.input_scaling search.tikhonov""",
    "control_strategies_table": f"{_KEYS} random_seed bootstrap.* case.training.noise",
    "dataset_table": f"{_KEYS} {_TIME}",
    "hyperparameters_table": _KEYS,
    "horizon_table": f"{_KEYS} random_seed bootstrap.*",
    "classification_table": f"""{_KEYS} random_seed case.event_threshold bootstrap.*
        classification.window_lt classification.resolution_lt classification.prediction_times_lt""",
    "calibration_set": f"""{_SYSTEM} {_TIME} {_OBSERVED} {_WINDOWS} case.test_series washout_lt
        probability.start_spacing_lt probability.calibration_series""",
    "calibration_forecast/esn": f"{_CALIBRATION_FORECAST} {_OBSERVED} {_NETWORK} {_JUDGED}",
    "calibration_forecast/equations": f"{_CALIBRATION_FORECAST} {_TRUE}",
    "calibration_forecast/equations_noisy": f"{_CALIBRATION_FORECAST} {_OBSERVED}",
    "calibration_forecast/quadratic_filtered": f"{_CALIBRATION_FORECAST} {_OBSERVED} {_LEARNT}",
    "calibrate": f"""{_TIME} case.event_threshold classification.prediction_times_lt
        classification.window_lt classification.resolution_lt
        probability.prior_forecasts""",
    "probability_scores": f"{_SCORED} probability.bins",
    "reliability_table": f"{_SCORED} probability.bins",
    "lead_times": f"{_SCORED} case.training.series classification.start_spacing_lt",
    "data_generation_parameters": f"""{_SYSTEM} case.ensemble.time_step case.ensemble.duration
        case.training.series case.laminarisation_threshold case.event_threshold""",
    "network_hyperparameters": """case.training.noise
        forecasters.esn.connectivity forecasters.esn.input_bias
        search.spectral_radius search.input_scaling search.tikhonov""",
}

_FORECASTS = """forecast/esn forecast/equations forecast/equations_noisy
    forecast/quadratic_filtered evaluation_set"""

COMES_FROM = {
    "lyapunov": "simulate",
    "evaluation_set": "simulate",
    "events": "simulate",
    "reference_statistics": "simulate",
    "scan": "simulate",
    "search": "simulate scan",
    "train": "simulate search",
    "fit/equations": "simulate",
    "fit/equations_noisy": "simulate",
    "fit/quadratic_filtered": "simulate",
    "forecast/esn": "train evaluation_set",
    "forecast/equations": "fit/equations evaluation_set",
    "forecast/equations_noisy": "fit/equations_noisy evaluation_set",
    "forecast/quadratic_filtered": "fit/quadratic_filtered evaluation_set",
    "horizon/esn": "simulate train events",
    "horizon/equations": "simulate fit/equations events",
    "horizon/equations_noisy": "simulate fit/equations_noisy events",
    "horizon/quadratic_filtered": "simulate fit/quadratic_filtered events",
    "long_term/esn": "simulate train",
    "lyapunov_spectrum/esn": "simulate train long_term/esn",
    "control/esn": "simulate train",
    "control/esn/receding_horizon": "simulate train",
    "control/equations": "simulate fit/equations",
    "control/esn-random": "simulate control/esn",
    "control/esn-committee": "simulate train",
    "control/quadratic_filtered-committee": "simulate fit/quadratic_filtered",
    "control/none": "simulate",
    "statistics_table": "reference_statistics long_term/esn",
    "survival_table": "simulate long_term/esn",
    "lyapunov_spectrum_table": "lyapunov lyapunov_spectrum/esn",
    "control_table": "control/esn control/equations control/esn-random",
    "control_density_table": "control/esn control/equations control/esn-random",
    "warnings_table": """simulate events reference_statistics calibration_set dataset_table
        classification_table hyperparameters_table statistics_table""",
    "control_strategies_table": """control/esn control/esn/receding_horizon control/equations
        control/esn-random control/none control/esn-committee
        control/quadratic_filtered-committee""",
    "dataset_table": "simulate events lyapunov",
    "hyperparameters_table": "search",
    "horizon_table": """horizon/esn horizon/equations horizon/equations_noisy
        horizon/quadratic_filtered""",
    "classification_table": _FORECASTS,
    "calibration_set": "simulate",
    "calibration_forecast/esn": "simulate train calibration_set",
    "calibration_forecast/equations": "simulate fit/equations calibration_set",
    "calibration_forecast/equations_noisy": "simulate fit/equations_noisy calibration_set",
    "calibration_forecast/quadratic_filtered": """simulate fit/quadratic_filtered
        calibration_set""",
    "calibrate": """calibration_set calibration_forecast/esn calibration_forecast/equations
        calibration_forecast/equations_noisy calibration_forecast/quadratic_filtered""",
    "probability_scores": f"{_FORECASTS} calibrate",
    "reliability_table": f"{_FORECASTS} calibrate",
    "lead_times": f"simulate {_FORECASTS} calibrate",
    "data_generation_parameters": "simulate",
}

# Tables of all cases, a section of the report at once: whatever those of a case read, these read
# nothing of it.
JOINED = {
    "joined_data": "dataset_table",
    "joined_networks": "hyperparameters_table",
    "joined_forecasts": "classification_table",
    "joined_horizon": "horizon_table",
    "joined_probabilities": "probability_scores reliability_table lead_times",
    "joined_long_term": "statistics_table survival_table lyapunov_spectrum_table",
    "joined_control": "control_table control_density_table control_strategies_table",
    "joined_warnings": "warnings_table",
}
TABLES_OF_CASES = " ".join(JOINED.values()).split()
COMES_FROM |= JOINED

ALL = {*READS, *COMES_FROM}


def readers(setting: str) -> set[str]:
    """Jobs that read a setting."""
    return {
        job
        for job, patterns in READS.items()
        if any(fnmatchcase(setting, pattern) for pattern in patterns.split())
    }


def and_what_follows(jobs: set[str]) -> set[str]:
    """Jobs, and all that come from them."""
    reached = set(jobs)
    while True:
        more = {job for job, sources in COMES_FROM.items() if reached & set(sources.split())}
        if more <= reached:
            return reached
        reached |= more


# -- code: beyond what importing a script loads ----------------------------------------------------

# What jobs of the tiny preset find by name, by the module that finds it. Forecasters are those of
# the job's own kind, strategies those of all networks, which one scan serves.
FOUND_BY_NAME = {
    "burstcast.systems.registry": ("burstcast.systems.mfe",),
    "burstcast.tuning.strategies.registry": (
        "burstcast.tuning.strategies.recycle",
        "burstcast.tuning.strategies.single_shot",
    ),
}
FORECASTERS_BY_NAME = "burstcast.forecasters.registry", "burstcast.forecasters."
# Strategies of control are those of the job.
STRATEGIES_BY_NAME = "burstcast.control.strategies.registry", "burstcast.control.strategies."
STRATEGIES = {
    "control/esn": ("prediction_triggered",),
    "control/esn/receding_horizon": ("receding_horizon",),
    "control/equations": ("prediction_triggered",),
    "control/esn-random": ("prediction_triggered",),
    "control/none": ("reactive",),
    "control/esn-committee": ("receding_horizon",),
    "control/quadratic_filtered-committee": ("receding_horizon",),
}
# All tables of a case are made by one script, each by a module of its own.
TABLES_OF_A_CASE, MAKERS = "tables/table.py", "burstcast.tables.makers"
# Their scripts run for one kind only, and the name of their job does not say it.
JOBS_OF_NETWORKS = ("scan", "search", "train")

# The harness is in no fingerprint: its version stands for it, in all of them.
HARNESS = (
    *("burstcast_workflow.harness.", "snaketrust."),
    *("burstcast.files.netcdf.", "burstcast.files.tables."),
)
VERSION_OF_HARNESS = "burstcast_workflow.harness.version"
