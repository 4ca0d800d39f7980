"""The campaign: which networks are made, and which settings each rule reads.

Every rule gets one plain dictionary of just the settings that its script reads. A setting that a
rule does not read cannot make it run again; a setting that it reads always does.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from burstcast import durations
from burstcast.statistics.profiles import flow_modes
from burstcast.systems.registry import make_system, parameters_of
from burstcast.tables import described_parameters
from burstcast_workflow.canonical import canonical, natural_order
from burstcast_workflow.config.cases import block_cases
from burstcast_workflow.table_layouts import NETWORK_KEYS, SUMMARIES

Settings = dict[str, Any]


@dataclass(frozen=True)
class Network:
    """One network of the campaign: a case, a size, a validation strategy and a seed."""

    case: str
    neurons: int
    validation: str
    seed: int

    @property
    def directory(self) -> str:
        """Its directory below the results directory."""
        return f"{self.case}/N{self.neurons}/{self.validation}/seed{self.seed}"


@dataclass(frozen=True)
class ControlRun:
    """One run of control: who forecasts, what, how far ahead; the network unless it is `equations`.

    Random actuation belongs to a network, too: it acts as often as that network did.
    """

    forecaster: str
    case: str
    prediction_time_lt: float
    network: Network | None

    @property
    def stem(self) -> str:
        """Its files below the results directory, without their suffixes."""
        name = "control" if self.forecaster == "esn" else f"control_{self.forecaster}"
        directory = self.case if self.network is None else self.network.directory
        return f"{directory}/{name}_PT{self.prediction_time_lt:g}"


@dataclass(frozen=True)
class Campaign:
    """A validated configuration, expanded.

    Attributes
    ----------
    config
        The whole configuration (`burstcast_workflow.config.loading.load`).
    cases
        The record of each case that the campaign uses
        (`burstcast_workflow.config.cases.case_records`).
    """

    config: Mapping[str, Any]
    cases: Mapping[str, Mapping[str, Any]]

    @cached_property
    def networks(self) -> tuple[Network, ...]:
        """All networks, each once: the same tuple in whatever order the config names them."""
        return tuple(sorted(set(self._expand()), key=self._order))

    def _order(self, network: Network) -> tuple[Any, ...]:
        return (
            natural_order(network.case),
            network.neurons,
            network.validation,
            network.seed,
        )

    def _prediction_times(self, stage: str) -> list[float]:
        return sorted({float(time) for time in self.config[stage]["prediction_times_lt"]})

    @property
    def _tikhonov(self) -> list[float]:
        """Tikhonov parameters of the search, each once, the largest first."""
        return sorted({float(value) for value in self.config["search"]["tikhonov"]}, reverse=True)

    def _expand(self) -> Iterator[Network]:
        for block in self.config["campaign"]:
            for case in block_cases(block):
                for neurons in block["neurons"]:
                    for validation in block["validation"]:
                        for seed in range(block["seeds"]):
                            yield Network(case, neurons, validation, seed)

    def select(self, **values: object) -> tuple[Network, ...]:
        """Networks whose attributes have the given values."""
        return tuple(
            network
            for network in self.networks
            if all(getattr(network, name) == value for name, value in values.items())
        )

    @property
    def case_names(self) -> tuple[str, ...]:
        """Cases that some network of the campaign is made for, in natural order."""
        return tuple(dict.fromkeys(network.case for network in self.networks))

    def reynolds(self, case: str) -> float | None:
        """Reynolds number of a case; None for a system that has none."""
        value = self.cases[case]["parameters"].get("reynolds")
        return None if value is None else float(value)

    def steps_per_lyapunov_time(self, case: str) -> int | None:
        """Network steps in a Lyapunov time if the config knows it; None where it is computed."""
        record = self.cases[case]
        exponent = record["lyapunov"]["published_exponent"]
        if record["lyapunov"]["time_unit"] == "computed" or exponent is None:
            return None
        return durations.steps_per_lyapunov_time(exponent, self.sampling_interval(case))

    def sampling_interval(self, case: str) -> float:
        """Time between two steps of the network, in time units."""
        ensemble = self.cases[case]["ensemble"]
        return float(ensemble["time_step"] * ensemble["sampling_stride"])

    @property
    def example(self) -> Network:
        """The network whose forecasts the figures show."""
        figures = self.config["figures"]
        return Network(
            figures["example_case"],
            figures["example_neurons"],
            figures["example_validation"],
            figures["example_seed"],
        )

    @property
    def climate_networks(self) -> tuple[Network, ...]:
        """Networks whose long-term statistics are computed."""
        strategies = self.config["statistics"]["validation"]
        return tuple(network for network in self.networks if network.validation in strategies)

    @cached_property
    def control_runs(self) -> tuple[ControlRun, ...]:
        """Who controls which case at which prediction time: networks first, then the references."""
        control = self.config["control"]
        runs = [
            ControlRun("esn", network.case, prediction_time, network)
            for network in self.networks
            if network.neurons in control["neurons"]
            and network.validation in control["validation"]
            and self.cases[network.case]["actuation"] is not None
            for prediction_time in self._control_times(network)
        ]
        if "random" in control["references"]:
            runs += [
                ControlRun("random", run.case, run.prediction_time_lt, run.network) for run in runs
            ]
        if "equations" in control["references"]:
            runs += dict.fromkeys(
                ControlRun("equations", run.case, run.prediction_time_lt, None) for run in runs
            )
        return tuple(runs)

    def _control_times(self, network: Network) -> list[float]:
        control = self.config["control"]
        times = list(control["prediction_times_lt"])
        sweep = control["sweep"]
        if network.case in sweep["cases"] and network.seed < sweep["seeds"]:
            times += sweep["prediction_times_lt"]
        return sorted({float(time) for time in times})

    # -- settings, one function for each rule ------------------------------------------------------

    def settings(self, rule: str, wildcards: Mapping[str, str]) -> Settings:
        """Settings that the script of ``rule`` reads, in canonical form.

        Raises
        ------
        KeyError
            If no settings are defined for the rule.
        """
        read: Callable[[Mapping[str, str]], Settings] = getattr(self, f"_{rule}")
        result: Settings = canonical(read(wildcards))
        return result

    def _system(self, case: str) -> Settings:
        return _pick(self.cases[case], "system", "parameters")

    def _time(self, case: str) -> Settings:
        return {
            "sampling_interval": self.sampling_interval(case),
            "steps_per_lyapunov_time": self.steps_per_lyapunov_time(case),
        }

    def _observation(self, case: str) -> Settings:
        return {
            "case": case,
            "random_seed": self.config["random_seed"],
            "training": self.cases[case]["training"],
        }

    def _simulate(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._system(case),
            **_pick(self.cases[case], "ensemble", "laminarisation_threshold"),
            "case": case,
            "random_seed": self.config["random_seed"],
        }

    def _lyapunov(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        record = self.cases[case]
        return {
            **self._system(case),
            "lyapunov": _pick(
                record["lyapunov"],
                "series",
                "orthonormalisation_interval",
                "perturbation",
                "saturation",
            ),
            "ensemble": _pick(record["ensemble"], "time_step", "sampling_stride"),
            "case": case,
            "random_seed": self.config["random_seed"],
        }

    def _test_set(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._system(case),
            **self._time(case),
            **self._observation(case),
            "test_series": self.cases[case]["test_series"],
            "washout_lt": self.config["network"]["washout_lt"],
            "start_spacing_lt": self.config["classification"]["start_spacing_lt"],
            "windows": self._windows(),
        }

    def _windows(self) -> Settings:
        """How forecasts are cut into windows: all that forecasting knows of the classification."""
        classification = self.config["classification"]
        resolution = classification["resolution_lt"]
        reach = classification["longest_prediction_time_lt"] + classification["window_lt"]
        return {"resolution_lt": resolution, "count": round(reach / resolution) - 1}

    def _events(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._time(case),
            **self._observation(case),
            "event_threshold": self.cases[case]["event_threshold"],
            "washout_lt": self.config["network"]["washout_lt"],
            **_pick(self.config["horizon"], "events", "longest_start_lt"),
        }

    def _validation(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._system(case),
            **self._time(case),
            **self._observation(case),
            **self._reservoir(wildcards),
            "interval_lt": self.config["search"]["interval_lt"],
            "recycle_validation": self.cases[case]["recycle_validation"],
            "tikhonov": self._tikhonov,
        }

    def _reservoir(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            "neurons": int(wildcards["neurons"]),
            "seed": int(wildcards["seed"]),
            **_pick(self.config["network"], "connectivity", "input_bias", "washout_lt", "kernel"),
        }

    def _scan(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            **self._validation(wildcards),
            **_pick(self.config["search"], "spectral_radius", "input_scaling", "grid"),
        }

    def _tune(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            **self._validation(wildcards),
            **_pick(self.config["search"], "spectral_radius", "input_scaling", "bayesian_points"),
            "validation": wildcards["validation"],
        }

    def _train(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._time(case),
            **self._observation(case),
            **self._reservoir(wildcards),
        }

    def _forecast(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._system(case),
            **self._time(case),
            "windows": self._windows(),
            **_pick(self.config["network"], "kernel", "divergence_bound"),
        }

    def _horizon(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._system(case),
            **self._time(case),
            "event_threshold": self.cases[case]["event_threshold"],
            **_pick(self.config["network"], "kernel", "washout_lt"),
            "horizon": _pick(
                self.config["horizon"], "longest_start_lt", "start_step_lt", "tolerance"
            ),
        }

    # -- statistics --------------------------------------------------------------------------------

    def _reference_statistics(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._system(case),
            "case": case,
            "random_seed": self.config["random_seed"],
            "density": self.cases[case]["density"],
            "training_series": self.cases[case]["training"]["series"],
            **_pick(self.config["statistics"], "profile_points", "floor_splits"),
        }

    def _climate(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._system(case),
            **self._time(case),
            **self._observation(case),
            **_pick(self.cases[case], "density", "laminarisation_threshold", "stuck"),
            **_pick(self.config["network"], "kernel", "washout_lt", "divergence_bound"),
            **_pick(
                self.config["statistics"],
                "starting_points",
                "start_spacing_lt",
                "duration",
                "stuck_interval_lt",
            ),
        }

    def _statistics_table(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            "cases": [
                {"case": case, "reynolds": self.reynolds(case), **self._system(case)}
                for case in self.case_names
            ],
            "networks": self.keys(self.climate_networks),
            "profile_points": self.config["statistics"]["profile_points"],
        }

    def has_flow(self, case: str) -> bool:
        """Whether a case is a flow: its state, the amplitudes of velocity modes."""
        return flow_modes(make_system(**self._named_system(case))) is not None

    def statistics_candidates(self, case: str) -> tuple[Network, ...]:
        """Networks of a case, the best of which stands for all where only one can be shown."""
        networks = [
            network
            for network in self.climate_networks
            if network.case == case and network.neurons == self.config["figures"]["fixed_neurons"]
        ]
        example = self.config["figures"]["example_validation"]
        strategies = {network.validation for network in networks}
        shown = example if example in strategies else min(strategies, default=example)
        return tuple(network for network in networks if network.validation == shown)

    @property
    def statistics_figures(self) -> tuple[str, ...]:
        """Names of the figures of long-term statistics, of the flow and of its statistics."""
        names = []
        # the example's case comes first, and has the plain names
        for case in dict.fromkeys([self.example.case, *self.case_names]):
            suffix = "" if case == self.example.case else f"_{case}"
            if self.statistics_candidates(case):
                names.append(f"energy_density{suffix}")
                if self.has_flow(case):
                    names += [f"profile_errors{suffix}", f"midplane_mean_square{suffix}"]
        if self.has_flow(self.example.case):
            names += ["midplane_planes", "vorticity_isosurfaces"]
        return tuple(names)

    def _flow_event(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        return {
            **self._system(case),
            **self._time(case),
            **self._observation(case),
            **_pick(self.cases[case], "event_threshold", "test_series"),
            **_pick(self.config["network"], "kernel", "washout_lt"),
            "flow_event": self.config["figures"]["flow_event"],
        }

    def _figure_energy_density(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.case_of_figure(wildcards)
        return {
            **self._statistics_figure(case),
            **self._labels(case),
            "event_threshold": self.cases[case]["event_threshold"],
        }

    def _figure_profile_errors(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.case_of_figure(wildcards)
        return {
            **self._statistics_figure(case),
            **self._system(case),
            "profile_points": self.config["statistics"]["profile_points"],
        }

    def _statistics_figure(self, case: str) -> Settings:
        return {
            "case": case,
            "reynolds": self.reynolds(case),
            "networks": self.keys(self.statistics_candidates(case)),
            "published_overlay": self.config["figures"]["published_overlay"],
        }

    def _figure_midplane_mean_square(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.case_of_figure(wildcards)
        return {
            **self._flow_field(case),
            "networks": self.keys(self.statistics_candidates(case)),
        }

    def _figure_midplane_planes(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.example.case
        return {
            **self._flow_field(case),
            **self._symbol(case),
            "event_threshold": self.cases[case]["event_threshold"],
        }

    def _figure_vorticity_isosurfaces(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            **self._flow_field(self.example.case),
            **_pick(self.config["figures"], "isosurface_level"),
        }

    def _flow_field(self, case: str) -> Settings:
        return {**self._system(case), **_pick(self.config["figures"], "flow_points")}

    # -- control -----------------------------------------------------------------------------------

    def _control_equations(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        record = self.cases[case]
        return {
            **self._system(case),
            **self._time(case),
            **self._observation(case),
            **_pick(
                record,
                "event_threshold",
                "laminarisation_threshold",
                "controlled_density",
                "actuation",
            ),
            **_pick(record["ensemble"], "time_step", "sampling_stride"),
            **_pick(self.config["control"], "window_lt", "flows", "span_lt"),
            "washout_lt": self.config["network"]["washout_lt"],
            "prediction_time_lt": float(wildcards["prediction_time_lt"]),
        }

    def _control(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            **self._control_equations(wildcards),
            "kernel": self.config["network"]["kernel"],
        }

    def _control_random(self, wildcards: Mapping[str, str]) -> Settings:
        return {**self._control_equations(wildcards), "seed": int(wildcards["seed"])}

    def _control_table(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            "runs": [
                {
                    "rule": "control" if run.forecaster == "esn" else f"control_{run.forecaster}",
                    **self._control_keys(run),
                    "prediction_time_lt": run.prediction_time_lt,
                }
                for run in self.control_runs
            ]
        }

    def _control_keys(self, run: ControlRun) -> Settings:
        if run.network is not None:
            return {**self.keys([run.network])[0], "forecaster": run.forecaster}
        return {
            "case": run.case,
            "reynolds": self.reynolds(run.case),
            "forecaster": run.forecaster,
            "neurons": None,
            "validation": None,
            "seed": None,
        }

    @cached_property
    def control_example(self) -> ControlRun | None:
        """Run of control that the figures of one event are taken from; None if there is none.

        The example's network, or else the first one that controls so far ahead.
        """
        time = self.config["figures"]["control_prediction_time_lt"]
        runs = [
            run
            for run in self.control_runs
            if run.forecaster == "esn" and run.prediction_time_lt == time
        ]
        return next((run for run in runs if run.network == self.example), next(iter(runs), None))

    @property
    def controlled_cases(self) -> tuple[str, ...]:
        """Cases that networks control; that of the example is the first if it is one of them."""
        cases = [run.case for run in self.control_runs if run.forecaster == "esn"]
        return tuple(sorted(dict.fromkeys(cases), key=lambda case: case != self.example.case))

    @property
    def control_figures(self) -> tuple[str, ...]:
        """Names of the figures of control."""
        names = []
        if self.control_example is not None:
            names.append("control_schematic")
            if self.has_flow(self.control_example.case):
                names.append("suppressed_event")
        shown: list[str] = []
        for index, case in enumerate(self.controlled_cases):
            suffix = f"_{case}" if index else ""
            names.append(f"control_tradeoff{suffix}")
            # one figure for all cases of one system
            if case not in shown:
                names.append(f"control_density{suffix}")
                shown += self._cases_like(case)
        return tuple(names)

    def case_of_control_figure(self, wildcards: Mapping[str, str]) -> str:
        """Case that a figure of control shows: the one its name ends in, or else the first one."""
        return wildcards.get("of_case", "").removeprefix("_") or self.controlled_cases[0]

    def _cases_like(self, case: str) -> list[str]:
        """Controlled cases of the same system, that case included."""
        system = self.cases[case]["system"]
        return [other for other in self.controlled_cases if self.cases[other]["system"] == system]

    def _control_kind(self, case: str) -> tuple[int, str]:
        """Size and validation strategy that the figures of control show for a case."""
        example = self.example
        networks = [run.network for run in self.control_runs if run.case == case and run.network]
        kinds = list(dict.fromkeys((network.neurons, network.validation) for network in networks))
        wanted = (self.config["figures"]["fixed_neurons"], example.validation)
        return wanted if wanted in kinds else kinds[0]

    def density_runs(self, wildcards: Mapping[str, str]) -> tuple[ControlRun, ...]:
        """Runs of control that a figure of densities shows: networks of one kind for each case."""
        times = self.config["control"]["prediction_times_lt"]
        return tuple(
            run
            for case in self._cases_like(self.case_of_control_figure(wildcards))
            for run in self.control_runs
            if run.case == case
            and run.forecaster == "esn"
            and run.network is not None
            and (run.network.neurons, run.network.validation) == self._control_kind(case)
            and run.prediction_time_lt in times
        )

    def _suppressed_event(self, wildcards: Mapping[str, str]) -> Settings:
        time = self.config["figures"]["control_prediction_time_lt"]
        return self._control({**wildcards, "prediction_time_lt": str(time)})

    def _figure_control_schematic(self, wildcards: Mapping[str, str]) -> Settings:
        assert self.control_example is not None
        case = self.control_example.case
        actuation = self.cases[case]["actuation"]
        return {
            **self._symbol(case),
            "event_threshold": self.cases[case]["event_threshold"],
            "prediction_time_lt": self.control_example.prediction_time_lt,
            "window_lt": self.config["control"]["window_lt"],
            "actuation": _pick(actuation, "parameters", "force"),
        }

    def _figure_suppressed_event(self, wildcards: Mapping[str, str]) -> Settings:
        assert self.control_example is not None
        case = self.control_example.case
        return {
            **self._flow_field(case),
            **self._symbol(case),
            "event_threshold": self.cases[case]["event_threshold"],
        }

    def _figure_control_density(self, wildcards: Mapping[str, str]) -> Settings:
        runs = self.density_runs(wildcards)
        return {
            **self._labels(self.case_of_control_figure(wildcards)),
            "runs": [
                {
                    **self._control_keys(run),
                    "event_threshold": self.cases[run.case]["event_threshold"],
                    "prediction_time_lt": run.prediction_time_lt,
                }
                for run in runs
            ],
        }

    def _figure_control_tradeoff(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.case_of_control_figure(wildcards)
        neurons, validation = self._control_kind(case)
        return {
            **self._symbol(case),
            "case": case,
            "neurons": neurons,
            "validation": validation,
        }

    # -- tables ------------------------------------------------------------------------------------

    def keys(self, networks: Iterable[Network]) -> list[Settings]:
        """Key columns of the tables, one record for each network."""
        return [
            {
                "case": network.case,
                "reynolds": self.reynolds(network.case),
                "forecaster": "esn",
                "neurons": network.neurons,
                "validation": network.validation,
                "seed": network.seed,
            }
            for network in networks
        ]

    def _dataset_table(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            "cases": [
                {
                    "case": case,
                    "reynolds": self.reynolds(case),
                    "published_exponent": self.cases[case]["lyapunov"]["published_exponent"],
                    **self._time(case),
                }
                for case in self.case_names
            ]
        }

    def _hyperparameters_table(self, wildcards: Mapping[str, str]) -> Settings:
        return {"networks": self.keys(self.networks)}

    def _horizon_table(self, wildcards: Mapping[str, str]) -> Settings:
        return {"networks": self.keys(self.networks)}

    def _classify(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            "networks": self.keys(self.networks),
            "cases": [
                {"case": case, "event_threshold": self.cases[case]["event_threshold"]}
                for case in self.case_names
            ],
            "prediction_times_lt": self._prediction_times("classification"),
            **_pick(self.config["classification"], "window_lt", "resolution_lt"),
            "bootstrap": self.config["bootstrap"],
            "random_seed": self.config["random_seed"],
        }

    # -- report ------------------------------------------------------------------------------------

    @property
    def tables(self) -> tuple[str, ...]:
        """Names of the tables of results that this campaign has."""
        names = ["dataset", "hyperparameters", "classification", "horizon"]
        if self.climate_networks:
            names.append("statistics")
        if self.control_runs:
            names.append("control")
        return tuple(names)

    @property
    def report_tables(self) -> tuple[str, ...]:
        """Names of all tables: results, percentiles over networks, parameters."""
        return (
            *self.tables,
            *(f"{name}_percentiles" for name in self.tables if name in SUMMARIES),
            "classification_intervals",
            "data_generation_parameters",
            "network_hyperparameters",
        )

    @property
    def figures(self) -> tuple[str, ...]:
        """Names of all figures; those of cases other than the example's end in ``_<case>``."""
        example = self.example.case
        others = [case for case in self.case_names if case != example]
        names = [
            "observable_and_density",
            "validation_strategies",
            "network_schematic",
            "search_landscape",
            "prediction_schematic",
            "prediction_examples",
            "classification_scores",
            "horizon_schematic",
            "horizon_evaluations",
            "horizon_by_size",
        ]
        if len(self._reynolds_cases) > 1:
            names.append("by_reynolds")
        names += [f"observable_and_density_{case}" for case in others]
        names += [f"classification_scores_{case}" for case in others]
        names += [
            f"horizon_by_size_{case}"
            for case in others
            if len({network.neurons for network in self.select(case=case)}) > 1
        ]
        return (*names, *self.statistics_figures, *self.control_figures)

    @property
    def _reynolds_cases(self) -> tuple[str, ...]:
        """One case for each Reynolds number that has networks of the size that is held fixed."""
        size = self.config["figures"]["fixed_neurons"]
        cases: dict[float, str] = {}
        for network in self.select(neurons=size):
            reynolds = self.reynolds(network.case)
            if reynolds is not None:
                cases.setdefault(reynolds, network.case)
        return tuple(cases.values())

    def case_of_figure(self, wildcards: Mapping[str, str]) -> str:
        """Case that a figure shows: the one that its name ends in, or else the example's."""
        return wildcards.get("of_case", "").removeprefix("_") or self.example.case

    def _labels(self, case: str) -> Settings:
        """How the observable of a case is called."""
        system = make_system(**self._named_system(case))
        return {"symbol": system.observable_symbol, "observable_name": system.observable_name}

    def _symbol(self, case: str) -> Settings:
        return _pick(self._labels(case), "symbol")

    def _named_system(self, case: str) -> Settings:
        record = self.cases[case]
        return {"name": record["system"], "parameters": record["parameters"]}

    def _percentiles(self, wildcards: Mapping[str, str]) -> Settings:
        summary = SUMMARIES[wildcards["table"]]
        return {"keys": [*NETWORK_KEYS, *summary.keys], "metrics": [*summary.metrics]}

    def _latex(self, wildcards: Mapping[str, str]) -> Settings:
        return {"table": wildcards["table"]}

    def _data_generation_parameters(self, wildcards: Mapping[str, str]) -> Settings:
        # a list: the order of the cases is the order of the columns
        return {
            "cases": [
                {"case": case, "parameters": self._data_parameters(case)}
                for case in self.case_names
            ]
        }

    def _data_parameters(self, case: str) -> Settings:
        record = self.cases[case]
        system = make_system(**self._named_system(case))
        return {
            "system": described_parameters(record["system"], parameters_of(system)),
            "time_step": record["ensemble"]["time_step"],
            "series_duration": record["ensemble"]["duration"],
            "training_series": record["training"]["series"],
            **_pick(record, "laminarisation_threshold", "event_threshold"),
            **self._symbol(case),
        }

    def _network_hyperparameters(self, wildcards: Mapping[str, str]) -> Settings:
        noise = [[case, self.cases[case]["training"]["noise"]] for case in self.case_names]
        return {
            "network": {
                **_pick(self.config["search"], "spectral_radius", "input_scaling"),
                "tikhonov": self._tikhonov,
                **_pick(self.config["network"], "connectivity", "input_bias"),
            },
            # one column is enough where all cases have the same noise
            "noise": noise if len({value for _, value in noise}) > 1 else noise[:1],
        }

    def _examples(self, wildcards: Mapping[str, str]) -> Settings:
        case = wildcards["case"]
        figures, classification = self.config["figures"], self.config["classification"]
        prediction_time, window = figures["example_prediction_time_lt"], classification["window_lt"]
        return {
            **self._system(case),
            **self._time(case),
            "event_threshold": self.cases[case]["event_threshold"],
            "training_series": self.cases[case]["training"]["series"],
            **_pick(self.config["network"], "kernel", "washout_lt"),
            **_pick(classification, "resolution_lt", "window_lt"),
            "prediction_time_lt": prediction_time,
            # what is shown: something before the washout, and as far as the test set surely reaches
            "before_lt": self.config["network"]["washout_lt"] + 1,
            "reach_lt": min(prediction_time + 1, classification["longest_prediction_time_lt"])
            + window,
            "after_event_lt": 0.5,
            "horizon_lt": figures["example_horizon_lt"],
            "horizon": _pick(
                self.config["horizon"], "longest_start_lt", "start_step_lt", "tolerance"
            ),
        }

    def _figure_observable_and_density(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.case_of_figure(wildcards)
        return {
            **self._time(case),
            **self._labels(case),
            **_pick(self.cases[case], "event_threshold", "density"),
        }

    def _figure_validation_strategies(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.example.case
        return {
            **self._time(case),
            **self._symbol(case),
            **_pick(self.cases[case], "event_threshold", "recycle_validation"),
            "validation": sorted(
                {network.validation for network in self.select(case=case)}, reverse=True
            ),
            "washout_lt": self.config["network"]["washout_lt"],
            "interval_lt": self.config["search"]["interval_lt"],
        }

    def _figure_network_schematic(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            "inputs": make_system(**self._named_system(self.example.case)).dimension,
            "neurons": self.example.neurons,
            **_pick(self.config["network"], "connectivity", "input_bias"),
        }

    def _figure_search_landscape(self, wildcards: Mapping[str, str]) -> Settings:
        return {}

    def _figure_prediction_examples(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            **self._symbol(self.example.case),
            "event_threshold": self.cases[self.example.case]["event_threshold"],
            "prediction_time_lt": self.config["figures"]["example_prediction_time_lt"],
            "window_lt": self.config["classification"]["window_lt"],
        }

    def _figure_prediction_schematic(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            **self._figure_prediction_examples(wildcards),
            "washout_lt": self.config["network"]["washout_lt"],
        }

    def _figure_classification_scores(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.case_of_figure(wildcards)
        return {
            **self._figure_horizon_by_size(wildcards),
            **_pick(
                self.config["figures"],
                "fixed_neurons",
                "fixed_prediction_time_lt",
                "example_validation",
            ),
            "case": case,
        }

    def _figure_horizon_schematic(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            **self._symbol(self.example.case),
            **_pick(self.config["horizon"], "longest_start_lt", "start_step_lt", "tolerance"),
        }

    def _figure_horizon_evaluations(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            **self._symbol(self.example.case),
            "event_threshold": self.cases[self.example.case]["event_threshold"],
            "washout_lt": self.config["network"]["washout_lt"],
        }

    def _figure_horizon_by_size(self, wildcards: Mapping[str, str]) -> Settings:
        case = self.case_of_figure(wildcards)
        return {
            "case": case,
            "reynolds": self.reynolds(case),
            "published_overlay": self.config["figures"]["published_overlay"],
        }

    def _figure_by_reynolds(self, wildcards: Mapping[str, str]) -> Settings:
        return {
            "cases": [*self._reynolds_cases],
            "reynolds_prediction_times_lt": sorted(
                set(self.config["figures"]["reynolds_prediction_times_lt"])
            ),
            **_pick(self.config["figures"], "fixed_neurons", "published_overlay"),
        }


def _pick(record: Mapping[str, Any], *names: str) -> Settings:
    return {name: record[name] for name in names}
