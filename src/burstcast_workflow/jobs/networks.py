"""Networks from a job's settings: reservoir, training series, the search for hyperparameters."""

from collections.abc import Sequence
from typing import Any, Literal

from burstcast.base.arrays import FloatArray
from burstcast.base.names import parsed
from burstcast.base.series_lengths import series_lengths
from burstcast.forecasters._options import AwareOptions
from burstcast.forecasters._parameter_factors import factored_training
from burstcast.forecasters._reservoirs import normalised_series
from burstcast.networks.hyperparameters import SearchSpace
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.training import TrainingSeries
from burstcast.networks.validation import PointValidator
from burstcast.networks.validation_strategies.base import ValidationPlan
from burstcast.systems.parameters import Parameters
from burstcast_workflow.harness.settings import JobSettings, at
from burstcast_workflow.jobs.cases import System, Washout
from burstcast_workflow.jobs.series import Observed, read_scheduled


class Networks(JobSettings):
    """A network without its hyperparameters: its reservoir, and the series that it learns from."""

    washout: Washout
    observed: Observed
    random_seed: int = at("random_seed")
    connectivity: float = at("forecasters.esn.connectivity")
    input_bias: float = at("forecasters.esn.input_bias")
    input_range: Literal["all", "first"] = at("forecasters.esn.input_range")
    input_offset: Literal["mean", "none"] = at("forecasters.esn.input_offset")
    aware: dict[str, Any] = at("forecasters.aware")

    def reservoir_seed(self, identifier: str) -> ReservoirSeed:
        """Settings that the reservoir of a network, or of its scan, is made from."""
        name = parsed(identifier)
        assert name.neurons is not None
        assert name.seed is not None
        return ReservoirSeed(
            self.random_seed, name.neurons, name.seed, self.connectivity, self.input_bias
        )

    def learnt(self, ensemble: str, scheduled: Sequence[str] = ()) -> TrainingSeries:
        """Training series as networks see them; ``scheduled`` files also have the parameters."""
        if not scheduled:
            states = self.observed.training.states(ensemble)
            return self._training(self.observed.rows(ensemble, 0, states), states)
        series = read_scheduled(scheduled, self.case)
        names, values = tuple(self.aware["parameters"]), tuple(self.aware["own"])
        options = AwareOptions(
            parameters=names,
            transform=self.aware["transform"],
            parameter_degree=self.aware["parameter_degree"],
        )
        training = self._training(series.observed, series.states)
        return factored_training(training, Parameters(names, values), options)

    def _training(self, observed: FloatArray, states: FloatArray) -> TrainingSeries:
        """Observed series, normalised by their true states."""
        return normalised_series(observed, states, self.input_range, self.input_offset)


class Search(JobSettings):
    """The search for hyperparameters."""

    system: System
    networks: Networks
    spectral_radius: tuple[float, float] = at("search.spectral_radius", make=tuple)
    input_scaling: tuple[float, float] = at("search.input_scaling", make=tuple)
    leak_rate: tuple[float, ...] = at("forecasters.esn.leak_rate", make=tuple)
    readout: Literal["linear", "quadratic"] = at("forecasters.esn.readout")
    backend: Literal["compiled", "scipy"] = at("forecasters.esn.backend")
    tikhonov: list[float] = at("search.tikhonov")
    interval_lt: float = at("search.interval_lt")
    single_shot_lead_steps: int = at("search.single_shot_lead_steps")
    validated_series: int = at("case.recycle_validation.series")
    intervals: int | None = at("case.recycle_validation.intervals_per_series")

    @property
    def space(self) -> SearchSpace:
        """Ranges of the hyperparameters."""
        return SearchSpace(self.spectral_radius, self.input_scaling, self.leak_rate)

    def point_validator(
        self, identifier: str, ensemble: str, scheduled: Sequence[str]
    ) -> PointValidator:
        """Validation of the search points of one reservoir, its own or a network's."""
        training = self.networks.learnt(ensemble, scheduled)
        washout = self.networks.washout
        plan = ValidationPlan(
            washout=washout.steps,
            interval=washout.clock.positive_steps(self.interval_lt, Search.interval_lt),
            series=self.validated_series,
            intervals=self.intervals,
            single_shot_lead=self.single_shot_lead_steps,
        )
        if (lengths := series_lengths(training.observed)) is not None:
            plan = plan.fitted_to(lengths.tolist())
        system = self.system.space
        return PointValidator(
            reservoir=self.networks.reservoir_seed(identifier).reservoir(system.dimension),
            training=training,
            observable=system.observable,
            plan=plan,
            tikhonov=self.tikhonov,
            backend=self.backend,
            readout=self.readout,
        )
