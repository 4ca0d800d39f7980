"""Options that several kinds of forecasters share, and sections of options of single kinds.

Each class is one section of ``forecasters`` in the workflow's config, with the same names and
defaults. A kind has the options of the sections that it inherits from.
"""

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

from burstcast.base import durations


@dataclass(frozen=True, kw_only=True)
class NetworkOptions:
    """Options of echo state networks."""

    section: ClassVar[str] = "esn"

    connectivity: float = 20.0  #: mean number of connections of a neuron
    input_bias: float = 1.0  #: constant that is appended to the normalised inputs
    #: training series whose range the inputs are divided by
    input_range: Literal["all", "first"] = "all"
    #: what is subtracted from inputs and targets: their mean over the training series, so that
    #: forecasts do not depend on the zero of a unit, or nothing, as in the paper
    input_offset: Literal["mean", "none"] = "mean"
    readout: Literal["linear", "quadratic"] = "quadratic"  #: `burstcast.networks.readout`
    leak_rate: tuple[float, ...] = (1.0,)  #: several: chosen by the search
    #: a forecast beyond this many training ranges of any component has diverged; None: not judged
    divergence_bound: float | None = 10.0
    backend: Literal["compiled", "scipy"] = "compiled"  #: implementation of the dynamics


@dataclass(frozen=True, kw_only=True)
class ObservationOptions:
    """Knowledge about the observations."""

    section: ClassVar[str] = "observation"

    #: standard deviation of the noise, in standard deviations of each component; None: estimated
    noise: float | None = None


@dataclass(frozen=True, kw_only=True)
class FilterOptions:
    """Options of an ensemble filter."""

    section: ClassVar[str] = "filter"

    members: int = 40  #: size of the ensemble: even, and at least twice the dimension
    #: factor of the ensemble's deviations before each observation, which makes up for errors of the
    #: model; None: chosen by the innovations in the training series
    inflation: float | None = None


@dataclass(frozen=True, kw_only=True)
class FilteredNetworkOptions:
    """Options of networks that are trained on smoothed series and start from a filter."""

    section: ClassVar[str] = "esn_filtered"

    denoising_rounds: int = 4  #: how often the training series are smoothed and learnt from again
    #: noise of the inputs of a training on smoothed series, in units of the observation noise
    jitter: float = 0.05
    members: int = 30  #: size of the ensemble: even
    voters: int = 10  #: members that forecast: even
    #: start of a washout that the members follow, before it corrects them, in Lyapunov times
    start_up_lt: float = 0.17
    lag_lt: float = 0.2  #: time by which later observations correct smoothed series


@dataclass(frozen=True, kw_only=True)
class QuadraticOptions:
    """Options of learnt equations."""

    section: ClassVar[str] = "quadratic"

    degree: int = 2  #: highest degree of the polynomials
    window_lt: float = 0.2  #: time that the equations are integrated over, in Lyapunov times


@dataclass(frozen=True, kw_only=True)
class HiddenQuadraticOptions:
    """Options of learnt quadratic equations with hidden variables."""

    section: ClassVar[str] = "quadratic_hidden"

    #: number of hidden variables, which nothing but prior knowledge tells; 0: there are none, and
    #: equations are learnt again from smoothed series
    hidden: int = 2
    #: whether the observable is a component that follows from the others and the hidden variables
    observable_follows: bool = False
    #: whether quadratic terms conserve the observable that follows, as those of an incompressible
    #: flow conserve its kinetic energy
    conserved: bool = False
    rounds: int = 12  #: how often the training series are smoothed and the equations learnt again
    #: rates of moving averages that the first hidden variables may be, per Lyapunov time
    rates_per_lt: tuple[float, ...] = (0.18, 0.4, 0.73, 1.5, 3.0, 5.5)
    smoothing_lag_lt: float = 0.65  #: time by which later observations correct smoothed series
    members: int = 40  #: size of the ensemble: even


@dataclass(frozen=True, kw_only=True)
class AnalogueOptions:
    """Options of analogues."""

    section: ClassVar[str] = "analogues"

    neighbours: int = 10  #: number of analogues


@dataclass(frozen=True, kw_only=True)
class NVAROptions:
    """Options of nonlinear vector autoregression."""

    section: ClassVar[str] = "nvar"

    lags: int = 2  #: number of last states that the next one depends on
    ridge: float = 1e-6  #: Tikhonov parameter, for features of standardised states


@dataclass(frozen=True, kw_only=True)
class ClassifierOptions:
    """Options of the training of classifiers."""

    section: ClassVar[str] = "classifiers"

    start_spacing_lt: float = 0.1  #: distance of the training points, in Lyapunov times
    folds: int = 10  #: parts of the training series that calibrate the probabilities


@dataclass(frozen=True, kw_only=True)
class PrecursorOptions:
    """Options of learnt precursors."""

    section: ClassVar[str] = "precursor"

    #: see `burstcast.forecasters.precursor`
    classifier: Literal["boosting", "logistic"] = "boosting"
    lags_lt: tuple[float, ...] = (0.1, 0.2, 0.3, 0.4)  #: past values, in Lyapunov times


@dataclass(frozen=True, kw_only=True)
class DirectReadoutOptions:
    """Options of reservoirs with a readout for the event. Several values: chosen in training."""

    section: ClassVar[str] = "esn_direct"

    neurons: int = 1000  #: size of the reservoir
    spectral_radius: tuple[float, ...] = (0.9,)
    input_scaling: tuple[float, ...] = (1.0, 10.0)
    #: strength of the penalty on squared weights of neurons of unit variance
    penalty: tuple[float, ...] = (1.0, 30.0)


@dataclass(frozen=True, kw_only=True)
class AwareOptions:
    """Options of kinds that learn how the flow depends on parameters."""

    section: ClassVar[str] = "aware"

    parameters: tuple[str, ...] = ("reynolds",)  #: names of the parameters
    #: function of a parameter that the factors are made of
    #: (`burstcast.forecasters._parameter_factors`)
    transform: Literal["identity", "inverse"] = "inverse"
    parameter_degree: int = 1  #: highest degree of the factors


SECTIONS: dict[str, type] = {
    options.section: options
    for options in (
        *(NetworkOptions, ObservationOptions, FilterOptions, QuadraticOptions, AnalogueOptions),
        *(FilteredNetworkOptions, HiddenQuadraticOptions),
        *(NVAROptions, ClassifierOptions, PrecursorOptions, DirectReadoutOptions, AwareOptions),
    )
}
"""Classes of options by section."""

_IN_SAMPLES: dict[type, dict[str, Any]] = {
    FilteredNetworkOptions: {"start_up_lt": 2.0, "lag_lt": 3.0},
    HiddenQuadraticOptions: {
        "rates_per_lt": (0.02, 0.05, 0.1, 0.2, 0.4),
        "smoothing_lag_lt": 10.0,
    },
    QuadraticOptions: {"window_lt": 1.0},
    ClassifierOptions: {"start_spacing_lt": 1.0},
    PrecursorOptions: {"lags_lt": (1.0, 2.0, 3.0, 4.0)},
}
"""Options whose defaults are durations, where durations are in samples."""


def in_samples(kind: Any) -> Any:
    """Forecaster whose durations are in samples: defaults in Lyapunov times are below a sample."""
    changes = {
        name: value
        for section, options in _IN_SAMPLES.items()
        for name, value in options.items()
        if isinstance(kind, section) and getattr(kind, name) == getattr(section(), name)
    }
    return replace(kind, **changes) if changes else kind


def resolved_by_samples(kind: Any, samples_per_lt: int, washout: int) -> dict[str, Any]:
    """Options of a forecaster that its samples are too coarse for, with the nearest that fit.

    Durations have one sample at least, and lags are different samples of a washout of ``washout``
    samples. ``samples_per_lt``: Samples in a Lyapunov time, or 1 where durations are in samples.
    """
    changes: dict[str, Any] = {}
    for section, name in ((QuadraticOptions, "window_lt"), (ClassifierOptions, "start_spacing_lt")):
        if isinstance(kind, section) and not durations.steps(getattr(kind, name), samples_per_lt):
            changes[name] = 1 / samples_per_lt
    if isinstance(kind, PrecursorOptions):
        lags = [durations.steps(lag, samples_per_lt) for lag in kind.lags_lt]
        if len({*lags}) < len(lags) or not all(0 < lag < washout for lag in lags):
            nearest = {max(1, round(lag * samples_per_lt)) for lag in kind.lags_lt}
            changes["lags_lt"] = tuple(
                lag / samples_per_lt for lag in sorted(nearest) if lag < washout
            )
    return changes
