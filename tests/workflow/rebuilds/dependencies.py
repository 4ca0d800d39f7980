"""What each rule depends on, written by hand: the oracle of the tests of selective rebuilds.

Nothing here comes from the workflow's own code. ``case.x`` stands for the setting x of a case,
wherever the config says it; percentiles and LaTeX tables are told apart by the table.
"""

from fnmatch import fnmatchcase

_SYSTEM = "case.system case.parameters.*"
_TIME = """case.ensemble.time_step case.ensemble.sampling_stride
    case.lyapunov.time_unit case.lyapunov.published_exponent"""
_OBSERVED = "random_seed case.training.*"
_RESERVOIR = """network.connectivity network.input_bias network.washout_lt network.kernel"""
_WINDOWS = """classification.resolution_lt classification.longest_prediction_time_lt
    classification.window_lt"""
_SEARCH = f"""{_SYSTEM} {_TIME} {_OBSERVED} {_RESERVOIR} case.recycle_validation.*
    search.spectral_radius search.input_scaling search.tikhonov search.interval_lt"""
_CONTROL = f"""{_SYSTEM} {_TIME} {_OBSERVED} case.event_threshold case.laminarisation_threshold
    case.controlled_density.* case.actuation.* network.washout_lt
    control.window_lt control.flows control.span_lt"""

READS = {
    "simulate": f"{_SYSTEM} random_seed case.ensemble.* case.laminarisation_threshold",
    "lyapunov": f"""{_SYSTEM} random_seed case.ensemble.time_step case.ensemble.sampling_stride
        case.lyapunov.series case.lyapunov.orthonormalisation_interval
        case.lyapunov.perturbation case.lyapunov.saturation""",
    "test_set": f"""{_SYSTEM} {_TIME} {_OBSERVED} {_WINDOWS} case.test_series network.washout_lt
        classification.start_spacing_lt""",
    "events": f"""{_TIME} {_OBSERVED} case.event_threshold network.washout_lt
        horizon.events horizon.longest_start_lt""",
    "scan": f"{_SEARCH} search.grid",
    "tune": f"{_SEARCH} search.bayesian_points",
    "train": f"{_TIME} {_OBSERVED} {_RESERVOIR}",
    "forecast": f"""{_SYSTEM} {_TIME} {_WINDOWS} network.kernel network.divergence_bound""",
    "horizon": f"""{_SYSTEM} {_TIME} case.event_threshold network.kernel network.washout_lt
        horizon.longest_start_lt horizon.start_step_lt horizon.tolerance""",
    "reference_statistics": f"""{_SYSTEM} random_seed case.density.* case.training.series
        statistics.profile_points statistics.floor_splits""",
    "climate": f"""{_SYSTEM} {_TIME} {_OBSERVED} case.density.* case.laminarisation_threshold
        case.stuck.* network.kernel network.washout_lt network.divergence_bound
        statistics.starting_points statistics.start_spacing_lt statistics.duration
        statistics.stuck_interval_lt""",
    "control": f"{_CONTROL} network.kernel",
    "control_random": _CONTROL,
    "control_equations": _CONTROL,
    "statistics_table": f"{_SYSTEM} statistics.profile_points",
    "control_table": "",
    "dataset_table": _TIME,
    "hyperparameters_table": "",
    "horizon_table": "",
    "classify": """random_seed case.event_threshold bootstrap.* classification.window_lt
        classification.resolution_lt classification.prediction_times_lt""",
    "data_generation_parameters": f"""{_SYSTEM} case.ensemble.time_step case.ensemble.duration
        case.training.series case.laminarisation_threshold case.event_threshold""",
    "network_hyperparameters": """case.training.noise network.connectivity network.input_bias
        search.spectral_radius search.input_scaling search.tikhonov""",
}

COMES_FROM = {
    "lyapunov": "simulate",
    "test_set": "simulate",
    "events": "simulate",
    "scan": "simulate",
    "tune": "simulate scan",
    "train": "simulate tune",
    "forecast": "train test_set",
    "horizon": "simulate train events",
    "reference_statistics": "simulate",
    "climate": "simulate train",
    "control": "simulate train",
    "control_random": "simulate control",
    "control_equations": "simulate",
    "statistics_table": "reference_statistics climate",
    "control_table": "control control_random control_equations",
    "dataset_table": "simulate events lyapunov",
    "hyperparameters_table": "tune",
    "horizon_table": "horizon",
    "classify": "forecast test_set",
    "data_generation_parameters": "simulate",
    "percentiles/hyperparameters": "hyperparameters_table",
    "percentiles/classification": "classify",
    "percentiles/horizon": "horizon_table",
    "percentiles/statistics": "statistics_table",
    "percentiles/control": "control_table",
    "latex/dataset": "dataset_table",
    "latex/hyperparameters": "hyperparameters_table",
    "latex/classification": "classify",
    "latex/classification_intervals": "classify",
    "latex/horizon": "horizon_table",
    "latex/statistics": "statistics_table",
    "latex/control": "control_table",
    "latex/data_generation_parameters": "data_generation_parameters",
    "latex/network_hyperparameters": "network_hyperparameters",
    **{
        f"latex/{name}_percentiles": f"percentiles/{name}"
        for name in ("hyperparameters", "classification", "horizon", "statistics", "control")
    },
}

ALL = {*READS, *COMES_FROM}


def readers(setting: str) -> set[str]:
    """Rules that read a setting."""
    return {
        rule
        for rule, patterns in READS.items()
        if any(fnmatchcase(setting, pattern) for pattern in patterns.split())
    }


def and_what_follows(rules: set[str]) -> set[str]:
    """Rules, and all that come from them."""
    reached = set(rules)
    while True:
        more = {rule for rule, sources in COMES_FROM.items() if reached & set(sources.split())}
        if more <= reached:
            return reached
        reached |= more


# Modules that put values of their own into the settings of a rule whose script does not load them.
RULES_WITH_VALUES_OF: dict[str, set[str]] = {}


# What a system's or a validation strategy's module defines is found by its name; backends are
# chosen while a job runs.
def may_be_found_otherwise(module: str, rule_has_case: bool, loaded: set[str]) -> bool:
    """Whether code may depend on a module that importing the script does not load."""
    if module.startswith("burstcast.systems."):
        return rule_has_case
    if module in ("burstcast.tuning.strategies.single_shot", "burstcast.tuning.strategies.recycle"):
        return "burstcast.tuning.strategies.registry" in loaded
    return module == "burstcast.esn.backend_numba" and "burstcast.esn.dynamics" in loaded
