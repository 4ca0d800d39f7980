"""The model of the configuration: every setting with its type, bounds, unit and meaning.

docs/settings.md and the schema for editors are made from it. A bound may be another setting;
`burstcast_workflow.config.checks` has what else must hold between settings.
"""

from typing import Annotated, Any, Literal

from pydantic import Field

from burstcast.data.training_realisations import realisation_of
from burstcast.networks.hyperparameters import SurrogateSettings
from burstcast_workflow.config.case import OBSERVABLE, TIME, CaseEntry, Data, Simulated
from burstcast_workflow.config.forecasters import SIZES, BlockForecasters, Choice, Forecasters
from burstcast_workflow.config.kinds import (
    CaseName,
    ControlStrategyName,
    Count,
    Directory,
    Distinct,
    EventShare,
    NetworkOrNull,
    Number,
    ParameterName,
    Positive,
    PositiveRange,
    Rising,
    Section,
    Size,
    Some,
    SomeFalling,
    SomeRising,
    StrategyValue,
    Whole,
    optional,
    setting,
    with_defaults,
)
from burstcast_workflow.harness.canonical import canonical

RESOLUTION = "classification.resolution_lt"


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
        le=10_000,
    )
    event_shares: Distinct[EventShare] = setting(
        "instead of realisations: choices `<case>-training<k>` whose training series are drawn at "
        "random from all but the test series, with a share of time at or above the event threshold "
        "near the k-th of these; all: the share of all the data",
        default=[],
    )
    forecasters: BlockForecasters

    @property
    def case_names(self) -> list[str]:
        """Names of its cases, each once.

        With ``realisations``, each is followed by those with other training series; with
        ``event_shares``, those stand in its place.
        """
        numbers = range(self.realisations)
        if self.event_shares:
            numbers = range(1, len(self.event_shares) + 1)
        return [
            f"{name}-training{number}" if number else name
            for name in dict.fromkeys([*map(case_name, self.reynolds), *self.cases])
            for number in numbers
        ]


def case_name(reynolds: float) -> str:
    """Name of the shear flow's case at a Reynolds number: Re400, Re412.5."""
    return f"Re{canonical(float(reynolds))}"


@with_defaults(canonical(vars(SurrogateSettings())))
class Surrogate(Section):
    """Gaussian process of the Bayesian optimisation."""

    variance: PositiveRange = setting("bounds of its variance", "variances of the objectives")
    length_scale: PositiveRange = setting("bounds of its length scales", "decades")
    first_length_scale: Positive = setting(
        "length scale that its fit starts from", "decades", within="search.surrogate.length_scale"
    )
    random_state: Whole | None = setting(
        "seed of the optimiser of every network; null: each network has its own", ge=0
    )


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

    @property
    def reach_lt(self) -> float:
        """Time from a starting point to the end of the last window."""
        return self.longest_prediction_time_lt + self.window_lt


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

    forecasters: Choice = setting("forecasters that are run freely")
    starting_points: Count = setting("long runs of each forecaster, started in the training series")
    start_spacing_lt: Positive = setting("time between two starting points")
    duration: Positive | None = setting(
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
    seeds: Count = setting("networks of the first seeds", le=10_000)


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
    forecasters: Choice | None = optional(
        "forecasters that control so; none for a strategy that asks none"
    )
    seeds: Count | None = optional("networks of the first seeds; null for all", le=10_000)
    committee: bool = setting(
        "whether all networks of a size and validation strategy, or all members of a forecaster's "
        "ensemble, control as one: by the share of them that votes for an alarm, vote_share",
        default=False,
    )
    starts: Literal["quiet", "unselected"] = setting(
        "whether flows with an event before their steps count are left out, or none is",
        default="quiet",
    )
    quiet_lt: Number = setting("the least time before the steps of a flow count", ge=0, default=0)
    span_lt: Positive | None = optional("time for which each flow counts; null for control.span_lt")
    delay_lt: Some[Annotated[Number, Field(ge=0)]] = setting(
        "from a decision to its effect", default=[0]
    )
    strength: Some[Positive] = setting(
        "of the actuator: the share of the case's actuation, changes and force, that it has",
        "actuations",
        default=[1],
    )
    noise: Distinct[Annotated[Number, Field(ge=0)]] = setting(
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


class LongRunBlock(StrategyBlock):
    """Long runs of control, for return times of rare events.

    Flows start unselected, settle for ``quiet_lt`` and count for ``span_lt``. They are not compared
    with themselves without control.
    """

    starts: Literal["unselected"] = setting(
        "where the flows start: unselected, of which none is left out", default="unselected"
    )
    quiet_lt: Number = setting("time for which a flow settles before it counts", ge=0, default=20)
    span_lt: Positive = setting("time for which each of the flows counts", default=1000)


class Control(Section):
    """Prediction-triggered control, and strategies beyond the paper's."""

    forecasters: Choice = setting("forecasters that control")
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
    tolerated_exceedance: Annotated[Number, Field(ge=0, lt=1)] | None = optional(
        "share of the uncontrolled exceedance that may be left when settings of strategies are "
        "chosen on half of the flows and scored on the others; null: nothing is chosen"
    )
    strategies: list[StrategyBlock] = setting(
        "control beyond the paper's: the union of these blocks"
    )
    long_runs: list[LongRunBlock] = setting(
        "long runs, whose states are not kept, for return times: the union of these blocks; the "
        "strategy `uncontrolled` is the free flow",
        default=[],
    )
    return_levels: Rising[Number] = setting(
        "levels whose return times are counted in long runs, beside the event threshold",
        OBSERVABLE,
        default=[],
    )

    @property
    def blocks(self) -> list[tuple[str, StrategyBlock]]:
        """All blocks of strategies, with their places in the config."""
        by_name: dict[str, list[Any]] = {"strategies": self.strategies, "long_runs": self.long_runs}
        return [
            (f"control.{name}[{index}]", block)
            for name, blocks in by_name.items()
            for index, block in enumerate(blocks)
        ]


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
    prior_forecasts: Number = setting(
        "weight of the prior at each share of votes, as a number of forecasts; 0: none", ge=0
    )
    bins: Whole = setting("equally wide bins of the probability", ge=2, le=1000)
    consistency: bool = setting(
        "test whether the washouts of the test series are like those of the training series, and "
        "score forecasts after consistent washouts and after the others"
    )


class Bootstrap(Section):
    """Confidence intervals of scores, resampled over test series."""

    resamples: Whole = setting("number of resamples", ge=10, le=1_000_000)
    confidence: Positive = setting("probability that an interval covers", lt=1)


class FlowEvent(Section):
    """The event of the test set whose flow is shown."""

    peak: Number = setting("wanted peak of the observable", OBSERVABLE)
    quiet_lt: Number = setting("time without another event before the event and after it", ge=0)
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
    cache_gb: Number = setting(
        "size of the cache, above which the entries that were unused for longest are removed",
        "GB",
        ge=0,
        default=20.0,
    )
    rerun_libraries: bool = setting(
        "whether another version of a library runs again the jobs that import it", default=False
    )
    # the files of the networks hold it, as an unsigned number of 64 bits
    random_seed: Whole = setting("the one root of all random numbers", ge=0, lt=2**64)
    campaign: list[Block] = setting("cases x forecasters: the union of these blocks", min_length=1)
    case_defaults: Simulated
    cases: dict[CaseName, CaseEntry] = setting("what differs from case_defaults, by case")
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

    @property
    def case_names(self) -> list[str]:
        """Names of the cases that the campaign uses, in the order of their first use."""
        return [*dict.fromkeys(name for block in self.campaign for name in block.case_names)]

    @property
    def simulated_cases(self) -> list[str]:
        """Names of the cases that the campaign uses and that are simulated."""
        return [name for name in self.case_names if self.data_of(name) is None]

    def blocks_of(self, case: str) -> list[Block]:
        """Blocks of the campaign that have a case."""
        return [block for block in self.campaign if case in block.case_names]

    def kinds_of(self, case: str) -> list[str]:
        """Kinds of forecasters that the campaign has of a case."""
        return sorted({kind for block in self.blocks_of(case) for kind in block.forecasters.kinds})

    def entry_of(self, case: str) -> dict[str, Any]:
        """The entry of a case in ``cases``; empty without one."""
        return self.cases.get(realisation_of(case)[0], {})

    def data_of(self, case: str) -> Data | None:
        """Section ``data`` of a case's entry in ``cases``; None without measured series."""
        data = self.entry_of(case).get("data")
        return None if data is None else Data.model_validate(data)

    def event_shares_of(self, case: str) -> list[float | Literal["all"]]:
        """Wanted shares of a case's choices of training series, in the order of their numbers."""
        lists = (block.event_shares for block in self.blocks_of(f"{case}-training1"))
        return max(lists, key=len, default=[])
