"""Any command that takes a protocol, of each protocol of a battery in turn.

A session's order is the row of a Williams square that the fewest people have finished; it is kept
under `sourcedata/`, so that a battery that was left goes on where it was.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from stimuli.errors import InputError
from stimuli.files import write_atomic
from study.protocol.battery import Battery, orders

Run = Callable[[argparse.Namespace], int]


def run_each(battery: Battery, args: argparse.Namespace) -> int:
    """The command for every protocol, as they are listed; a session in the person's own order."""
    if args.command == "run":
        return _session(battery, args)
    return max(int(args.run(_of(args, member))) for member in battery.protocols)


def _of(args: argparse.Namespace, member: str, **more: object) -> argparse.Namespace:
    return argparse.Namespace(**{**vars(args), "protocol": member, **more})


def _session(battery: Battery, args: argparse.Namespace) -> int:
    from study.cli.person import settle_participant
    from study.record.dataset import check_participant, finished_runs
    from study.trials.reading import load_protocol

    if args.stimuli is not None:
        raise InputError(
            "--stimuli: a battery shows several sets, found one named; leave it out, and render "
            f"them with `segue render {args.protocol}`"
        )
    if not settle_participant(args):
        print("left before the session began", file=sys.stderr)
        return 1
    check_participant(args.participant)
    path = _kept(args.data, args.participant, battery.name)
    order = _order(battery, args, path)
    for place, member in enumerate(order, start=1):
        label = load_protocol(member).label
        if not args.restart and finished_runs(args.data, args.participant, label, args.rehearsal):
            continue
        print(f"{battery.name}, {place} of {len(order)}: {member}", file=sys.stderr)
        part = {"name": battery.name, "order": list(order), "position": place}
        if code := int(args.run(_of(args, member, battery=part))):
            return code
    if not args.rehearsal:
        _write(path, order, finished=True)
    return 0


def _order(battery: Battery, args: argparse.Namespace, path: Path) -> tuple[str, ...]:
    """The order that was begun, or a new one."""
    if path.is_file() and not args.restart:
        held = json.loads(path.read_text(encoding="utf-8"))
        if held.get("finished"):
            raise InputError(
                f"{args.participant} has finished {battery.name} already; run one of its protocols "
                "by its own name for more, or say --restart"
            )
        return tuple(held["order"])
    done = Counter[tuple[str, ...]]()
    for other in args.data.glob(f"sourcedata/sub-*/{path.name}"):
        held = json.loads(other.read_text(encoding="utf-8"))
        done[tuple(held["order"])] += bool(held.get("finished"))
    rows = orders(battery.protocols)
    fewest = min(done[row] for row in rows)
    open_rows = [row for row in rows if done[row] == fewest]
    seed = args.seed if args.seed is not None else _by_name(args.participant)
    order = open_rows[seed % len(open_rows)]
    if not args.rehearsal:
        _write(path, order, finished=False)
    return order


def _by_name(participant: str) -> int:
    """A number that a person's name stands for, the same everywhere."""
    from zlib import crc32

    return crc32(participant.encode())


def _kept(data: Path, participant: str, name: str) -> Path:
    return data / "sourcedata" / f"sub-{participant}" / f"battery_{name}.json"


def _write(path: Path, order: tuple[str, ...], finished: bool) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomic(path, json.dumps({"order": list(order), "finished": finished}, indent=2) + "\n")
