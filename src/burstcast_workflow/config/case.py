"""Settings of a case, and what a case is: where its series come from, and what is known of them.

A case is simulated, measured in files, a part of another case's state, or encoded from it. Each of
these has a class, and all answer the same questions (`Case`).
"""

import glob
import math
import os
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, ValidationError
from pydantic_core import PydanticCustomError

from burstcast.base import durations
from burstcast.base.natural_order import natural_order
from burstcast.control.actuation import actuated_system
from burstcast.data.encoders.channels import IDENTITY
from burstcast.data.encoders.registry import encoder_class, encoder_module
from burstcast.data.measured_data import Quantity
from burstcast.data.training_realisations import realisation_of
from burstcast.systems.mfe_modes import flow_modes
from burstcast.systems.parameters import SHARE, SystemParameters
from burstcast.systems.registry import make_space, make_system, system_module
from burstcast.systems.state_space import StateSpace
from burstcast_workflow.config.kinds import (
    CaseName,
    Count,
    Distinct,
    EncoderName,
    Number,
    ParameterName,
    Positive,
    Range,
    Section,
    SystemName,
    Threshold,
    TimeStep,
    Whole,
    optional,
    setting,
)
from burstcast_workflow.harness.canonical import canonical

TIME = "time units"
OBSERVABLE = "units of the observable"


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
    initial_state: list[Number] | None = setting(
        "initial state that all series share, one number per component; null: the system draws "
        "initial states"
    )
    perturbed_component: Count | None = setting(
        "perturbed component of the initial state, counted from 1"
    )
    perturbation: Positive | None = setting(
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

    time_unit: Literal["given", "computed"] = setting("the exponent that sets the Lyapunov time")
    given_exponent: Number | None = optional(
        "leading exponent, if it is known: published, or from elsewhere", "inverse time units", gt=0
    )
    orthonormalisation_interval: Positive = setting(
        "time between two QR factorisations", TIME, multiple_of="ensemble.time_step"
    )

    @property
    def known_exponent(self) -> float | None:
        """Exponent that the unit of time follows from; None where it is computed."""
        return durations.known_exponent(self.time_unit, self.given_exponent)


class Lyapunov(TimeUnit):
    """The Lyapunov exponents."""

    series: Whole = setting(
        "trajectories that the exponents are averaged over", ge=2, at_most="ensemble.series"
    )
    exponents: Whole = setting("the leading ones; all where there are fewer", ge=1)
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
    noise: Number = setting(
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

    variation: Number = setting("smallest variation of the observable in motion", OBSERVABLE, ge=0)
    above: Number = setting("observable above which a settled forecast is discarded", OBSERVABLE)


class Actuation(Section):
    """Actuation after an alarm; null where the case is not controlled."""

    parameters: dict[ParameterName, Number] = setting(
        "parameters of the equations during an actuation", default={}
    )
    force: list[Number] | None = optional(
        "constant force on each component of the state; null for none"
    )
    start_lt: Number = setting("start of the actuation, from the start of the alarm's window")
    duration_lt: Positive = setting("duration of the actuation")


class RecycleValidation(Section):
    """Validation intervals of Recycle Validation."""

    series: Count = setting("training series with validation intervals", at_most="training.series")
    intervals_per_series: Count | None = setting(
        "validation intervals in each, end to end after the washout; null: as many as fit"
    )


class Blocks(Section):
    """Lengths by which measured records are cut into series."""

    duration: Positive | None = optional(
        "length of each block; null: each record, or part of one between gaps, is a series", TIME
    )
    gap: Number = setting("from the end of a block to the start of the next", TIME, ge=0, default=0)
    shortest: Positive | None = optional(
        "length of the shortest series: what is left of a record beside its blocks is a series "
        "from this length on; null: all series are as long as a block",
        TIME,
    )


class Data(Section):
    """Measured series instead of equations; null: the series are simulated."""

    files: Distinct[str] = setting(
        "files of series, or patterns (lab/run_*.csv), seen from where Snakemake runs: tables with "
        "a header and a column time (CSV, Parquet), or arrays of series, time and component "
        "(NetCDF, Zarr, HDF5)",
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
    observable: str | None = optional(
        "a component, an expression of components or columns, or <name> = <one of these>"
    )
    time_step: TimeStep = optional("time between two rows, which are the steps of a forecast", TIME)
    gaps: Literal["cut"] | None = optional(
        "cut: gaps cut a record, and parts that are too short for a series (blocks) are left out; "
        "null: gaps are errors"
    )
    blocks: Blocks | None = optional("how series are cut; null: not at all")

    @property
    def paths(self) -> list[str]:
        """Files of the series, in their order: files of a pattern as people sort names."""
        paths: list[str] = []
        for name in self.files:
            is_pattern = glob.has_magic(name) and not os.path.exists(name)
            matches = sorted(glob.glob(name, recursive=True), key=natural_order)
            if is_pattern and not matches:
                raise ValueError(f"data.files: no file is called {name}, seen from {os.getcwd()}")
            if "://" in name:
                raise ValueError(
                    f"data.files: {name} is an address, not a file: download it, and give its path"
                )
            paths += map(os.path.relpath, matches if is_pattern else [name])
        return list(dict.fromkeys(paths))


class DataOfCase(Data):
    """Measured series, with the components of the state that another case has."""

    columns: Distinct[str] = setting("components of the state of another case", default=[])
    observable: str


class Sensors(Section):
    """What is observed in place of the whole state; equations with a filter estimate the rest."""

    points: Annotated[list[Annotated[Count, Field(le=20)]], Field(min_length=2, max_length=2)] = (
        setting("number of probes of the velocity along x and y", default=[8, 8])
    )
    components: list[str] | None = optional("components that are observed, in place of probes")


class CaseEncoder(Section):
    """Encoding of the observations in the channels that forecasters receive."""

    kind: EncoderName = setting("a module of burstcast.data.encoders, or module:Class of your own")
    modes: Count | None = optional("number of modes, of the kind pod")


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
    laminarisation_threshold: Number | None = optional(
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

    files: Distinct[str] | None = optional(
        "files that a module of your own reads, from the directory of the module; [] if none"
    )

    has_equations: ClassVar[bool] = False
    _name: str = ""
    _source: "Case | None" = None

    def in_campaign(self, name: str, source: "Case | None") -> None:
        """Take the name that a campaign has for the case, and the case that it is a part of."""
        self._name, self._source = name, source

    @property
    def name(self) -> str:
        """Name of the case."""
        return self._name

    @property
    def source(self) -> "Case":
        """Case whose series and Lyapunov exponents it has: itself, or what it is a part of."""
        return self._source or self

    @property
    def source_system(self) -> dict[str, Any]:
        """Name, system and parameters of the source."""
        source = self.source
        return {"name": source.name, "system": source.system, "parameters": source.parameters}

    @property
    def realisation(self) -> int:
        """Number of its choice of training series; 0: the first ones."""
        return realisation_of(self._name)[1]

    @property
    def is_encoded(self) -> bool:
        """Whether forecasters receive readings of sensors, or what an encoder makes."""
        return not self.has_equations and (self.sensors or self.encoder) is not None

    @property
    def own_module(self) -> str | None:
        """Module of a system or an encoder of the user's own."""
        if ":" in self.kind_of_encoder:
            return encoder_module(self.kind_of_encoder)
        return system_module(self.system) if ":" in self.system else None

    @property
    def takes_series(self) -> bool:
        """Whether it has the series of another case: encoded, or other ones to train on."""
        return bool(self.is_encoded or self.realisation)

    @property
    def is_switched(self) -> bool:
        """Whether its test series are under an actuator that switches at random."""
        return self.training.actuation is not None and self.training.actuation.tested

    @property
    def space(self) -> StateSpace:
        """State space; a ValueError or TypeError if the system or its parameters are invalid."""
        return make_space(self.system, self.parameters)

    @property
    def is_flow(self) -> bool:
        """Whether the state is the amplitudes of velocity modes."""
        return self.has_equations and flow_modes(self.space) is not None

    @property
    def steps_per_lyapunov_time(self) -> int | None:
        """Steps of a forecast in a Lyapunov time; None where the config does not know it."""
        exponent = self.lyapunov.known_exponent
        if exponent is None:
            return None
        return durations.steps_per_lyapunov_time(exponent, self.ensemble.sampling_interval)

    @property
    def samples(self) -> int | None:
        """Samples of a series, with both of its ends; None where the config does not know them."""
        duration: float | None = getattr(self.ensemble, "duration", None)
        interval = self.ensemble.sampling_interval
        return None if duration is None else math.floor(duration / interval + 1e-9) + 1

    @property
    def has_known_lengths(self) -> bool:
        """Whether the config knows how long a Lyapunov time and a series are."""
        shorter = self.data and self.data.blocks and self.data.blocks.shortest
        return None not in (self.steps_per_lyapunov_time, self.samples) and not shorter

    @property
    def computed_exponents(self) -> str | list[str]:
        """File of the computed Lyapunov exponents, where they set the unit of time."""
        is_computed = self.steps_per_lyapunov_time is None
        return f"{self.source.name}/lyapunov.json" if is_computed else []

    @property
    def estimates_time_unit(self) -> bool:
        """Whether a Lyapunov time is known only from how neighbouring states of the series part."""
        return self.steps_per_lyapunov_time is None and not self.source.has_equations

    @property
    def imported_noise(self) -> float:
        """Level of the noise that series get when they are imported; 0 if later, or none.

        Past values among the components have the noise of their own time, which must be there
        before they are taken.
        """
        early = self.is_encoded or (self.data and self.data.delays)
        return self.training.noise if early else 0.0

    @property
    def known_columns(self) -> list[str]:
        """Names of the columns that are known in advance."""
        return [Quantity(text).name for text in self.data.known] if self.data else []

    @property
    def kind_of_encoder(self) -> str:
        """Kind of the encoder; forecasters receive the observations themselves without one."""
        return self.encoder.kind if self.encoder else IDENTITY

    @property
    def undecoded(self) -> str | None:
        """Encoder from whose channels no state follows; None where states follow."""
        kind = self.kind_of_encoder
        return None if encoder_class(kind).decodes else kind

    @property
    def sensor(self) -> dict[str, Any]:
        """Observations of the source, for forecasters that control it by this part of it."""
        plain = self.of_jobs()
        if self.is_encoded:
            return {name: plain[name] for name in ("parameters", "sensors", "encoder")}
        components, observable = plain["data"]["components"], plain["parameters"]["observable_of"]
        return {"components": components, "of": observable}

    def values_of(self, names: Sequence[str], share: float = 0.0) -> list[float]:
        """Values of parameters in force at a share of the actuation; none of records."""
        return []

    def of_jobs(self) -> dict[str, Any]:
        """Settings as jobs are given them."""
        plain = self.dump()
        if self.imported_noise:
            plain["training"]["noise"] = 0  # what is imported has it already
        return plain


class Simulated(Case):
    """A dynamical system with its dataset: defaults of every case."""

    system: SystemName = setting(
        "the equations: a module of burstcast.systems, or module:Class of your own, in the working "
        "directory, beside a config, or installed"
    )
    parameters: dict[ParameterName, Number] = setting("parameters of the equations", default={})
    ensemble: Ensemble
    lyapunov: Lyapunov
    controlled_density: Density = setting("bins of the observable's density under control")
    has_equations: ClassVar[bool] = True

    def values_of(self, names: Sequence[str], share: float = 0.0) -> list[float]:
        """Values of parameters of the equations, or the share itself."""
        if list(names) == [SHARE]:
            return [share]
        system = make_system(self.system, self.parameters)
        if share:
            if self.actuation is None:
                raise ValueError("training.actuation needs a case with an actuation")
            system = actuated_system(system, self.actuation.parameters, None, share)
        return [*SystemParameters.of(system, names).defaults]


class MeasuredSteps(Steps):
    """Steps of measured series."""

    duration: Positive | None = optional("of each series, where it is known", TIME)


class Measured(Case):
    """A case of measured series: in files, or of what is seen of another case's state."""

    system: Literal["measured"]
    ensemble: MeasuredSteps
    density: MeasuredDensity
    fixed_point: FixedPoint | None = None  # type: ignore[assignment]
    test_series: Count | None = None  # type: ignore[assignment]
    actuation: None = None
    data: DataOfCase


WHOLE = ("data", "sensors", "encoder")
"""Sections of a case that nothing is laid over: an entry of `cases` has them with all settings."""


def _entry(settings: dict[Any, Any]) -> dict[str, Any]:
    """Check an entry of `cases` as a case, of which all but some sections may be incomplete."""
    try:
        Simulated.model_validate(settings)
    except ValidationError as error:
        mistakes: list[Any] = [
            {**mistake, "type": PydanticCustomError(mistake["type"], mistake["msg"])}
            for mistake in error.errors(include_url=False)
            if mistake["type"] != "missing" or mistake["loc"][0] in WHOLE
        ]
        if mistakes:
            raise ValidationError.from_exception_data("case", mistakes) from None
    return canonical(settings)  # type: ignore[no-any-return]


CaseEntry = Annotated[dict[Any, Any], AfterValidator(_entry)]
"""An entry of `cases`: the settings that differ from case_defaults, or from those of a class."""
