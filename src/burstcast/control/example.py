"""A suppressed event as it is shown: the times of the flow fields.

Source: section "Control of extreme events" of the paper, figure of a suppressed event.
"""

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.events import upward_crossings


def suppressed_event_times(
    uncontrolled: FloatArray, threshold: float, actuation_start: int, window: tuple[int, int]
) -> tuple[int, int, int, int]:
    """Four steps of an event that control suppresses.

    Parameters
    ----------
    uncontrolled
        Observable without control from the alarm on, ``(steps,)``.
    threshold
        The event threshold, k_e.
    actuation_start
        Step at which the actuation starts, before the window ends.
    window
        First and last step of the alarm's window, in which the observable crosses the threshold.

    Returns
    -------
    The start of the actuation, up to which the flow is the same with and without control; the
    first step of the event in the window; its peak; and the first step after it below the
    threshold, or else the last step that there is.

    Raises
    ------
    ValueError
        If the observable does not cross the threshold in the window.
    """
    above = uncontrolled >= threshold
    first, last = window
    crossings = np.flatnonzero(upward_crossings(uncontrolled, threshold)[first + 1 : last + 1])
    if crossings.size == 0:
        raise ValueError("the observable does not cross the threshold in the window")
    crossing = first + 1 + int(crossings[0])
    below = np.flatnonzero(~above[crossing:])
    end = crossing + int(below[0]) if below.size else len(uncontrolled) - 1
    peak = crossing + int(uncontrolled[crossing : end + 1].argmax())
    return actuation_start, crossing, peak, end
