"""Pictures of costs and lengths, drawn without a display."""

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stimuli.files import write_atomic
from stimuli.motion.quaternions import Array
from stimuli.motion.skeleton import Motion
from stimuli.ties import first_least
from stimuli.transition.curves import joint_curves
from stimuli.transition.length import geodesic_costs
from stimuli.transition.points import TransitionPoint

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES = (".png", ".svg", ".pdf", ".jpg")  # suffixes of files that can be drawn
SLIMMEST = 0.4  # of a matrix's sides, as it is drawn
MARKED = 10  # of the minima, the cheapest are marked larger
_LEFT, _RIGHT = "#c1440e", "#1f5fa8"
_LOOKS = {"hip": ("-", "o"), "knee": ("--", "s"), "shoulder": ("-.", "^"), "elbow": (":", "v")}


def draw_lengths(
    a: Motion, b: Motion, i: int, j: int, specification: str, path: Path, title: str = ""
) -> None:
    """The cost against blend length as in Fig. V.2, and each joint's as in Fig. V.6."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 6.4), layout="constrained")
    whole, each = figure.subplots(2, 1, sharex=True)
    costs = geodesic_costs(a, b, i, j, specification)
    frames = np.arange(1, len(costs) + 1)
    best = first_least(costs)
    whole.plot(frames, costs, color="black")
    # a legend finds room inside the panel wherever the optimum lies
    told = _optimum(best + 1, a.fps)
    whole.plot(best + 1, costs[best], "o", color=_LEFT, label=told, clip_on=False)
    longest = int(np.flatnonzero(np.isfinite(costs)).max()) + 1
    if longest < len(costs):
        for axes, label in ((whole, None), (each, f"no room: the clips allow {longest}")):
            axes.axvspan(longest + 0.5, len(costs) + 1, color="0.9", lw=0, label=label, zorder=0)
    whole.legend(fontsize="small")
    whole.set_ylabel("mean weighted distance (rad²)")
    whole.set_title(title or f"Cost of a {specification} blend from frame {i} to frame {j}")
    for role, curve in joint_curves(a, b, i, j, specification).items():
        side, _, limb = role.partition("_")
        dash, mark = _LOOKS[limb]
        each.plot(
            frames, curve, ls=dash, marker=mark, ms=4, markevery=[first_least(curve)],
            color=_LEFT if side == "left" else _RIGHT, label=role, clip_on=False,
        )  # fmt: skip
    each.set_ylabel("mean distance of each joint (rad²)")
    each.set_xlabel("blend length (frames)")
    marks = "a marker is a joint's minimum"
    each.legend(fontsize="small", ncols=2, title=marks, title_fontsize="small")
    each.set_xlim(0, len(costs) + 1)
    for axes in (whole, each):
        axes.set_ylim(bottom=0)
        axes.spines[["top", "right"]].set_visible(False)
    save(figure, path)


def _optimum(frames: int, fps: float) -> str:
    return f"least at {frames} frame{'s' if frames > 1 else ''}, {frames / fps:.2f} s"


def draw_cost(
    cost: Array, minima: Sequence[TransitionPoint], names: tuple[str, str], path: Path
) -> None:
    """The cost matrix as in Fig. IV.1, darker is cheaper, with its local minima marked."""
    from matplotlib.figure import Figure

    tall = float(np.clip(cost.shape[0] / cost.shape[1], SLIMMEST, 1 / SLIMMEST))
    size = (5.0 * min(1 / tall, 1) + 1.4, 5.0 * min(tall, 1) + 0.8)
    figure = Figure(figsize=size, layout="compressed")
    axes = figure.subplots()
    axes.set_box_aspect(tall)
    picture = axes.imshow(cost, cmap="gray", interpolation="nearest", aspect="auto")
    figure.colorbar(picture, ax=axes, label="cost (darker is cheaper)")
    # a point on the edge is whole, and the edges stay where they are
    shown: dict[str, Any] = {
        "color": "#ff9d5c",
        "ls": "",
        "clip_on": False,
        "scalex": False,
        "scaley": False,
    }
    if minima:
        axes.plot(*_places(minima), marker=".", ms=2.5, label="local minimum", **shown)
        cheap = minima[:MARKED]
        told = f"the {len(cheap)} cheapest" if len(cheap) > 1 else "the only one"
        axes.plot(*_places(cheap), marker="+", ms=8, label=told, **shown)
        ring = {"mfc": "none", "mec": _LEFT, "ms": 11, "mew": 1.6, "label": "the best"}
        axes.plot(*_places(minima[:1]), marker="o", **shown | ring)
        figure.legend(loc="outside lower center", ncols=3, fontsize="small", facecolor="0.75")
    axes.set_xlabel(f"{names[1]}: frame (30 a second)")
    axes.set_ylabel(f"{names[0]}: frame (30 a second)")
    figure.suptitle(f"Cost, least {minima[0].cost:.4g}" if minima else "Cost of a transition")
    save(figure, path)


def _places(points: Sequence[TransitionPoint]) -> tuple[list[int], list[int]]:
    """Columns and rows of points in a matrix."""
    return [p.j for p in points], [p.i for p in points]


def save(figure: "Figure", path: Path) -> None:
    """Write a figure whole or not at all, in the format of its suffix, one of PICTURES."""
    buffer = BytesIO()
    figure.savefig(buffer, format=path.suffix.lower().lstrip("."), dpi=150)
    write_atomic(path, buffer.getvalue())
