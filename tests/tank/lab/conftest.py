import numpy as np
import pytest
from lab_parts import Operator, make_tank


@pytest.fixture
def operator():
    return Operator(make_tank())


@pytest.fixture
def straight():
    return np.zeros(18)
