"""Names of kinds of forecasters in tables and figures."""

_LABELS = {
    "esn": "network",
    "esn_committee": "committee of networks",
    "esn_aware": "parameter-aware network",
    "esn_aware_committee": "committee of parameter-aware networks",
    "equations": "equations, true state",
    "equations_filtered": "equations, filtered",
    "equations_filtered_committee": "equations, filter's members",
    "equations_noisy": "equations, noisy state",
    "quadratic": "learnt equations, noisy state",
    "quadratic_filtered": "learnt equations, filtered",
    "quadratic_filtered_committee": "learnt equations, filter's members",
    "quadratic_aware": "parameter-aware equations, noisy state",
    "quadratic_aware_filtered": "parameter-aware equations, filtered",
    "quadratic_aware_filtered_committee": "parameter-aware equations, filter's members",
    "analogues_committee": "analogues, one by one",
    "linear_inverse": "linear inverse model",
    "esn_true_washout": "network, true washout",
    "esn_true_washout_committee": "committee of networks, true washouts",
    "esn_direct": "reservoir, read out for the event",
    "precursor": "learnt precursor",
    "random": "random alarms",
}


def forecaster_label(kind: str) -> str:
    """Words for a kind of forecaster, a committee or a baseline; its name if there are no others.

    Examples
    --------
    >>> forecaster_label("quadratic_filtered"), forecaster_label("permanent_alarm")
    ('learnt equations, filtered', 'permanent alarm')
    """
    words = kind.replace("_", " ")
    if kind.startswith("esn_"):  # a variant
        words = f"network, {words.removeprefix('esn ')}"
    return _LABELS.get(kind, words)
