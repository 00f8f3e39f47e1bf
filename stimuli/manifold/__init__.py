"""Poses in few dimensions, and motion decoded from them (Wang 2005, VII.2, "preliminary").

`neighbours` has the distance of poses and the graph of the nearest, refused when it is in pieces;
`isomap` the shortest ways and their scaling; `embedding` both for clips. `decoder` is the network
back to poses and its test, `resequence` motion along ways, `meetings` where clips come close,
`passing` a way as a transition. scikit-learn loads where a network is trained, plotly in `page`.
"""

from stimuli.manifold.decoder import Decoder, Reconstruction, tested, train_decoder
from stimuli.manifold.embedding import Embedding, embed_motions
from stimuli.manifold.meetings import Meeting, meetings
from stimuli.manifold.page import write_page
from stimuli.manifold.plots import draw_embedding
from stimuli.manifold.resequence import Resequenced, along_way, resequenced, straight_way

__all__ = [
    "Decoder",
    "Embedding",
    "Meeting",
    "Reconstruction",
    "Resequenced",
    "along_way",
    "draw_embedding",
    "embed_motions",
    "meetings",
    "resequenced",
    "straight_way",
    "tested",
    "train_decoder",
    "write_page",
]
