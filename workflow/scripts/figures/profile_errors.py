"""(a-c) Profiles of the velocity along x, its square and the Reynolds stress, averaged over x, z
and time, of all data, the training set and one network: of those of the size and strategy shown,
the one with the smallest Kantorovich metric. (d-f) Errors of the profiles, normalised by the
range of the true profile, against reservoir size: medians and quartiles over the networks of an
ensemble. Thin bars: the bootstrap interval of one network over its closed loops, in the median. In
grey: the same errors between two random halves of the data, in the median. Open markers, if any:
published values, those of the training set as diamonds on the right edge.
"""

import numpy as np
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.profile_errors import profile_errors
from burstcast.statistics.profiles import flow_modes, velocity_profiles
from burstcast.statistics.reductions import LongTermStatistics
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.best_network import best_of
from burstcast_workflow.jobs.figures import Statistics, published_beside
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(
    *,
    data: Statistics,
    training: Statistics,
    long_term: list[str],
    percentiles: Table,
    intervals: Table,
    settings: Settings,
    published: Table | None = None,
) -> Figure:
    """Draw the data, the training set and the best network, and the errors of all networks."""
    y = np.linspace(-1.0, 1.0, settings["statistics.profile_points"])
    modes = flow_modes(system_of(settings))
    assert modes is not None
    matrices = modes.profile_matrices(y)

    def profiles(statistics: LongTermStatistics) -> FloatArray:
        found = velocity_profiles(matrices, statistics.moments)
        return np.stack([found.u, found.uu, found.uv])

    best = best_of(settings, data, long_term)
    return profile_errors(
        y,
        profiles(data),
        profiles(training),
        None if best is None else profiles(best.statistics),
        percentiles,
        intervals,
        network_label="" if best is None else best.label,
        published=published_beside(percentiles, published, "statistics"),
    )
