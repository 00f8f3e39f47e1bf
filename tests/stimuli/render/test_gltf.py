"""Figures as glTF: what Khronos' validator says of them, and whether they move as ours do."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from platformdirs import user_cache_path

from stimuli.motion import Motion, forward, walker
from stimuli.motion import quaternions as quat
from stimuli.render import Appearance
from stimuli.render.bodies import Body, bone_motion, make_body
from stimuli.render.gltf import influences, joint_tracks, write_glb
from stimuli.render.rig import moved

VALIDATOR = "gltf-validator@2.0.0-dev.3.10"
ASK = """
const validator = require("gltf-validator"), fs = require("fs");
const bytes = new Uint8Array(fs.readFileSync(process.argv[2]));
validator.validateBytes(bytes).then((told) => console.log(JSON.stringify(told)));
"""


@pytest.fixture(scope="module")
def walk() -> Motion:
    return walker(0)


@pytest.fixture(scope="module", params=["figure", "mannequin"])
def body(walk: Motion, request: pytest.FixtureRequest) -> Body:
    return make_body(walk, Appearance(style=request.param))


@pytest.fixture(scope="module")
def validator() -> Path:
    """Khronos' validator, installed once into the user's cache."""
    npm = shutil.which("npm")
    if npm is None or shutil.which("node") is None:
        pytest.skip("no node and npm, in which Khronos' glTF validator runs")
    folder = user_cache_path("segue-tests") / VALIDATOR
    if not (folder / "node_modules/gltf-validator").is_dir():
        folder.mkdir(parents=True, exist_ok=True)
        done = subprocess.run(
            [npm, "install", "--silent", "--no-fund", "--prefix", str(folder), VALIDATOR],
            capture_output=True, text=True, timeout=120,
        )  # fmt: skip
        if done.returncode:
            pytest.skip("Khronos' glTF validator cannot be fetched from npm")
    (folder / "ask.js").write_text(ASK)
    return folder / "ask.js"


def judged(validator: Path, path: Path) -> dict[str, Any]:
    done = subprocess.run(
        ["node", str(validator), str(path)], capture_output=True, text=True, check=True
    )
    return dict(json.loads(done.stdout))


def test_khronos_finds_no_error_and_no_warning(
    walk: Motion, body: Body, validator: Path, tmp_path: Path
) -> None:
    path = tmp_path / "walk.glb"
    write_glb(path, body, bone_motion(body, walk), walk.fps, (0.8, 0.76, 0.72))
    told = judged(validator, path)
    assert told["issues"]["messages"] == []
    assert told["info"]["totalTriangleCount"] == len(body.skin.faces)
    assert (told["info"]["hasSkins"], told["info"]["animationCount"]) == (True, 1)


def test_the_validator_is_one_that_finds_faults(
    walk: Motion, body: Body, validator: Path, tmp_path: Path
) -> None:
    path = tmp_path / "walk.glb"
    write_glb(path, body, bone_motion(body, walk) * 1.01, walk.fps, (0.8, 0.76, 0.72))
    assert judged(validator, path)["issues"]["numErrors"] > 0


def test_bones_go_where_the_joints_go(walk: Motion, body: Body) -> None:
    rotations, places = joint_tracks(body.rig, bone_motion(body, walk).astype(np.float64))
    turned, stood = rotations.copy(), places.copy()
    for bone, parent in enumerate(body.rig.parents):
        if parent >= 0:
            turned[:, bone] = quat.multiply(turned[:, parent], rotations[:, bone])
            stood[:, bone] = stood[:, parent] + quat.rotate(turned[:, parent], places[:, bone])
    joints, _ = forward(walk.skeleton, walk.rotations, walk.root)
    np.testing.assert_allclose(stood, joints[:, body.rig.joints], atol=1e-5)
    assert (np.einsum("fbi,fbi->fb", rotations[1:], rotations[:-1]) > 0.5).all()


def test_a_skin_moves_as_ours_but_where_limbs_twist(
    walk: Motion, body: Body, tmp_path: Path
) -> None:
    """Read back with pygltflib and skinned by hand, as the specification says."""
    from pygltflib import GLTF2

    path = tmp_path / "walk.glb"
    bones = bone_motion(body, walk)
    write_glb(path, body, bones, walk.fps, (0.8, 0.76, 0.72))
    document = GLTF2().load(str(path))
    frame = 11
    worlds = _worlds(document, frame)
    primitive = document.meshes[0].primitives[0].attributes
    points, joints, weights = (
        _values(document, place)
        for place in (primitive.POSITION, primitive.JOINTS_0, primitive.WEIGHTS_0)
    )
    unbound = _values(document, document.skins[0].inverseBindMatrices).reshape(-1, 4, 4)
    matrices = worlds @ unbound.transpose(0, 2, 1)
    whole = np.concatenate([points, np.ones((len(points), 1))], axis=1)
    each = np.einsum("vjab,vb->vja", matrices[joints.astype(int)], whole)
    shown = (weights[..., None] * each).sum(axis=1)[:, :3]
    ours, _ = moved(body.skin.weights, bones[frame], body.skin.points, body.skin.normals)
    apart = np.linalg.norm(shown - ours, axis=1)
    assert np.median(apart) < 1e-3
    assert apart.max() < 0.03
    assert apart[body.skin.weights.max(axis=1) > 0.999].max() < 2e-3


def test_shares_of_four_bones_sum_to_one_and_idle_bones_are_the_first() -> None:
    weights = np.array([[0.1, 0.2, 0.3, 0.25, 0.15], [0, 0, 1.0, 0, 0]], dtype=np.float32)
    joints, shares = influences(weights)
    assert joints.tolist() == [[2, 3, 1, 4], [2, 0, 0, 0]]
    np.testing.assert_allclose(shares.sum(axis=1), 1, atol=1e-6)


def _values(document: Any, place: int) -> np.ndarray:
    accessor = document.accessors[place]
    view = document.bufferViews[accessor.bufferView]
    kinds = {5126: np.float32, 5121: np.uint8, 5125: np.uint32}
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor.type]
    data = document.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    return np.frombuffer(data, kinds[accessor.componentType]).reshape(-1, width)


def _worlds(document: Any, frame: int) -> np.ndarray:
    """(B, 4, 4) of every node in a frame of the animation."""
    animation = document.animations[0]
    local = {n: (np.eye(3), np.array(node.translation or (0, 0, 0)))
             for n, node in enumerate(document.nodes)}  # fmt: skip
    for channel in animation.channels:
        value = _values(document, animation.samplers[channel.sampler].output)[frame].astype(float)
        turn, shift = local[channel.target.node]
        if channel.target.path == "rotation":
            turn = quat.rotate(np.roll(value, 1), np.eye(3)).T
        else:
            shift = value
        local[channel.target.node] = (turn, shift)
    worlds = np.zeros((len(document.skins[0].joints), 4, 4))

    def place(node: int, above: np.ndarray) -> None:
        turn, shift = local[node]
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = turn, shift
        worlds[node] = above @ matrix
        for child in document.nodes[node].children:
            place(child, worlds[node])

    place(0, np.eye(4))
    return worlds
