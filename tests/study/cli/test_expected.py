"""What studies of a protocol's observer come to, and whether another study comes to that."""

import json
from pathlib import Path

import pytest

from study.cli import main
from study.cli.designs import SimulatedStudy, one_study, simulated_trials
from study.cli.expected import expected, measured
from study.protocol.protocol import shipped
from study.trials.reading import load_protocol, parse_protocol
from tests.study.session.test_session import PREFERENCE

NATURAL = PREFERENCE.split("[observer]")[0].replace('"preference"', '"natural"') + (
    "[observer]\nnatural = { geodesic = 0.9, fixed = 0.4, velocity = 0.5 }\n"
)
STUDIES, SDS = 30, 3.3
WHO_TELLS = {"jnd-pilot": set()}  # of whose levels the least is beyond these thresholds


def test_a_certificate_says_what_studies_of_the_observer_come_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--out", str(tmp_path / "c.json"), "--workers", "1", "--sets", "4"]
    assert main(["certify", "weights", "--json", *options]) == 0
    held = {row["what"]: row for row in json.loads(capsys.readouterr().out)["expected"]}
    assert set(held) == {
        "realism, lee", "realism, wang", "noticeability, lee", "noticeability, wang",
        "looks better", "more natural",
    }  # fmt: skip
    for row in held.values():
        assert row["low"] <= row["mean"] <= row["high"]
        assert abs(row["mean"] - row["truth"]) < 0.6


def test_of_preferences_it_says_the_share_of_each_category() -> None:
    protocol = load_protocol("study-four")
    study = {"table": simulated_trials(protocol, SimulatedStudy(protocol.document, {}, 1, 35))[0]}
    held = measured(protocol, study)
    assert held == {
        "geodesic over velocity, locomotion": pytest.approx(0.75, abs=0.15),
        "geodesic over velocity, activity": pytest.approx(0.111, abs=0.15),
    }


def test_of_naturalness_it_says_how_often_each_method_is_called_natural() -> None:
    protocol = parse_protocol(NATURAL)
    job = SimulatedStudy(dict(protocol.document), {}, 1, 12)
    held = measured(protocol, one_study(job))
    assert held["natural, geodesic"] == pytest.approx(0.9, abs=0.1)
    assert held["natural, fixed"] == pytest.approx(0.4, abs=0.15)


def test_an_effect_of_a_study_of_ratings_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["certify", "weights", "--effect", "0.5"]) == 2
    assert "expected none for a rating study" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(shipped()))
def test_another_study_comes_out_as_the_certificate_expects(name: str) -> None:
    """Each quantity within 3.3 SDs of its mean, so that chance does not decide in 1,000 studies."""
    protocol = load_protocol(name)
    references = {pair.name: 10 for pair in protocol.file.stimuli.motions}
    people = max(protocol.file.participants, 12)
    jobs = [
        SimulatedStudy(dict(protocol.document), references, seed, people)
        for seed in range(100, 101 + STUDIES)
    ]
    *studies, other = [one_study(job) for job in jobs]
    rows = expected(protocol, studies)
    told = {row["what"] for row in rows if "mean" in row}
    assert told == WHO_TELLS.get(name, {row["what"] for row in rows})
    for row in rows:
        if row["what"] in told:
            assert abs(other["measured"][row["what"]] - row["mean"]) < SDS * row["sd"], row
