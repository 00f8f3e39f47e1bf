"""`segue score`: how natural motions are, by their feet, their balance, and what they do in flight.

Any motion, of whatever made it.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stimuli.motion import Clip
    from stimuli.motion.quaternions import Array
    from stimuli.naturalness import Naturalness

_PICTURES = (".png", ".svg", ".pdf")
_CENTIMETRES = ("plant", "zmp", "score")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "paths", nargs="+", type=Path, metavar="FILE|DIR", help="motions, or directories of them"
    )
    parser.add_argument(
        "--masses", type=Path, metavar="FILE|DIR",
        help="motions of the performer, to whose balance the masses are fitted "
        "(default: Winter's table of an average body)",
    )  # fmt: skip
    parser.add_argument("--csv", type=Path, metavar="frames.csv", help="write every frame")
    parser.add_argument(
        "--plot", type=Path, metavar="score.png", help="draw one motion's errors over time"
    )
    parser.add_argument("--frames", action="store_true", help="every frame in the JSON too")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument(
        "--overrides", type=Path, metavar="TOML", help="scale, up, fps and roles for the clips"
    )


def run(args: argparse.Namespace) -> int:
    """2 when a file named on the command line, or every file found, was refused."""
    import sys

    from stimuli.errors import InputError
    from study.cli.common import check_outputs, print_json

    check_outputs(("--plot", args.plot, _PICTURES), ("--csv", args.csv, (".csv",)))
    clips, refused = _opened(args.paths, args.overrides)
    if args.plot and len(clips) > 1:
        raise InputError(
            f"--plot: expected one motion to draw, found {len(clips)}.\nName one file."
        )
    masses = _masses(args.masses, args.overrides)
    rows = []
    for clip in clips:
        try:
            rows.append((clip, _scored(clip, masses)))
        except InputError as error:
            refused.append((clip.path, f"{clip.path}: {error}"))
    for _, told in refused:
        print(told, file=sys.stderr)
    for clip, found in rows:
        if args.plot:
            from stimuli.naturalness.plots import draw_course

            draw_course(found, clip.motion.fps, clip.name, args.plot)
    if args.csv:
        _write_csv(args.csv, rows)
    if args.json:
        print_json([_document(clip, found, args.frames) for clip, found in rows])
    else:
        _print_table(rows)
        for path in (args.csv, args.plot):
            if path:
                print(f"written: {path}")
    named = set(args.paths)
    return 2 if not rows or any(path in named for path, _ in refused) else 0


def _opened(
    paths: list[Path], overrides: Path | None
) -> tuple[list["Clip"], list[tuple[Path, str]]]:
    """The clips of files and directories, and what was said of those that were refused."""
    from stimuli.errors import InputError
    from stimuli.motion import load_clip
    from stimuli.motion.library import clips_under

    clips: list[Clip] = []
    refused: list[tuple[Path, str]] = []
    for place in paths:
        if not place.exists():
            raise InputError(f"{place}: expected a motion or a directory, found nothing there.")
        found = clips_under(place)
        if not found:
            raise InputError(f"{place}: expected motion clips, found none.")
        for path in found:
            try:
                clips.append(load_clip(path, overrides=overrides))
            except InputError as error:
                refused.append((path, str(error)))
    return clips, refused


def _masses(place: Path | None, overrides: Path | None) -> "Array":
    from stimuli.naturalness import WINTER, fitted_masses

    if place is None:
        return WINTER
    clips, _ = _opened([place], overrides)
    return fitted_masses([clip.motion for clip in clips])


def _scored(clip: "Clip", masses: "Array") -> "Naturalness":
    from stimuli.naturalness import score_motion

    return score_motion(clip.motion, masses=masses)


def _document(clip: "Clip", found: "Naturalness", frames: bool) -> dict[str, Any]:
    document = {"name": clip.name, "path": str(clip.path), "frames": found.frames}
    document |= found.as_dict() | {"remark": found.remark or None}
    if frames:
        document["course"] = [
            dict(zip(_COLUMNS, row, strict=True)) for row in _frames(found, clip.motion.fps)
        ]
    return document


_COLUMNS = (
    "frame", "seconds", "left_slide", "right_slide", "zmp_x", "zmp_z", "zmp_beyond",
    "weight_borne", "angular_momentum", "flight",
)  # fmt: skip


def _frames(found: "Naturalness", fps: float) -> list[list[Any]]:
    """A row a frame; None where nothing is told."""
    import numpy as np

    course = found.course
    turning = np.linalg.norm(course.momentum, axis=1)
    rows = []
    for frame in range(found.frames):
        numbers = (
            frame / fps, *course.slide[frame], *course.point[frame], course.beyond[frame],
            course.borne[frame], turning[frame],
        )  # fmt: skip
        told = [round(float(x), 6) if np.isfinite(x) else None for x in numbers]
        rows.append([frame, *told, bool(course.flight[frame])])
    return rows


def _write_csv(path: Path, rows: "list[tuple[Clip, Naturalness]]") -> None:
    import csv
    from io import StringIO

    from stimuli.files import write_atomic

    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("clip", *_COLUMNS))
    for clip, found in rows:
        for row in _frames(found, clip.motion.fps):
            writer.writerow([clip.name, *("" if cell is None else cell for cell in row)])
    write_atomic(path, text.getvalue().encode())


def _print_table(rows: "list[tuple[Clip, Naturalness]]") -> None:
    if not rows:
        return
    width = max(4, *(len(clip.name) for clip, _ in rows))
    print(f"{'name':{width}}  frames  plants  flight  feet cm  balance cm  score cm  flight m²/s")
    for clip, found in rows:
        feet, balance, score = (
            "–" if value is None else f"{100 * value:.1f}"
            for value in (getattr(found, name) for name in _CENTIMETRES)
        )
        spin = "–" if found.ballistic is None else f"{found.ballistic:.3f}"
        print(
            f"{clip.name:{width}}  {found.frames:6d}  {found.plants:6d}  {found.flight:6d}"
            f"  {feet:>7}  {balance:>10}  {score:>8}  {spin:>11}"
        )
        if found.remark:
            print(f"{'':{width}}  {found.remark}")
