"""Transition points: drawn again from their stated seed, they are those of the protocols."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Library, walker
from stimuli.transition.draw import POINT_CONDITIONS, draw_point, length_at
from tests.corpora import CORPORA

PROTOCOLS = Path(__file__).resolve().parents[3] / "protocols"


def points(name: str, set_name: str, library: Library) -> dict[str, list[tuple[int, int]]]:
    """The points of a protocol's set, as written and as drawn again."""
    document = tomllib.loads((PROTOCOLS / f"{name}.toml").read_text(encoding="utf-8"))
    bound = document["sets"][set_name]
    stated = re.search(r"seed \[(\d+), (\d+), n\]", bound["about"])
    assert stated is not None
    later = {
        motion: int(which)
        for motion, which in re.findall(r"of ([\w-]+) the (\d+)\w\w such point", bound["about"])
    }
    found: dict[str, list[tuple[int, int]]] = {"written": [], "drawn": []}
    for n, motion in enumerate(document["stimuli"]["motions"]):
        start, end = bound[motion["from"]], bound[motion["to"]]
        generator = np.random.default_rng([int(stated[1]), int(stated[2]), n])
        a, b = library.load(start["clip"]).motion, library.load(end["clip"]).motion
        drawn = [
            draw_point(a, b, POINT_CONDITIONS[name], generator)
            for _ in range(later.get(motion["name"], 1))
        ]
        found["drawn"].append(drawn[-1])
        found["written"].append((start["frame"], end["frame"]))
    return found


@pytest.mark.parametrize("corpus", CORPORA)
@pytest.mark.parametrize("name", POINT_CONDITIONS)
def test_points_of_captured_motion(name: str, corpus: str, sample_motions: Path) -> None:
    """Of the sample motions, and of the others where there are any."""
    bound = {"sample": "sample", "captured": "cmu"}[corpus]
    found = points(name, bound, Library(CORPORA[corpus].folders))
    assert found["drawn"] == found["written"]


def test_a_drawn_point_meets_its_condition() -> None:
    a, b = walker(0), walker(1)
    generator = np.random.default_rng(1)
    i, j = draw_point(a, b, lambda length: length("geodesic").frames > 1, generator)
    assert length_at(a, b, i, j)("geodesic").frames > 1
    with pytest.raises(InputError, match="20 draws"):
        draw_point(a, b, impossible, generator, tries=20)


def impossible(length: object) -> bool:
    return False
