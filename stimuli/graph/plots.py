"""Pictures of a graph and of a plan, drawn without a display."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stimuli.collection import Collection
from stimuli.graph.graph import MotionGraph
from stimuli.graph.plan import MotionPlan
from stimuli.transition.plots import save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#1f5fa8", "#c1440e", "#2e8b57", "#8a4fa3", "#b8860b", "#3f8f9b", "#a33b57", "#5a6b2f")
ARROW = 0.35  # metres
_EVERY = 15  # frames between two headings
MOST_NAMED = 30  # clips whose names fit around a circle


def draw_plan(plans: list[MotionPlan], collection: Collection, path: Path, title: str) -> None:
    """The floor from above: the way and its headings, demands, obstacles, pieces in colours."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.4, 6.4), layout="constrained")
    axes = figure.subplots()
    for plan in plans:
        _obstacles(axes, plan)
        _way(axes, plan, collection)
        _demands(axes, plan)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.12)
    axes.invert_xaxis()  # a figure that faces up the page, +Z, has its left, +X, on the left
    axes.set_xlabel("x (m)")
    axes.set_ylabel("z (m)")
    axes.grid(color="0.92", lw=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_title(title, fontsize="medium")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize="x-small", frameon=False)
    save(figure, path)


def _way(axes: "Axes", plan: MotionPlan, collection: Collection) -> None:
    first = 0
    for n, piece in enumerate(plan.pieces):
        colour = COLOURS[n % len(COLOURS)]
        part = slice(max(first - 1, 0), first + len(piece))
        name = f"{n + 1}  {collection.names[piece.clip]} {piece.first}–{piece.last}"
        told = f"{plan.demands.name} {name}".strip()
        axes.plot(*plan.place[part].T, color=colour, lw=2.2, label=told, solid_capstyle="butt")
        middle = plan.place[first + len(piece) // 2]
        axes.annotate(
            str(n + 1), middle, color=colour, fontsize="small", xytext=(4, 4),
            textcoords="offset points", zorder=6,
        )  # fmt: skip
        first += len(piece)
        if n + 1 < len(plan.pieces):
            axes.plot(*plan.place[first - 1], "o", color="white", mec="0.3", ms=4, zorder=5)
    some = np.arange(0, plan.frames, _EVERY)
    ahead = 0.6 * ARROW * np.stack([np.sin(plan.yaw[some]), np.cos(plan.yaw[some])], axis=1)
    axes.quiver(
        *plan.place[some].T, *ahead.T, angles="xy", scale_units="xy", scale=1, width=0.0022,
        color="0.45", zorder=3,
    )  # fmt: skip


def _demands(axes: "Axes", plan: MotionPlan) -> None:
    for n, body in enumerate(plan.demands.of("body")):
        yaw = np.radians(body["heading"])
        x, z = body["place"]
        ahead = (x + ARROW * np.sin(yaw), z + ARROW * np.cos(yaw))
        axes.annotate(
            "", ahead, (x, z), arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1.8},
            zorder=7,
        )  # fmt: skip
        label = "body demanded" if n == 0 else None
        axes.plot(x, z, "o", color="black", ms=6, zorder=7, label=label)
        axes.annotate(
            f"at {body['at']}", (x, z), xytext=(6, -11), textcoords="offset points",
            fontsize="x-small",
        )  # fmt: skip
        if body["at"] < plan.frames:
            there = plan.place[body["at"]]
            axes.plot([x, there[0]], [z, there[1]], ls=":", color="black", lw=1.0, zorder=4)
    for joint in plan.demands.of("joint"):
        x, _, z = joint["place"]
        axes.plot(x, z, "^", color="#c1440e", mec="black", ms=7, zorder=7)
        axes.annotate(
            f"{joint['role']} at {joint['at']}", (x, z), xytext=(6, 5),
            textcoords="offset points", fontsize="x-small",
        )  # fmt: skip


def _obstacles(axes: "Axes", plan: MotionPlan) -> None:
    from matplotlib.patches import Circle, Patch, Rectangle

    for n, place in enumerate(plan.demands.of("avoid")):
        look: dict[str, Any] = {"facecolor": "0.85", "edgecolor": "0.4", "hatch": "///", "lw": 0.8,
                                "zorder": 1, "label": "to avoid" if n == 0 else None}  # fmt: skip
        patch: Patch
        if place["centre"]:
            patch = Circle(place["centre"], place["radius"], **look)
        else:
            low, high = np.array(place["low"])[[0, -1]], np.array(place["high"])[[0, -1]]
            patch = Rectangle(tuple(low), *(high - low), **look)
        axes.add_patch(patch)


def draw_graph(graph: MotionGraph, path: Path, pair: tuple[int, int] | None = None) -> None:
    """Clips as nodes around a circle, and the edges of one pair with their clusters, as Fig. 2."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 6.2), layout="constrained")
    nodes, matrix = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
    _circle(nodes, graph)
    _clusters(matrix, graph, largest_pair(graph) if pair is None else pair)
    save(figure, path)


def largest_pair(graph: MotionGraph) -> tuple[int, int]:
    """The two clips with most edges from the one to the other."""
    cuts = graph.cuts
    other = cuts.from_clip != cuts.to_clip
    chosen = other if other.any() else ~other
    keys = cuts.from_clip[chosen].astype(np.int64) * len(graph.names) + cuts.to_clip[chosen]
    most = int(np.argmax(np.bincount(keys)))
    return divmod(most, len(graph.names))


def _circle(axes: "Axes", graph: MotionGraph) -> None:
    from matplotlib.collections import LineCollection

    count = len(graph.names)
    order = np.argsort(graph.parts, kind="stable")
    angle = np.empty(count)
    angle[order] = np.pi / 2 - 2 * np.pi * np.arange(count) / count
    at = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    pairs = np.argwhere(graph.joined)
    lines = [(at[s], at[t]) for s, t in pairs if s != t]
    axes.add_collection(LineCollection(lines, colors="0.6", lw=0.25, alpha=0.5))
    inside = graph.parts == 0
    for chosen, colour, told in (
        (inside, COLOURS[0], "largest strongly connected part"),
        (~inside, COLOURS[1], "outside it"),
    ):
        if chosen.any():
            label = f"{told}: {int(chosen.sum())} clips"
            sizes = 8 + graph.frames[chosen] / 8
            axes.scatter(at[chosen, 0], at[chosen, 1], sizes, color=colour, label=label, zorder=3)
    small = "x-small" if count <= MOST_NAMED else 4.6
    for clip, name in enumerate(graph.names):
        left = np.cos(angle[clip]) < 0
        turn = np.degrees(angle[clip]) + (180 if left else 0)
        axes.annotate(
            name, 1.05 * at[clip], rotation=turn, rotation_mode="anchor", fontsize=small,
            ha="right" if left else "left", va="center",
        )  # fmt: skip
    axes.set(xlim=(-1.75, 1.75), ylim=(-1.75, 1.75))
    axes.set_aspect("equal")
    axes.axis("off")
    axes.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=2, fontsize="small", frameon=False
    )
    axes.set_title(f"{count} clips, {len(graph.cuts):,} edges at τ = {graph.tau:g}")


def _clusters(axes: "Axes", graph: MotionGraph, pair: tuple[int, int]) -> None:
    """Edges of one pair in the colours of their clusters, whose centres are marked."""
    here = (graph.root_from == pair[0]) & (graph.root_to == pair[1])
    ends = np.append(graph.roots[1:], len(graph.right))
    names = graph.names[pair[0]], graph.names[pair[1]]
    for n, root in enumerate(np.flatnonzero(here)):
        nodes = np.arange(graph.roots[root], ends[root])
        leaves = nodes[graph.right[nodes] == 0]
        colour = COLOURS[n % len(COLOURS)]
        axes.scatter(
            graph.labels[leaves, 1], graph.labels[leaves, 0], s=3, color=colour, marker="s", lw=0
        )
    centres = graph.labels[graph.roots[here]]
    axes.plot(centres[:, 1], centres[:, 0], "k+", ms=5, label="cluster, an edge of G′")
    for clip, span in ((pair[0], axes.axhspan), (pair[1], axes.axvspan)):
        span(graph.exits[clip] + 0.5, graph.frames[clip], color="0.9", zorder=0)
    axes.fill([], [], color="0.9", label="leads nowhere")
    axes.set_xlabel(f"{names[1]}: frame entered after")
    axes.set_ylabel(f"{names[0]}: frame left at")
    axes.set_xlim(-1, graph.frames[pair[1]])
    axes.set_ylim(graph.frames[pair[0]], -1)
    axes.set_title(f"edges from {names[0]} to {names[1]}", fontsize="medium")
    axes.legend(
        loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2, fontsize="small", frameon=False
    )


def draw_reach(place: np.ndarray, yaw: np.ndarray, seconds: float, path: Path) -> None:
    """Where the body gets within a time, and in which headings, from the origin (Reitsma 2004)."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    floor, compass = figure.subplots(1, 2, width_ratios=(1.3, 1.0))
    cells = floor.hexbin(place[:, 0], place[:, 1], gridsize=40, bins="log", cmap="Blues", mincnt=1)
    figure.colorbar(cells, ax=floor, label="random walks that end there")
    floor.plot(0, 0, "^", color=COLOURS[1], label="start, facing up the page")
    floor.invert_xaxis()
    floor.set_aspect("equal", adjustable="datalim")
    floor.set(xlabel="x (m)", ylabel="z (m)", title=f"places reached after {seconds:g} s")
    floor.legend(fontsize="x-small", loc="lower right")
    degrees = (np.degrees(yaw) + 180) % 360 - 180
    compass.hist(degrees, bins=np.arange(-180, 181, 10), color=COLOURS[0])
    compass.set(xlabel="heading after it (°; left is positive)", ylabel="random walks",
                xlim=(-180, 180), title="headings reached")  # fmt: skip
    compass.spines[["top", "right"]].set_visible(False)
    save(figure, path)
