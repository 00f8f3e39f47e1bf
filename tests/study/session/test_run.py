"""What `segue run` says beside the window: before a session, and when somebody left."""

import json
from argparse import ArgumentParser, Namespace
from pathlib import Path

import pytest

from stimuli.motion import write_walker
from study.cli import main
from study.cli import run as command
from study.protocol.protocol import Protocol
from study.record.dataset import record_path
from study.record.table import COMMON, create
from study.trials.reading import load_protocol
from tests.study.session.test_session import PREFERENCE, REFERENCES


def arguments(*words: str) -> Namespace:
    parser = ArgumentParser()
    command.add_arguments(parser)
    return parser.parse_args(["jnd-center", "--participant", "p01", *words])


def begun(data: Path, number: int, **sidecar: bool) -> Protocol:
    protocol = load_protocol("jnd-center")
    create(record_path(data, "p01", protocol.label, number), tuple(COMMON), dict(sidecar))
    return protocol


@pytest.mark.parametrize("option", ["--resume", "--restart", "--windowed"])
def test_one_run_more_of_somebody_who_has_finished_is_said(
    option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    protocol = begun(tmp_path, 1, Finished=True)
    command._tell_before(arguments("--data", str(tmp_path), option), protocol, REFERENCES)
    told = capsys.readouterr().err.splitlines()
    assert told[0] == ("p01 has a finished run of jnd-center already (run 1); this is run 2")
    assert told[1].startswith("a session has about ")


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ({"Finished": True, "Rehearsal": True}, None),
        ({"Finished": True}, {"Finished": False}),
        ({"Finished": False}, None),
    ],
)
def test_nothing_is_said_of_rehearsals_or_where_a_run_is_gone_on_with(
    first: dict[str, bool],
    second: dict[str, bool] | None,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    protocol = begun(tmp_path, 1, **first)
    if second is not None:
        begun(tmp_path, 2, **second)
    command._tell_before(arguments("--data", str(tmp_path)), protocol, REFERENCES)
    assert "finished" not in capsys.readouterr().err


def test_the_command_to_go_on_is_the_command_that_was_given() -> None:
    given = (
        "--data", "my data", "--stimuli", "a set", "--screen", "1", "--observer", "simulated",
        "--pace", "20", "--windowed", "--rehearsal", "--motions", "m",
    )  # fmt: skip
    told = command._resume_command(arguments(*given, "--seed", "4"))
    assert told == (
        "segue run jnd-center --participant p01 --data 'my data' --stimuli 'a set' --screen 1 "
        "--observer simulated --pace 20 --windowed --rehearsal --motions m --resume"
    )
    plain = "segue run jnd-center --participant p01 --data data --resume"
    assert command._resume_command(arguments("--restart")) == plain


def test_rendering_says_how_long_a_session_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for seed in (0, 1):
        write_walker(tmp_path / "motions", seed)
    clips = PREFERENCE.replace('"x"', '"generated-walker-0"').replace('"y"', '"generated-walker-1"')
    path = tmp_path / "pairs.toml"
    path.write_text(clips + '[appearance]\ncamera = "fixed"\n')
    words = ["render", str(path), "--motions", str(tmp_path / "motions"), "--dry-run"]
    assert main(words) == 0
    assert "a session has 24 trials and takes about 5 minutes" in capsys.readouterr().out
    assert main([*words, "--json"]) == 0
    session = json.loads(capsys.readouterr().out)["session"]
    assert session["trials"] == 24
    assert 4 < session["minutes"] < 6
