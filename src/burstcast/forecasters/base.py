"""The interface of a forecaster, which continues an observed washout.

Scoring, prediction horizon, long-term runs and control know only this interface. A forecaster's
memory is an array whose last axis is the batch, so that forecasts can be picked out and put aside
at any step.

A kind of forecaster is a frozen dataclass, a subclass of `Forecaster`, in this package or in any
other module (`burstcast.forecasters.registry`). Its fields are its options, with defaults. What
`fit` learns are fields as well, declared by `fitted`. A forecaster whose options alone are given is
unfitted.

Parameters of the equations may differ between series, and change in time: parameters of the system,
such as a Reynolds number, or the share of an actuator in force (`burstcast.systems.parameters`).
Columns of a record that are known in advance are parameters, too. Kinds that are `aware` may be
given them as further components of series and washouts (`burstcast.base.exogenous`).
"""

import abc
import copy
import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.base.left_out import LeftOut, rows_left_out
from burstcast.data.encoders.state_maps import StateMaps
from burstcast.forecasters._limits import DIVERGENCE_BOUND, TrainingLimits
from burstcast.forecasters._record import ForecasterRecord as ForecasterRecord
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import Parameters
from burstcast.systems.state_space import StateSpace


@dataclass(frozen=True)
class ForecastingCase:
    """Information for forecasters of a case beside the data.

    Attributes
    ----------
    system
        What states are, and the observable: a dynamical system, unless they were measured.
    time_step
        Time step of its integration, in time units.
    sampling_stride
        Integration steps in one step of a forecast.
    steps_per_lyapunov_time
        Steps of a forecast in a Lyapunov time.
    parameters
        Parameters that schedules are about, and their values in this case; None: there are none.
    source
        Equations of the flow whose states are encoded; None where the case's states are not
        encoded.
    maps
        Between states of the source and channels, which are all components of the case but the
        last one, the observable of the source; None where a forecaster is restored.
    random_seed
        Root of all random numbers.
    """

    system: StateSpace
    time_step: float
    sampling_stride: int
    steps_per_lyapunov_time: int
    parameters: Parameters | None = None
    source: DynamicalSystem | None = None
    maps: StateMaps | None = None
    random_seed: int = 0

    @property
    def required_parameters(self) -> Parameters:
        """Parameters, for kinds that learn how the flow depends on them."""
        if self.parameters is None:
            raise ValueError("a forecaster that knows the parameters needs a case that has some")
        return self.parameters


def fitted() -> Any:
    """Declare a field of a forecaster that `fit` fills in; its other fields are options."""
    return field(default=None, kw_only=True, repr=False, metadata={"fitted": True})


class ForecasterKind:
    """Common base of all kinds of forecasters: properties of the kind, and a record of the fit.

    A kind forecasts trajectories (`Forecaster`), or probabilities of events without them
    (`burstcast.forecasters._event_classifier.EventClassifier`).
    """

    has_trajectories: ClassVar[bool] = True
    """Whether it forecasts states: what prediction horizons, long runs and control need."""
    sees_truth: ClassVar[bool] = False
    """Whether it is given true states instead of observed ones: only as a bound for others."""
    needs_equations: ClassVar[bool] = False
    """Whether it forecasts with the equations of the system."""
    provides_ensemble: ClassVar[bool] = False
    """Whether `ensemble` has several members, whose forecasts are equally likely."""
    has_filter: ClassVar[bool] = False
    """Whether an ensemble filter estimates the present state from the whole washout."""
    aware: ClassVar[bool] = False
    """Whether it may be given exogenous inputs. Without them, the case's own values are assumed."""
    has_search: ClassVar[bool] = False
    """Whether a search finds its hyperparameters before it is trained."""
    searched_as: ClassVar[str] = ""
    """Another kind whose search finds its hyperparameters; empty: its own."""

    learns_parameters: ClassVar[bool] = False
    """Whether it is `aware` and learns how the flow depends on parameters; equations need not."""

    @classmethod
    def option_fields(cls) -> "list[dataclasses.Field[Any]]":
        """Fields that are options: all that `fit` does not fill in."""
        assert dataclasses.is_dataclass(cls)
        return [option for option in dataclasses.fields(cls) if not option.metadata.get("fitted")]

    @property
    def options(self) -> dict[str, Any]:
        """Options by name."""
        return {option.name: getattr(self, option.name) for option in self.option_fields()}

    def record(self) -> ForecasterRecord:
        """Return the record from which `restore` recreates the forecaster.

        By default it holds all fitted fields, which must be arrays, numbers or texts.

        Raises
        ------
        TypeError
            If a fitted field is of another type: the kind then defines `record` and `restore`.
        """
        arrays, attributes = {}, {}
        for name in sorted(set(vars(self)) & self._fitted_names()):
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                arrays[name] = np.asarray(value, dtype=np.float64)
            elif isinstance(value, str | int | float | np.number):
                attributes[name] = value.item() if isinstance(value, np.number) else value
            else:
                raise TypeError(
                    f"{type(self).__name__}.{name} is {type(value).__name__}, which no file holds: "
                    "make it an array, a number or a text, or define record and restore"
                )
        return ForecasterRecord(arrays, attributes)

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Return this forecaster with what a record says was fitted."""
        names = self._fitted_names()
        values = {**record.arrays, **record.attributes}
        return self.with_fitted(**{name: values[name] for name in names})

    def with_fitted(self, **values: Any) -> Self:
        """Return a forecaster with the same options and these fitted fields."""
        return dataclasses.replace(self, **values)  # type: ignore[type-var]

    def weaknesses(self) -> list[str]:
        """Sentences about a fit that is less than it seems; none by default."""
        return []

    def tuned(self) -> Self:
        """Return a forecaster whose `fit` takes the hyperparameters that this one has chosen.

        Probabilities are calibrated with forecasters of the same hyperparameters, which have learnt
        from fewer series.
        """
        return self

    @classmethod
    def _fitted_names(cls) -> set[str]:
        assert dataclasses.is_dataclass(cls)
        return {option.name for option in dataclasses.fields(cls) if option.metadata.get("fitted")}


class Forecaster(ForecasterKind, abc.ABC):
    """Continues many observed series at once."""

    tolerated_invalid: ClassVar[float] = 0.01
    """Share of invalid forecasts above which users are warned."""
    why_invalid: ClassVar[str] = "not finite, or more than ten training ranges away"
    """Why forecasts of the kind are invalid, in words."""

    limits: TrainingLimits | None = None
    """Ranges of the training series (`within`), far beyond which a forecast is invalid; None: it is
    invalid only where it is not finite."""

    def within(self, limits: TrainingLimits | None) -> Self:
        """Return this forecaster with the ranges of its training series.

        Whoever fits or reads a forecaster sets them; `fit` need not.
        """
        limited = copy.copy(self)
        object.__setattr__(limited, "limits", limits)
        return limited

    @abc.abstractmethod
    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Return a forecaster that has learnt from series, with the same options.

        Parameters
        ----------
        training
            Observed training series, ``(series, time, dimension)``, with inputs for kinds that
            learn parameters.
        case
            What may be known beside them.

        Raises
        ------
        NotImplementedError
            If the kind is made otherwise: networks have a search for hyperparameters.
        """

    def leave_one_out(
        self,
        training: FloatArray,
        case: ForecastingCase,
        washout: int,
        left_out: Sequence[LeftOut] | None = None,
    ) -> Iterator[Self]:
        """Forecasters that have learnt from all training series but one, for each one in turn.

        Their forecasts of the series left out are honest: probabilities are calibrated with them.

        Parameters
        ----------
        training, case
            As `fit` was given them.
        washout
            Steps at the beginning of each series that training leaves out.
        left_out
            Series that are left out together, for each forecaster; None: each series by itself.

        Raises
        ------
        ValueError
            If there is a single series: nothing would be left.
        """
        tuned = self.tuned()
        for rows in rows_left_out(len(training), left_out):
            yield tuned.fit(np.delete(training, rows, axis=0), case)

    @abc.abstractmethod
    def start(self, washout: FloatArray) -> FloatArray:
        """Memory after an observed washout.

        Parameters
        ----------
        washout
            Observed states up to and including the starting point, ``(steps, dimension, batch)``.

        Returns
        -------
        Memory, ``(..., batch)``.
        """

    def ensemble(self, washout: FloatArray) -> FloatArray:
        """Memories of all members of an ensemble after an observed washout, equally likely.

        By default, the memory of `start` is the only member. A kind with several overrides this
        method and `combined`, and sets `provides_ensemble`. The share of members whose forecast
        has an event is the event's probability.

        Parameters
        ----------
        washout
            As for `start`.

        Returns
        -------
        ``(..., members, batch)``. With its last two axes flattened it is a memory of `advance`.
        """
        return self.start(washout)[..., np.newaxis, :]

    def combined(self, ensemble: FloatArray) -> FloatArray:
        """Memory of the single forecast that an ensemble stands for: `start` of its washout."""
        return ensemble[..., 0, :]

    @abc.abstractmethod
    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Forecast the next steps.

        Parameters
        ----------
        memory
            Memory that `start` or an earlier call returned, or members of an `ensemble` side by
            side.
        steps
            Steps of the forecast.

        Returns
        -------
        Forecast states ``(steps, dimension, batch)``, the first one step after the starting point
        or after the last forecast state, and the memory from which the forecast goes on.
        """

    def advance_tangent(
        self, memory: FloatArray, tangent: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Forecast the next steps together with small perturbations of the memory.

        A kind that has it has Lyapunov exponents (`burstcast.statistics.lyapunov_spectrum`).

        Parameters
        ----------
        memory
            ``(size, batch)``.
        tangent
            Perturbations, ``(size, perturbations, batch)``.
        steps
            Steps of the forecast.

        Returns
        -------
        Both, so many steps later: the memory as `advance` returns it, bit for bit, and the
        perturbations multiplied by the derivative of the map from the old memory to the new one.

        Raises
        ------
        NotImplementedError
            If the kind provides no derivative.
        """
        raise NotImplementedError(f"{type(self).__name__} does not linearise its forecasts")

    @classmethod
    def linearises(cls) -> bool:
        """Whether the kind linearises its forecasts, so that it has Lyapunov exponents."""
        return cls.advance_tangent is not Forecaster.advance_tangent

    def invalid(self, outputs: FloatArray) -> BoolArray:
        """Mark the steps from which forecasts are invalid.

        A forecast is invalid from its first step on at which a component is not finite, or further
        than `DIVERGENCE_BOUND` training ranges (networks: ``divergence_bound``) from the middle of
        its training range.

        Parameters
        ----------
        outputs
            Forecasts as `advance` returns them, ``(steps, dimension, batch)``.

        Returns
        -------
        ``(steps, batch)``; once true, it stays true.
        """
        bound = getattr(self, "divergence_bound", DIVERGENCE_BOUND)
        if self.limits is None or bound is None:
            wrong = ~np.isfinite(outputs).all(axis=1)
        else:
            wrong = self.limits.outside(outputs, bound)
        return np.asarray(np.logical_or.accumulate(wrong, axis=0))

    def valid(self, outputs: FloatArray) -> FloatArray:
        """Forecasts ``(steps, dimension, batch)`` with NaN where they are `invalid`."""
        invalid = self.invalid(outputs)
        if not invalid.any():
            return outputs
        return np.where(invalid[:, np.newaxis], np.nan, outputs)

    def diverged(self, outputs: FloatArray) -> BoolArray:
        """Mark forecasts ``(steps, dimension, batch)`` that are `invalid` at any step."""
        return np.asarray(self.invalid(outputs).any(axis=0))
