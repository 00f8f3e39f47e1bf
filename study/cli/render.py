"""`segue render`: build or complete a protocol's stimulus set."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from study.cli.common import (
    add_crew_options,
    add_motions_option,
    check_crew,
    print_json,
    progress,
)

if TYPE_CHECKING:
    from stimuli.sets import Inventory, Manifest
    from study.session.duration import Duration


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `segue render`."""
    parser.add_argument("protocol", help="a protocol file, or the name of a shipped protocol")
    parser.add_argument("--set", dest="set_name", metavar="NAME", help="which set of clips")
    parser.add_argument("--out", type=Path, metavar="SET", help="default: stimulus-sets/<protocol>")
    add_crew_options(parser)
    parser.add_argument(
        "--device",
        default="auto",
        metavar="auto|gpu|software|N",
        help="what draws: a card where there is one (auto), only a card, Mesa's software, or the "
        "N-th device of `segue doctor`",
    )
    parser.add_argument(
        "--archive", action="store_true", help="keep masters as FFV1: a quarter of the room, slower"
    )
    parser.add_argument("--dry-run", action="store_true", help="say what would be rendered")
    parser.add_argument(
        "--strips", action="store_true", help="write a film strip of each clip beside it"
    )
    parser.add_argument(
        "--sheet",
        action="store_true",
        help="write a page in which all clips play, and a picture of strips, beside the manifest",
    )
    parser.add_argument(
        "--web", action="store_true", help="write H.264 for browsers beside each master (.mp4)"
    )
    parser.add_argument(
        "--glb", action="store_true", help="write each clip's moving figure as glTF 2.0 (.glb)"
    )
    parser.add_argument(
        "--prune", action="store_true", help="remove clips that the set no longer names"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    """Render what is missing and say what the set holds."""
    from stimuli.motion import Library, motion_directories
    from stimuli.sets import build, inventory, prune
    from stimuli.sets.looks import write_figures, write_web
    from study.protocol.rendered import SETS
    from study.protocol.sets import references_of_manifest, set_spec
    from study.session.duration import session_duration
    from study.trials.reading import load_protocol

    check_crew(args)
    protocol = load_protocol(args.protocol)
    library = Library(motion_directories(args.motions))
    spec = set_spec(protocol, args.set_name, library)
    out = args.out or SETS / protocol.name
    if args.dry_run:
        would = inventory(spec, library, out, archive=args.archive)
        lengths = {p.name: p.reference_length for p in would.resolved if p.reference_length}
        return _dry_run(args, spec.frames, out, would, session_duration(protocol, lengths))
    with progress(None, "rendering") as step:
        manifest = build(
            spec, library, out, workers=args.workers, scheduler=args.scheduler,
            device=args.device, archive=args.archive, progress=step,
        )  # fmt: skip
    pruned = prune(manifest) if args.prune else 0
    if args.strips:
        _write_strips(manifest)
    if args.web:
        with progress(None, "H.264") as step:
            write_web(manifest, args.workers, step)
    if args.glb:
        with progress(None, "glTF") as step:
            write_figures(manifest, spec, library, args.workers, step)
    if args.sheet:
        _write_sheet(manifest, args.workers)
    duration = session_duration(protocol, references_of_manifest(protocol, manifest))
    _tell(args, manifest, pruned, duration)
    return 0


def _dry_run(
    args: argparse.Namespace, frames: int, out: Path, would: "Inventory", duration: "Duration"
) -> int:
    document = {
        "set": str(out),
        "clips": would.wanted,
        "missing": len(would.missing),
        "frames": frames * len(would.missing),
        "stale": len(would.stale),
        "pairings": {
            pairing.name: {
                "reference_length": pairing.reference_length,
                "lengths": list(pairing.lengths),
                "methods": dict(pairing.methods),
            }
            for pairing in would.resolved
        },
        "session": _session(duration),
    }
    if args.json:
        print_json(document)
        return 0
    print(f"{out}: {would.wanted} clips, {len(would.missing)} of them to render")
    for pairing in would.resolved:
        print(f"  {pairing.name}: {_lengths(pairing.methods, pairing.lengths)}")
    print(duration.told())
    return 0


def _session(duration: "Duration") -> dict[str, Any]:
    return {"trials": duration.trials, "minutes": round(duration.minutes, 1)}


def _tell(
    args: argparse.Namespace, manifest: "Manifest", pruned: int, duration: "Duration"
) -> None:
    from stimuli.sets import stale_clips

    stale = len(stale_clips(manifest))
    if args.json:
        print_json(
            {
                "set": str(manifest.directory),
                "hash": manifest.hash,
                "clips": len(manifest.clips),
                "rendered": manifest.rendered,
                "stale": stale,
                "pruned": pruned,
                "pairings": manifest.pairings,
                "session": _session(duration),
            }
        )
        return
    print(f"{manifest.directory}: {len(manifest.clips)} clips, {manifest.rendered} rendered now")
    for name, pairing in manifest.pairings.items():
        print(f"  {name}: {_lengths(pairing['methods'], pairing['lengths'])}")
    print(duration.told())
    if stale:
        print(
            f"{stale} clips of earlier builds are kept, since records may refer to them; "
            "--prune removes them",
            file=sys.stderr,
        )


def _lengths(methods: Any, lengths: Any) -> str:
    """Blend lengths in words."""
    if methods:
        return ", ".join(f"{method} {length}" for method, length in methods.items()) + " frames"
    return ", ".join(str(length) for length in lengths) + " frames"


def _write_strips(manifest: "Manifest") -> None:
    """A film strip of each clip around its transition, beside the clip."""
    from stimuli.render.strip import chosen_frames, strip_of, write_png
    from stimuli.sets.masters import clip_frames

    for entry in {entry.hash: entry for entry in manifest.clips}.values():
        first, last = entry.document["mixed"]
        kind = entry.method or f"{entry.length:02d}"
        name = f"{entry.motion}-{kind}.png"
        numbers = chosen_frames(entry.frames, middle=(first + last) // 2)
        found = dict.fromkeys(numbers)
        pictures = dict(zip(found, clip_frames(entry, list(found)), strict=True))
        picture = strip_of([pictures[number] for number in numbers], numbers, (first, last))
        write_png(manifest.directory / "strips" / name, picture)


def _write_sheet(manifest: "Manifest", workers: int | None) -> None:
    """The page and the picture to look at before people are invited; says where they are."""
    from stimuli.sheet import gather, write_page, write_strips

    motions = len({entry.motion for entry in manifest.clips})
    with progress(motions, "gathering the sheet") as step:
        shown = list(gather(manifest, workers, step))
    page, picture = (manifest.directory / f"sheet.{ending}" for ending in ("html", "png"))
    write_page(manifest, shown, page)
    write_strips(manifest, shown, picture)
    print(f"sheet: {page} and {picture}", file=sys.stderr)
