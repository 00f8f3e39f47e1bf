"""The method `manifold` in a protocol: it needs no collection, and is laid out as others are."""

import re
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import Library
from stimuli.sets import clip_motion, resolve
from study.protocol.protocol import shipped
from study.protocol.sets import set_spec
from study.trials.reading import load_protocol


def written(path: Path, specification: str = "start-end") -> Path:
    """The protocol `graph` with manifold for motion-graph, one motion and no collection."""
    text = shipped()["graph"].read_text(encoding="utf-8").replace("motion-graph", "manifold")
    lines = [
        line
        for line in text.splitlines()
        if not line.startswith("collection") and not re.search("locomotion-[2-8]", line)
    ]
    path.write_text("\n".join(lines).replace('"start-end"', f'"{specification}"'))
    return path


def test_a_set_with_manifold_is_planned_and_laid_out(tmp_path: Path, sample_motions: Path) -> None:
    library = Library([sample_motions])
    protocol = load_protocol(str(written(tmp_path / "p.toml")))
    spec = set_spec(protocol, "sample", library)
    (found,) = resolve(spec, library)
    assert found.methods["manifold"] >= 1
    clip = clip_motion(spec, found, library, method="manifold")
    assert np.isfinite(clip.root).all()
    assert len(clip) == spec.frames
    again = clip_motion(spec, found, library, method="manifold")
    assert np.array_equal(clip.rotations, again.rotations)


def test_both_frames_at_one_instant_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path / "p.toml", "center-aligned")
    with pytest.raises(InputError, match="manifold leaves and reaches: it is start-end"):
        load_protocol(str(path))
