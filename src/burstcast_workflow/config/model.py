"""The model of the configuration: every setting with its type, bounds, unit and meaning.

Messages about mistakes are made from it, and docs/settings.md. A bound may be another setting;
`burstcast_workflow.config.checks` has what else must hold between settings.
"""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Field,
    create_model,
    model_validator,
)
from pydantic_core import PydanticCustomError

from burstcast import durations
from burstcast.compiled.backends import usable_backend
from burstcast.esn.readout import ReadoutKind
from burstcast.forecasters._options import DEFAULTS
from burstcast.forecasters.registry import all_kinds
from burstcast.tuning.hyperparameters import SurrogateSettings
from burstcast_workflow.config.kinds import (
    CaseName,
    ControlStrategyName,
    Count,
    CountOrNull,
    Directory,
    Distinct,
    EncoderName,
    EventShare,
    Label,
    NetworkOrNull,
    ParameterName,
    Positive,
    PositiveOrNull,
    PositiveRange,
    Range,
    Rising,
    Section,
    Size,
    Some,
    SomeFalling,
    SomeRising,
    Strategy,
    StrategyValue,
    SystemName,
    Threshold,
    TimeStep,
    Whole,
    Words,
    optional,
    part_of,
    setting,
    with_defaults,
)
from burstcast_workflow.harness.canonical import canonical

TIME = "time units"
OBSERVABLE = "units of the observable"
RESOLUTION = "classification.resolution_lt"
SIZES = "campaign.forecasters.esn.neurons"
STRATEGIES = "campaign.forecasters.esn.validation"


class NoAxes(Section):
    """There is one forecaster of this kind: {}."""


KINDS = Words("a list of kinds, or a mapping of kinds to their axes, {} where there are none")
Alone = Annotated[NoAxes | None, Words("{}, or null for none")]


class Chosen(Section):
    """Kinds of forecasters, with the axes of each kind."""

    @model_validator(mode="before")
    @classmethod
    def _mapping(cls, said: Any) -> Any:
        """A list of kinds, names or mappings of names to axes, as one mapping."""
        if not isinstance(said, list):
            return said
        kinds: dict[Any, Any] = {}
        for one in said:
            if not isinstance(one, str | dict):
                text = f"has {one}; each kind is a name, or a name with its axes"
                raise PydanticCustomError("between", text)
            found = one if isinstance(one, dict) else {one: {}}
            for kind in found.keys() & kinds.keys():
                raise PydanticCustomError("between", f"has {kind} twice")
            # what YAML reads in `- equations:`
            kinds |= {kind: {} if axes is None else axes for kind, axes in found.items()}
        return kinds

    @property
    def kinds(self) -> dict[str, Any]:
        """Axes by kind, of kinds that are not null."""
        return {kind: axes for kind, axes in self if axes is not None}


class NetworkAxes(Section):
    """Echo state networks of a block: neurons x validation strategies x seeds."""

    neurons: Some[Size] = setting("sizes of the reservoir")
    validation: Some[Strategy] = setting("validation strategies: Single Shot (SSV), Recycle (RV)")
    seeds: Count = setting("realisations of the random matrices, seeds 0 to seeds - 1", le=10_000)
    variants: Distinct[Label] = setting(
        "names of `forecasters.variants`: networks of each of them instead of networks with the "
        "settings of `forecasters.esn`",
        default=[],
    )


if TYPE_CHECKING:
    AllKinds = Chosen
else:  # a new module of burstcast.forecasters is one kind more
    AllKinds = create_model(
        "AllKinds", __base__=Chosen, **dict.fromkeys(all_kinds(), (Alone, None))
    )


class ExternalFiles(Section):
    """Forecasts that another program has made, in files (docs/benchmark.md)."""

    files: Some[str] = setting(
        "files of forecasts, NetCDF or CSV, as seen from where Snakemake runs; {case} stands for "
        "the name of the case"
    )
    alarm_threshold: Annotated[Positive, Field(le=1)] = setting(
        "probability at or above which an alarm is raised; probabilities are taken as they are",
        default=0.5,
    )


class BlockForecasters(AllKinds):
    """Forecasters of a block, by kind; null for none of a kind."""

    external: Annotated[
        dict[Label, ExternalFiles] | None, Words("a mapping of names, or null for none")
    ] = optional(
        "forecasts that other programs have made, by a name: each has `files`, NetCDF or CSV "
        "(`{case}` in a path stands for the name of the case), and may have an `alarm_threshold`, "
        "0.5 if left out"
    )

    esn: NetworkAxes | None = optional("echo state networks")
    esn_true_washout: NetworkAxes | None = optional(
        "the same networks, given washouts without noise"
    )
    esn_aware: NetworkAxes | None = optional(
        "echo state networks that know the parameters in force"
    )

    @property
    def networks(self) -> list[NetworkAxes]:
        """Axes of the kinds that are networks."""
        kinds = (self.esn, self.esn_true_washout, self.esn_aware)
        return [axes for axes in kinds if axes is not None]


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

    external: Alone = optional("forecasts from files, which start from no other state: always null")

    esn: NetworkChoice | None = optional("echo state networks")
    esn_true_washout: NetworkChoice | None = optional(
        "networks that are given washouts without noise"
    )
    esn_aware: NetworkChoice | None = optional(
        "echo state networks that know the parameters in force"
    )


class Block(Section):
    """Block of the campaign: cases x forecasters."""

    reynolds: Distinct[Positive] = setting(
        "Reynolds numbers; each names the case Re<value> of the shear flow", default=[]
    )
    cases: Distinct[CaseName] = setting("names of entries of `cases`", default=[])
    realisations: Count = setting(
        "number of choices of the training series: the case itself, and cases `<case>-training<k>` "
        "with other training series",
        default=1,
    )
    event_shares: Distinct[EventShare] = setting(
        "instead of realisations: choices `<case>-training<k>` whose training series are drawn at "
        "random from all but the test series, with a share of time at or above the event threshold "
        "near the k-th of these; all: the share of all the data",
        default=[],
    )
    forecasters: Annotated[BlockForecasters, KINDS]


class Steps(Section):
    """Steps of the time series of a case."""

    time_step: Positive = setting("time step of the Runge-Kutta scheme", TIME)
    sampling_stride: Count = setting("integration steps in one step of a forecast")

    @property
    def sampling_interval(self) -> float:
        """Time between two steps of a forecast, in time units."""
        return self.time_step * self.sampling_stride


class Ensemble(Steps):
    """The time series that all data come from."""

    series: Whole = setting("number of series that are generated", ge=2, le=1_000_000)
    initial_state: Annotated[
        list[float] | None, Words("a list of numbers, or null: the system draws initial states")
    ] = setting("initial state that all series share, one number per component")
    perturbed_component: CountOrNull = setting(
        "perturbed component of the initial state, counted from 1"
    )
    perturbation: PositiveOrNull = setting(
        "largest perturbation; each series draws its own from [0, perturbation]",
        "units of the component",
    )
    transient: Positive = setting(
        "beginning of each series that is dropped", TIME, multiple_of="ensemble.time_step"
    )
    duration: Positive = setting(
        "part of each series that is kept",
        TIME,
        multiple_of="ensemble.time_step * ensemble.sampling_stride",
    )


class TimeUnit(Section):
    """The Lyapunov exponents."""

    time_unit: Literal["published", "computed"] = setting(
        "the exponent that sets the Lyapunov time"
    )
    published_exponent: float | None = optional(
        "published leading exponent; null if there is none", "inverse time units", gt=0
    )
    orthonormalisation_interval: Positive = setting(
        "time between two QR factorisations", TIME, multiple_of="ensemble.time_step"
    )

    @property
    def known_exponent(self) -> float | None:
        """Exponent that the unit of time follows from; None where it is computed."""
        return durations.known_exponent(self.time_unit, self.published_exponent)


class Lyapunov(TimeUnit):
    """The Lyapunov exponents."""

    series: Whole = setting(
        "trajectories that the exponents are averaged over", ge=2, at_most="ensemble.series"
    )
    perturbation: Positive = setting(
        "initial distance of neighbouring trajectories",
        "attractor sizes",
        le=1,
        below="lyapunov.saturation",
    )
    saturation: Positive = setting(
        "distance of neighbouring trajectories at which growth is no longer linear",
        "attractor sizes",
        le=1,
    )


class TrainingActuation(Section):
    """An actuator that switches on and off at random during training series; null for none."""

    interval_lt: Positive = setting("interval between two possible switchings")
    mean_on_lt: Positive = setting(
        "mean time that it stays on", at_least="training.actuation.interval_lt"
    )
    mean_off_lt: Positive = setting(
        "mean time that it stays off", at_least="training.actuation.interval_lt"
    )
    strength: Positive = setting("share of the case's actuation", "actuations", default=1)
    tested: bool = setting(
        "whether the case's test series are such series, too; forecasters that know the parameters "
        "are given the actuation",
        default=False,
    )


class Training(Section):
    """Training data."""

    series: Count = setting("number of series that forecasters are trained on")
    noise: float = setting(
        "standard deviation of the observation noise", "standard deviations of each component", ge=0
    )
    trained_on: Distinct[CaseName] = setting(
        "cases whose training series the kinds that know the parameters are trained on; the case "
        "itself if empty",
        default=[],
    )
    actuation: TrainingActuation | None = optional(
        "actuation of the series that this case gives to the kinds that know the parameters; null: "
        "its training series, which are free"
    )


class Density(Section):
    """Bins of the observable's probability density."""

    bins: Whole = setting("number of bins", ge=2)
    range: Range = setting("lower and upper end of the bins", OBSERVABLE)


class MeasuredDensity(Density):
    """Bins of the observable's probability density."""

    range: Range | None = optional(  # type: ignore[assignment]
        "lower and upper end of the bins; null: the smallest and the largest value of the data",
        OBSERVABLE,
    )


class FixedPoint(Section):
    """When a long forecast has settled on a fixed point."""

    variation: float = setting("smallest variation of the observable in motion", OBSERVABLE, ge=0)
    above: float = setting("observable above which a settled forecast is discarded", OBSERVABLE)


class Actuation(Section):
    """Actuation after an alarm; null where the case is not controlled."""

    parameters: dict[ParameterName, float] = setting(
        "parameters of the equations during an actuation", default={}
    )
    force: Annotated[list[float] | None, Words("a list of numbers, or null")] = optional(
        "constant force on each component of the state; null for none"
    )
    start_lt: float = setting("start of the actuation, from the start of the alarm's window")
    duration_lt: Positive = setting("duration of the actuation")


class RecycleValidation(Section):
    """Validation intervals of Recycle Validation."""

    series: Count = setting("training series with validation intervals", at_most="training.series")
    intervals_per_series: CountOrNull = setting(
        "validation intervals in each, end to end after the washout; null: as many as fit"
    )


class Blocks(Section):
    """Lengths by which measured records are cut into series."""

    duration: Positive = setting("length of each block; the remainder is dropped", TIME)
    gap: float = setting("from the end of a block to the start of the next", TIME, ge=0, default=0)


class Data(Section):
    """Measured series instead of equations; null: the series are simulated."""

    files: Distinct[str] = setting(
        "files of series, or patterns (lab/run_*.csv), seen from where Snakemake runs: CSV or "
        "Parquet with a header and a column time, NetCDF or NumPy arrays of series, time and "
        "component",
        default=[],
    )
    case: CaseName | None = optional(
        "another case of the campaign, a part of whose state is observed"
    )
    components: Distinct[str] = setting(
        "what forecasters see: columns, expressions of columns, or <name> = <one of these>; all "
        "columns if left out",
        default=[],
    )
    known: Distinct[str] = setting(
        "what is known in advance, and given to forecasters that can use it over their forecasts: "
        "columns, expressions of columns, or <name> = <one of these>",
        default=[],
    )
    delays: Distinct[Count] = setting(
        "past values of all components that forecasters see beside the present ones: steps of a "
        "forecast back; each series begins so much later",
        default=[],
    )
    observable: str = setting(
        "a component, an expression of components or columns, or <name> = <one of these>"
    )
    time_step: TimeStep = optional("time between two rows, which are the steps of a forecast", TIME)
    gaps: Annotated[Literal["cut"] | None, Words("cut, or null")] = optional(
        "cut: gaps cut a record, and parts shorter than a block are left out; null: gaps are errors"
    )
    blocks: Blocks | None = optional("how series are cut; null: not at all")


class DataOfCase(Data):
    """Measured series, with the components of the state that another case has."""

    columns: Distinct[str] = setting("components of the state of another case", default=[])


class Sensors(Section):
    """What is observed in place of the whole state; equations with a filter estimate the rest."""

    points: Annotated[list[Annotated[Count, Field(le=20)]], Field(min_length=2, max_length=2)] = (
        setting("number of probes of the velocity along x and y", default=[8, 8])
    )
    components: list[str] | None = optional("components that are observed, in place of probes")


class CaseEncoder(Section):
    """Encoding of the observations in the channels that forecasters receive."""

    kind: EncoderName = setting("a module of burstcast.encoders")
    modes: CountOrNull = optional("number of modes, of the kind pod")


class Case(Section):
    """A dynamical system with its dataset: defaults of every case."""

    system: str
    parameters: dict[str, Any] = setting("parameters of the equations", default={})
    event_threshold: Threshold = setting(
        "value of the observable that an extreme event reaches, k_e, or the share of its values in "
        "the training series that are below it",
        OBSERVABLE,
        below="laminarisation_threshold",
    )
    laminarisation_threshold: float | None = optional(
        "value of the observable beyond which a series is discarded, k_l; null keeps all",
        OBSERVABLE,
    )
    ensemble: Steps
    lyapunov: TimeUnit
    training: Training
    density: Density
    fixed_point: FixedPoint
    actuation: Actuation | None = optional("")
    test_series: Count = setting(
        "number of test series; if left out, all measured series after the training series"
    )
    recycle_validation: RecycleValidation
    data: Data | None = optional(
        "measured series instead of equations; null: the series are simulated"
    )
    sensors: Sensors | None = optional(
        "probes that see the state of another case (data.case); null: all of it is observed"
    )
    encoder: CaseEncoder | None = optional(
        "encoder of what is observed of another case (data.case), an estimate of its state where "
        "sensors see it; null: forecasters receive what is observed"
    )

    @property
    def steps_per_lyapunov_time(self) -> int | None:
        """Steps of a forecast in a Lyapunov time; None where the config does not know it."""
        exponent = self.lyapunov.known_exponent
        if exponent is None:
            return None
        return durations.steps_per_lyapunov_time(exponent, self.ensemble.sampling_interval)


class Simulated(Case):
    """A dynamical system with its dataset: defaults of every case."""

    system: SystemName = setting(
        "the equations: a module of burstcast.systems, or module:Class of your own, in the working "
        "directory, beside a config, or installed"
    )
    files: Annotated[Distinct[str] | None, Words("a list, each text, or null")] = optional(
        "files that a module of your own reads, from the directory of the module; [] if none"
    )
    parameters: dict[ParameterName, float] = setting("parameters of the equations", default={})
    ensemble: Ensemble
    lyapunov: Lyapunov
    controlled_density: Density = setting("bins of the observable's density under control")


class MeasuredSteps(Steps):
    """Steps of measured series."""

    duration: Positive | None = optional("of each series, where it is known", TIME)


class Measured(Case):
    """A case of measured series, or of a part of another case's state."""

    system: Literal["measured"]
    ensemble: MeasuredSteps
    density: MeasuredDensity
    fixed_point: FixedPoint | None = None  # type: ignore[assignment]
    test_series: CountOrNull = None  # type: ignore[assignment]
    actuation: None = None
    data: DataOfCase


# an entry of `cases`: what differs from case_defaults, or from what a class says
if TYPE_CHECKING:
    CasePart = Simulated
else:
    CasePart = part_of(Simulated)


@with_defaults(DEFAULTS["esn"])
class EchoStateNetwork(Section):
    """Echo state networks."""

    connectivity: Positive = setting("mean number of connections of a neuron")
    input_bias: float = setting("constant that is appended to the normalised inputs, b_in")
    input_range: Literal["all", "first"] = setting(
        "training series whose range the inputs are divided by: all, or the first one, as in the "
        "programs of the paper's authors"
    )
    divergence_bound: float = setting(
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


# what differs from forecasters.esn
if TYPE_CHECKING:
    Variant = EchoStateNetwork
else:
    Variant = part_of(EchoStateNetwork)


@with_defaults(DEFAULTS["observation"])
class Observation(Section):
    """Knowledge of learnt equations and filters about the observations."""

    noise: float | None = setting(
        "standard deviation of the noise; null: estimated from the training series",
        "standard deviations of each component",
        ge=0,
    )


@with_defaults(DEFAULTS["filter"])
class Filter(Section):
    """The filter of `equations_filtered` and `quadratic_filtered`."""

    members: Annotated[Whole, Field(multiple_of=2), Words("an even number above 0")] = setting(
        "size of the ensemble: at least twice the components of a wholly observed state", ge=2
    )
    inflation: float = setting("factor of the ensemble's scatter before each observation", ge=1)


@with_defaults(DEFAULTS["quadratic"])
class Quadratic(Section):
    """Learnt equations, of `quadratic` and `quadratic_filtered`."""

    degree: Whole = setting("highest degree of the polynomials", ge=1, le=3)
    window_lt: Positive = setting("time that the equations are integrated over, to learn them")


@with_defaults(DEFAULTS["analogues"])
class AnalogueForecasters(Section):
    """Analogues."""

    neighbours: Count = setting("number of analogues, whose mean is the forecast")


@with_defaults(DEFAULTS["classifiers"])
class Classifiers(Section):
    """Training of `precursor` and `esn_direct`, which give probabilities without a trajectory."""

    start_spacing_lt: Positive = setting("distance of the starting points that are learnt from")
    folds: Whole = setting(
        "parts of the training series, each forecast by what has learnt from the others, to "
        "calibrate the probabilities",
        ge=2,
    )


@with_defaults(DEFAULTS["precursor"])
class Precursor(Section):
    """Learnt precursors, `precursor`."""

    classifier: Literal["boosting", "logistic"] = setting(
        "gradient boosting of trees, or logistic regression of features and their products"
    )
    lags_lt: Distinct[Positive] = setting(
        "past values that are features beside the present ones, within the washout"
    )


@with_defaults(DEFAULTS["esn_direct"])
class DirectReadout(Section):
    """Reservoirs that are read out for the event, `esn_direct`; `esn` has all other settings."""

    neurons: Size = setting("size of the reservoir")
    spectral_radius: Some[Positive] = setting("spectral radius; several: chosen in training")
    input_scaling: Some[Positive] = setting("input scaling; several: chosen in training")
    penalty: Some[Positive] = setting(
        "strength of the penalty on squared weights of neurons of unit variance; several: chosen "
        "in training"
    )


@with_defaults(DEFAULTS["aware"])
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
        "networks that differ from `forecasters.esn`, by a name: the settings that differ",
        default={},
    )
    observation: Observation = setting("", default_factory=Observation)
    filter: Filter = setting("", default_factory=Filter)
    quadratic: Quadratic = setting("", default_factory=Quadratic)
    analogues: AnalogueForecasters = setting("", default_factory=AnalogueForecasters)
    classifiers: Classifiers = setting("", default_factory=Classifiers)
    precursor: Precursor = setting("", default_factory=Precursor)
    esn_direct: DirectReadout = setting("", default_factory=DirectReadout)
    aware: Aware = setting("", default_factory=Aware)


@with_defaults(canonical(vars(SurrogateSettings())))
class Surrogate(Section):
    """Gaussian process of the Bayesian optimisation."""

    variance: PositiveRange = setting("bounds of its variance", "variances of the objectives")
    length_scale: PositiveRange = setting("bounds of its length scales", "decades")
    first_length_scale: Positive = setting(
        "length scale that its fit starts from", "decades", within="search.surrogate.length_scale"
    )
    random_state: Annotated[
        Annotated[Whole, Field(ge=0)] | None, Words("a whole number from 0, or null")
    ] = setting("seed of the optimiser of every network; null: each network has its own")


class Search(Section):
    """Search of the hyperparameters."""

    spectral_radius: PositiveRange = setting("range of the spectral radius, on a logarithmic scale")
    input_scaling: PositiveRange = setting("range of the input scaling, on a logarithmic scale")
    # from the largest, as in the paper
    tikhonov: SomeFalling[Positive] = setting("Tikhonov parameters, the best of which is taken")
    grid: Whole = setting("grid points per direction, corners included", ge=2, le=100)
    bayesian_points: Whole = setting(
        "points of Bayesian optimisation after the grid", ge=0, le=1000
    )
    interval_lt: Positive = setting("length of a validation interval")
    single_shot_lead_steps: Whole = setting(
        "how far before the end of the training data the validation interval of Single Shot "
        "Validation starts; 1 in the programs of the paper's authors",
        "steps of a forecast",
        ge=0,
        default=0,
    )
    surrogate: Surrogate = setting("", default_factory=Surrogate)
    choice: Literal["best", "survival"] = setting(
        "choice of the point: the best objective; or, within one paired standard error of it, the "
        "point whose long runs leave the chaotic phase as often as the series generated for the "
        "training"
    )


class Classification(Section):
    """Precision and recall of the prediction of extreme events."""

    start_spacing_lt: Positive = setting("distance of two starting points")
    window_lt: Positive = setting("window that has an event or has none", multiple_of=RESOLUTION)
    resolution_lt: Positive = setting("forecasts are reduced to windows of this length")
    longest_prediction_time_lt: Positive = setting(
        "longest time from the start of a forecast to its window", multiple_of=RESOLUTION
    )
    prediction_times_lt: SomeRising[Positive] = setting(
        "times from a starting point to the window",
        multiple_of=RESOLUTION,
        not_beyond="classification.longest_prediction_time_lt",
    )


class Horizon(Section):
    """Prediction horizon of extreme events."""

    events: Count = setting("number of events")
    longest_lead_time_lt: Positive = setting("first start of a forecast before the event, tau_e")
    lead_time_step_lt: Positive = setting(
        "step by which tau_e falls", at_most="horizon.longest_lead_time_lt"
    )
    tolerance: Positive = setting(
        "error of a forecast that counts as lost",
        "distances of the event threshold from the observable's mean",
    )


class Statistics(Section):
    """Long-term statistics of the flow that forecasters make by themselves."""

    forecasters: Annotated[Choice, KINDS] = setting("forecasters that are run freely")
    starting_points: Count = setting("long runs of each forecaster, started in the training series")
    start_spacing_lt: Positive = setting("time between two starting points")
    duration: PositiveOrNull = setting(
        "length of each long run; null: the length of the case's series, ensemble.duration", TIME
    )
    fixed_point_interval_lt: Positive = setting("end of a long run, which shows whether it settled")
    lyapunov_exponents: Whole = setting(
        "leading Lyapunov exponents of each forecaster's own flow; 0 for none", ge=0
    )
    lyapunov_runs: Count = setting("long runs that those exponents are averaged over")
    profile_points: Whole = setting("heights of the velocity profiles, from wall to wall", ge=3)
    floor_splits: Count = setting("random halves of the data that are compared with one another")


class Sweep(Section):
    """Reduction against the prediction time, beyond the paper."""

    cases: Distinct[CaseName] = setting("cases that the sweep is made for; none switches it off")
    prediction_times_lt: Distinct[Positive] = setting("prediction times")
    seeds: Count = setting("networks of the first seeds")


class StrategyBlock(Section):
    """Control beyond the paper's: forecasters x settings of one strategy x conditions."""

    strategy: ControlStrategyName = setting(
        "the strategy, a module of burstcast.control.strategies"
    )
    settings: dict[ParameterName, Some[StrategyValue]] = setting(
        "its settings, several values each; names in _lt are in Lyapunov times", default={}
    )
    cases: Distinct[CaseName] = setting(
        "cases that are controlled so; all if left out or empty", default=[]
    )
    forecasters: Annotated[Choice | None, KINDS] = optional(
        "forecasters that control so; none for a strategy that asks none"
    )
    seeds: CountOrNull = optional("networks of the first seeds; null for all")
    committee: bool = setting(
        "whether all networks of a size and validation strategy, or all members of a forecaster's "
        "ensemble, control as one: by the share of them that votes for an alarm, vote_share",
        default=False,
    )
    starts: Literal["quiet", "unselected"] = setting(
        "whether flows with an event before their steps count are left out, or none is",
        default="quiet",
    )
    quiet_lt: float = setting("the least time before the steps of a flow count", ge=0, default=0)
    span_lt: PositiveOrNull = optional("time for which each flow counts; null for control.span_lt")
    delay_lt: Some[Annotated[float, Field(ge=0)]] = setting(
        "from a decision to its effect", default=[0]
    )
    strength: Some[Positive] = setting(
        "of the actuator: the share of the case's actuation, changes and force, that it has",
        "actuations",
        default=[1],
    )
    noise: Distinct[Annotated[float, Field(ge=0)]] = setting(
        "observation noise; if left out or empty, the noise of the training series",
        "standard deviations of each component",
        default=[],
    )
    observed: Distinct[CaseName] = setting(
        "cases of parts of the controlled case's state, or of its sensors and encoders "
        "(`data.case`), which rules observe, and whose forecasters control",
        default=[],
    )

    @property
    def kinds(self) -> dict[str, Any]:
        """Axes of its forecasters by kind; empty for a strategy that asks none."""
        return self.forecasters.kinds if self.forecasters else {}


class Control(Section):
    """Prediction-triggered control, and strategies beyond the paper's."""

    forecasters: Annotated[Choice, KINDS] = setting("forecasters that control")
    prediction_times_lt: Rising[Positive] = setting("prediction times")
    window_lt: Positive = setting("length of the window that a forecast is judged in")
    flows: Count = setting("series that each forecaster controls, taken after the training series")
    span_lt: Positive = setting("time for which each flow counts")
    random_alarms: bool = setting(
        "whether alarms at random, as often as each network's own, are compared with it"
    )
    sweep: Sweep
    cost: bool = setting(
        "whether the effort and the power of the actuation are recorded", default=False
    )
    tolerated_exceedance: Annotated[float, Field(ge=0, lt=1)] | None = optional(
        "share of the uncontrolled exceedance that may be left when settings of strategies are "
        "chosen on half of the flows and scored on the others; null: nothing is chosen"
    )
    strategies: list[StrategyBlock] = setting(
        "control beyond the paper's: the union of these blocks"
    )


class Probability(Section):
    """Probabilities of events, and the alarms that they raise."""

    start_spacing_lt: Positive = setting(
        "distance of the starting points that probabilities are calibrated on"
    )
    calibration_series: Whole = setting(
        "number of further series for calibration; 0: calibration on the training series, each "
        "forecast by a forecaster that was refitted without it",
        ge=0,
    )
    prior_forecasts: float = setting(
        "weight of the prior at each share of votes, as a number of forecasts; 0: none", ge=0
    )
    bins: Whole = setting("equally wide bins of the probability", ge=2, le=1000)


class Bootstrap(Section):
    """Confidence intervals of scores, resampled over test series."""

    resamples: Whole = setting("number of resamples", ge=10, le=1_000_000)
    confidence: Positive = setting("probability that an interval covers", lt=1)


class FlowEvent(Section):
    """The event of the test set whose flow is shown."""

    peak: float = setting("wanted peak of the observable", OBSERVABLE)
    quiet_lt: float = setting("time without another event before the event and after it", ge=0)
    tolerance: Positive = setting(
        "largest distance of the forecast from the true state through the event",
        "largest distance of a state from zero in the training series",
    )


class Figures(Section):
    """Content of the figures."""

    published_overlay: bool = setting("draw the paper's published values on ours")
    example_case: CaseName | None = setting(
        "case of the network whose forecasts are shown as examples; null: the first that has "
        "networks of the fixed size"
    )
    example_forecaster: NetworkOrNull = setting(
        "network whose forecasts are shown as examples; null: of the fixed size, of Recycle "
        "Validation if there is any, seed 0"
    )
    example_horizon_lt: Positive = setting("horizon of the example event; the nearest one is shown")
    fixed_neurons: Size | None = setting(
        "size of the reservoir where panels hold it fixed; null: the size that most cases have, "
        "the largest of those",
        one_of=SIZES,
    )
    flow_event: FlowEvent
    flow_points: list[Annotated[Whole, Field(ge=5, le=1000)]] = setting(
        "points of the grid on which flow fields are drawn, along x, y and z",
        min_length=3,
        max_length=3,
    )


class Configuration(Section):
    """Configuration of a campaign."""

    results: Directory = setting("directory of everything that the workflow writes")
    # the files of the networks hold it, as an unsigned number of 64 bits
    random_seed: Whole = setting("the one root of all random numbers", ge=0, lt=2**64)
    campaign: list[Block] = setting("cases x forecasters: the union of these blocks", min_length=1)
    case_defaults: Simulated
    cases: dict[CaseName, CasePart] = setting("what differs from case_defaults, by case")
    washout_lt: Positive = setting(
        "observed stretch that a forecaster is given before it starts; training leaves it out"
    )
    forecasters: Forecasters = setting("", default_factory=Forecasters)
    search: Search
    classification: Classification
    horizon: Horizon
    statistics: Statistics
    control: Control
    probability: Probability
    bootstrap: Bootstrap
    figures: Figures

    def dump(self) -> dict[str, Any]:
        """All settings with their defaults, in canonical form; entries of ``cases`` as said."""
        plain = self.model_dump(exclude={"cases": True, "forecasters": {"variants"}})
        variants = self.forecasters.variants.items()
        plain["forecasters"]["variants"] = {name: one.dump() for name, one in variants}
        plain["cases"] = {name: entry.dump() for name, entry in self.cases.items()}
        whole: dict[str, Any] = canonical(plain)
        return whole
