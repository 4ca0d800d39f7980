"""Units of quantities in files.

The library does not know the units of a system's equations or of measured series: units are named
after the quantity that they belong to. The shear flow is made dimensionless by the half-distance of
its walls and the laminar velocity halfway between centre and wall: there, all of them are numbers.
"""

NUMBER = "1"
"""Pure numbers: counts, steps, shares, probabilities, logarithms, truth values."""
TIME = "time units"
"""The unit of the system's time step."""
RATE = "1 / time unit"
LYAPUNOV_TIMES = "Lyapunov times"
OBSERVABLE = "units of the observable"
COMPONENT = "units of the component"
"""Of the state; each component has its own."""
COMPONENT_RATIO = "ratio of the units of two components"
COMPONENT_PRODUCT = "product of the units of two components"
POWER = "units of the energy / time unit"
