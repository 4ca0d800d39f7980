"""Order of names as people sort them."""

import re


def natural_order(name: str) -> list[tuple[bool, float, str]]:
    """Key to sort names by, numbers in them by their size.

    Examples
    --------
    >>> sorted(["Re1000", "Zeta", "Re400", "alpha"], key=natural_order)
    ['alpha', 'Re400', 'Re1000', 'Zeta']
    """
    parts = re.split(r"(\d+(?:\.\d+)?)", name)
    pieces = [
        (True, float(part), "") if index % 2 else (False, 0.0, part.casefold())
        for index, part in enumerate(parts)
    ]
    return [*pieces, (False, 0.0, name)]  # names that differ in case only have an order, too
