"""What the clips of a group have a figure do, and the one camera that shows all of them best.

Directions all around are tried; the camera takes the one from which the figure is largest where
it is smallest, its front rather than its back where both serve within a tenth. Sizes are told as
the standing height of the figure at its distance, so that a crouch does not count as small.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from stimuli.errors import InputError
from stimuli.motion.kinematics import headings
from stimuli.motion.skeleton import Motion
from stimuli.render.appearance import SHAPES, Appearance
from stimuli.render.bodies import Body
from stimuli.render.camera import Camera, fit_camera
from stimuli.render.pan import pan_camera
from stimuli.render.rig import moved
from stimuli.render.shapes import Floats
from stimuli.render.skin import BETWEEN
from stimuli.ties import first_least

NEAR_BLEND, ANYWHERE = 0.55, 0.45  # of the picture's height, that a figure should have at least
DIRECTIONS = 36
WITHIN = 0.9  # of the best size, that a view from a better side may have
SIDE = np.radians(40.0)  # from the heading: half from the front, where limbs hide each other least
AS_GOOD = 1e-6  # views that show a figure as large, or as much from the front, but for rounding
THINNED, LIKELY = 8, 10  # one frame in so many tells which directions may be the best
SMOOTH_SECONDS = 0.5  # SD of what a path is smoothed with
SCREEN_SHAPE = 16 / 9


@dataclass(frozen=True, eq=False)
class Staging:
    """The N distinct frames of all clips of a group, and how the group goes over the floor."""

    outlines: NDArray[np.float32]  # (N, P, 3) points of the moving skin
    roots: Floats  # (N, 3)
    frames: NDArray[np.intp]  # (N,) which clip frame each is
    near: NDArray[np.bool_]  # (N,) whether the blend mixes it, or it is within a second of that
    path: Floats  # (F, 2) x and z: the mean of all clips' roots, smoothed
    heading: float  # radians, at the transition
    stature: float  # metres, standing
    around: float = BETWEEN  # metres that the skin may reach beyond its outlines

    def thinned(self, step: int = THINNED) -> "Staging":
        """One frame in `step`, for a first look."""
        return replace(
            self, outlines=self.outlines[::step], roots=self.roots[::step],
            frames=self.frames[::step], near=self.near[::step],
        )  # fmt: skip


def stage(
    body: Body,
    motions: Sequence[Motion],
    bones: Sequence[NDArray[np.float32]],
    at: int,
    mixed: Sequence[tuple[int, int]] | None = None,
) -> Staging:
    """What the motions of a group do, which move the body's `bones` (F, B, 8) so.

    `at` is the frame of the transition, `mixed` the first and last frame that the blend mixes in
    each (the whole clip where that is not told). All have equally many frames. A frame that
    equals the first motion's counts once.
    """
    spans = mixed or [(0, len(motions[0]) - 1)] * len(motions)
    fps = round(motions[0].fps)
    outlines, roots, frames, near = [], [], [], []
    for motion, moves, (first, last) in zip(motions, bones, spans, strict=True):
        numbers = np.arange(len(motion))
        known = (moves is not bones[0]) & np.all(moves == bones[0], axis=(1, 2))
        new = np.flatnonzero(~known)
        outlines.append(outline(body, moves[new]))
        roots.append(motion.root[new])
        frames.append(new)
        near.append((numbers >= first - fps)[new] & (numbers <= last + fps)[new])
    path = smoothed(np.mean([motion.root[:, [0, 2]] for motion in motions], axis=0), fps)
    facing = float(headings(motions[0][at : at + 1])[0])
    return Staging(
        np.concatenate(outlines), np.concatenate(roots), np.concatenate(frames),
        np.concatenate(near), path, facing, body.stature, BETWEEN + _dot(body),
    )  # fmt: skip


def _dot(body: Body) -> float:
    """Metres that a dot reaches from its middle, of degrees where the figure fills the picture."""
    look = body.look
    if body.skin.lit:
        return 0.0
    whole = 1.0 if look.dot_unit == "metres" else body.stature / look.picture_degrees
    return look.dot_size / 2 * whole


def outline(body: Body, bones: NDArray[np.float32]) -> NDArray[np.float32]:
    """(F, P, 3) points of the skin, moved by bones (F, B, 8), that tell how far it reaches."""
    skin = body.skin
    weights, points, normals = (
        a[skin.outermost] for a in (skin.weights, skin.points, skin.normals)
    )
    places = [moved(weights, moves, points, normals)[0] for moves in bones]
    return np.array(places, dtype=np.float32).reshape(len(bones), len(points), 3)


def smoothed(path: Floats, fps: int) -> Floats:
    """A path (F, n) without its steps; it goes on at both ends as it goes there."""
    sd = SMOOTH_SECONDS * fps
    reach = min(int(3 * sd), len(path) - 1)
    longer = np.pad(path, ((reach, reach), (0, 0)), mode="reflect", reflect_type="odd")
    smooth = gaussian_filter1d(longer, sd, axis=0, mode="nearest", truncate=3.0)
    return np.asarray(smooth[reach : reach + len(path)])


def camera_fixed(staging: Staging, yaw: float, look: Appearance) -> Camera:
    """It stands still and holds everything."""
    return fit_camera(staging.outlines, yaw, look, staging.around)


def camera_pan(staging: Staging, yaw: float, look: Appearance) -> Camera:
    """It stands, and turns after the group's mean smoothed path."""
    return pan_camera(staging.outlines, staging.frames, staging.path, yaw, look, staging.around)


def camera_follow(staging: Staging, yaw: float, look: Appearance) -> Camera:
    """It goes along the group's mean smoothed path, the same for every clip of the group."""
    x, z = staging.path.T
    along = np.stack([x, np.zeros_like(x), z], axis=-1).astype(np.float32)
    beside = staging.outlines - along[staging.frames][:, None]
    camera = fit_camera(beside, yaw, look, staging.around)
    moves = tuple((round(float(a), 5), round(float(b), 5), 0.0) for a, b in staging.path)
    return replace(camera, kind="follow", moves=moves)


CAMERAS: Mapping[str, Callable[[Staging, float, Appearance], Camera]] = {
    "fixed": camera_fixed,
    "pan": camera_pan,
    "follow": camera_follow,
}


@dataclass(frozen=True)
class Sizes:
    """Shares of the picture's height, and where in it the figure stands on average (0 the top)."""

    near_blend: float
    anywhere: float
    middle: float

    @property
    def enough(self) -> float:
        """1 or more where the figure is as large as it should be."""
        return min(self.near_blend / NEAR_BLEND, self.anywhere / ANYWHERE)


def sizes(camera: Camera, staging: Staging) -> Sizes:
    """How large and how high a camera shows what a group does."""
    share = camera.size_of(staging.stature, staging.roots, staging.frames)
    seen = camera.seen(staging.outlines, staging.frames)
    high = seen[..., 1] / (-2 * seen[..., 2] * np.tan(camera.field_of_view / 2))
    middle = 0.5 - float(np.mean(high.max(axis=-1) + high.min(axis=-1)) / 2)
    near = share[staging.near] if staging.near.any() else share
    return Sizes(float(near.min()), float(share.min()), middle)


def choose_camera(staging: Staging, look: Appearance) -> Camera:
    """The camera of a settled look, in the best direction unless the look has one.

    InputError for a camera that is not in the table.
    """
    if look.camera not in CAMERAS:
        raise InputError(f"camera: expected {', '.join(CAMERAS)} or auto; found {look.camera!r}.")
    make = CAMERAS[look.camera]
    if look.direction is not None:
        return make(staging, staging.heading + np.radians(look.direction), look)
    angles = np.radians(np.arange(DIRECTIONS) * 360 / DIRECTIONS)
    rough = _shown(staging.thinned(), look, angles)
    likely = angles[np.sort(np.argsort(-rough, kind="stable")[:LIKELY])]
    shown = _shown(staging, look, likely)
    best = shown.max()
    least = max(WITHIN * best, 1.0) if best >= 1 else WITHIN * best
    turned = np.abs(np.abs(np.arctan2(np.sin(likely), np.cos(likely))) - SIDE)
    chosen = likely[first_least(np.where(shown >= least, turned, np.inf), AS_GOOD)]
    return make(staging, staging.heading + float(chosen), look)


def _shown(staging: Staging, look: Appearance, angles: Floats) -> Floats:
    """(N,) how far the figure is as large as it should be, seen from each direction (N,)."""
    make = CAMERAS[look.camera]
    cameras = [make(staging, staging.heading + float(angle), look) for angle in angles]
    return np.array([sizes(camera, staging).enough for camera in cameras])


@dataclass(frozen=True, eq=False)
class Settled:
    """A look with its camera and size chosen, the camera of each group, and what is to be said."""

    look: Appearance
    cameras: tuple[Camera, ...]
    remarks: tuple[str, ...] = ()


def settle(look: Appearance, stagings: Sequence[Staging], beside: int = 1) -> Settled:
    """One choice for all groups of a study whose trials show `beside` clips side by side.

    `auto` takes `fixed` where the figure is as large as it should be, else `follow`, with a
    grid where no ground was asked for, since nothing else would show its way over the floor.
    """
    if look.camera != "auto":
        return _shaped(look, stagings, beside)
    found = _shaped(replace(look, camera="fixed"), stagings, beside)
    least = _least(found, stagings)
    if least.enough >= 1:
        return found
    ground = "grid" if look.ground == "none" else look.ground
    followed = _shaped(replace(look, camera="follow", ground=ground), stagings, beside)
    said = (
        f"camera auto: follow, with the ground {ground}: standing still, it would show the figure "
        f"down to {least.near_blend:.2f} of the picture's height near the blend and "
        f"{least.anywhere:.2f} elsewhere"
    )
    return replace(followed, remarks=(said,))


def _shaped(look: Appearance, stagings: Sequence[Staging], beside: int) -> Settled:
    """The shape in which the figure is large enough and, on a screen, largest."""
    tried = [
        Settled(shaped, tuple(choose_camera(staging, shaped) for staging in stagings))
        for shaped in _shapes(look)
    ]

    def worth(settled: Settled) -> float:
        least = _least(settled, stagings)
        shape = settled.look.width / settled.look.height
        on_screen = min(1.0, SCREEN_SHAPE / beside / shape) * least.enough
        return on_screen if least.enough >= 1 else least.enough - 1

    if len(tried) == 1:
        return tried[0]
    return tried[first_least([-worth(settled) for settled in tried], AS_GOOD)]


def _shapes(look: Appearance) -> Iterator[Appearance]:
    if look.shape != "best" and look.shape not in SHAPES:
        raise InputError(f"shape: expected {', '.join(SHAPES)} or best; found {look.shape!r}.")
    if look.width or look.shape != "best":
        yield look.shaped(look.shape)
        return
    for shape in SHAPES:
        yield look.shaped(shape)


def _least(settled: Settled, stagings: Sequence[Staging]) -> Sizes:
    """The group that is shown smallest."""
    shown = [sizes(c, s) for c, s in zip(settled.cameras, stagings, strict=True)]
    return min(shown, key=lambda size: size.enough)
