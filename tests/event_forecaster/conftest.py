"""Series of the Lorenz system that forecasters are fitted to and tested with."""

import pytest
from test_event_forecaster import lorenz


@pytest.fixture(scope="session")
def training():
    return lorenz(4, 900, 1)


@pytest.fixture(scope="session")
def tested():
    return lorenz(5, 800, 2)
