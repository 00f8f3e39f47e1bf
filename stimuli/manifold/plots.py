"""An embedding as a picture: curves in three dimensions, residual variances, poses along them."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stimuli.manifold.embedding import Embedding
from stimuli.manifold.meetings import Meeting
from stimuli.motion import quaternions as quat
from stimuli.motion.kinematics import end_positions, forward, headings
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.transition.plots import save

if TYPE_CHECKING:
    from collections.abc import Sequence

CLIP_COLOURS = (
    "#1f5fa8", "#c1440e", "#2e8b57", "#8a4fa3", "#b8860b", "#3f8f9b", "#a33b57", "#5a6b2f",
)  # fmt: skip
THUMBNAILS = 10  # poses along the curves
_ROWS = 3  # of clips that have poses of their own


def draw_embedding(
    embedding: Embedding, path: Path, dimensions: int, found: "Sequence[Meeting]" = ()
) -> None:
    """The curves with the path in time, coloured by time or by clip; residual variances; poses.

    `dimensions` are marked in the curve of residual variances, `found` where curves come close.
    """
    from matplotlib.figure import Figure

    shown = min(len(embedding.motions), _ROWS)
    figure = Figure(figsize=(10.0, 5.6 + 1.5 * shown), layout="constrained")
    parts = figure.subfigures(2, 1, squeeze=False, height_ratios=(5.6, 1.5 * shown))
    above, below = parts[:, 0]
    grid = above.add_gridspec(1, 2, width_ratios=(1.9, 1.0))
    curves = above.add_subplot(grid[0], projection="3d")
    _draw_curves(curves, embedding, found)
    _draw_residual(above.add_subplot(grid[1]), embedding, dimensions)
    rows = below.subplots(shown, 1, squeeze=False)[:, 0]
    for clip, axes in enumerate(rows):
        motion = embedding.motions[clip]
        _draw_poses(axes, motion, thumbnail_frames(len(motion)), _colour(embedding, clip))
        axes.set_ylabel(embedding.names[clip], fontsize=7)
    figure.suptitle(
        f"{len(embedding.places)} frames, {embedding.neighbours} neighbours of each; "
        "numbers are frames, drawn below"
    )
    save(figure, path)


def thumbnail_frames(frames: int) -> np.ndarray:
    """The frames of a clip that are drawn as poses, evenly along it."""
    return np.unique(np.linspace(0, frames - 1, THUMBNAILS).round().astype(int))


def stick_points(motion: Motion, frame: int) -> tuple[Array, list[tuple[int, int]]]:
    """A pose seen from its left, (P, 2) metres, and the bones as pairs of those points."""
    rotations, root = motion.rotations[frame : frame + 1], motion.root[frame : frame + 1]
    positions, orientations = forward(motion.skeleton, rotations, root)
    ends = end_positions(motion.skeleton, positions, orientations)
    points = np.concatenate([positions[0], ends[0]]) - root[0] * np.array([1.0, 0.0, 1.0])
    home = quat.about("Y", -headings(motion[frame : frame + 1]))
    turned = quat.rotate(home, points)
    bones = [(j, int(p)) for j, p in enumerate(motion.skeleton.parents) if p >= 0]
    joints = len(motion.skeleton)
    bones += [(joints + n, int(p)) for n, p in enumerate(motion.skeleton.end_parents)]
    return turned[:, [2, 1]], bones


def _colour(embedding: Embedding, clip: int) -> str:
    return CLIP_COLOURS[clip % len(CLIP_COLOURS)] if len(embedding.motions) > 1 else "0.25"


def _draw_curves(axes: Any, embedding: Embedding, found: "Sequence[Meeting]") -> None:
    starts, one = embedding.starts, len(embedding.motions) == 1
    for clip, name in enumerate(embedding.names):
        at = embedding.places[starts[clip] : starts[clip + 1], :3]
        colour = _colour(embedding, clip)
        axes.plot(*at.T, color="0.6" if one else colour, lw=1.0, label=None if one else name)
        seconds = np.arange(len(at)) / embedding.motions[clip].fps
        dots = axes.scatter(*at.T, c=seconds if one else colour, s=9, depthshade=False)
        if one:
            axes.figure.colorbar(dots, ax=axes, label="seconds", shrink=0.6, pad=0.1)
        axes.plot(*at[:1].T, "^", color=colour, ms=7)
        if clip < _ROWS:
            for frame in thumbnail_frames(len(at)):
                axes.text(*at[frame], str(frame), fontsize=7, color=colour)
    pairs = np.array([_ends(embedding, m) for m in found[:8]], dtype=int).reshape(-1, 2)
    for n, pair in enumerate(embedding.places[pairs, :3]):
        label = "where clips come close" if n == 0 else None
        axes.plot(*pair.T, "o-", color="black", mfc="none", ms=8, lw=1.2, label=label)
    axes.plot([], [], "^", color="0.3", ls="", label="first frame")
    for axis, each in zip("xyz", (1, 2, 3), strict=True):
        getattr(axes, f"set_{axis}label")(f"dimension {each} (rad)", fontsize=8)
    axes.tick_params(labelsize=7)
    axes.set_aspect("equal")
    axes.legend(fontsize="x-small", loc="upper left")


def _ends(embedding: Embedding, meeting: Meeting) -> tuple[int, int]:
    starts, names = embedding.starts, embedding.names
    return (
        int(starts[names.index(meeting.from_clip)]) + meeting.i,
        int(starts[names.index(meeting.to_clip)]) + meeting.j,
    )


def _draw_residual(axes: Any, embedding: Embedding, dimensions: int) -> None:
    each = np.arange(1, len(embedding.residual) + 1)
    axes.plot(each, embedding.residual, "o-", color="black", ms=4)
    knee = embedding.knee
    axes.plot(knee, embedding.residual[knee - 1], "o", color="#c1440e", ms=9, label=f"knee: {knee}")
    if dimensions != knee:
        axes.axvline(dimensions, color="0.6", ls=":", label=f"taken: {dimensions}")
    axes.set(xlabel="dimensions", ylabel="residual variance (1 − R²)", xticks=each)
    axes.set_ylim(bottom=0)
    axes.legend(fontsize="small")
    axes.spines[["top", "right"]].set_visible(False)


def _draw_poses(axes: Any, motion: Motion, frames: np.ndarray, colour: str) -> None:
    from matplotlib.collections import LineCollection

    for n, frame in enumerate(frames):
        points, bones = stick_points(motion, int(frame))
        points = points + np.array([1.6 * n, 0.0])
        lines = [(points[a], points[b]) for a, b in bones]
        axes.add_collection(LineCollection(lines, colors=colour, lw=1.3, capstyle="round"))
        axes.text(1.6 * n, -0.12, str(frame), ha="center", va="top", fontsize=7)
    axes.set(xlim=(-1.0, 1.6 * (THUMBNAILS - 1) + 1.0), ylim=(-0.4, 2.0), xticks=[], yticks=[])
    axes.set_aspect("equal")
    axes.spines[:].set_visible(False)
