"""What must hold between the settings of a config, each of which is allowed by the schema."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from burstcast import durations
from burstcast.statistics.profiles import flow_modes
from burstcast.systems.registry import make_system
from burstcast_workflow.cases import block_cases, case_name, case_record
from burstcast_workflow.config_messages import suggestion
from burstcast_workflow.series_fit import misfits


def problems_between_settings(config: Mapping[str, Any]) -> list[str]:
    """Check what the schema cannot; one message for each thing that is wrong.

    Cases that the campaign does not use are not looked at: an overlay may shorten the series of all
    cases without adjusting those that it leaves out.
    """
    problems = [
        *_campaign(config),
        *_search(config["search"]),
        *_classification(config["classification"]),
        *_horizon(config["horizon"]),
        *_control(config),
        *_figures(config),
    ]
    known = _known_cases(config)
    by_problem: dict[str, list[str]] = {}
    for name in dict.fromkeys(name for block in config["campaign"] for name in block_cases(block)):
        if name in known:
            for problem in _case(config, name):
                by_problem.setdefault(problem, []).append(name)
    problems += [f"{_listed_cases(names)}: {problem}" for problem, names in by_problem.items()]
    return list(dict.fromkeys(problems))


def _listed_cases(names: list[str]) -> str:
    return f"case{'s' if len(names) > 1 else ''} {', '.join(names)}"


def _known_cases(config: Mapping[str, Any]) -> list[str]:
    """Names with an entry in ``cases``, and those of Reynolds numbers, which need none."""
    numbers = [value for block in config["campaign"] for value in block.get("reynolds", [])]
    return list(dict.fromkeys([*config["cases"], *map(case_name, numbers)]))


def _campaign(config: Mapping[str, Any]) -> Iterator[str]:
    connectivity = config["network"]["connectivity"]
    known = _known_cases(config)
    for index, block in enumerate(config["campaign"]):
        place = f"campaign[{index}]"
        if not block_cases(block):
            yield f"{place} names no case: give it reynolds: [...] or cases: [...]"
        for name in block.get("cases", []):
            if name not in known:
                yield f"{place}.cases: there is no case {name} in cases; {suggestion(name, known)}"
        smallest = min(block["neurons"])
        if connectivity > smallest - 1:
            yield (
                f"network.connectivity is {connectivity}, but a reservoir of {smallest} neurons "
                f"({place}.neurons) has at most {smallest - 1} connections per neuron"
            )


def _search(search: Mapping[str, Any]) -> Iterator[str]:
    for name in ("spectral_radius", "input_scaling"):
        yield from _range(f"search.{name}", search[name])


def _range(name: str, ends: list[float]) -> Iterator[str]:
    low, high = ends
    if not low < high:
        yield f"{name} is [{low}, {high}]; the first number must be below the second"


def _classification(classification: Mapping[str, Any]) -> Iterator[str]:
    resolution = classification["resolution_lt"]
    longest = classification["longest_prediction_time_lt"]
    for name in ("window_lt", "longest_prediction_time_lt"):
        if not _is_multiple(classification[name], resolution):
            yield (
                f"classification.{name} is {classification[name]}; it must be a multiple of "
                f"classification.resolution_lt, {resolution}"
            )
    for time in classification["prediction_times_lt"]:
        if not _is_multiple(time, resolution):
            yield (
                f"classification.prediction_times_lt has {time}, which is no multiple of "
                f"classification.resolution_lt, {resolution}"
            )
        if time > longest:
            yield (
                f"classification.prediction_times_lt has {time}, which is beyond "
                f"classification.longest_prediction_time_lt, {longest}"
            )


def _horizon(horizon: Mapping[str, Any]) -> Iterator[str]:
    if horizon["start_step_lt"] > horizon["longest_start_lt"]:
        yield (
            f"horizon.start_step_lt is {horizon['start_step_lt']}; it must be at most "
            f"horizon.longest_start_lt, {horizon['longest_start_lt']}"
        )


def _control(config: Mapping[str, Any]) -> Iterator[str]:
    control, sizes = config["control"], _sizes(config)
    if control["validation"]:
        for neurons in control["neurons"]:
            if neurons not in sizes:
                yield (
                    f"control.neurons has {neurons}, which is no size of the campaign: "
                    f"{', '.join(map(str, sizes))}; control.validation: [] switches control off"
                )
    used = list(dict.fromkeys(name for block in config["campaign"] for name in block_cases(block)))
    for name in control["sweep"]["cases"]:
        if name not in used:
            yield f"control.sweep.cases: the campaign has no case {name}; {suggestion(name, used)}"


def _sizes(config: Mapping[str, Any]) -> list[int]:
    return sorted({neurons for block in config["campaign"] for neurons in block["neurons"]})


def _figures(config: Mapping[str, Any]) -> Iterator[str]:
    figures, campaign = config["figures"], config["campaign"]
    wanted = {
        "neurons": figures["example_neurons"],
        "validation": figures["example_validation"],
    }
    if not any(
        figures["example_case"] in block_cases(block)
        and all(value in block[name] for name, value in wanted.items())
        and figures["example_seed"] < block["seeds"]
        for block in campaign
    ):
        yield (
            f"the example network of the figures ({figures['example_case']}, "
            f"{figures['example_neurons']} neurons, {figures['example_validation']}, seed "
            f"{figures['example_seed']}) is not part of the campaign: change figures.example_case, "
            "example_neurons, example_validation or example_seed"
        )
    if figures["fixed_neurons"] not in _sizes(config):
        yield (
            f"figures.fixed_neurons is {figures['fixed_neurons']}; it must be a size of the "
            f"campaign: {', '.join(map(str, _sizes(config)))}"
        )
    times = config["classification"]["prediction_times_lt"]
    for name in ("example_prediction_time_lt", "fixed_prediction_time_lt"):
        if figures[name] not in times:
            yield _not_a_prediction_time(f"{name} is", figures[name], times)
    for time in figures["reynolds_prediction_times_lt"]:
        if time not in times:
            yield _not_a_prediction_time("reynolds_prediction_times_lt has", time, times)
    if figures["example_case"] in _known_cases(config):
        record = case_record(config, figures["example_case"])
        threshold, peak = record["event_threshold"], figures["flow_event"]["peak"]
        if not peak > threshold and _is_flow(record):
            yield (
                f"figures.flow_event.peak is {peak}; it must be above the event_threshold of "
                f"{figures['example_case']}, {threshold}"
            )
    control = config["control"]
    time, times = figures["control_prediction_time_lt"], control["prediction_times_lt"]
    if control["validation"] and times and time not in times:
        yield _not_a_prediction_time("control_prediction_time_lt is", time, times, "control")


def _is_flow(record: Mapping[str, Any]) -> bool:
    """Whether the figures of the flow are drawn for a case."""
    try:
        return flow_modes(make_system(record["system"], record["parameters"])) is not None
    except ValueError:  # told with the case
        return False


def _not_a_prediction_time(
    setting: str, time: float, times: list[float], stage: str = "classification"
) -> str:
    return (
        f"figures.{setting} {time}; it must be one of {stage}.prediction_times_lt: "
        f"{', '.join(map(str, times))}"
    )


def _case(config: Mapping[str, Any], name: str) -> Iterator[str]:
    record = case_record(config, name)
    ensemble, lyapunov = record["ensemble"], record["lyapunov"]
    yield from _system(config["control"], name, record)
    yield from _thresholds(record)
    yield from _series_counts(record)
    yield from _times(ensemble, lyapunov)
    for density in ("density", "controlled_density"):
        yield from _range(f"{density}.range", record[density]["range"])
    if lyapunov["perturbation"] >= lyapunov["saturation"]:
        yield (
            f"lyapunov.perturbation is {lyapunov['perturbation']}; it must be below "
            f"lyapunov.saturation, {lyapunov['saturation']}"
        )
    if lyapunov["time_unit"] == "published" and lyapunov["published_exponent"] is not None:
        interval = ensemble["time_step"] * ensemble["sampling_stride"]
        try:
            steps = durations.steps_per_lyapunov_time(lyapunov["published_exponent"], interval)
        except ValueError as error:
            yield f"lyapunov.published_exponent: {error}"
        else:
            # both ends of a series are sampled
            samples = math.floor(ensemble["duration"] / interval + 1e-9) + 1
            yield from misfits(config, record, samples, steps)


def _system(control: Mapping[str, Any], name: str, record: Mapping[str, Any]) -> Iterator[str]:
    reynolds = record["parameters"].get("reynolds")
    if name.startswith("Re") and reynolds is not None and _is_reynolds_of_another(name, reynolds):
        yield f"parameters.reynolds is {reynolds}, which contradicts the name {name}: leave it out"
    try:
        system = make_system(record["system"], record["parameters"])
    except ValueError as error:
        yield f"system or parameters: {error}"
        return
    ensemble = record["ensemble"]
    if len(ensemble["initial_state"]) != system.dimension:
        yield (
            f"ensemble.initial_state has {len(ensemble['initial_state'])} numbers; the system "
            f"{record['system']} needs {system.dimension}"
        )
    if ensemble["perturbed_component"] > system.dimension:
        yield (
            f"ensemble.perturbed_component is {ensemble['perturbed_component']}; the system "
            f"{record['system']} has the components 1 to {system.dimension}"
        )
    if record["actuation"] is not None:
        yield from _actuation(control, record, system.dimension)


def _actuation(
    control: Mapping[str, Any], record: Mapping[str, Any], dimension: int
) -> Iterator[str]:
    actuation = record["actuation"]
    try:
        make_system(record["system"], {**record["parameters"], **actuation["parameters"]})
    except ValueError as error:
        yield f"actuation.parameters: {error}"
    if actuation["force"] is not None and len(actuation["force"]) != dimension:
        yield f"actuation.force has {len(actuation['force'])} numbers; it needs {dimension}"
    times = control["prediction_times_lt"] if control["validation"] else []
    too_short = [time for time in times if time + actuation["start_lt"] < 0]
    if too_short:
        yield (
            f"control.prediction_times_lt has {too_short[0]}, but an actuation that starts at "
            f"actuation.start_lt, {actuation['start_lt']}, would then begin before its alarm"
        )


def _is_reynolds_of_another(name: str, reynolds: float) -> bool:
    try:
        return float(name.removeprefix("Re")) != reynolds
    except ValueError:  # a name such as Reference
        return False


def _thresholds(record: Mapping[str, Any]) -> Iterator[str]:
    laminar = record["laminarisation_threshold"]
    if laminar is not None and laminar <= record["event_threshold"]:
        yield (
            f"event_threshold is {record['event_threshold']}; it must be below "
            f"laminarisation_threshold, {laminar}"
        )


def _series_counts(record: Mapping[str, Any]) -> Iterator[str]:
    series, training = record["ensemble"]["series"], record["training"]["series"]
    if training + record["test_series"] > series:
        yield (
            f"training.series and test_series are {training} and {record['test_series']}; together "
            f"they must be at most ensemble.series, {series}"
        )
    if record["recycle_validation"]["series"] > training:
        yield (
            f"recycle_validation.series is {record['recycle_validation']['series']}; it must be at "
            f"most training.series, {training}"
        )


def _times(ensemble: Mapping[str, Any], lyapunov: Mapping[str, Any]) -> Iterator[str]:
    step = ensemble["time_step"]
    interval = step * ensemble["sampling_stride"]
    if not _is_multiple(ensemble["transient"], step):
        yield (
            f"ensemble.transient is {ensemble['transient']}; it must be a multiple of "
            f"ensemble.time_step, {step}"
        )
    if not _is_multiple(ensemble["duration"], interval):
        yield (
            f"ensemble.duration is {ensemble['duration']}; it must be a multiple of "
            f"ensemble.time_step times sampling_stride, {interval:g}"
        )
    if not _is_multiple(lyapunov["orthonormalisation_interval"], step):
        yield (
            f"lyapunov.orthonormalisation_interval is {lyapunov['orthonormalisation_interval']}; "
            f"it must be a multiple of ensemble.time_step, {step}"
        )


def _is_multiple(value: float, unit: float) -> bool:
    """Whether value is unit times 1, 2, 3, ..., up to rounding errors."""
    ratio = value / unit
    return round(ratio) >= 1 and math.isclose(ratio, round(ratio), rel_tol=1e-9)
