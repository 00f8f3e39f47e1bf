"""`segue run`: one session with one participant."""

import argparse
import shlex
import sys
from pathlib import Path
from typing import Any

from study.cli.common import add_motions_option, progress


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `segue run`."""
    parser.add_argument("protocol", help="a protocol file, or the name of a shipped protocol")
    parser.add_argument(
        "--participant", metavar="ID", help="letters and digits (default: a dialog asks)"
    )
    parser.add_argument("--data", type=Path, default=Path("data"), metavar="DIR")
    parser.add_argument(
        "--stimuli", type=Path, metavar="SET", help="default: stimulus-sets/<protocol>"
    )
    parser.add_argument("--screen", type=int, default=0, metavar="N")
    parser.add_argument("--windowed", action="store_true", help="a window, not the whole screen")
    parser.add_argument("--observer", choices=("human", "simulated"), default="human")
    parser.add_argument(
        "--rehearsal", action="store_true", help="one motion, clips of one second, short tracks"
    )
    parser.add_argument("--pace", type=float, default=1.0, metavar="N", help="time runs N times")
    parser.add_argument("--seed", type=int, metavar="N", help="default: drawn anew, recorded")
    go_on = parser.add_mutually_exclusive_group()
    go_on.add_argument("--resume", action="store_true", help="go on with an unfinished record")
    go_on.add_argument("--restart", action="store_true", help="leave it and start a new run")
    add_motions_option(parser)


def run(args: argparse.Namespace) -> int:
    """Run the session; 1 when somebody left it."""
    from stimuli.errors import InputError
    from study.cli.person import settle_participant
    from study.cli.telling import Teller
    from study.protocol.rendered import check_rendered
    from study.protocol.sets import references_of_manifest
    from study.screen.priority import PERMIT, may_have_priority
    from study.screen.virtual import has_screen
    from study.session.lab import Request, check
    from study.trials.reading import load_protocol

    protocol = load_protocol(args.protocol)
    if not settle_participant(args):
        print("left before the session began", file=sys.stderr)
        return 1
    request = Request(
        participant=args.participant,
        data=args.data,
        observer=args.observer,
        rehearsal=args.rehearsal,
        pace=args.pace,
        seed=args.seed,
        restart=args.restart,
        screen=args.screen,
        windowed=args.windowed,
        lost=_lost(args),
        battery=getattr(args, "battery", None),
    )
    check(request, protocol)
    if not has_screen():
        raise InputError(
            "expected a screen, found none (DISPLAY is not set);\nrun it on the lab's machine; for "
            "a trial start `Xvfb :9 -screen 0 1280x800x24 &` and say DISPLAY=:9 before the command"
        )
    manifest = _stimuli(args, protocol)
    check_rendered(protocol, manifest, args.rehearsal)
    expected = _tell_before(args, protocol, references_of_manifest(protocol, manifest))
    if not may_have_priority():
        print(
            f"segue: note: keys are timed by the X server, to about a millisecond;\n{PERMIT}",
            file=sys.stderr,
        )
    _ask_person(args, protocol)
    record = _conducted(args, request, protocol, manifest, Teller(expected))
    if record is None:
        return 1
    _ask_comments(args)
    print(f"record: {record.path}")
    return 0


def _conducted(
    args: argparse.Namespace, request: Any, protocol: Any, manifest: Any, teller: Any
) -> Any:
    """The record of a session that came to its end; None when it did not, and it is said why."""
    from stimuli.errors import UnwritableError
    from study.record.table import NotKeptError
    from study.screen.opening import open_window
    from study.session.lab import run_session
    from study.session.stage import ScreenLostError, SessionLeft

    go_on = f"go on with: {_resume_command(args)}"
    try:
        return run_session(
            request, protocol, manifest, lambda record: _resume(args, record), open_window, teller
        )
    except (SessionLeft, KeyboardInterrupt):
        print(f"left; {go_on}", file=sys.stderr)
    except ScreenLostError:
        print(request.lost, file=sys.stderr)
    except (NotKeptError, UnwritableError) as error:
        begun = any(args.data.glob(f"sub-{args.participant}/beh/*_beh.tsv"))
        kept = "all answers before it are kept" if begun else "nothing was answered yet"
        print(
            f"segue run: {str(error).splitlines()[0].rstrip('.')}; {kept}.\n"
            f"See that there is room to write, and {go_on}",
            file=sys.stderr,
        )
    finally:
        teller.end()
    return None


def _stimuli(args: argparse.Namespace, protocol: Any) -> Any:
    """The stimulus set; a rehearsal builds a short one where the study's own is not there."""
    from stimuli.errors import InputError
    from stimuli.motion import Library, motion_directories
    from stimuli.sets import build, load_manifest
    from study.protocol.rendered import SETS, render_command
    from study.protocol.sets import set_spec

    if args.stimuli is not None:
        return load_manifest(args.stimuli)
    if not args.rehearsal:
        folder = SETS / protocol.name
        if not folder.is_dir():
            raise InputError(
                f"{folder}: expected the stimulus set of {protocol.name}, found none;\n"
                f"run `{render_command(protocol)}`, or name another set with --stimuli"
            )
        return load_manifest(folder)
    if (full := _full_set(protocol)) is not None:
        return full
    library = Library(motion_directories(args.motions))
    spec = set_spec(protocol, None, library, rehearsal=True)
    folder = SETS / f"{protocol.name}-rehearsal"
    with progress(None, "rendering") as step:
        return build(spec, library, folder, progress=step)


def _full_set(protocol: Any) -> Any:
    """The study's own set where it lies whole: a rehearsal shows the middle of its clips."""
    from stimuli.errors import InputError
    from stimuli.sets import load_manifest
    from study.protocol.rendered import SETS, check_rendered

    try:
        manifest = load_manifest(SETS / protocol.name)
        check_rendered(protocol, manifest, rehearsal=True)
    except InputError:
        return None
    names = {pair.name for pair in protocol.file.stimuli.shown(rehearsal=True)}
    shown = [clip for clip in manifest.clips if clip.motion in names]
    return manifest if all(clip.path.is_file() for clip in shown) else None


def _tell_before(args: argparse.Namespace, protocol: Any, references: dict[str, int]) -> int:
    """How long it will take, and that it is one run more of somebody who has finished one.

    Returns about how many trials there will be.
    """
    from study.record.dataset import finished_runs, runs, unfinished
    from study.session.duration import session_duration

    pending = None
    if not args.restart:  # which reads nothing of the run that it leaves
        pending = unfinished(args.data, args.participant, protocol, args.rehearsal)
    done = finished_runs(args.data, args.participant, protocol.label, args.rehearsal)
    if done and pending is None:
        number = max(runs(args.data, args.participant, protocol.label)) + 1
        kind = "rehearsal" if args.rehearsal else "run"
        print(
            f"{args.participant} has a finished {kind} of {protocol.name} already "
            f"(run {', '.join(map(str, done))}); this is run {number}",
            file=sys.stderr,
        )
    duration = session_duration(protocol, references, args.rehearsal)
    print(duration.told(args.pace), file=sys.stderr)
    return duration.trials


def _lost(args: argparse.Namespace) -> str:
    """What is said when the screen goes away."""
    folder = args.data / f"sub-{args.participant}"
    return (
        f"segue run: the screen went away; all answers so far are kept in {folder}.\n"
        f"Bring it back, and go on with: {_resume_command(args)}"
    )


def _resume_command(args: argparse.Namespace) -> str:
    """The command that goes on with this session as it began, ready to paste."""
    words = ["segue", "run", args.protocol, "--participant", args.participant]
    words += ["--data", str(args.data)]
    if args.stimuli is not None:
        words += ["--stimuli", str(args.stimuli)]
    for option, value, usual in (
        ("--screen", args.screen, 0),
        ("--observer", args.observer, "human"),
        ("--pace", args.pace, 1.0),
    ):
        if value != usual:
            words += [option, f"{value:g}" if isinstance(value, float) else str(value)]
    words += [f"--{flag}" for flag in ("windowed", "rehearsal") if getattr(args, flag)]
    for directory in args.motions or ():
        words += ["--motions", str(directory)]
    return shlex.join([*words, "--resume"])


def _resume(args: argparse.Namespace, record: Any) -> bool:
    """Whether to go on with an unfinished record: as --resume says, else ask."""
    from stimuli.errors import InputError

    if args.resume:
        return True
    done = len(record.rows())
    if not sys.stdin.isatty():
        raise InputError(
            f"{record.path.name}: found an unfinished session with {done} trials; say --resume to "
            "go on with it, or --restart to begin a new run"
        )
    print(f"{record.path.name} is unfinished, with {done} trials.", file=sys.stderr)
    return input("Go on with it? [Y/n] ").strip().lower() in ("", "y", "yes")


def _place(args: argparse.Namespace) -> int:
    """Which part of a battery this session is; alone it is the first."""
    part = getattr(args, "battery", None)
    return int(part["position"]) if part else 1


def _asks(args: argparse.Namespace) -> bool:
    return args.observer == "human" and not args.rehearsal and sys.stdin.isatty()


def _ask_person(args: argparse.Namespace, protocol: Any) -> None:
    """What a study asks of a person, before the session, if no dialog did, on a terminal.

    Blank is n/a.
    """
    from study.record.dataset import enrol, prepare
    from study.record.people import QUESTIONS

    answers = getattr(args, "details", {})
    if _place(args) != 1 or args.rehearsal:
        return
    if not answers and _asks(args):
        answers = {key: input(f"{asked.told}: ").strip() for key, asked in QUESTIONS.items()}
    if answers:
        prepare(args.data, protocol.file.lab)
        enrol(args.data, args.participant, **answers)


def _ask_comments(args: argparse.Namespace) -> None:
    from study.record.dataset import enrol

    part = getattr(args, "battery", None)
    if _asks(args) and (part is None or _place(args) == len(part["order"])):
        enrol(args.data, args.participant, comments=" ".join(input("comments: ").split()))
