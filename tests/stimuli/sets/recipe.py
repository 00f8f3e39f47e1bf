"""What clips of the present recipe show, in figures, and the names of the shipped protocols' clips.

    python -m tests.stimuli.sets.recipe

writes them anew to `recipe.json`: after `RECIPE` was raised because code that shows was changed on
purpose, or after motions are read otherwise. It refuses where figures have changed and the recipe
has not.
"""

import json
import sys
import tempfile
import warnings
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import numpy as np

import protocols
from stimuli.motion import Library, Motion, forward, user_library, walker, write_walker
from stimuli.render import Appearance, group_camera, render_frames
from stimuli.render.bodies import STYLES, bone_motion, make_body
from stimuli.render.pointlight import CONTROLS
from stimuli.render.staging import CAMERAS
from stimuli.sets.group import PlannedGroup, plan_groups
from stimuli.sets.naming import RECIPE, digest
from stimuli.transition import PAIRWISE, SPECIFICATIONS, transition, with_room
from study.protocol.sets import set_spec
from study.trials.reading import load_protocol
from tests.conftest import SHARED

KEPT = Path(__file__).with_suffix(".json")
SAME = 1e-6  # by which figures of positions, lengths and angles may differ on another processor
SHADES = 1.0  # of 255, by which the mean of a part of a figure may, on another rasteriser
BANDS = 6


def figure(values: np.ndarray) -> float:
    """One number for many: their sum with weights that never repeat, so that every one tells."""
    flat = np.asarray(values, dtype=float).ravel()
    return float(flat @ np.cos(1.0 + 0.7548776662 * np.arange(len(flat)) ** 1.5) / len(flat) ** 0.5)


def figures() -> dict[str, float]:
    """Of joins in every way, of every style of body, and of every camera."""
    a, i = with_room(walker(0), 12)
    b, j = with_room(walker(1), 20)
    found = {}
    for method, specification, lock in (
        (m, s, lock) for m in PAIRWISE for s in SPECIFICATIONS for lock in (False, True)
    ):
        for smooth in (False, True):
            done = transition(a, b, i, j, method=method, specification=specification,
                              smooth=smooth, foot_lock=lock)  # fmt: skip
            key = f"{method}, {specification}{', smooth' * smooth}{', held' * lock}"
            found[key] = figure(positions(done.motion)[i - 20 : i + 80])
    for style in STYLES:
        skin = make_body(walker(0), Appearance(style=style)).skin
        parts = (skin.points, skin.normals, skin.weights, skin.openness)
        found[f"body {style}"] = sum(figure(part) for part in parts) + skin.faces.sum() / 1e9
    body = make_body(walker(0), Appearance(style="mannequin"))
    for kind in CAMERAS:
        look = Appearance(style="mannequin", camera=kind, width=640, height=480)
        camera = group_camera(body, [walker(0)], look, 5)
        moves = [value for move in camera.moves for value in move]
        found[f"camera {kind}"] = figure(
            np.array([*camera.position, camera.yaw, camera.elevation, *moves])
        )
    for control in CONTROLS:
        dots = make_body(walker(0), Appearance(style="point-light", control=control))
        found[f"dots {control}"] = figure(bone_motion(dots, walker(0)))
    return found


def positions(motion: Motion) -> np.ndarray:
    return forward(motion.skeleton, motion.rotations, motion.root)[0]


def shades() -> list[list[float]]:
    """Mean red, green and blue of a figure from head to foot, and its share of the picture (%)."""
    pictures = []
    for style in STYLES:
        look = Appearance(width=240, height=180, camera="fixed", ground="grid", style=style)
        picture = next(iter(render_frames(walker(0)[:3], look))).astype(float)
        shown = np.any(picture != picture[0, 0], axis=-1)
        rows = np.array_split(np.flatnonzero(shown.any(axis=1)), BANDS)
        means = [picture[band][shown[band]].mean(axis=0) for band in rows]
        pictures.append([*np.round(np.ravel(means), 1).tolist(), round(100 * shown.mean(), 1)])
    return pictures


def names(captured: bool = True) -> dict[str, str]:
    """A digest of the clips' names of each shipped protocol's sets."""
    return {
        key: digest([clip.hash for group in groups for clip in group.clips])[:24]
        for key, groups in planned(captured).items()
    }


@lru_cache(maxsize=1)
def planned(captured: bool = True) -> dict[str, list[PlannedGroup]]:
    """The groups of each shipped protocol's sets, planned, as far as there are motions.

    Those of captured motion that is not fetched only if asked for: they take as long as the rest.
    """
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        libraries = dict(_libraries(Path(folder), captured))
        return {
            f"{path.stem}, {name}": plan_groups(
                set_spec(protocol, name, libraries[name]), libraries[name]
            )
            for path in sorted(Path(protocols.__file__).parent.glob("*.toml"))
            for protocol in [load_protocol(str(path))]
            for name in protocol.file.sets
            if name in libraries
        }


def _libraries(folder: Path, captured: bool) -> Iterator[tuple[str, Library]]:
    for seed in range(3):
        write_walker(folder, seed)
    yield "generated", Library([folder])
    if list(user_library().glob("humanoid3d_walk*")):
        yield "sample", Library([user_library()])
    if captured and SHARED.is_dir():
        yield "cmu", Library([SHARED / "cmu_bvh", SHARED / "accad_male1_bvh"])


def main() -> int:
    """Write the figures anew; 1 where they have changed and the recipe has not."""
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {"recipe": 0}
    now = {"recipe": RECIPE, "figures": figures(), "shades": shades(), "names": names()}
    if kept["recipe"] == RECIPE:
        if changed := differing(kept["figures"], now["figures"]):
            print(f"{', '.join(changed)}: changed. Raise RECIPE in stimuli/sets/naming.py first.")
            return 1
        now = now | {"figures": kept["figures"], "names": kept["names"] | now["names"]}
    KEPT.write_text(json.dumps(now, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return 0


def differing(kept: dict[str, float], now: dict[str, float]) -> list[str]:
    """Which figures are not those that are kept."""
    return [
        key
        for key in kept | now
        if key not in kept or key not in now or abs(kept[key] - now[key]) > SAME
    ]


if __name__ == "__main__":
    sys.exit(main())
