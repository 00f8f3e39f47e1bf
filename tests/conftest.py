"""What the whole suite shares: where captured motion lies."""

from pathlib import Path

import pytest

SHARED = Path(__file__).resolve().parents[2] / "shared" / "motions"


@pytest.fixture(scope="session")
def motions() -> Path:
    """The captured motions kept beside the checkout; they are no part of the project."""
    if not SHARED.is_dir():
        pytest.skip(f"captured motions are absent: {SHARED}")
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
