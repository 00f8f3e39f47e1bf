"""`segue embed`: clips in few dimensions, and motion decoded from there (Wang 2005, VII.2)."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stimuli.manifold import Embedding, Meeting, PoseDecoder, Reconstruction
    from stimuli.motion import Clip, Motion

_MOST = 10
_OUT = (".png", ".svg", ".pdf", ".jpg", ".html")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.common import COUNT, SEED, add_motions_option, argument

    dimensions = argument(int, f"from 1 to {_MOST}", lambda n: 1 <= n <= _MOST)
    seconds = argument(float, "seconds above 0, up to 120", lambda x: 0 < x <= 120)
    parser.add_argument(
        "clips", nargs="+", metavar="CLIP", help="clips of one hierarchy, or directories of them"
    )
    parser.add_argument(
        "--dimensions", type=dimensions, metavar="N", help="that motion is decoded from "
        "(default: the knee of the residual variance, 3 at least)",
    )  # fmt: skip
    parser.add_argument(
        "--neighbours", type=COUNT, default=7, metavar="K", help="of each frame (default 7)"
    )
    parser.add_argument("--seed", type=SEED, default=0, help="of all that is random (default 0)")
    parser.add_argument(
        "--resequence", type=seconds, metavar="SECONDS",
        help="motion along straight ways between frames drawn at random",
    )  # fmt: skip
    parser.add_argument(
        "--out", type=Path, action="append", default=[], metavar="FILE",
        help="a picture (.png), a page to turn (.html), or, with --resequence, the motion "
        "(.bvh, .mp4, .mkv, .glb); repeatable",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from stimuli.errors import InputError
    from stimuli.manifold import (
        draw_embedding,
        embed_motions,
        meetings,
        taken_dimensions,
        write_embedding_page,
    )
    from study.cli.clips import open_all, tell_warnings
    from study.cli.common import check_outputs, print_json
    from study.cli.writing import MOTION_FILES, write_motion

    kinds = (*_OUT, *(MOTION_FILES if args.resequence else ()))
    check_outputs(*(("--out", path, kinds) for path in args.out))
    clips = list(dict.fromkeys(c for group in open_all(args.motions, args.clips) for c in group))
    tell_warnings(*clips)
    embedding = embed_motions(
        [clip.motion for clip in clips], _names(clips), args.neighbours, args.seed
    )
    dimensions = taken_dimensions(embedding, args.dimensions)
    close = meetings(embedding, dimensions)
    document = _document(embedding, dimensions, close)
    try:
        decoder, quality = _decoded(embedding, dimensions, args.seed)
    except InputError as error:
        if args.resequence:
            raise
        document["decoder"] = None
        document["remark"] = str(error)
    else:
        document["decoder"] = _tests(decoder, quality)
        document["remark"] = _verdict(quality)
        if args.resequence:
            motion, scores = _resequenced(embedding, decoder, clips, args)
            document["resequenced"] = scores
    for path in args.out:
        if path.suffix.lower() == ".html":
            write_embedding_page(embedding, path)
        elif path.suffix.lower() in _OUT:
            draw_embedding(embedding, path, dimensions, close)
        else:
            write_motion(motion, path)
    if args.json:
        print_json(document | {"out": [str(path) for path in args.out]})
    else:
        _tell(document)
        for path in args.out:
            print(f"written: {path}")
    return 0


def _names(clips: "list[Clip]") -> list[str]:
    """The clips' names; paths where two have one name."""
    names = [clip.name for clip in clips]
    return names if len(set(names)) == len(names) else [str(clip.path) for clip in clips]


def _document(embedding: "Embedding", dimensions: int, close: "list[Meeting]") -> dict[str, Any]:
    from dataclasses import asdict

    return {
        "clips": [
            {"name": name, "frames": len(motion)}
            for name, motion in zip(embedding.names, embedding.motions, strict=True)
        ],
        "frames": len(embedding.places),
        "neighbours": embedding.neighbours,
        "landmarks": embedding.landmarks or None,
        "residual_variance": [round(float(x), 6) for x in embedding.residual],
        "knee": embedding.knee,
        "dimensions": dimensions,
        "speed": round(embedding.step(dimensions), 6),
        "meetings": [_rounded(asdict(m)) for m in close],
    }


def _rounded(row: dict[str, Any]) -> dict[str, Any]:
    return {k: round(v, 6) if isinstance(v, float) else v for k, v in row.items()}


def _decoded(
    embedding: "Embedding", dimensions: int, seed: int
) -> "tuple[PoseDecoder, Reconstruction]":
    from stimuli.manifold import decoding_errors, train_decoder

    decoder = train_decoder(embedding, dimensions, seed)
    return decoder, decoding_errors(decoder, embedding)


def _tests(decoder: "PoseDecoder", quality: "Reconstruction") -> dict[str, Any]:
    return {
        "epochs": decoder.epochs,
        **{f"{name}_frames": len(frames) for name, frames in decoder.sets.items()},
        "degrees": _rounded(quality.errors),
        "roles": {role: _rounded(each) for role, each in quality.roles.items()},
    }


def _verdict(quality: "Reconstruction") -> str | None:
    """Where the network is worse than the nearest frame, in words."""
    if not quality.worse_roles and not quality.worse:
        return None
    roles = ", ".join(quality.worse_roles)
    whole = "the network is worse than the nearest frame"
    if quality.worse:
        return f"{whole}" + (f", for {roles}" if roles else "")
    return f"{whole} for {roles}; over all joints it is not"


def _resequenced(
    embedding: "Embedding", decoder: "PoseDecoder", clips: "list[Clip]", args: argparse.Namespace
) -> "tuple[Motion, dict[str, Any]]":
    """The motion, and its score beside the clips' own, as `segue score` has them."""
    import numpy as np

    from stimuli.manifold import resequenced
    from stimuli.naturalness import score_motion

    frames = round(args.resequence * embedding.motions[0].fps)
    generator = np.random.default_rng([args.seed, 2])
    made = resequenced(embedding, decoder, frames, generator)
    scores = {
        "frames": len(made.motion),
        "visited": [embedding.frame_name(int(frame)) for frame in made.stops],
        **score_motion(made.motion).as_dict(),
        "clips": {
            name: score_motion(clip.motion).as_dict()["naturalness"]
            for name, clip in zip(embedding.names, clips, strict=True)
        },
    }
    return made.motion, scores


def _tell(document: dict[str, Any]) -> None:
    by = f" by {document['landmarks']} landmarks" if document["landmarks"] else ""
    print(
        f"{len(document['clips'])} clips, {document['frames']} frames, "
        f"{document['neighbours']} neighbours{by}"
    )
    left = "  ".join(f"{x:.3f}" for x in document["residual_variance"])
    print(f"residual variance in 1 to {_MOST} dimensions: {left}; knee at {document['knee']}")
    for m in document["meetings"][:5]:
        print(
            f"{m['from_clip']}:{m['i']} is close to {m['to_clip']}:{m['j']} ({m['apart']:.3f} "
            f"rad): cost {m['cost']:.4f}, {100 * m['cheaper']:.1f} % of pairs cost less "
            f"(the cheapest: {m['best'][0]} → {m['best'][1]})"
        )
    if decoder := document["decoder"]:
        print(f"decoded from {document['dimensions']} dimensions, degrees off on test frames:")
        width = max(map(len, (*decoder["roles"], "all joints")))
        print(f"{'':{width}}  network  nearest  interpolated")
        for role, e in {"all joints": decoder["degrees"], **decoder["roles"]}.items():
            print(
                f"{role:{width}}  {e['network']:7.2f}  {e['nearest']:7.2f}"
                f"  {e['interpolated']:12.2f}"
            )
    if document["remark"]:
        print(document["remark"])
    if made := document.get("resequenced"):
        own = ", ".join(f"{name} {_centimetres(score)}" for name, score in made["clips"].items())
        print(
            f"resequenced: {made['frames']} frames by way of {', '.join(made['visited'])}; score "
            f"{_centimetres(made['naturalness'])} (captured: {own}); less is more natural"
        )


def _centimetres(score: float | None) -> str:
    return "–" if score is None else f"{100 * score:.1f} cm"
