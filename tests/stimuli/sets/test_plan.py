"""Which lengths a set means."""

import json
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from stimuli.errors import InputError, InputWarning
from stimuli.motion import Library
from stimuli.sets import SetSpec, resolve
from stimuli.sets.group import _plain, plan_group
from stimuli.transition import blend_length, with_room


def test_differences_become_lengths(spec: SetSpec, library: Library) -> None:
    (resolved,) = resolve(spec, library)
    assert resolved.reference_length == resolved.anchor == 6
    assert resolved.lengths == (2, 4, 6, 9)
    assert resolved.methods == {}


def test_a_geodesic_reference_is_computed(spec: SetSpec, library: Library) -> None:
    (resolved,) = resolve(replace(spec, reference="geodesic", shorter=()), library)
    a, i = with_room(library.load("generated-walker-0").motion, 12)
    b, j = with_room(library.load("generated-walker-1").motion, 20)
    assert (
        resolved.reference_length == blend_length(a, b, i, j, "geodesic", "center-aligned").frames
    )


def test_lengths_below_one_are_refused_or_dropped(spec: SetSpec, library: Library) -> None:
    below = replace(spec, shorter=(2, 6, 7))
    with pytest.raises(InputError, match="drop_missing"):
        resolve(below, library)
    with pytest.warns(InputWarning, match="-7, -6"):
        (resolved,) = resolve(replace(below, drop_missing=True), library)
    assert resolved.lengths == (4, 6, 9)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"reference": None}, "methods or a reference"),
        ({"reference": None, "methods": ("magic",)}, "magic"),
        ({"specification": "middle"}, "middle"),
    ],
)
def test_sets_that_cannot_be_are_refused(
    spec: SetSpec, library: Library, change: dict[str, object], what: str
) -> None:
    faulty = replace(spec, **change)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=what):
        resolve(replace(faulty, reference=faulty.reference and "geodesic"), library)


def test_two_methods_that_make_one_clip_are_named(spec: SetSpec, library: Library) -> None:
    alike = replace(spec, reference=None, shorter=(), longer=(), methods=("fixed", "geodesic"))
    (pairing,) = alike.pairings
    everywhere = (
        replace(alike, pairings=(replace(pairing, from_frame=i, to_frame=j),))
        for i, j in product(range(0, 30, 2), range(0, 30, 2))
    )
    moved, resolved = next(
        (moved, resolved)
        for moved in everywhere
        for resolved in resolve(moved, library)
        if resolved.methods["geodesic"] == resolved.methods["fixed"]
    )
    with pytest.warns(InputWarning, match="tiny, walk: fixed and geodesic make one and the same"):
        plan_group(moved, resolved, library)


def test_missing_clips_and_frames_are_named(spec: SetSpec, library: Library) -> None:
    (pairing,) = spec.pairings
    with pytest.raises(InputError, match="nowhere"):
        resolve(replace(spec, pairings=(replace(pairing, to_clip="nowhere"),)), library)
    with pytest.raises(InputError, match=r"from 0 to .* found 999"):
        resolve(replace(spec, pairings=(replace(pairing, from_frame=999),)), library)


def test_a_methods_report_is_kept_as_far_as_json_goes() -> None:
    report = {
        "joint": "left_knee", "clamped": np.bool_(True), "speed": np.float64(0.5), "given": True,
        "wanted": float("inf"), "costs": np.ones(60),
    }  # fmt: skip
    kept = _plain(report)
    assert kept == {"joint": "left_knee", "clamped": True, "speed": 0.5, "given": True}
    json.dumps(kept, allow_nan=False)
