"""What is a sign that a result is less than it seems, and what is none."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import linregress

from burstcast.networks.negligible_ridge import negligible_ridge
from burstcast.statistics import warning_signs as signs
from burstcast.systems.integration import integrate
from kolmogorov_flow import KolmogorovFlow

ENOUGH, NAN = signs.FEW_POSITIVES, np.nan
ESTIMATED, PERMANENT = (1.0, 0.95, 1.05), [2 / 3, 2 / 3, NAN]
ONE = (1.0, 0.9, 1.1)


# A sign, what it is asked of, and all that it says: nothing where all is well.
SIGNS = {
    signs.optimum_on_edge: [
        (("rho", [0.3, 0.3, 0.1], 0.1, 1.0),),
        (("rho", [0.3, 0.1, 0.1], 0.1, 1.0), "rho at its lower bound 0.1 in 2 of 3 networks"),
        (
            ("rho", [1.0, 0.1], 0.1, 1.0),
            *("rho at its lower bound 0.1 in 1 of 2 networks", "rho at its upper bound 1 .*"),
        ),
        (("beta", [1e-6], 1e-6, 1e-6),),
        (("beta", [], 1e-9, 1e-6),),
    ],
    signs.few_events: [
        ((500, 500, 0.1, 0.4),),
        ((8, 8, 0.1, 0.4),),  # as many as were asked for
        ((12, 500, 0.1, 0.4), "12 events to forecast, 500 were asked for"),
        ((0, 500, 0.5, 0.4), r"no event: the threshold 0\.5 is above .* the observable, 0\.4"),
    ],
    signs.few_positives: [
        (([1.0, 2.0], [ENOUGH, ENOUGH]),),
        (([1.0, 2.0, 2.5], [ENOUGH, 3, 7]), "3 to 7 positives at 2, 2.5 LT"),
        (([1.0], [0]), "0 positives at 1 LT"),
    ],
    signs.nothing_to_calibrate_with: [
        ((np.array([0.3, 0.1, 0.2]), 0.11),),
        ((np.array([0.3, 0.1, 0.2]), 0.1), "no calibration .* of all 3 starting points in the .*"),
        ((np.empty(0), 0.1), "no calibration .* in the washouts of all 0 starting points .*"),
    ],
    signs.lost_long_runs: [
        (([0.1, 0.5], [0.0, 0.01]),),
        (
            ([0.1, 0.6], [0.0, 0.2]),
            "in 1 of 2 forecasters, up to 20% of the long runs diverge",
            "in 1 of 2 forecasters, up to 60% of the long runs leave the chaotic phase",
        ),
    ],
    signs.ill_conditioned_readout: [
        ((["cholesky", "cholesky"],),),
        ((["cholesky", "ldl"],), "the ridge regression of 1 of 2 networks is indefinite"),
    ],
    signs.own_exponents_differ: [
        ((ESTIMATED, [1.05, 1.09, NAN]),),  # as far as it may miss
        ((ESTIMATED, [1.098, NAN]),),  # by a tenth of the exponent itself
        ((ESTIMATED, [0.9, 1.5, 1.6]),),  # they disagree themselves
        ((ESTIMATED, [NAN]),),
        ((ESTIMATED, [-0.1, -0.3, NAN]),),  # without chaos there is no unit of time
        ((ESTIMATED, [1.1, 1.19, NAN]), ".* own flows 1.1.*"),
        (
            (ESTIMATED, [0.7, 0.5, NAN, 0.6]),
            r"estimated from the series 1 \(0.95 to 1.05\), of forecasters' own flows 0.6 \(0.5 to "
            "0.7 of 3.*: lyapunov: {given_exponent: 0.6}",
        ),
    ],
    signs.no_chaos_learnt: [
        ((1.0, [0.1, 0.2, -0.1]),),
        ((1.0, [NAN]),),
        (
            (1.0, [-0.1, -0.3, NAN]),
            r"the forecasters have learnt no chaos: ((?!given_exp).)*-0.3 to -0.1 \(of 2\)"
            "((?!given_exp).)*",
        ),
    ],
    signs.exponents_differ: [
        ((ONE, (1.05, 0.95, 1.15), 1.05),),
        ((ONE, (1.05, 0.95, 1.15), None),),
        ((ONE, (1.3, 1.2, 1.4), 1.0), r"by QR factorisation 1 \(0.9 to 1.1\), by the growth.*"),
        ((ONE, ONE, 2.0), "computed 1, given 2"),
    ],
    signs.outside_bins: [
        ((0, 1, 999),),
        ((0, 0, 0),),
        ((10, 20, 970), "1.00% of the observable below the bins, 2.00% above"),
    ],
    signs.no_better_than_permanent_alarm: [
        (([1, 2, 3], [0.9, 0.7, 0.1], PERMANENT),),
        (([1, 2, 3], [0.9, 0.6, NAN], PERMANENT), r".* alarm, in brackets: 2 LT 0.60 \(0.67\)"),
    ],
}


@pytest.mark.parametrize(
    ("sign", "row"), [(finding, row) for finding in SIGNS for row in SIGNS[finding]]
)
def test_a_sign_says_this_and_no_more(sign, row):
    arguments, *texts_expected = row
    findings = list(sign(*arguments))
    assert len(findings) == len(texts_expected), findings
    for finding, expected in zip(findings, texts_expected, strict=True):
        assert re.fullmatch(expected, finding), finding


def test_a_ridge_that_rounding_loses_is_no_edge():
    least = negligible_ridge(neurons=700, samples=40_000)
    assert 1e-12 < least < 1e-8
    at_bound = [1e-12, 1e-12]
    assert list(signs.optimum_on_edge("tikhonov", at_bound, 1e-12, 1e-6, least)) == []
    assert len(list(signs.optimum_on_edge("tikhonov", [1e-6], 1e-12, 1e-6, least))) == 1
    assert len(list(signs.optimum_on_edge("tikhonov", [1e-6], 1e-6, 1e-3, least))) == 1
    # an eigenvalue is never larger than what the bound is made from
    states = np.tanh(np.random.default_rng(0).normal(size=(50, 400)))
    assert np.linalg.eigvalsh(states @ states.T)[-1] <= 50 * 400


@pytest.mark.parametrize(
    ("place", "count"),
    [(0.0, 1), (0.0095, 1), (0.0105, 0), (0.5, 0), (0.9895, 0), (0.9905, 1), (1.0, 1)],
)
@given(low=st.floats(1e-9, 1e9), factor=st.floats(1.5, 1e6))
def test_a_hundredth_of_the_box_is_its_edge_in_any_unit(place, count, low, factor):
    findings = signs.optimum_on_edge("sigma", [low * factor**place], low, low * factor)
    assert len(list(findings)) == count


def test_noise_that_drowns_a_component():
    time = np.arange(1000.0)
    slow, fast = np.sin(2 * np.pi * time / 500), np.sin(2 * np.pi * time / 10)
    states = np.stack([slow, fast, np.ones(1000)], axis=-1)[np.newaxis]
    assert list(signs.noise_drowns_components(states, 0.001)) == []
    (findings,) = signs.noise_drowns_components(states, 0.1)
    # of a slow sine the increments are 2 pi / period of its standard deviation
    ratio = 0.1 / (2 * np.pi / 500)
    assert findings.startswith("component 0: the noise is up to ")
    assert float(findings.split()[7]) == pytest.approx(ratio, rel=0.01)


def test_a_flow_that_its_wavenumbers_do_not_resolve():
    """Kolmogorov flows of one Reynolds number with few and with enough wavenumbers."""
    shares = []
    for largest in (5, 10):
        flow = KolmogorovFlow(40.0, 4, largest)
        start = flow.sample_initial_states(2, np.random.default_rng(3))
        states = integrate(flow, start, 0.05, 1000, 50)[10:]
        shares.append(flow.energy_of_last_shell(np.moveaxis(states, 1, 0)))
    (findings,) = signs.unresolved_flow(shares[0])
    assert findings.startswith("the largest wavenumbers hold 0.0")
    assert list(signs.unresolved_flow(shares[1])) == []
    (finding,) = signs.unresolved_flow(np.array([0.1, 0.3]))
    assert "hold 0.2 of the energy" in finding


def test_a_slow_trend():
    generator = np.random.default_rng(3)
    start = np.sort(generator.uniform(0, 100, 60))
    states = generator.normal(size=(60, 40, 3))
    assert list(signs.slow_trend(start, states, "uvw", 30)) == []
    states[:, :, 1] -= 0.03 * start[:, np.newaxis]
    (finding,) = signs.slow_trend(start, states, "uvw", 30)
    # of other software, over the whole record
    slope = linregress(start, states[:, :, 1].mean(axis=1)).slope
    drift = slope * np.ptp(start) / states[:, :, 1].std()
    share = (start[30:].mean() - start[:30].mean()) / np.ptp(start)
    assert finding.endswith(
        f"standard deviations: v by {drift:+.2g}, {share:.0%} of that from training to the others"
    )
    assert list(signs.slow_trend(start[:3], states[:3], "uvw", 2)) == []  # too short for a line
    # means that wander are no trend: their errors are correlated
    wandering = np.cumsum(generator.normal(size=(60, 1, 400)), axis=0) * np.ones((60, 5, 400))
    names = [str(number) for number in range(400)]
    findings = list(signs.slow_trend(start, wandering, names, 30))
    assert findings[0].count(" by ") < 200
