"""From the data to forecasters: the search for a network's hyperparameters, training, fitting."""

stage(
    # one job for all strategies that share their sums over the training data
    "forecasters/scan",
    "objectives on the grid",
    inputs=files("ensemble scheduled"),
    outputs={
        "scan": f"{CASE}/scan/{{reservoir}}-{{strategies}}.csv",
        "scan_errors": f"{CASE}/scan/{{reservoir}}-{{strategies}}.nc",
    },
    settings="SEARCH search.grid",
    cost="search_grid",
    cached=True,
)
stage(
    "forecasters/search",
    "Bayesian search",
    inputs={
        **files("ensemble scheduled"),
        "scan": stages.scan_of_network("csv"),
        "scan_errors": stages.scan_of_network("nc"),
    },
    outputs={
        "hyperparameters": f"{FORECASTER}/hyperparameters.json",
        "trace": f"{FORECASTER}/search.csv",
    },
    settings="SEARCH search.bayesian_points search.surrogate",
    cost="search_points",
    cached=True,
)
stage(
    # of equally good points: requested only by search.choice
    "forecasters/survival_choice",
    "choose hyperparameters by survival",
    inputs=files("ensemble trace scheduled"),
    outputs={
        "chosen": f"{FORECASTER}/survival_choice.json",
        "candidates": f"{FORECASTER}/survival_choice.csv",
    },
    settings="LONG_TERM RESERVOIR bootstrap.confidence",
    cost="choice",
    cached=True,
    constraints={"forecaster": NETWORKS},
)
stage(
    "forecasters/train",
    "train",
    inputs={
        **files("ensemble scheduled"),
        "hyperparameters": stages.hyperparameters,
    },
    outputs={"forecaster": f"{FORECASTER}/forecaster.nc"},
    settings="TIME OBSERVED RESERVOIR washout_lt",
    cost="training",
    cached=True,
    constraints={"forecaster": NETWORKS},
)
stage(
    # forecasters of all other kinds, which need no search
    "forecasters/fit",
    "fit",
    inputs=files("ensemble scheduled"),
    outputs={"forecaster": f"{FORECASTER}/forecaster.nc"},
    settings="FORECASTER OBSERVED",
    cost="training",
    cached=True,
    constraints={"forecaster": NO_CLASSIFIER + OTHERS},
)
