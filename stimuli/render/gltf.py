"""A moving figure as glTF 2.0: its skin, the bones that carry it, and their motion.

What people open in Blender or three.js, and put their own characters to. Bones have the names of
`rig`; a helper that takes half of a twist is a bone of its own. glTF blends matrices where Segue
blends dual quaternions, so that strongly twisted limbs are a little thinner there.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.errors import InputError
from stimuli.files import write_atomic
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array
from stimuli.render.bodies import Body
from stimuli.render.rig import Rig
from stimuli.render.shapes import Floats
from stimuli.render.skin import Skin

MOST_CARRIERS = 4  # bones a vertex, as many as every program reads
MOVES = 1e-5  # metres: a bone that moves less within its parent has no track for it
FLOAT, BYTE, INDEX = 5126, 5121, 5125  # glTF's numbers of component types
VERTICES, TRIANGLES = 34962, 34963  # and of what a view is for
GAMMA_OF_SRGB = 2.2


def write_glb(
    path: Path,
    body: Body,
    bones: NDArray[np.float32],
    fps: float,
    colour: tuple[float, float, float],
) -> None:
    """Write a body and the motion of its bones (F, B, 8) as one binary file, whole or not at all.

    `colour` is what a screen shows, 0..1. InputError where pygltflib is not installed,
    UnwritableError where the file cannot be written.
    """
    try:
        import pygltflib as gltf
    except ImportError as error:
        raise InputError(
            f"{path}: expected pygltflib, found it is not installed.\n"
            "Install it with `pip install 'segue[gltf]'`."
        ) from error
    if body.skin.weights.shape[1] != len(body.rig.names):
        raise InputError(
            f"{path}: expected a style whose body has a skin, found {body.look.style}.\n"
            "Take the style figure, mannequin or stick for glTF."
        )
    rotations, places = joint_tracks(body.rig, bones.astype(np.float64))
    written = _Written(gltf)
    mesh = _mesh(gltf, written, body.skin)
    joints = list(range(len(body.rig.names)))
    rest = _at_rest(body.rig)
    document = gltf.GLTF2(
        asset=gltf.Asset(version="2.0", generator="Segue"),
        scene=0,
        scenes=[gltf.Scene(nodes=[0, len(joints)])],
        nodes=[*_nodes(gltf, body.rig, rest), gltf.Node(name="figure", mesh=0, skin=0)],
        meshes=[mesh],
        skins=[gltf.Skin(joints=joints, inverseBindMatrices=_unbinding(written, body.rig))],
        animations=[_animation(gltf, written, rotations, places, rest, fps)],
        materials=[_material(gltf, colour)],
        accessors=written.accessors,
        bufferViews=written.views,
        buffers=[gltf.Buffer(byteLength=len(written.content))],
    )
    document.set_binary_blob(bytes(written.content))
    write_atomic(path, b"".join(document.save_to_bytes()))


def joint_tracks(rig: Rig, bones: Array) -> tuple[Array, Array]:
    """(F, B, 4) rotations (w, x, y, z) and (F, B, 3) places of bones within their parents."""
    turned, dual = bones[..., :4], bones[..., 4:]
    shift = 2 * quat.multiply(dual, quat.inverse(turned))[..., 1:]
    world = quat.rotate(turned, rig.reference.positions[rig.joints]) + shift
    rotations, places = turned.copy(), world.copy()
    for bone, parent in enumerate(rig.parents):
        if parent >= 0:
            back = quat.inverse(turned[:, parent])
            rotations[:, bone] = quat.multiply(back, turned[:, bone])
            places[:, bone] = quat.rotate(back, world[:, bone] - world[:, parent])
    same = np.einsum("fbi,fbi->fb", rotations[1:], rotations[:-1]) >= 0
    signs = np.cumprod(np.where(same, 1.0, -1.0), axis=0)
    rotations[1:] *= signs[..., None]
    return rotations, places


@dataclass
class _Written:
    """The binary part as it grows, and what is said of each stretch of it."""

    gltf: Any
    content: bytearray = field(default_factory=bytearray)
    views: list[Any] = field(default_factory=list)
    accessors: list[Any] = field(default_factory=list)

    def add(
        self, values: NDArray[Any], kind: str, component: int, target: int | None = None,
        bounds: bool = False,
    ) -> int:  # fmt: skip
        """The accessor of values (n,) or (n, width)."""
        data = np.ascontiguousarray(values).tobytes()
        view = self.gltf.BufferView(
            buffer=0, byteOffset=len(self.content), byteLength=len(data), target=target
        )
        rows = values.reshape(len(values), -1)
        self.accessors.append(
            self.gltf.Accessor(
                bufferView=len(self.views),
                componentType=component,
                count=len(values),
                type=kind,
                min=rows.min(axis=0).tolist() if bounds else None,
                max=rows.max(axis=0).tolist() if bounds else None,
            )
        )
        self.views.append(view)
        self.content += data + bytes(-len(data) % 4)
        return len(self.accessors) - 1


def _mesh(gltf: Any, written: _Written, skin: Skin) -> Any:
    joints, weights = influences(skin.weights)
    attributes = gltf.Attributes(
        POSITION=written.add(skin.points, "VEC3", FLOAT, VERTICES, bounds=True),
        NORMAL=written.add(_unit(skin.normals), "VEC3", FLOAT, VERTICES),
        JOINTS_0=written.add(joints, "VEC4", BYTE, VERTICES),
        WEIGHTS_0=written.add(weights, "VEC4", FLOAT, VERTICES),
    )
    faces = written.add(skin.faces.astype(np.uint32).ravel(), "SCALAR", INDEX, TRIANGLES)
    return gltf.Mesh(
        name="figure",
        primitives=[gltf.Primitive(attributes=attributes, indices=faces, material=0)],
    )


def influences(weights: Floats) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """(V, 4) the bones that carry each point most, and their shares, which sum to one."""
    strongest = np.argsort(-weights, axis=1, kind="stable")[:, :MOST_CARRIERS]
    shares = np.take_along_axis(weights.astype(float), strongest, axis=1)
    shares /= shares.sum(axis=1, keepdims=True)
    return np.where(shares > 0, strongest, 0).astype(np.uint8), shares.astype(np.float32)


def _unit(normals: Floats) -> NDArray[np.float32]:
    exact = normals.astype(float)
    return (exact / np.linalg.norm(exact, axis=1, keepdims=True)).astype(np.float32)


def _at_rest(rig: Rig) -> Floats:
    """(B, 3) places of bones within their parents in the reference pose."""
    places = rig.reference.positions[rig.joints]
    return np.array(
        [
            place - places[parent] if parent >= 0 else place
            for place, parent in zip(places, rig.parents, strict=True)
        ]
    )


def _nodes(gltf: Any, rig: Rig, rest: Floats) -> list[Any]:
    children = [[int(n) for n in np.flatnonzero(rig.parents == bone)] for bone in range(len(rest))]
    return [
        gltf.Node(name=name, translation=place.tolist(), children=below)
        for name, place, below in zip(rig.names, rest, children, strict=True)
    ]


def _unbinding(written: _Written, rig: Rig) -> int:
    """The accessor of what takes each bone's place in the reference pose to the origin."""
    matrices = np.tile(np.eye(4, dtype=np.float32), (len(rig.names), 1, 1))
    matrices[:, 3, :3] = -rig.reference.positions[rig.joints]  # columns first
    return written.add(matrices.reshape(-1, 16), "MAT4", FLOAT)


def _animation(
    gltf: Any, written: _Written, rotations: Floats, places: Floats, rest: Floats, fps: float
) -> Any:
    times = (np.arange(len(rotations)) / fps).astype(np.float32)
    at = written.add(times, "SCALAR", FLOAT, bounds=True)
    samplers: list[Any] = []
    channels: list[Any] = []

    def track(bone: int, path: str, values: Floats, kind: str) -> None:
        values_at = written.add(values.astype(np.float32), kind, FLOAT)
        target = gltf.AnimationChannelTarget(node=bone, path=path)
        channels.append(gltf.AnimationChannel(sampler=len(samplers), target=target))
        samplers.append(gltf.AnimationSampler(input=at, output=values_at, interpolation="LINEAR"))

    for bone in range(rotations.shape[1]):
        track(bone, "rotation", np.roll(rotations[:, bone], -1, axis=-1), "VEC4")
        if np.abs(places[:, bone] - rest[bone]).max() > MOVES:
            track(bone, "translation", places[:, bone], "VEC3")
    return gltf.Animation(name="motion", samplers=samplers, channels=channels)


def _material(gltf: Any, colour: tuple[float, float, float]) -> Any:
    shade = [round(float(channel) ** GAMMA_OF_SRGB, 6) for channel in colour]
    plain = gltf.PbrMetallicRoughness(
        baseColorFactor=[*shade, 1.0], metallicFactor=0.0, roughnessFactor=0.8
    )
    return gltf.Material(name="skin", pbrMetallicRoughness=plain, alphaCutoff=None)
