"""An embedding as a page to turn and to point at, with plotly's own code: it needs no network."""

from pathlib import Path
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.files import write_atomic
from stimuli.manifold.embedding import Embedding
from stimuli.manifold.plots import CLIP_COLOURS


def write_embedding_page(embedding: Embedding, path: Path) -> None:
    """The curves in three dimensions, each frame with its clip and number under the pointer.

    InputError where plotly, an extra, is not installed.
    """
    try:
        import plotly.graph_objects as plotly
    except ImportError as error:
        raise InputError(
            f"{path}: expected plotly, which interactive pages need, found none.\n"
            "Install it: pip install 'segue[pages]'. A name in .png needs nothing."
        ) from error
    figure, starts, one = plotly.Figure(), embedding.starts, len(embedding.motions) == 1
    for clip, name in enumerate(embedding.names):
        x, y, z = embedding.places[starts[clip] : starts[clip + 1], :3].T
        frames = np.arange(len(x))
        colour = CLIP_COLOURS[clip % len(CLIP_COLOURS)]
        dots: dict[str, Any] = {
            "size": 3,
            "color": colour,
        }
        if one:
            dots |= {"color": frames, "colorscale": "Viridis", "colorbar": {"title": "frame"}}
        figure.add_scatter3d(
            x=x, y=y, z=z, mode="lines+markers", name=name, text=[f"{name}:{n}" for n in frames],
            hoverinfo="text", marker=dots, line={"color": "gray" if one else colour, "width": 2},
        )  # fmt: skip
    titles = {f"{axis}axis": {"title": f"dimension {n}"} for n, axis in enumerate("xyz", 1)}
    figure.update_layout(scene=titles | {"aspectmode": "data"}, title=", ".join(embedding.names))
    text = figure.to_html(include_plotlyjs=True, full_html=True, div_id="embedding")
    write_atomic(path, text.encode())
