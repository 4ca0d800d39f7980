"""Settings that figures and tables declare, as text."""


def paths_by_argument(settings: str) -> dict[str, str]:
    """Path of each setting in the config, by the name of its argument.

    ``settings``: ``name=path``, or the path alone where the argument has the name of its last part.

    Examples
    --------
    >>> paths_by_argument("threshold=case.event_threshold case.system")
    {'threshold': 'case.event_threshold', 'system': 'case.system'}
    """
    parts = (one.rpartition("=") for one in settings.split())
    return {name or path.rpartition(".")[2]: path for name, _, path in parts}
