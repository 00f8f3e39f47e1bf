"""A transition by way of an embedding: the straight way from a frame of A to one of B, decoded."""

from stimuli.errors import InputError
from stimuli.manifold.decoder import PoseDecoder, train_decoder
from stimuli.manifold.embedding import Embedding, embed_motions
from stimuli.manifold.isomap import MOST
from stimuli.manifold.neighbours import NEIGHBOURS
from stimuli.manifold.resequence import along_way, straight_way
from stimuli.motion.skeleton import Motion
from stimuli.transition.room import with_room
from stimuli.transition.route import Piece, Route

LEAST_DIMENSIONS = 3  # that motion is decoded from (VII.2.2)
DECODED = "(decoded)"  # the name of a piece that no clip holds


def taken_dimensions(embedding: Embedding, asked: int | None = None) -> int:
    """The dimensions to decode motion from: those asked for, else the knee, three at least."""
    return asked or min(max(embedding.knee, LEAST_DIMENSIONS), MOST)


def passing(
    a: Motion,
    b: Motion,
    i: int,
    j: int,
    names: tuple[str, str] = ("A", "B"),
    neighbours: int = NEIGHBOURS,
    seed: int = 0,
) -> Route:
    """The way from frame i of `a` to frame j of `b` through the embedding of both (VII.2.1).

    A motion that goes over into itself is embedded alone. The way's length is its distance at the
    motions' own speed. What is decoded is a piece of its own, behind which B comes at frame j.
    InputError where they cannot be embedded or decoded (`embed_motions`, `train_decoder`), and for
    frame 0 of a motion that is no loop, before which nothing tells how B comes.
    """
    alone = a.same_as(b)
    if j == 0 and not b.loop:
        raise InputError(
            f"manifold: expected a frame of {names[1]} from 1 on, found 0.\n"
            "What comes before the frame tells how it is reached."
        )
    motions, called = ([a], names[:1]) if alone else ([a, b], names)
    embedding = embed_motions(motions, called, neighbours, seed)
    decoder = train_decoder(embedding, taken_dimensions(embedding), seed)
    return routed(embedding, decoder, i, j)


def routed(embedding: Embedding, decoder: PoseDecoder, i: int, j: int) -> Route:
    """The same from frame i of the first to frame j of the last clip of an embedding."""
    target, name = embedding.motions[-1], embedding.names[-1]
    end = int(embedding.starts[-2]) + j
    way = straight_way(embedding, decoder.dimensions, i, end)
    longer, at = with_room(target, j, 1)
    last = Piece(name, longer, at, at)
    between = len(way) - 2
    pieces: tuple[Piece, ...] = (last,)
    if between:
        decoded = along_way(embedding, decoder, way, lock=False)
        pieces = (Piece(DECODED, decoded, 1, between), last)
    far = float(((way[-1] - way[0]) ** 2).sum() ** 0.5)
    return Route(embedding.names[0], i, j, pieces, far)
