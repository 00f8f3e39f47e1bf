"""A collection: clips of one skeleton taken together, out of which motions are made.

`gathered` brings clips to one body and refuses what cannot be told apart or joined; `annotations`
says what is done in which frames; `torso` has the poses as the body itself sees them, which is how
poses of clips that lie anywhere are compared (Arikan and Forsyth 2002, appendix A).
"""

from stimuli.collection.annotations import annotated
from stimuli.collection.gather import Collection, gathered
from stimuli.collection.select import collected
from stimuli.collection.torso import FloorFrames, floor_frames, torso_features

__all__ = [
    "Collection",
    "FloorFrames",
    "annotated",
    "collected",
    "floor_frames",
    "gathered",
    "torso_features",
]
