"""Poses in few dimensions, and motion decoded from them (Wang 2005, VII.2, "preliminary").

`neighbours` has the distance of poses and the graph of the nearest, refused when it is in pieces;
`isomap` the shortest ways and their scaling; `embedding` both for clips. `decoder` is the network
back to poses and its test, `resequence` motion along ways, `meetings` where clips come close,
`passing` a way as a transition. scikit-learn loads where a network is trained, plotly in `page`.
"""

from stimuli.manifold.decoder import PoseDecoder, Reconstruction, decoding_errors, train_decoder
from stimuli.manifold.embedding import Embedding, embed_motions
from stimuli.manifold.meetings import Meeting, meetings
from stimuli.manifold.page import write_embedding_page
from stimuli.manifold.passing import passing, taken_dimensions
from stimuli.manifold.plots import draw_embedding
from stimuli.manifold.resequence import Resequenced, along_way, resequenced, straight_way

__all__ = [
    "Embedding",
    "Meeting",
    "PoseDecoder",
    "Reconstruction",
    "Resequenced",
    "along_way",
    "decoding_errors",
    "draw_embedding",
    "embed_motions",
    "meetings",
    "passing",
    "resequenced",
    "straight_way",
    "taken_dimensions",
    "train_decoder",
    "write_embedding_page",
]
