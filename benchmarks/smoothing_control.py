"""Control by networks that learn from smoothed series and start from a filter, as a table.

    python benchmarks/smoothing_control.py > benchmarks/smoothing_control.csv

Receding-horizon control at Re = 400 without delay: a forecast of 3 LT every LT, and the paper's
actuation (Re = 2000) until the next decision where the forecast has an event. Training sets,
reservoirs and variants as in smoothing.py; with a filter, the majority of its members decides. All
control the same flows with the same noise, each for 20 LT after 3 LT without an event. `told`: the
filter of the true equations is given the actuation; all others are not, and follow observations of
a flow that their model does not describe. Columns:
remaining exceedance with its 95 % interval over resampled flows, duty cycle of the actuation, and
the difference of the remaining exceedance from that of the true equations, with its interval over
the same resamples.
"""

import argparse
import csv
import sys
import time
from dataclasses import replace
from itertools import islice, product

import numpy as np
from shear_flow_starts import (
    NOISE,
    SEED,
    STEPS_PER_LT,
    SYSTEM,
    THRESHOLD,
    WASHOUT,
    true_series,
    with_noise,
)
from smoothing import CASE, IN_SET, SETS, bound, equations, networks

from burstcast.base import random_streams
from burstcast.control.actuation import ActuationValues, actuated_system
from burstcast.control.controllers import controlling_policy
from burstcast.control.experiment import ControlExperiment, noise_of_flows
from burstcast.control.records import FlowSample, Span, record_flows, score_flows
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.control.timing import Schedule
from burstcast.data.dataset import component_scales
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.systems.parameters import SystemParameters

SCHEDULE = Schedule(
    washout=WASHOUT,
    quiet_lt=3.0,
    span_lt=20.0,
    delay_lt=0.0,
    actuation_start_lt=-1.0,
    actuation_duration_lt=1.5,
    steps_per_lyapunov_time=STEPS_PER_LT,
    sampling_stride=CASE.sampling_stride,
    time_step=CASE.time_step,
)

ACTUATED = actuated_system(SYSTEM, {"reynolds": 2000.0})
PARAMETERS = ["reynolds"]


def told(observed, neurons, seed):
    """True equations whose filter is given the actuation."""
    case = replace(CASE, parameters=SystemParameters.of(SYSTEM, PARAMETERS))
    yield "told", FilteredEquations().fit(observed, case)


def main():
    """Print the table as CSV."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--neurons", nargs="*", type=int, default=[500, 1000])
    parser.add_argument("--sets", nargs="*", type=int, default=[0])
    parser.add_argument("--interval", type=float, default=1.0, help="between decisions, in LT")
    parser.add_argument("--integrated", type=int, default=1000, help="series that are integrated")
    parser.add_argument("--flows", type=int, default=500)
    arguments = parser.parse_args()
    first = SETS * IN_SET
    states = true_series(arguments.integrated)
    observed = with_noise(states[:first], slice(first))
    series = range(first, min(first + arguments.flows, len(states)))
    experiment = ControlExperiment(
        system=SYSTEM,
        actuated_system=ACTUATED,
        values=ActuationValues.of(PARAMETERS, SYSTEM, ACTUATED, 1.0),
        threshold=THRESHOLD,
        series=series,
        washouts=np.ascontiguousarray(states[series.start : series.stop, :WASHOUT]),
        quiet_starts=True,
        schedule=SCHEDULE,
        root_seed=SEED,
        case="smoothed networks",
    )
    scales = component_scales(states[:first])
    del states
    strategy = RecedingHorizon(decision_interval_lt=arguments.interval, horizon_lt=3.0)
    steps = strategy.timing(SCHEDULE).length
    noise = noise_of_flows(series, steps, NOISE, scales, SEED, experiment.case)

    def controlled(model, aware):
        role = "committee" if model.provides_ensemble else "forecaster"
        deciding = replace(strategy, aware=aware)
        policy = controlling_policy(role, deciding, experiment, [model])
        flows = deciding.simulate(experiment, policy, noise=noise)
        sample = FlowSample(record_flows(flows, 0.48), Span.of(flows.timing))
        generator = random_streams.stream(SEED, "resampled flows")
        return len(sample), score_flows(sample, 1000, generator)

    table = csv.writer(sys.stdout, lineterminator="\n")
    columns = ["remaining", "low", "high", "duty", "difference", "difference_low"]
    columns += ["difference_high", "fallbacks", "seconds"]
    table.writerow(["kind", "neurons", "set", "variant", "interval_lt", "flows", *columns])
    rows = [
        ("equations", "", bound, 0),
        ("equations", "", told, 0),
        ("quadratic", "", equations, 0),
    ]
    rows += [
        ("esn", neurons, networks, number)
        for number, neurons in product(arguments.sets, arguments.neurons)
    ]
    reference = None
    for kind, neurons, variants, number in rows:
        training = observed[number * IN_SET : (number + 1) * IN_SET]
        made = variants(training, neurons, number)
        if kind == "quadratic":  # with the filter alone
            made = islice(made, 1, 2)
        for variant, model in made:
            began = time.process_time()
            flows, scores = controlled(model, variant == "told")
            remaining = scores["relative_exceedance"]
            if reference is None:
                reference = remaining
            apart = remaining.samples - reference.samples
            values = [remaining.value, *np.percentile(remaining.samples, [2.5, 97.5])]
            values += [scores["control_fraction"].value, remaining.value - reference.value]
            values += [*np.percentile(apart, [2.5, 97.5]), scores["fallback_fraction"].value]
            cells = [kind, neurons, number, variant, f"{arguments.interval:g}", flows]
            cells += [f"{value:.4f}" for value in values]
            table.writerow([*cells, f"{time.process_time() - began:.0f}"])
            sys.stdout.flush()


if __name__ == "__main__":
    main()
