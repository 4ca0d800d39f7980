"""What made-up systems have in common."""

from typing import ClassVar

import numpy as np


class FirstObserved:
    """The observable is the first component."""

    observable_name: ClassVar[str] = "x"
    observable_symbol: ClassVar[str] = "x"

    def observable(self, state):
        return np.array(state[0])
