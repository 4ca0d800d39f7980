"""Draw the graph of rules that ``snakemake --rulegraph`` prints: ``rule_graph.py FILE.svg < DOT``.

A rule stands right of those that it is made from. Rules of tables are drawn as one; targets without
jobs, and lines that follow from others, are left out. Graphviz is not needed.
"""

import re
import sys
from graphlib import TopologicalSorter
from statistics import fmean

import matplotlib as mpl
from matplotlib.figure import Figure

from burstcast_workflow.tables.declarations import TABLES

TARGETS = {"all", "forecasters", "tables", "figures"}


def shown(rule: str) -> str:
    """Name of a rule in the graph."""
    for table in TABLES.values():
        if rule == table.script:
            return "tables of a case" if table.of_cases else "tables of all cases"
    return "tables of all cases" if rule.startswith("joined_") else rule


def sources(dot: str) -> dict[str, set[str]]:
    """What each rule is made from, by name, without what follows from the rest."""
    names = {key: shown(name) for key, name in re.findall(r'(\d+)\[label = "(\w+)"', dot)}
    made_from = {name: set[str]() for name in names.values() if name not in TARGETS}
    for before, after in re.findall(r"(\d+) -> (\d+)", dot):
        # random control is matched to control by a forecaster, of the same rule
        if names[before] != names[after] and not TARGETS & {names[before], names[after]}:
            made_from[names[after]].add(names[before])
    every: dict[str, set[str]] = {}
    for name in TopologicalSorter(made_from).static_order():
        every[name] = made_from[name].union(*(every[source] for source in made_from[name]))
    return {
        name: {source for source in rules if not any(source in every[other] for other in rules)}
        for name, rules in made_from.items()
    }


def drawn(made_from: dict[str, set[str]]) -> Figure:
    """Rules in columns, each near the height of the rules that it is made from."""
    columns: dict[int, list[str]] = {}
    places: dict[str, tuple[int, float]] = {}
    for name in TopologicalSorter(made_from).static_order():
        column = max((places[source][0] + 1 for source in made_from[name]), default=0)
        places[name] = column, 0.0
        columns.setdefault(column, []).append(name)
    for column, names in sorted(columns.items()):
        near = {
            name: fmean([places[source][1] for source in made_from[name]] or [0]) for name in names
        }
        for number, name in enumerate(sorted(names, key=lambda name: (near[name], name))):
            # columns are shifted, so that no line runs behind a box
            places[name] = column, (number + 0.5) / len(names) + 0.04 * (column % 3 - 1)
    figure = Figure((12, 5))
    axes = figure.add_axes((0.06, 0, 0.88, 1), frameon=False, xticks=[], yticks=[])
    axes.set(xlim=(0, max(columns)), ylim=(1, 0))
    box = {"boxstyle": "round", "facecolor": "white", "edgecolor": "steelblue"}
    for name, place in places.items():
        axes.text(*place, name, ha="center", va="center", size=8, bbox=box)
        for source in sorted(made_from[name]):
            axes.plot(*zip(places[source], place, strict=True), color="grey", linewidth=1)
    return figure


if __name__ == "__main__":
    with mpl.rc_context({"svg.hashsalt": "rules", "svg.fonttype": "none"}):
        drawn(sources(sys.stdin.read())).savefig(sys.argv[1], metadata={"Date": None})
