r"""Mistakes of a config: each is told with the words behind it, before any job, and alone.

A line of the tables is what is said in the config, then parts of the message. ``plan.`` stands for
``control.strategies.0.``; ``...`` takes a setting away; ``&`` before a line: others may be told.
"""

import copy

import pytest
import yaml
from helpers_configs import MEASURED, NETWORKS, paper_with, put, tiny_campaign

from burstcast_workflow.campaign.loading import ConfigError, load

# -- how the tables are read -----------------------------------------------------------------------

INTERVAL = {"decision_interval_lt": [0.5]}
PLANS = {
    "reactive": {"settings": {"level": [0.05], "decision_interval_lt": [0.25]}},
    "receding_horizon": {
        "settings": {"horizon_lt": [2], "decision_interval_lt": [0.25]},
        "forecasters": {"esn": {}},
    },
    "planned": {
        "settings": {"horizon_lt": [3], **INTERVAL},
        "cases": ["Re400"],
        "forecasters": {"quadratic_aware": {}},
    },
    "probability_triggered": {
        "settings": {"probability": [0.2], **INTERVAL},
        "observed": ["invariants"],
        "forecasters": {"precursor": {}},
    },
}
OVERLAYS = {"measured": MEASURED, "lorenz": {"cases": {"lorenz": {"system": "lorenz63"}}}}
FILES = dict.fromkeys([f"lab/run_{number}.csv" for number in (10, 9, 1)], "time,u,v\n0,1,2")
FILES |= {"README.md": "", "lab/numbers.csv": "1,2\n3,4"}
FILES["flows.py"] = """
import numpy as np

from burstcast.systems.lorenz63 import Lorenz63


class Silent(Lorenz63):
    case_defaults = {"event_threshold": 40, "ensemble": {"time_step": 0.01}}

class Wrong(Lorenz63):
    case_defaults = {"event_treshold": 40, "density": {"range": [5, 1]}}

class OfNumpy(Lorenz63):
    case_defaults = {"event_threshold": np.float64(40)}

class Stepping(Lorenz63):
    def flow_map(self, state, time_step):
        return state
"""


def config_of(table):
    """The config that the lines of a table change."""
    name, _, plan = table.partition(" ")
    if name in ("aware", "encoded", "precursor"):
        config = tiny_campaign(name)
    else:
        config = paper_with(OVERLAYS.get(name, {}))
    if name == "lorenz":
        config["campaign"].append({"cases": ["lorenz"], "forecasters": {"esn": NETWORKS}})
    if plan:
        block = {"strategy": plan, **copy.deepcopy(PLANS[plan])}
        config.setdefault("control", {})["strategies"] = [block]
    return config


def changed(table, line):
    """The config of a table with what a line says."""
    config = config_of(table)
    for name, value in yaml.safe_load(f"{{{line.removeprefix('& ')}}}").items():
        put(config, name.replace("plan.", "control.strategies.0."), value)
    return config


def lines_of(tables):
    """Lines of all tables: the table, what is said, parts of the message."""
    for table, text in tables.items():
        for line in text.replace("\n  ", " ").strip().splitlines():
            change, *parts = map(str.strip, line.split(" | "))
            yield pytest.param(table, change, parts, id=f"{table}: {change}")


TABLES = {}
TABLES["paper"] = """
campaign: [{reynolds: [400], forecasters: {esn_filtered: {neurons: [50], validation: [RV],
  seeds: 1}}}], washout_lt: 0.15 | start_up_lt is 0.17 | below washout_lt, 0.15
forecasters.esn_filtered.voters: 40 | voters: must be at most | esn_filtered.members, 30 (got 40)
seeds: 1 | seeds: unknown setting | campaign[].forecasters.esn.seeds or | control.sweep.seeds
cases.Re400.lyapunov.xyz: 1 | cases.Re400.lyapunov.xyz | known are time_unit
search.5: null | search: the key 5 must be text; in braces a comma ends a value
search.input_scaling: [1] | search.input_scaling: must be [low, high], two rising
campaign.0.forecasters.esn.neurons: [500, 500] | esn.neurons: has 500 twice
campaign.0.forecasters: [equations, equatoins] | forecasters.equatoins: unknown | did you mean
& campaign.0.forecasters: [equations, equations: {}] | campaign[0].forecasters: has equations twice
& campaign.0.forecasters: [[equations]] | campaign[0].forecasters: has ['equations']; each kind
& campaign.0.forecasters: [esn] | campaign[0].forecasters.esn.neurons: missing: sizes
campaign.0.forecasters: esn | .forecasters: must be a list of kinds, or a mapping of kinds
figures.example_forecaster: esn_aware-N1000-RV-seed0 | network of kind esn, no variant
case_defaults.ensemble: [] | case_defaults.ensemble: must be a mapping of settings
cases: [] | cases: must be a mapping of settings
search: null | search: must be a mapping of settings
campaign: {} | campaign: Input should be a valid list
campaign.0: Re400 | campaign[0]: must be a mapping of settings
campaign.0.forecasters.esn.neurons: 500 | campaign[0].forecasters.esn.neurons: Input should be a
cases.Re400.data: {file: x} | cases.Re400.data.file: unknown setting; did you mean files?
results: README.md | results: this is a file
results: 'a{b}' | results: must be the path of a directory, without braces
results: . | of their own
results: .. | of their own
results: / | of their own
results: "a\\0b" | results: must be the path of a directory | control characters
results: "a\\nb" | results: must be the path of a directory | control characters
campaign.0.realisations: 10001 | campaign[0].realisations: Input should be less than or equal to
control.sweep.seeds: 10001 | control.sweep.seeds: Input should be less than or equal to
results: false | results: must be the path | YAML reads yes, no, on and off as
cases.tables: {} | cases.tables: the name must be
cases.Re400-training1: {parameters: {reynolds: 400}} | other training series of Re400
cases.Re400.event_threshold: {quantile: 1} | {quantile: <a number between 0 and 1>}
cases.Re400.event_threshold: .inf | cases.Re400.event_threshold: must be a finite number
search.input_scaling: [1, 1] | search.input_scaling | below
search.surrogate.length_scale: [0.01, 0.1] | search.surrogate.first_length_scale
classification.prediction_times_lt: [2, 2.2, 3] | prediction_times_lt: must be a multiple | 2.2
classification.prediction_times_lt: [2, 3, 6] | must not be beyond | prediction_time_lt, 5
horizon.lead_time_step_lt: 11 | horizon.lead_time_step_lt: must be at most
& horizon.longest_lead_time_lt: 66 | case Re400: | 4026 steps | ensemble.duration
& search.interval_lt: 0.001 | case Re400: | search.interval_lt is 0.001
figures.example_case: Re401 | figures.example_case | not part of the campaign
figures.example_forecaster: esn-N2000-RV-seed10 | not part of | (Re400 has esn-N500-SSV-seed0)
figures.fixed_neurons: 500, figures.example_case: Re800 | example_case is Re800
& figures.fixed_neurons: 700 | figures.fixed_neurons: must be one of | 500, 1000, 1500
figures.flow_event.peak: 0.05 | figures.flow_event.peak is 0.05 | of Re400, 0.1
campaign.1.cases: [Re40O] | campaign[1].cases | did you mean Re400?
campaign.1.reynolds: ... | campaign[1] names no case
forecasters.esn.connectivity: 600 | forecasters.esn.connectivity is 600 | at most 499
campaign.0.forecasters.esn.variants: [quadratic] | campaign[0].forecasters: there is no quadratic
forecasters.esn.readout: quadratic | networks with squares have a name of their own
forecasters.variants: {aware: {readout: quadratic}} | esn_aware is another kind
forecasters.variants: {sparse: {connectivity: 600}} | at most 499
forecasters.variants: {committee: {readout: quadratic}} | forecasters.variants | committee
campaign.1.forecasters: {} | campaign[1].forecasters names no kind
case_defaults.system: mfee | unknown system 'mfee' | did you mean 'mfe'
case_defaults.parameters.length: 1 | no parameter 'length' | length_x
case_defaults.ensemble.initial_state: [1, 2] | initial_state has 2 | needs 9
case_defaults.ensemble.perturbed_component: 10 | perturbed_component is 10 | 1 to 9
case_defaults.ensemble.duration: 4000.5 | ensemble.duration: must be a multiple
probability.calibration_series: 1695 | calibration_series is 1695 | ensemble.series, 2000
case_defaults.training.series: 1, case_defaults.recycle_validation.series: 1,
  cases.Re400.recycle_validation.series: 1 | one by one: take 2 at least
case_defaults.laminarisation_threshold: 0.1 | event_threshold: must be below
case_defaults.actuation.force: [0, 1] | actuation: a force needs 9 | [0.0, 1.0]
case_defaults.actuation.parameters: {rho: 1} | actuation: | no parameter 'rho'
& case_defaults.actuation: null, cases.Re400.actuation: {parameters: {}, force: null} |
  case Re400: actuation.start_lt: missing
case_defaults.actuation.start_lt: -1.5 | control.prediction_times_lt has 1 | alarm
control.forecasters.esn.neurons: [2000, 7] | must be one of | 500, 1000
control.sweep.cases: [Re40] | control.sweep.cases | did you mean Re400
cases.Re400.parameters: {reynolds: 300} | Re400 | contradicts the name
cases.Re400.lyapunov.given_exponent: 2 | Re400 | given_exponent | step
cases.Re400.recycle_validation.intervals_per_series: 33 | 33 validation | only 32
& statistics.duration: 100 | Re400 | statistics.duration | loop of 100 | last 610
& campaign.0.realisations: 5, case_defaults.ensemble.series: 199 | is 5 | are 200 series of Re400
& campaign.0.event_shares: [0.13], campaign.0.realisations: 3 | realisations and event_shares
& campaign.0.event_shares: [0.13, all], case_defaults.ensemble.series: 179 | has 2 | are 180 series
forecasters.filter.members: 16, campaign.0.forecasters.quadratic_filtered: {} |
  Re400 | forecasters.filter.members | 18 for the system mfe
forecasters.quadratic.window_lt: 70, campaign.0.forecasters.quadratic_filtered: {} |
  Re400 | forecasters.quadratic.window_lt | 4270 steps | has 4001 samples
campaign.2: {reynolds: [400], event_shares: [0.13, all], forecasters: {equations: {}}},
  campaign.3: {reynolds: [400], event_shares: [0.17], forecasters: {equations: {}}} | must begin
campaign: [{reynolds: [400], forecasters: {persistence: {}}}], washout_lt: 0.01 |
  case Re400: washout_lt is 0.01 Lyapunov times | a Lyapunov time has 61
campaign.0.event_shares: [0.17] | drawn from the series of Re400, which no block
& campaign.0.event_shares: [0.17], cases.Re400.event_threshold: {quantile: 0.9} | is a quantile of
"""
TABLES["lorenz"] = """
cases.lorenz.ensemble: {initial_state: null} | lorenz63 draws no initial states: give one
cases.lorenz.ensemble: {perturbation: null} | are needed beside ensemble.initial_state
cases.lorenz.files: [table.csv] | case lorenz: files belong to a system or encoder of your own
cases.lorenz: {system: "flows:Silent", ensemble: {sampling_stride: 2}} |
  case lorenz: ensemble.initial_state, ensemble.perturbed_component, ensemble.perturbation,
  ensemble.transient, ensemble.duration, density.range, fixed_point, controlled_density.range are
  missing: the class Silent says nothing of them in its case_defaults, and config.yaml's are in
  units of another system; say them in cases.lorenz
cases.lorenz.system: "flows:Wrong" | case_defaults of the class Wrong (system flows:Wrong): |
  event_treshold: unknown setting; did you mean event_threshold? |
  density.range: the first number must be below the second (got [5, 1])
cases.lorenz.system: "flows:OfNumpy" | event_threshold is np.float64(40.0) of type numpy.float64
cases.lorenz: {system: "flows:Stepping", actuation: {force: [1, 0, 0]}} |
  case lorenz: actuation: a force is added to a right-hand side, but Stepping has an integrator of
  its own: let the actuation change a parameter
"""
TABLES["paper reactive"] = """
control.strategies: [strategy: receding_horizn] | strategies[0].strategy: must be a strategy
plan.settings.level: [] | control.strategies[0].settings.level: List should have at least 1 item
plan.settings.level: [high] | strategies[0].settings: setting 'level' of | must be a finite number
plan.settings.decision_interval_lt: [0.001] | control.strategies[0]: the interval | must last a step
plan.cases: [Re40] | control.strategies[0].cases | did you mean Re400
plan.forecasters: {equations: {}} | control.strategies[0].forecasters | reactive uses no forecaster
plan.committee: true | control.strategies[0].committee: reactive has no votes
plan.strategy: prediction_triggered, plan.settings: {prediction_time_lt: [1], window_lt: [1]} |
  control.strategies[0].forecasters names no kind | asks forecasters
plan.strategy: prediction_triggered, plan.settings: {prediction_time_lt: [1], window_lt: [1]},
  plan.forecasters: {esn: {neurons: [7]}} | control.strategies.forecasters.esn.neurons: must be one
plan.strategy: prediction_triggered, plan.settings: {prediction_time_lt: [0.5], window_lt: [1]},
  plan.forecasters: {equations: {}} | control.strategies[0]: control is not defined
"""
TABLES["paper receding_horizon"] = """
plan.forecasters: {3: {}} | control.strategies[0].forecasters: the key 3 must be text
plan.settings.vote_share: [0.5] | committees; say committee: true
plan.committee: true, plan.settings.vote_share: [0.5, 5] | above 0, and 1 at most |
  control.strategies[0].settings.vote_share has 5
plan.committee: true, plan.seeds: 2 | control.strategies[0].seeds | leave it out
plan.committee: true, plan.forecasters: {equations: {}} | names equations | provides no ensemble
"""
TABLES["measured"] = """
cases.lab.event_threshold: ... | case lab: event_threshold: missing: value of
cases.lab.data.observable: ... | case lab: data.observable is missing
cases.lab.data.time_step: ... | case lab: data.time_step is missing: the time between
cases.lab.data.time_step: 0 | data.time_step: must be a number above 0
cases.lab.data.gaps: cut | case lab: data.gaps needs data.blocks beside it
cases.lab.data.files: [lab/run_2.csv] | data.files: lab/run_2.csv: there is no such file
cases.lab.data.files: [] | case lab: data needs files
cases.lab.data.files: [lab/numbers.csv] | lab/numbers.csv, line 1 has numbers where the names of
cases.lab.data.files: [lab/x_*] | case lab: data.files: no file is called lab/x_*
cases.lab.data.case: Re400 | case lab: data needs files: [...], or else the name
cases.lab.data.components: [u, u = v] | data.components has u twice
cases.lab.data.observable: u + | 'u +' is no arithmetic expression
cases.lab.data.blocks: {gap: 1} | case lab: data.blocks needs a duration, or the length of
cases.lab.data.blocks: {duration: 20, shortest: 30} | data.blocks.shortest is longer than
cases.lab.data.blocks: {duration: 20}, cases.lab.lyapunov.given_exponent: 0.5,
  campaign.1.forecasters: {persistence: {}} | or data.blocks.duration: series of 41 samples
cases.part.data.delays: [4000] | case part: data.delays reach back by 4000 steps
cases.lab.system: mfe | case lab: system means nothing for measured series
cases.lab.training.series: 1 | case lab: training.series is 1, but probabilities
cases.lab.encoder: {kind: pod, modes: 1} | sensors and encoder are for cases of another
cases.part.data.case: Re600 | case part: data.case is Re600; it must be a case of the
cases.part.data.case: lab | that is simulated: Re400
cases.part.data.components: [a1, a10] | no column 'a10' (did you mean 'a1'?)
cases.part.data.time_step: 1 | data.time_step means nothing where the series come from
& cases.part.data.observable: a1 | case part: event_threshold: missing
campaign.1.forecasters.equations: {}, campaign.1.forecasters.equations_filtered: {} |
  cases lab, part: there are no equations of measured series | (equations, equations_filtered)
cases.lab.data.known: [v] | data.known has v, which forecasters see and forecast
cases.lab.data.components: [u], cases.lab.data.known: [vv] | no column 'vv' (did you mean 'v'?)
campaign.1: {cases: [lab], forecasters: {quadratic_aware: {}, persistence: {}}} | known is empty
cases.lab.data.components: [u], cases.lab.data.known: [v], cases.lab.training.trained_on: [lab],
  campaign.1: {cases: [lab], forecasters: {quadratic_aware: {}}} | training.trained_on means nothing
"""
TABLES["measured reactive"] = """
plan.cases: [part] | control.strategies[0].cases: control needs equations
"""
TABLES["aware"] = """
cases.Re800.training.actuation: null, case_defaults.training.trained_on: [] | reynolds does not vary
case_defaults.training.trained_on: [Re400, Re80] | Re80 is no case | did you mean Re800?
forecasters.aware.parameters: [reynold] | no parameter 'reynold' | did you mean 'reynolds'
& cases.Re400.training.trained_on: [Re800, Re400] | are found for the first case, Re400
cases.Re800.ensemble.duration: 500 | must have the same ensemble.duration, not 400.0, 500.0
"""
TABLES["aware planned"] = """
plan.forecasters: {quadratic_filtered: {}} | which quadratic_filtered cannot use
plan.settings.horizon_lt: [2] | plans are longer than the horizon
plan.strategy: receding_horizon, plan.forecasters: {esn: {}}, plan.observed: [Re800] | modes_4
"""
TABLES["encoded"] = """
cases.invariants.encoder.kind: invariant | pod, state_estimate, or <module>:<class> of your own
cases.invariants.encoder.kind: "shift_invariants:Invariant" | case invariants: encoder.kind: |
  has no class Invariant (did you mean 'Invariants'?)
cases.invariants.files: [rates.csv] | case invariants: files: there is no file rates.csv in
campaign.2.forecasters.equations_filtered: {} | cannot be decoded | (equations_filtered)
cases.sensors_pod.data.delays: [2] | data.delays means nothing beside sensors or an encoder
cases.turbulence.sensors: {} | sensors and encoder are for cases of another case's
cases.sensors_pod.training.noise: 0 | training.noise is 0
cases.turbulence.parameters.largest_wavenumber: 10, cases.sensors_pod.encoder.modes: 364 |
  case sensors_pod: | encoder.modes is 364 | have 363 snapshots
cases.sensors.training.noise: 0 | case sensors: sensors, encoder: training.noise
cases.turbulence.parameters.largest_wavenumber: 3.5 | case turbulence: system or parameters:
cases.turbulence.actuation.parameters.largest_wavenumber: 5 | actuation: | 80, not make it 120
campaign: [{cases: [turbulence], forecasters: {persistence: {}}}], control.strategies: [],
  cases.turbulence.data.known: [a_1_0] | case turbulence: data needs files: [...], or else
"""
TABLES["encoded probability_triggered"] = """
plan.settings.hold_lt: [1], plan.forecasters: {esn: {}} | takes classifiers: esn_direct, precursor
plan.settings.hold_lt: [1], plan.settings.windows: [4] | settings.windows: classifiers have 3
"""
TABLES["encoded receding_horizon"] = """
plan.observed: [invariants], plan.forecasters: {precursor: {}} | strategies[0] | forecasts no states
plan.observed: [sensors], plan.forecasters: {equations_filtered: {}}, plan.strength: [1, 3] |
  case turbulence: actuation: at a strength of 3, reynolds must be positive
plan.observed: [invariants], plan.forecasters: {equations_filtered: {}} | no equations_filtered for
plan.observed: [sensors], plan.forecasters: {equations_filtered: {}},
  cases.turbulence.actuation: null | strategies[0].observed: sensors is a part of turbulence
"""
TABLES["precursor"] = """
statistics.forecasters.precursor: {} | statistics.forecasters names precursor | no states
forecasters.precursor.lags_lt: [0.2, 0.5] | cases Re400, modes_4: forecasters.precursor.lags_lt |
  a lag of 30 steps | washout_lt holds the present and 29 steps before it
case_defaults.lyapunov.time_unit: computed, forecasters.precursor.lags_lt: [0.6] | washout_lt holds
forecasters.classifiers.start_spacing_lt: 0.001 | start_spacing_lt is 0.001 Lyapunov times
forecasters.esn_direct.neurons: 20 | connectivity is 20 | 20 neurons (forecasters.esn_direct
"""

SOUND = {}
SOUND["paper"] = """
search.grid: '4'
statistics.forecasters: {}, control.forecasters: {}
case_defaults.laminarisation_threshold: null
forecasters.filter.members: 16
forecasters.quadratic.window_lt: 70
campaign.0.realisations: 5
campaign.2: {reynolds: [400], event_shares: [0.13, all], forecasters: {equations: {}}}
probability.calibration_series: 20, case_defaults.training.series: 1,
  case_defaults.recycle_validation.series: 1, cases.Re400.recycle_validation.series: 1
"""
SOUND["lorenz"] = """
cases.lorenz.lyapunov.given_exponent: null,
  cases.lorenz.recycle_validation.intervals_per_series: 1000000
campaign: [{cases: [lorenz], forecasters: {persistence: {}}}], control.forecasters: {}
"""
SOUND["precursor"] = """
case_defaults.lyapunov.time_unit: computed
campaign: [{reynolds: [400], forecasters: {equations_noisy: {}}}],
  forecasters.precursor.lags_lt: [0.5]
"""


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    """The files that configs name."""
    directory = tmp_path_factory.mktemp("configs")
    (directory / "lab").mkdir()
    for name, text in FILES.items():
        (directory / name).write_text(text + "\n", encoding="utf-8")
    return directory


@pytest.mark.parametrize(("table", "line", "parts"), list(lines_of(TABLES)))
def test_a_mistake_is_told_in_these_words_and_no_other_is(
    table, line, parts, directory, monkeypatch
):
    monkeypatch.chdir(directory)
    monkeypatch.syspath_prepend(directory)
    with pytest.raises(ConfigError) as caught:
        load(changed(table, line))
    messages = caught.value.problems
    assert any(all(part in message for part in parts) for message in messages), messages
    assert line.startswith("& ") or len(messages) == 1


@pytest.mark.parametrize(("table", "line", "nothing"), list(lines_of(SOUND)))
def test_nothing_is_wrong(table, line, nothing, directory, monkeypatch):
    monkeypatch.chdir(directory)
    load(changed(table, line))


LONG, LARGE = "n" * 300, 10**400
HUGE = [
    ("results", LONG, "results: a path has at most 3000 bytes, and 255 in each part"),
    ("results", "n/" * 1600, "results: a path has at most 3000 bytes, and 255 in each part"),
    (f"cases.{LONG}", {"parameters": {"reynolds": 400}}, ": the name must be a letter, then at mo"),
    ("campaign.0.forecasters.esn.variants", [LONG], "variants[0]: must be a lower-case letter"),
    ("horizon.events", LARGE, "horizon.events: no setting takes a number as large as this"),
    ("horizon.tolerance", LARGE, "horizon.tolerance: Input should be a valid number"),
    ("random_seed", -LARGE, "random_seed: no setting takes a number as large as this"),
]


@pytest.mark.parametrize("number", range(len(HUGE)))
def test_what_is_too_long_or_too_large_is_told(number):
    name, value, message = HUGE[number]
    config = paper_with()
    put(config, name, value)
    with pytest.raises(ConfigError) as caught:
        load(config)
    assert len(caught.value.problems) == 1
    assert message in caught.value.problems[0]
