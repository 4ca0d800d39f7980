"""What arguments of functions declare, and calls with it."""

import pytest

from burstcast.base.declared import (
    File,
    at,
    called,
    declaring,
    files_of,
    gathered,
    made_by,
    paths_of,
    read,
)

SETTINGS = {"case.size": 3, "search.grid.points": [1, 2], "random_seed": 5}


def half(*, size: int = at("case.size"), table: str = read("case/a.csv")) -> tuple[float, str]:
    return size / 2, table


@declaring
def whole(
    *,
    made: tuple[float, str] = made_by(half),
    size: int = at("case.size"),
    points: tuple[int, ...] = at("search.grid.points", make=tuple),
    cost: bool = at("control.cost", otherwise=False),
    flows: list[str] = gathered("runs/flows.nc", "row edge*"),
    state: str = read("source/ensemble.nc:state"),
    extra: int | None = None,
) -> list[object]:
    return [made, size, points, cost, flows, state, extra]


def test_files_and_paths_are_those_of_a_function_and_of_what_makes_its_arguments():
    files = {
        "table": File("case/a.csv", ""),
        "flows": File("runs/flows.nc", "row edge*", of_each=True),
        "state": File("source/ensemble.nc:state", ""),
    }
    assert files_of(whole) == files
    assert [(file.path, file.part) for file in files.values()] == [
        ("case/a.csv", ""),
        ("runs/flows.nc", ""),
        ("source/ensemble.nc", "state"),
    ]
    assert paths_of(whole) == ["case.size", "search.grid.points", "control.cost"]


def test_a_function_is_called_with_what_it_declares_and_with_what_is_given_beside():
    result = called(whole, SETTINGS.__getitem__, lambda name, file: f"{name} of {file.path}")
    flows, state = "flows of runs/flows.nc", "state of source/ensemble.nc"
    assert result == [(1.5, "table of case/a.csv"), 3, (1, 2), False, flows, state, None]
    more = called(whole, SETTINGS.__getitem__, lambda name, file: name, extra=7)
    assert more[-1] == 7
    with pytest.raises(KeyError, match="random"):
        called(declaring(lambda *, seed=at("random"): seed), SETTINGS.__getitem__, None)


def test_a_call_without_a_declared_argument_names_it():
    given = {"made": 0, "size": 1, "points": 2, "cost": 3, "flows": 4, "state": 5}
    assert whole(**given) == [0, 1, 2, 3, 4, 5, None]
    del given["cost"], given["state"]
    with pytest.raises(TypeError, match=r"test_declared is called without cost, state$"):
        whole(**given)
