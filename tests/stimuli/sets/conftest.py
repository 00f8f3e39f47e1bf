"""A small library of generated walkers, and small sets of them."""

from pathlib import Path

import pytest

from stimuli.motion import Library, write_walker
from stimuli.sets import Appearance, Pairing, SetSpec

SMALL = Appearance(width=96, height=72, camera="fixed", style="mannequin")


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    """Three generated walkers of one skeleton."""
    directory = tmp_path_factory.mktemp("walkers")
    for seed in range(3):
        write_walker(directory, seed)
    return Library([directory])


@pytest.fixture
def pairing() -> Pairing:
    """From one walker to another."""
    return Pairing("walk", "generated-walker-0", 12, "generated-walker-1", 20, "locomotion")


@pytest.fixture
def spec(pairing: Pairing) -> SetSpec:
    """Half a second in four lengths around 6, very small pictures."""
    return SetSpec(
        "tiny", (pairing,), "center-aligned", reference=6, shorter=(2, 4), longer=(3,),
        seconds=0.5, foot_lock=False, appearance=SMALL,
    )  # fmt: skip


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """Where a set is built."""
    return tmp_path / "set"
