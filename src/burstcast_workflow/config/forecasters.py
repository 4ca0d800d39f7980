"""Settings of forecasters: the kinds of a block of the campaign, and the options of kinds."""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    ConfigDict,
    Field,
    create_model,
    model_serializer,
    model_validator,
)

from burstcast.base.compiled.backends import usable_backend
from burstcast.base.names import ForecasterName
from burstcast.forecasters._options import SECTIONS
from burstcast.forecasters.registry import all_kinds, make_kind
from burstcast.networks.readout import ReadoutKind
from burstcast_workflow.config.kinds import (
    Count,
    Distinct,
    Label,
    Number,
    OwnClass,
    ParameterName,
    Positive,
    Section,
    Size,
    Some,
    SomeFalling,
    Strategy,
    Whole,
    optional,
    setting,
    with_defaults,
    wrong,
)

SIZES = "campaign.forecasters.esn.neurons"
STRATEGIES = "campaign.forecasters.esn.validation"


class NoAxes(Section):
    """There is one forecaster of this kind: {}."""


class OwnForecaster(Section):
    """A forecaster of one's own, `<module>:<class>`: its options, and a label beside them."""

    model_config = ConfigDict(extra="allow")

    label: Label | None = optional("name beside the name of the class, in tables and paths")

    @property
    def options(self) -> dict[str, Any]:
        """Options, without the label."""
        return dict(self.model_extra or {})


class Chosen(Section):
    """Kinds of forecasters, with the axes of each kind."""

    # `_mapping` takes them for entries of ``own``
    model_config = ConfigDict(
        json_schema_extra={"patternProperties": {"^[^:]+:[^:]+$": {"type": ["object", "null"]}}}
    )

    own: dict[OwnClass, OwnForecaster] = setting(
        "classes of your own, `<module>:<class>`, with their options; they may stand beside the "
        "kinds of this list",
        default={},
    )

    @model_validator(mode="before")
    @classmethod
    def _mapping(cls, kinds: Any) -> Any:
        """One mapping of a list of kinds or of a mapping, with classes of one's own in ``own``."""
        if isinstance(kinds, list):
            kinds = cls._of_list(kinds)
        if isinstance(kinds, cls):
            return kinds
        if not isinstance(kinds, dict):
            raise wrong("must be a list of kinds, or a mapping of kinds to their axes")
        classes = {kind: axes for kind, axes in kinds.items() if ":" in str(kind)}
        if not classes:
            return kinds
        others = {kind: axes for kind, axes in kinds.items() if kind not in classes}
        classes = {kind: {} if axes is None else axes for kind, axes in classes.items()}
        return {**others, "own": {**others.get("own", {}), **classes}}

    @staticmethod
    def _of_list(items: list[Any]) -> dict[Any, Any]:
        kinds: dict[Any, Any] = {}
        for item in items:
            if not isinstance(item, str | dict):
                raise wrong(f"has {item}; each kind is a name, or a name with its axes")
            for kind, axes in (item if isinstance(item, dict) else {item: {}}).items():
                if kind in kinds:
                    raise wrong(f"has {kind} twice")
                kinds[kind] = {} if axes is None else axes  # what YAML reads in `- equations:`
        return kinds

    @model_validator(mode="after")
    def _sound(self) -> Self:
        for kind, forecaster in self.own.items():
            try:
                make_kind(kind, forecaster.options)
            except (ValueError, TypeError) as error:
                raise wrong(f"has {kind}: {error}") from None
        return self

    @property
    def kinds(self) -> dict[str, Any]:
        """Axes by kind, of kinds that are not null."""
        kinds = {kind: axes for kind, axes in self if kind != "own" and axes is not None}
        return {**kinds, **self.own}


class NetworkAxes(Section):
    """Echo state networks of a block: neurons x validation strategies x seeds."""

    neurons: Some[Size] = setting("sizes of the reservoir")
    validation: Some[Strategy] = setting("validation strategies: Single Shot (SSV), Recycle (RV)")
    seeds: Count = setting("realisations of the random matrices, seeds 0 to seeds - 1", le=10_000)
    variants: Distinct[Label] = setting(
        "names of `forecasters.variants`: networks of each of them instead of networks with the "
        "settings of `forecasters.esn` and `forecasters.esn_filtered`",
        default=[],
    )


if TYPE_CHECKING:
    AllKinds = Chosen
else:  # a new module of burstcast.forecasters is one kind more
    AllKinds = create_model(
        "AllKinds", __base__=Chosen, **dict.fromkeys(all_kinds(), (NoAxes | None, None))
    )


class BlockForecasters(AllKinds):
    """Forecasters of a block, by kind; null for none of a kind."""

    esn: NetworkAxes | None = optional("echo state networks")
    esn_true_washout: NetworkAxes | None = optional(
        "the same networks, given washouts without noise"
    )
    esn_aware: NetworkAxes | None = optional(
        "echo state networks that know the parameters in force"
    )
    esn_filtered: NetworkAxes | None = optional(
        "echo state networks that learn from smoothed series and start from a filter's estimate"
    )

    @property
    def networks(self) -> list[NetworkAxes]:
        """Axes of the kinds that are networks."""
        return [axes for axes in self.kinds.values() if isinstance(axes, NetworkAxes)]

    def names(self, kind: str) -> Iterator[ForecasterName]:
        """Names of the forecasters of a kind: of networks, all combinations along the axes."""
        axes = self.kinds.get(kind)
        if isinstance(axes, NetworkAxes):
            labels: Sequence[str | None] = axes.variants or [None]
            several = product(labels, axes.neurons, axes.validation, range(axes.seeds))
            for label, neurons, validation, seed in several:
                yield ForecasterName(kind, neurons, validation, seed, label=label)
        elif axes is not None:
            yield ForecasterName(kind, label=getattr(axes, "label", None))


class NetworkChoice(Section):
    """Selection of the campaign's networks; a property that is left out is not restricted."""

    neurons: Distinct[Size] | None = setting(
        "sizes of the reservoir; all if left out or empty; null: figures.fixed_neurons",
        one_of=SIZES,
        default=[],
    )
    validation: Distinct[Strategy] | None = setting(
        "validation strategies; all if left out or empty; null: the example network's strategy",
        one_of=STRATEGIES,
        default=[],
    )


class Choice(AllKinds):
    """Selection of the campaign's forecasters by kind; null for none of a kind."""

    esn: NetworkChoice | None = optional("echo state networks")
    esn_true_washout: NetworkChoice | None = optional(
        "networks that are given washouts without noise"
    )
    esn_aware: NetworkChoice | None = optional(
        "echo state networks that know the parameters in force"
    )
    esn_filtered: NetworkChoice | None = optional(
        "echo state networks that start from a filter's estimate"
    )


@with_defaults(vars(SECTIONS["esn"]()))
class EchoStateNetwork(Section):
    """Echo state networks."""

    connectivity: Positive = setting("mean number of connections of a neuron")
    input_bias: Number | None = setting(
        "constant that is appended to the normalised inputs, b_in; null: 1 for measured series "
        "(`data` of a case), 0.1 for simulated ones, as in the paper"
    )
    input_range: Literal["all", "first"] = setting(
        "training series whose range the inputs are divided by: all, or the first one, as in the "
        "programs of the paper's authors"
    )
    input_offset: Literal["mean", "none"] | None = setting(
        "what is subtracted from inputs and targets: mean, their mean over the training series, so "
        "that forecasts do not depend on the zero of a unit; none, nothing, as in the paper; null: "
        "mean for measured series (`data` of a case), none for simulated ones"
    )
    divergence_bound: Number = setting(
        "a forecast beyond this many training ranges has diverged", "training ranges", ge=1
    )
    readout: ReadoutKind = setting(
        "what the output weights multiply: the states of the neurons, or these with every second "
        "one squared"
    )
    leak_rate: SomeFalling[Annotated[Positive, Field(le=1)]] = setting(
        "part of the way that neurons go in a step, a, where 1 is no leak; several: chosen by the "
        "search"
    )
    # a platform that cannot compile says so once, and every file says what it was made with
    backend: Annotated[Literal["compiled", "scipy"], AfterValidator(usable_backend)] = setting(
        "implementation of the reservoir's dynamics", validate_default=True
    )


@with_defaults(vars(SECTIONS["esn_filtered"]()))
class FilteredNetworks(Section):
    """Smoothing and filter of `esn_filtered`, whose networks have the settings of `esn`."""

    denoising_rounds: Whole = setting(
        "how often the training series are smoothed by the network and learnt from again", ge=0
    )
    jitter: Number = setting(
        "noise of the inputs in a training on smoothed series",
        "standard deviations of the observation noise",
        ge=0,
    )
    members: Annotated[Whole, Field(multiple_of=2)] = setting("size of the ensemble", ge=4)
    voters: Annotated[Whole, Field(multiple_of=2)] = setting(
        "members that forecast", ge=2, at_most="forecasters.esn_filtered.members"
    )
    start_up_lt: Positive = setting(
        "start of a washout that the members follow, before its observations correct them; shorter "
        "than washout_lt"
    )
    lag_lt: Positive = setting("time by which later observations correct smoothed series")


class Variant(FilteredNetworks, EchoStateNetwork):
    """Settings of networks that differ from `forecasters.esn` or `forecasters.esn_filtered`."""

    @model_serializer(mode="wrap")
    def _given(self, serialise: Any) -> dict[str, Any]:
        """Explicitly given settings."""
        settings = serialise(self)
        return {name: settings[name] for name in self.model_fields_set}


@with_defaults(vars(SECTIONS["observation"]()))
class Observation(Section):
    """Knowledge of learnt equations and filters about the observations."""

    noise: Number | None = setting(
        "standard deviation of the noise; null: estimated from the training series",
        "standard deviations of each component",
        ge=0,
    )


@with_defaults(vars(SECTIONS["filter"]()))
class Filter(Section):
    """The filter of `equations_filtered` and `quadratic_filtered`."""

    members: Annotated[Whole, Field(multiple_of=2)] = setting(
        "size of the ensemble: at least twice the components of a wholly observed state", ge=2
    )
    inflation: Number | None = setting(
        "factor of the ensemble's scatter before each observation; null: chosen by the innovations "
        "in the training series, 1 for a model without error",
        ge=1,
    )


@with_defaults(vars(SECTIONS["quadratic"]()))
class Quadratic(Section):
    """Learnt equations, of `quadratic` and `quadratic_filtered`."""

    degree: Whole = setting("highest degree of the polynomials", ge=1, le=3)
    window_lt: Positive = setting("time that the equations are integrated over, to learn them")


@with_defaults(vars(SECTIONS["quadratic_hidden"]()))
class HiddenQuadratic(Section):
    """Learnt quadratic equations with hidden variables, `quadratic_hidden`."""

    hidden: Whole = setting(
        "number of hidden variables, which must be known beforehand; 0: smoothing alone", ge=0
    )
    observable_follows: bool = setting(
        "whether the observable is a component that follows from the others and the hidden "
        "variables, and has no equation of its own"
    )
    conserved: bool = setting(
        "whether quadratic terms conserve this observable, as those of an incompressible flow "
        "conserve its kinetic energy; takes observable_follows"
    )
    rounds: Whole = setting(
        "how often the training series are smoothed by the equations, which are learnt again", ge=0
    )
    rates_per_lt: Some[Positive] = setting(
        "rates of moving averages that hidden variables begin as, two of which are chosen",
        "per Lyapunov time",
    )
    smoothing_lag_lt: Positive = setting("time by which later observations correct smoothed series")
    members: Annotated[Whole, Field(multiple_of=2)] = setting("size of the ensemble", ge=4)


@with_defaults(vars(SECTIONS["analogues"]()))
class AnalogueForecasters(Section):
    """Analogues."""

    neighbours: Count = setting("number of analogues, whose mean is the forecast")


@with_defaults(vars(SECTIONS["nvar"]()))
class NonlinearVectorAutoregression(Section):
    """Nonlinear vector autoregression, `nvar`."""

    lags: Count = setting("number of last states that the next one depends on")
    ridge: Positive = setting("Tikhonov parameter, for features of standardised states")


@with_defaults(vars(SECTIONS["classifiers"]()))
class Classifiers(Section):
    """Training of `precursor` and `esn_direct`, which give probabilities without a trajectory."""

    start_spacing_lt: Positive = setting("distance of the starting points that are learnt from")
    folds: Whole = setting(
        "parts of the training series, each forecast by what has learnt from the others, to "
        "calibrate the probabilities",
        ge=2,
    )


@with_defaults(vars(SECTIONS["precursor"]()))
class Precursor(Section):
    """Learnt precursors, `precursor`."""

    classifier: Literal["boosting", "logistic"] = setting(
        "gradient boosting of trees, or logistic regression of features and their products"
    )
    lags_lt: Distinct[Positive] = setting(
        "past values that are features beside the present ones, within the washout"
    )


@with_defaults(vars(SECTIONS["esn_direct"]()))
class DirectReadout(Section):
    """Reservoirs that are read out for the event, `esn_direct`; `esn` has all other settings."""

    neurons: Size = setting("size of the reservoir")
    spectral_radius: Some[Positive] = setting("spectral radius; several: chosen in training")
    input_scaling: Some[Positive] = setting("input scaling; several: chosen in training")
    penalty: Some[Positive] = setting(
        "strength of the penalty on squared weights of neurons of unit variance; several: chosen "
        "in training"
    )


@with_defaults(vars(SECTIONS["aware"]()))
class Aware(Section):
    """Kinds that know the parameters in force, whose factors what they learn is linear in."""

    parameters: Some[ParameterName] = setting(
        "parameters of the equations that forecasters are given, or share: share of the actuator"
    )
    transform: Literal["identity", "inverse"] = setting(
        "function of a parameter that the factors are made of, scaled to [-1, 1] in training"
    )
    parameter_degree: Whole = setting("highest degree of the factors", ge=1, le=3)


class Forecasters(Section):
    """Settings of the kinds of forecasters that have any."""

    esn: EchoStateNetwork = setting("", default_factory=EchoStateNetwork)
    variants: dict[Label, Variant] = setting(
        "networks that differ from `forecasters.esn` or `forecasters.esn_filtered`, by a name: the "
        "settings that differ",
        default={},
    )
    esn_filtered: FilteredNetworks = setting("", default_factory=FilteredNetworks)
    observation: Observation = setting("", default_factory=Observation)
    filter: Filter = setting("", default_factory=Filter)
    quadratic: Quadratic = setting("", default_factory=Quadratic)
    quadratic_hidden: HiddenQuadratic = setting("", default_factory=HiddenQuadratic)
    analogues: AnalogueForecasters = setting("", default_factory=AnalogueForecasters)
    nvar: NonlinearVectorAutoregression = setting("", default_factory=NonlinearVectorAutoregression)
    classifiers: Classifiers = setting("", default_factory=Classifiers)
    precursor: Precursor = setting("", default_factory=Precursor)
    esn_direct: DirectReadout = setting("", default_factory=DirectReadout)
    aware: Aware = setting("", default_factory=Aware)
