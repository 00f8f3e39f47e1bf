"""What the whole suite shares: where captured motion lies, and what is said of what is absent."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

# No machine is too slow for a property to hold.
settings.register_profile(
    "any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("any machine")

SHARED = Path(__file__).resolve().parents[2] / "shared" / "motions"
ABSENT = "captured motion of another licence, kept beside the checkout"
NO_CASES = "small inputs with the right answer of each, kept beside the checkout"


def of_captured(choices: Iterable[Any]) -> list[Any]:
    """Parameters of a test of captured motion: where there is none, one that says so."""
    return _where(SHARED.is_dir(), choices, ABSENT)


def of_cases(choices: Iterable[Any]) -> list[Any]:
    """Parameters of a test of the cases: where there are none, one that says so."""
    return _where((SHARED.parent / "cases").is_dir(), choices, NO_CASES)


def _where(there: bool, choices: Iterable[Any], reason: str) -> list[Any]:
    first, *others = choices
    if there:
        return [first, *others]
    values = first if isinstance(first, tuple) else (first,)
    return [pytest.param(*values, marks=pytest.mark.skip(reason=reason))]


@pytest.fixture(scope="session")
def motions() -> Path:
    """The captured motions kept beside the checkout; they are no part of the project."""
    if not SHARED.is_dir():
        pytest.skip(ABSENT)
    return SHARED


@pytest.fixture(scope="session")
def sample_motions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sample clips, fetched once into the user's library."""
    from stimuli.motion import fetch, user_library

    library = user_library()
    if not list(library.glob("humanoid3d_walk*")):
        try:
            fetch(library)
        except OSError as error:
            pytest.skip(f"the sample motions cannot be fetched: {error}")
    return library


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """One line for all tests that one thing is absent for."""
    lacking: dict[str, int] = {}
    for report in terminalreporter.getreports("skipped"):
        _, _, why = report.longrepr
        why = why.removeprefix("Skipped: ").splitlines()[0]
        if why.startswith("got empty parameter set"):  # of the files of a folder that is not there
            why = ABSENT
        lacking[why] = lacking.get(why, 0) + 1
    for why, count in lacking.items():
        place = f" (in {SHARED.parent})" if why in (ABSENT, NO_CASES) else ""
        terminalreporter.write_line(
            f"{count} test{'s' * (count > 1)} skipped, for want of: {why}{place}"
        )
