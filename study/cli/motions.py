"""`segue motions`: list clips, or fetch the sample motions."""

import argparse
from pathlib import Path
from typing import Any


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from study.cli.common import add_motions_option

    parser.add_argument(
        "paths",
        nargs="*",
        type=Path,
        metavar="FILE|DIR",
        help="clips or directories (default: the motion directories); "
        "`fetch` alone brings the sample motions into your library",
    )
    parser.add_argument(
        "--roles",
        type=Path,
        metavar="FILE",
        help="print which joint of a clip plays which anatomical part, as overrides to start from",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument(
        "--overrides",
        type=Path,
        metavar="TOML",
        help="scale, up, fps and roles for the clips, or in [clips.NAME] for one "
        "(default: overrides.toml beside each clip)",
    )
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    """2 when a file named on the command line, or every file found, was refused."""
    if [str(path) for path in args.paths] == ["fetch"]:
        return _fetch(args)
    if args.roles is not None:
        return _print_roles(args)
    rows = [_row(path, args.overrides) for path in _paths(args)]
    refused = [row for row in rows if "error" in row]
    if args.json:
        from study.cli.common import print_json

        print_json(rows)
    else:
        _print_table([row for row in rows if "error" not in row])
    _complain(rows)
    named = {str(path) for path in args.paths}
    return 2 if refused and (len(refused) == len(rows) or _any_named(refused, named)) else 0


def _fetch(args: argparse.Namespace) -> int:
    import sys

    from stimuli.motion import fetch
    from study.cli.common import print_json

    target = args.motions[0] if args.motions else None
    paths = fetch(target, lambda message: print(message, file=sys.stderr))
    if args.json:
        print_json([str(path) for path in paths])
    else:
        print(f"{len(paths)} clips in {paths[0].parent}")
    return 0


def _print_roles(args: argparse.Namespace) -> int:
    from stimuli.errors import InputError
    from stimuli.motion import load_clip
    from stimuli.motion.listing import roles_as_overrides

    if args.json:
        raise InputError(
            "--roles: expected no --json beside it, found one: roles are printed as TOML.\n"
            "Leave out --json, or list the clip with --json and without --roles."
        )
    if args.paths:
        raise InputError(
            f"--roles: expected one FILE, found another argument, {args.paths[0]}.\n"
            "Name the clip after --roles."
        )
    print(roles_as_overrides(load_clip(args.roles, overrides=args.overrides)), end="")
    return 0


def _paths(args: argparse.Namespace) -> list[Path]:
    from stimuli.errors import InputError
    from stimuli.motion import motion_directories
    from stimuli.motion.library import clips_under

    places = args.paths or motion_directories(args.motions)
    if absent := [str(place) for place in places if not place.exists()]:
        raise InputError(
            f"{absent[0]}: expected a clip or a directory of clips, found nothing there."
        )
    found = [path for place in places for path in clips_under(place)]
    if not found:
        where = ", ".join(str(place) for place in places) or "no directory"
        raise InputError(
            f"expected motion clips, found none in {where}.\n"
            "`segue motions fetch` brings samples; --motions names a directory of your own."
        )
    return found


def _row(path: Path, overrides: Path | None) -> dict[str, Any]:
    from stimuli.errors import InputError
    from stimuli.motion import load_clip

    try:
        clip = load_clip(path, overrides=overrides)
    except InputError as error:
        return {"name": path.stem, "path": str(path), "error": str(error)}
    return {
        "name": clip.name,
        "path": str(path),
        "format": clip.format,
        "frames": clip.frames,
        "fps": clip.fps,
        "seconds": clip.seconds,
        "joints": clip.joints,
        "scale": clip.scale,
        "up": clip.up,
        "roles_missing": list(clip.roles_missing),
        "warnings": list(clip.warnings),
        "working_frames": len(clip.motion),
        "loop": clip.motion.loop,
        "sha256": clip.sha256,
    }


def _print_table(rows: list[dict[str, Any]]) -> None:
    width = max((len(row["name"]) for row in rows), default=4)
    print(f"{'name':{width}}  format     frames    fps  seconds  joints  metres/unit  up")
    for row in rows:
        print(
            f"{row['name']:{width}}  {row['format']:9}  {row['frames']:6d}  {row['fps']:5.4g}"
            f"  {row['seconds']:7.2f}  {row['joints']:6d}  {row['scale']:11.6g}  {row['up']:2}"
            f"{'  loop' if row['loop'] else ''}"
        )


def _complain(rows: list[dict[str, Any]]) -> None:
    """Refusals, warnings and missing roles, on standard error."""
    import sys

    for error in dict.fromkeys(row["error"] for row in rows if "error" in row):
        print(error, file=sys.stderr)  # once, where one file of overrides has many clips refused
    for row in rows:
        if "error" in row:
            continue
        notes = list(row["warnings"])
        if row["roles_missing"]:
            notes.append(f"no joint for {', '.join(row['roles_missing'])}")
        for note in notes:
            print(f"{row['path']}: {note}", file=sys.stderr)


def _any_named(refused: list[dict[str, Any]], named: set[str]) -> bool:
    return any(row["path"] in named for row in refused)
