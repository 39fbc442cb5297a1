"""What holds for every test: slow ones only on request, floating-point errors raise."""

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import settings

# How long an example takes is no condition of a test.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="also run the tests that need minutes")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow"):
        return
    skip = pytest.mark.skip(reason="needs --slow")
    for item in items:
        if "slow" in item.keywords:
            item.add_marker(skip)


@pytest.fixture(autouse=True)
def floating_point_errors_raise() -> Iterator[None]:
    # Underflow to 0 is what decaying exponentials are meant to do.
    with np.errstate(divide="raise", over="raise", invalid="raise", under="ignore"):
        yield
