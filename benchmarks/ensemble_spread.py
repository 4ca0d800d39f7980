"""Spread of an ensemble of forecasts against the error of its mean, as a table in CSV.

::

    python benchmarks/ensemble_spread.py [RECORD ...] > benchmarks/ensemble_spread.csv

Records are the simulated ones of benchmarks/default_forecasters.py, by default shear_flow, with its
training series and twenty test series. Ensembles are the networks of a committee, and the members
of a filter around learnt equations. Spread and error are root mean squares of the
observable over starting points, in standard deviations of the observable in the test series; a
reliable ensemble has equal ones.
"""

import sys
import warnings

import numpy as np
from default_forecasters import SIMULATED

from burstcast import EventForecaster
from burstcast.base.threads import single_threaded

TIMES = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0)
KINDS = ("esn", "quadratic_filtered")
TESTS = 20
HEAD = "record,forecaster,members,prediction_time_lt,spread,error"


def main() -> None:
    """Print a row for each record, kind of forecaster and prediction time."""
    warnings.simplefilter("ignore")
    print(HEAD, flush=True)
    with single_threaded():
        for name in sys.argv[1:] or ["shear_flow"]:
            record = SIMULATED[name]()
            states = np.asarray(record.series)
            test = states[record.training : record.training + TESTS]
            deviation = float(np.std(record.settings["observable"](test)))
            for kind in KINDS:
                forecaster = EventForecaster(kind=kind, prediction_times=TIMES, **record.settings)
                forecaster.fit(states[: record.training])
                for time in TIMES:
                    scores = forecaster.ensemble_scores(test, time)
                    members = len(np.atleast_1d(scores["rank_histogram"])) - 1
                    ratios = (float(scores[each]) / deviation for each in ("spread", "error"))
                    cells = ",".join(f"{ratio:.4f}" for ratio in ratios)
                    print(f"{name},{kind},{members},{time:g},{cells}", flush=True)


if __name__ == "__main__":
    main()
