"""What figures and tables show: choices of cases, places of files, settings that follow from them.

A figure names a property of `Choices` as its ``cases``. ``at("shown.panels")`` is a property of
`Shown`, and ``read("example/examples.nc")`` a file in the directory of one, or in each of several.
"""

from collections.abc import Iterable
from functools import cached_property
from typing import Any

from burstcast.base.declared import File
from burstcast.data.observation.velocity_sensors import PlaneFlow
from burstcast_workflow.campaign.campaign import Campaign, nearest
from burstcast_workflow.campaign.members import CaseForecaster, ControlRun


class Choices:
    """Choices of cases that figures are made for: the first case has the plain name."""

    def __init__(self, campaign: Campaign) -> None:
        self.campaign = campaign

    @property
    def example_case(self) -> list[str]:
        """The example's case."""
        return [self.campaign.example.case]

    @property
    def every(self) -> list[str]:
        """All cases, the example's first."""
        return list(dict.fromkeys([*self.example_case, *self.campaign.case_names]))

    @property
    def networks(self) -> list[str]:
        """Cases with networks that are not aware, the example's first."""
        return [case for case in self.every if self.campaign.select(case=case, kind="esn")]

    @property
    def several_sizes(self) -> list[str]:
        """The example's, and others with networks of several sizes."""
        sizes: dict[str, set[int | None]] = {case: set() for case in self.every}
        for network in self.campaign.networks:
            sizes[network.case].add(network.name.neurons)
        return [case for case in sizes if case in self.example_case or len(sizes[case]) > 1]

    @property
    def reynolds_cases(self) -> list[str]:
        """One case for each Reynolds number that has networks of the size that is held fixed."""
        cases: dict[float, str] = {}
        for network in self.campaign.select(neurons=self.campaign.config.figures.fixed_neurons):
            reynolds = self.campaign.cases[network.case].parameters.get("reynolds")
            if reynolds is not None:
                cases.setdefault(reynolds, network.case)
        return list(cases.values())

    @property
    def several_reynolds(self) -> list[str]:
        """The example's, if there are several Reynolds numbers."""
        return self.example_case if len(self.reynolds_cases) > 1 else []

    @property
    def aware_cases(self) -> list[str]:
        """Cases of the example's system with forecasters that know parameters, tested freely."""
        campaign = self.campaign
        system = campaign.cases[campaign.example.case].system
        cases = [campaign.cases[name] for name in campaign.aware_cases]
        return [case.name for case in cases if not case.is_switched and case.system == system]

    @property
    def several_parameters(self) -> list[str]:
        """The example's, if forecasters that know the parameters are tested at several values."""
        values = {tuple(self.campaign.own_values(case)) for case in self.aware_cases}
        return self.example_case if len(values) > 1 else []

    @property
    def encoded(self) -> list[str]:
        """Cases that others are encoded from."""
        cases, encoded = self.campaign.cases, self.campaign.where(is_encoded=True)
        return list(dict.fromkeys(cases[case].source.name for case in encoded))

    @property
    def plane_flows(self) -> list[str]:
        """Cases of flows in a plane."""
        return [case for case in self.campaign.simulated_cases if self._is_plane(case)]

    def _is_plane(self, case: str) -> bool:
        return isinstance(self.campaign.cases[case].space, PlaneFlow)

    @property
    def decoded_planes(self) -> list[str]:
        """Encoded cases of flows in a plane, with a forecaster whose channels can be decoded."""
        encoded = self.campaign.where(is_encoded=True)
        return [case for case in encoded if Shown(self.campaign, case).decoded]

    @property
    def long_term(self) -> list[str]:
        """Cases with networks whose long-term statistics are shown, the example's first."""
        return [case for case in self.every if Shown(self.campaign, case).long_term_networks]

    @property
    def control_example(self) -> list[str]:
        """The case of the run of control that the figures of one event are taken from."""
        return [] if self.example_run is None else [self.example_run.case]

    @cached_property
    def example_run(self) -> ControlRun | None:
        """Run of control that figures of one event show: the example network's, or the first."""
        time = nearest(self.campaign.config.control.prediction_times_lt, 2)
        runs = [run for run in self._network_runs if run.prediction_time_lt == time]
        example = self.campaign.example
        first = [run for run in runs if (run.case, run.controller) == (example.case, example.name)]
        return next(iter([*first, *runs]), None)

    @cached_property
    def _network_runs(self) -> list[ControlRun]:
        """The paper's control by networks."""
        return [run for run in self.campaign.control_runs if _by_network(run)]

    @property
    def controlled(self) -> list[str]:
        """Cases that networks control, the example's first if it is included."""
        cases = dict.fromkeys(run.case for run in self._network_runs)
        return sorted(cases, key=lambda case: case not in self.example_case)

    @property
    def controlled_systems(self) -> list[str]:
        """One controlled case of each system: a figure shows all cases of a system."""
        first: dict[str, str] = {}
        for case in self.controlled:
            first.setdefault(self.campaign.cases[case].system, case)
        return list(first.values())

    @property
    def other_control(self) -> list[str]:
        """Cases that are controlled in other ways than the paper's, too, the example's first."""
        papers = set(self.campaign.control_runs)
        cases = {run.case for run in self.campaign.strategy_runs if run not in papers}
        return [case for case in self.every if case in cases]

    @property
    def long_controlled(self) -> list[str]:
        """Cases with long runs of control, the example's first."""
        cases = {run.case for run in self.campaign.long_runs}
        return [case for case in self.every if case in cases]


class Shown(Choices):
    """What figures and tables show of one case."""

    def __init__(self, campaign: Campaign, case: str) -> None:
        super().__init__(campaign)
        self.case = case

    def _of_case(self, members: Iterable[Any]) -> list[Any]:
        return [member for member in members if member.case == self.case]

    def paths(self, file: File) -> str | list[str]:
        """Paths of a declared file below the results directory; an empty list if there is none.

        Its place is the case, or a property of `Shown`; of a file of each forecaster, or run of
        control, a property of the campaign, whose members in the case have the file.
        """
        place, slash, name = file.path.partition("/")
        if file.of_each:
            places = self._of_case(getattr(self.campaign, place))
        else:
            places = getattr(self, place)
        if isinstance(places, list):
            return [f"{_directory(each)}{slash}{name}" for each in places]
        return [] if places is None else f"{_directory(places)}{slash}{name}"

    # -- places of files: a directory, or several, below the results directory ---------------------

    @property
    def source(self) -> str:
        """The case that another is a part of."""
        return self.campaign.cases[self.case].source.name

    @property
    def example(self) -> CaseForecaster:
        """The example network."""
        return self.campaign.example

    @cached_property
    def long_term_networks(self) -> list[CaseForecaster]:
        """Networks the best of which stands for all where only one can be shown."""
        size = self.campaign.config.figures.fixed_neurons
        networks = [
            network
            for network in self._of_case(self.campaign.long_term_forecasters)
            if network.name.neurons == size and network.name.label is None
        ]
        example = self.example.name.validation
        strategies = {str(network.name.validation) for network in networks}
        shown = example if example in strategies else min(strategies, default=example)
        return [network for network in networks if network.name.validation == shown]

    @property
    def spectrum_case(self) -> list[str]:
        """The case, if spectra of its networks are computed."""
        computed = self._of_case(self.campaign.spectrum_forecasters) and self.simulated_case
        return [self.case] if computed and self.long_term_networks else []

    @property
    def suppressed_event(self) -> str:
        """The file of an event that control suppresses."""
        assert self.example_run is not None
        return f"{self.example_run.directory}/suppressed_event.nc"

    @property
    def decoded(self) -> list[CaseForecaster]:
        """Forecasters whose channels of a plane flow can be decoded: networks first."""
        if self.campaign.cases[self.case].undecoded or not self._is_plane(self.source):
            return []
        networks = self.campaign.select(case=self.case, kind="esn")
        forecasters = [*networks, *self._of_case(self.campaign.trajectory_forecasters)]
        return [forecaster for forecaster in forecasters if not forecaster.kind.sees_truth]

    @property
    def decoded_forecaster(self) -> CaseForecaster:
        """The first forecaster whose channels of a plane flow can be decoded."""
        return next(iter([*self.decoded, self.example]))

    @property
    def controlled_cases(self) -> list[str]:
        """All controlled cases of a case's system."""
        cases = self.campaign.cases
        system = cases[self.case].system
        return [case for case in self.controlled if cases[case].system == system]

    @property
    def encoded_cases(self) -> list[str]:
        """A case and the cases encoded from it."""
        cases = self.campaign.cases
        return [case for case in self.campaign.ranked_cases if cases[case].source.name == self.case]

    @property
    def classified_case(self) -> str | None:
        """The case, if it has forecasters that give probabilities without a trajectory."""
        return self.case if self._of_case(self.campaign.classifiers) else None

    @property
    def simulated_case(self) -> str | None:
        """The case, if it is simulated."""
        return self.case if self.case in self.campaign.simulated_cases else None

    @property
    def controlled_case(self) -> str | None:
        """The case, if there are runs of control in it."""
        return self.case if self._of_case(self.campaign.strategy_runs) else None

    @property
    def contradicted_case(self) -> str | None:
        """The case, if forecasters' exponents may contradict an estimate of its unit of time."""
        return self.case if self.campaign.cases[self.case].estimates_time_unit else None

    # -- settings ----------------------------------------------------------------------------------

    @property
    def strategies(self) -> list[str]:
        """Validation strategies of the case's networks."""
        names = {network.name.validation for network in self._of_case(self.campaign.networks)}
        return sorted((str(name) for name in names), reverse=True)

    @property
    def example_prediction_time_lt(self) -> float:
        """Prediction time of examples."""
        return self._prediction_time(2)

    @property
    def fixed_prediction_time_lt(self) -> float:
        """Prediction time of what is drawn against something else."""
        return self._prediction_time(3)

    def _prediction_time(self, wanted: float) -> float:
        """The classified prediction time nearest to a wanted one."""
        time = nearest(self.campaign.config.classification.prediction_times_lt, wanted)
        assert time is not None
        return time

    @property
    def prediction_times_lt(self) -> list[float]:
        """Prediction times of examples, and of what is drawn against something else."""
        return sorted({self.example_prediction_time_lt, self.fixed_prediction_time_lt})

    @property
    def control_networks(self) -> dict[str, Any]:
        """Size and validation strategy that the figures of control show for the case."""
        names = [run.controller for run in self._of_case(self._network_runs)]
        kinds = [{"neurons": name.neurons, "validation": name.validation} for name in names]
        size = self.campaign.config.figures.fixed_neurons
        wanted = {"neurons": size, "validation": self.example.name.validation}
        return wanted if wanted in kinds else kinds[0]

    @property
    def frontier_network(self) -> dict[str, Any] | None:
        """Network whose control by all strategies is shown: the example's, or else the first."""
        runs = filter(_by_network, self._of_case(self.campaign.strategy_runs))
        names = [run.controller for run in runs]
        example = [name for name in names if name == self.example.name]
        return next((name.keys for name in [*example, *names]), None)

    @property
    def panels(self) -> list[dict[str, Any]]:
        """Each controlled case, with the kind of networks that are shown."""
        return [
            {"case": case, **Shown(self.campaign, case).control_networks}
            for case in self.controlled_cases
        ]

    @property
    def parameter(self) -> dict[str, Any]:
        """The first parameter that forecasters know: its values by case, and those trained on."""
        campaign, cases = self.campaign, self.aware_cases
        learning = [member for member in campaign.forecasters if member.kind.learns_parameters]
        aware = [member for member in learning if member.case in cases]
        sources = {source for case in cases for source in campaign.sources(case)}
        return {
            "name": campaign.config.forecasters.aware.parameters[0],
            "values": {case: campaign.own_values(case)[0] for case in cases},
            "trained": sorted({campaign.own_values(source)[0] for source in sources}),
            "kinds": sorted({member.name.kind for member in aware}),
        }


def _directory(place: str | CaseForecaster | ControlRun) -> str:
    return place if isinstance(place, str) else place.directory


def _by_network(run: ControlRun) -> bool:
    """Whether a single network controls, of no variant."""
    controller = run.controller
    return controller.kind == "esn" and controller.role is None and controller.label is None
