"""Where clips of a group lie outside the blend: measured against the group's reference."""

from pathlib import Path

import numpy as np
import pytest

from stimuli.motion import Library, write_walker
from stimuli.sets import Appearance, Pairing, SetSpec, resolve
from stimuli.sets.ends import end_displacements, picture_displacements
from stimuli.sets.group import plan_group
from stimuli.sets.layout import lay_out


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    folder: Path = tmp_path_factory.mktemp("ends")
    for seed in (0, 1):
        write_walker(folder, seed)
    return Library([folder])


@pytest.mark.parametrize(
    ("specification", "moves"), [("start-end", True), ("center-aligned", False)]
)
def test_only_start_end_lengths_move_the_end(
    library: Library, specification: str, moves: bool
) -> None:
    pairing = Pairing("m", "generated-walker-0", 3, "generated-walker-1", 20)
    spec = SetSpec(
        "s", (pairing,), specification, reference=10, shorter=(8,), longer=(12,), foot_lock=False
    )
    resolved = resolve(spec, library)[0]
    reference = lay_out(spec, resolved, library, length=10)
    assert end_displacements(reference, reference) == {
        "displacement_before": 0.0,
        "displacement_after": 0.0,
    }
    for length in (2, 22):
        found = end_displacements(lay_out(spec, resolved, library, length=length), reference)
        assert found["displacement_before"] == 0.0
        assert (found["displacement_after"] > 0.02) == moves


def test_in_the_picture_lengths_differ_in_the_blend_alone(library: Library) -> None:
    """As an angle at the camera: metres across the line of sight over the distance."""
    pairing = Pairing("m", "generated-walker-0", 3, "generated-walker-1", 20)
    spec = SetSpec(
        "s", (pairing,), "center-aligned", reference=10, shorter=(8,), foot_lock=False,
        appearance=Appearance(width=96, height=72, style="mannequin"),
    )  # fmt: skip
    resolved = resolve(spec, library)[0]
    group = plan_group(spec, resolved, library)
    clip, reference = (each.laid_out for each in group.clips)
    found = picture_displacements(clip, reference, group.camera, 20.0)
    assert found["picture_before"] == found["picture_after"] == 0.0
    metres = group.clips[0].document["measures"]["displacement_from_reference"]
    away = np.linalg.norm(np.array(group.camera.position) - reference.motion.root[90])
    assert 0.3 < np.radians(found["picture_in"]) * away / metres <= 1.2
    assert group.clips[1].document["measures"]["picture_in"] == 0.0
