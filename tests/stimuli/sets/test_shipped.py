"""The stimulus sets of the shipped protocols, planned: their clips' names, and how large they show
the figure, in every frame of every clip.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from stimuli.motion import forward
from stimuli.sets.group import PlannedGroup
from tests.conftest import SHARED
from tests.stimuli.sets import recipe

MIDDLE = 0.07  # of the height: joints reach less far up than crowns do
KEPT = json.loads(recipe.KEPT.read_text(encoding="utf-8"))


def test_the_shipped_protocols_clips_have_their_names_on_any_machine(sample_motions: Path) -> None:
    """Every set of sample motions and of generated ones; `make test-portable` has the rest."""
    found = recipe.names(captured=False)
    assert len(found) == 11
    assert found == {key: KEPT["names"][key] for key in found}


def test_the_shipped_sets_show_the_figure_large_whole_and_in_the_middle(
    sample_motions: Path,
) -> None:
    assert small(recipe.planned(False)) == []


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="needs captured motion that is not fetched")
def test_the_captured_sets_show_it_so_too(sample_motions: Path) -> None:
    assert small(recipe.planned(True)) == []


def small(sets: dict[str, list[PlannedGroup]]) -> list[str]:
    """Groups that show a figure that is too small, cut, or above or below the middle."""
    return [
        f"{name}, {group.name}: {fault}"
        for name, groups in sets.items()
        for group in groups
        for fault in faults(group)
    ]


def faults(group: PlannedGroup) -> list[str]:
    """What is wrong with how a group's camera shows the joints of its clips."""
    width, height = group.look.width, group.look.height
    near, anywhere, middles, found = [], [], [], []
    for clip in group.clips:
        motion, (first, last) = clip.laid_out.motion, clip.laid_out.mixed
        joints, _ = forward(motion.skeleton, motion.rotations, motion.root)
        pixels, _ = group.camera.project(joints, width, height)
        if not np.all((pixels > 0) & (pixels < [width, height])):
            found.append(f"{clip.hash} is cut")
        standing = np.stack([motion.root, motion.root], axis=1)
        standing[:, :, 1] += np.array([-0.5, 0.5]) * group.body.stature
        ends, _ = group.camera.project(standing, width, height)
        tall = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=-1) / height
        near.append(tall[max(first - 30, 0) : last + 31].min())
        anywhere.append(tall.min())
        middles.append((pixels[..., 1].min(axis=1) + pixels[..., 1].max(axis=1)) / 2 / height)
    middle = float(np.mean(middles))
    checks = {
        f"{min(near):.2f} near the blend": min(near) >= 0.55,
        f"{min(anywhere):.2f} elsewhere": min(anywhere) >= 0.45,
        f"its middle at {middle:.2f}": abs(middle - 0.5) < MIDDLE,
    }
    return found + [told for told, right in checks.items() if not right]
