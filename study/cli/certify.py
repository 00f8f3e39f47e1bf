"""`segue certify`: what a protocol will be able to show, before any session."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from study.cli.common import (
    SEED,
    add_crew_options,
    add_motions_option,
    check_crew,
    print_json,
    progress,
)

if TYPE_CHECKING:
    from study.cli.designs import SimulatedStudy
    from study.protocol.protocol import Protocol


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("protocol", help="a protocol file, or the name of a shipped protocol")
    parser.add_argument("--sets", type=int, default=100, help="simulated studies (default 100)")
    parser.add_argument("--participants", type=int, help="people a study (default: the protocol's)")
    parser.add_argument(
        "--effect",
        type=float,
        action="append",
        help="effect to give the power for: frames of threshold, or a share (repeatable)",
    )
    parser.add_argument("--seed", type=SEED, default=1, help="default: 1")
    parser.add_argument("--set", dest="set_name", help="the set whose motions give the lengths")
    parser.add_argument("--stimuli", type=Path, metavar="SET", help="stimulus set to check as well")
    add_crew_options(parser)
    parser.add_argument("--out", type=Path, default=Path("certificate.json"), metavar="FILE")
    parser.add_argument("--json", action="store_true")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    from datetime import UTC, datetime

    from stimuli.errors import InputError
    from stimuli.motion import Library, motion_directories
    from study.cli.designs import Options, SimulatedStudy, certificate
    from study.protocol.sets import references
    from study.trials.reading import load_protocol

    if args.sets < 2 or (args.participants is not None and args.participants < 1):
        raise InputError("--sets and --participants: expected at least 2 sets and 1 participant")
    check_crew(args)
    protocol = load_protocol(args.protocol)
    _check_effects(args.effect or [], protocol)
    people = args.participants or protocol.file.participants
    lengths = references(protocol, Library(motion_directories(args.motions)), args.set_name)
    jobs = [
        SimulatedStudy(dict(protocol.document), lengths, args.seed * 100_003 + n, people)
        for n in range(args.sets)
    ]
    studies = _all(jobs, args.workers, args.scheduler)
    options = Options(
        args.seed, tuple(args.effect or ()), args.stimuli, args.workers, args.scheduler
    )
    created = datetime.now(UTC).isoformat(timespec="seconds")
    entry = certificate(protocol, lengths, studies, people, options) | {"created": created}
    _write(args.out, protocol.hash, entry)
    if args.json:
        print_json(entry)
    else:
        print(describe(entry))
        print(f"written to {args.out}; `segue report` quotes it from here or beside the data")
    return 0


def _check_effects(effects: list[float], protocol: "Protocol") -> None:
    from stimuli.errors import InputError
    from study.cli.designs import EFFECTS, analysis_of

    if effects and analysis_of(protocol) not in EFFECTS:
        raise InputError(
            f"--effect: expected none for a {protocol.file.task} study, whose power is not "
            f"simulated, found {effects[0]:g}; leave it out"
        )
    for effect in effects:
        unit, highest = EFFECTS[analysis_of(protocol)]
        if not 0 < effect < highest:
            raise InputError(
                f"--effect: expected {unit} above 0 for a {protocol.file.task} study, found "
                f"{effect:g}"
            )


def _all(
    jobs: "list[SimulatedStudy]", workers: int | None, scheduler: str | None
) -> list[dict[str, Any]]:
    """Simulate and analyse every study, on all cores or a cluster."""
    from stimuli.processes import mapped
    from study.cli.designs import one_study

    found = []
    with progress(len(jobs), "simulating studies") as step:
        for study in mapped(one_study, jobs, workers, len(jobs), scheduler):
            found.append(study)
            step(len(found))
    return found


def _write(path: Path, key: str, entry: dict[str, Any]) -> None:
    """Add or replace this protocol's entry; those of other protocols stay."""
    import json

    from analysis.files import write_atomic

    try:
        held = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        held = {}
    held = held if isinstance(held, dict) else {}
    write_atomic(path, json.dumps({**held, key: entry}, indent=2, ensure_ascii=False) + "\n")


def describe(entry: dict[str, Any]) -> str:
    """The certificate in lines."""
    trials, minutes = entry["trials"], entry["minutes"]
    lines = [
        f"{entry['protocol']}: {entry['simulated_sets']} simulated studies of "
        f"{entry['participants']} people",
        f"a session: {trials['mean']:.0f} trials ({trials['least']:.0f} to {trials['most']:.0f}), "
        f"{minutes['mean']:.0f} minutes ({minutes['least']:.0f} to {minutes['most']:.0f})",
    ]
    for name, held in entry["balance"].items():
        lines.append(f"{name}: {held['share']:.3f} of trials "
                     f"({held['least']:.2f} to {held['most']:.2f} in a session)")  # fmt: skip
    for row in entry["expected"]:
        lines.append(_told_expected(row))
    for row in entry.get("staircases", []):
        where = "goes where answers tell most"
        if row["target"] is not None:
            where = f"settles at a proportion of {row['target']:.4f}"
        lines.append(f"staircase {row['motion']}/{row['side']} ({row['rule']}): {where}")
    for row in entry.get("ends", []):
        lines += _told_ends(row)
    for row in entry.get("thresholds", []):
        lines.append(
            f"threshold {row['side']} {row['truth']:+g}: fit {_spread(row['fit'])}, reversals "
            f"{_spread(row['reversal_mean'])}, most visited {_spread(row['stop_level'])}; interval "
            f"covers {row['coverage']:.2f}, identifiable {row['identifiable']:.2f}"
        )
    for category, finds in (entry.get("finds_by_category") or {"": entry.get("finds", {})}).items():
        for test, share in finds.items():
            where = f" of {category}" if category else ""
            lines.append(f"{test} finds the observer's preference{where} in {share:.2f} of studies")
    if "power_test" in entry:
        lines.append(f"power is that of {entry['power_test']}")
    if "recommended_for" in entry:
        n = entry["recommended_participants"]
        lines.append(f"people recommended ({entry['recommended_for']}): "
                     f"{n if n is not None else 'more than could be tried'}")  # fmt: skip
    return "\n".join(lines + entry["warnings"])


def _told_expected(row: dict[str, Any]) -> str:
    """What studies of the observer come to."""
    if "mean" not in row:
        return f"{row['what']}, in truth {row['truth']:g}: no study could tell it"
    return (
        f"{row['what']}, in truth {row['truth']:g}: {row['mean']:.3g} on average, in 95 % of "
        f"studies between {row['low']:.3g} and {row['high']:.3g}"
    )


def _told_ends(row: dict[str, Any]) -> list[str]:
    """How often a track ends at its first or last level, for whom, and what would mend it."""
    from study.trials.ends import SELDOM

    levels = row["levels"]
    lines = [
        f"tracks of {row['track']}, from {row['start']}, end at the first level ({levels[0]}) in "
        f"{row['ends_first']:.2f}, at the last ({levels[-1]}) in {row['ends_last']:.2f}"
    ]
    if row["ends_first"] + row["ends_last"] < SELDOM:
        return lines
    people = [f"{p['threshold']:g}: {p['ends_first'] + p['ends_last']:.2f}" for p in row["people"]]
    lines.append(f"  in all, by personal threshold: {', '.join(people)}")
    better = [c for c in row["changes"] if c["at_ends"] < row["ends_first"] + row["ends_last"]]
    tried = [
        min(kind, key=lambda c: (c["at_ends"] >= SELDOM, len(c["levels"]), c["at_ends"]))
        for word in ("start", "levels")
        if (kind := [c for c in better if c["change"].startswith(word)])
    ]
    told = [f"{c['change']} would make it {c['at_ends']:.2f}" for c in tried]
    lines.append(
        f"  {'; '.join(told) or 'no other start and no level more that can be would help'}"
    )
    return lines


def _spread(held: dict[str, float | None]) -> str:
    mean, sd = held["mean"], held["sd"]
    return "none" if mean is None else f"{mean:+.2f} (SD {sd or 0:.2f})"
