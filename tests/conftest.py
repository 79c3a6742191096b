"""What several rooms of tests share."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

DATA = Path(__file__).parent / "data"


@pytest.fixture
def rng() -> np.random.Generator:
    """Random numbers that are the same in every run."""
    return np.random.default_rng(560)


def data(name: str) -> Any:
    """A file of golden values."""
    return json.loads((DATA / name).read_text())
