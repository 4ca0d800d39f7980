"""What entries that forecast all components share: the case, the choice of settings, the files."""

import itertools

import netCDF4
import numpy as np

HELD_OUT = 2
"""Training series that settings are chosen on."""


def error(model, series, washout, lyapunov_time):
    """Mean error of the forecasts of series, two Lyapunov times long, in units of their scale."""
    reach = 2 * lyapunov_time
    starts = np.arange(washout, series.shape[1] - reach, lyapunov_time)
    washouts = np.concatenate([series[:, at - washout : at] for at in starts])
    truth = np.concatenate([series[:, at : at + reach] for at in starts])
    missed = (model.forecast(washouts, reach) - truth) / model.scale
    return np.sqrt((missed**2).mean(axis=(1, 2))).mean()


def chosen(make, grid, training, washout, lyapunov_time):
    """Model with the settings that forecast the training series best that are held out.

    ``make``: Makes a model of training series, the length of a washout, and settings by name.
    ``grid``: Values of the settings by their names.
    """
    learnt, held_out = training[:-HELD_OUT], training[-HELD_OUT:]
    errors = []
    for values in itertools.product(*grid.values()):
        given = dict(zip(grid, values, strict=True))
        with np.errstate(over="ignore", invalid="ignore"):
            found = error(make(learnt, washout, **given), held_out, washout, lyapunov_time)
        errors.append((np.isnan(found), found, values))
        print(f"{given}: error {found:.4f}", flush=True)
    return make(training, washout, **dict(zip(grid, min(errors)[2], strict=True)))


def enter(make, grid, case_path, path):
    """Write forecasts of all components of a case (see `chosen`)."""
    with netCDF4.Dataset(case_path) as case:
        facts = {name: case.getncattr(name) for name in ("case", "case_version", "seed")}
        names = ("training", "washout", "horizon_washout")
        training, washouts, before_events = (np.asarray(case[name][:]) for name in names)
        steps, horizon_steps = int(case.forecast_steps), int(case.horizon_steps)
        lyapunov_time = int(case.steps_per_lyapunov_time)
    model = chosen(make, grid, training, washouts.shape[1], lyapunov_time)
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(facts)
        file.createDimension("component", training.shape[2])
        for before, given, length in (
            ("", washouts, steps),
            ("horizon_", before_events, horizon_steps),
        ):
            names = (f"{before}point", f"{before}step", "component")
            for name, size in zip(names, (len(given), length), strict=False):
                file.createDimension(name, size)
            file.createVariable(f"{before}state", "f4", names)[:] = model.forecast(given, length)
