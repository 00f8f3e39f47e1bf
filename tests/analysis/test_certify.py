"""`segue certify`: figures of a design, and the report that quotes them."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.certificate import PowerJob, difference_power, fewest, preference_power
from analysis.design import balance, telltale
from analysis.record import read
from analysis.report import write_report
from analysis.report.certificate_part import certificate_section
from analysis.report.context import Context
from analysis.screening import screen
from study.cli import main
from tests.analysis import records

PROTOCOL = """
name = "small"
task = "{task}"
participants = 3
{methods}
[stimuli]
specification = "center-aligned"
{stimuli}
motions = [{{ name = "one", from = "a", to = "b" }}, {{ name = "two", from = "b", to = "a" }}]
[sets.sample]
a = {{ clip = "x", frame = 0 }}
b = {{ clip = "y", frame = 0 }}
{more}
"""
ODD_PAIR = PROTOCOL.format(
    task="odd-pair",
    methods="",
    stimuli="reference = 10\nshorter = [2, 4, 6, 8]\nlonger = [2, 4, 6, 8, 10, 12]",
    more="""
[staircase]
rule = "levitt"
stop = { visits = 6 }
[observer]
shorter = -5
longer = 7
slope = 0.8
""",
)
PREFERENCE = PROTOCOL.format(
    task="preference",
    methods='methods = ["geodesic", "fixed"]',
    stimuli="",
    more="[observer]\nprefer = { geodesic = 0.8, fixed = 0.2 }\n",
)


def certified(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> dict:
    protocol = tmp_path / "small.toml"
    protocol.write_text(text)
    options = ["--sets", "2", "--workers", "1", "--out", str(tmp_path / "certificate.json")]
    assert main(["certify", str(protocol), "--json", *options]) == 0
    return json.loads(capsys.readouterr().out)


def test_odd_pair(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    entry = certified(ODD_PAIR, tmp_path, capsys)
    assert {"trials", "minutes", "balance", "staircases", "convergence", "thresholds", "power",
            "recommended_participants"} <= set(entry)  # fmt: skip
    assert entry["minutes"]["mean"] > 1
    assert [(row["motion"], row["side"]) for row in entry["staircases"]] == [
        ("one", "shorter"), ("one", "longer"), ("two", "shorter"), ("two", "longer"),
    ]  # fmt: skip
    assert all(0.6 < row["target"] < 0.8 for row in entry["staircases"])
    by_side = {row["track"]: row["ends_first"] + row["ends_last"] for row in entry["ends"]}
    assert list(by_side) == ["one, two/shorter", "one, two/longer"]
    simulated = {row["side"]: row["ended_at_edge"] for row in entry["convergence"]}
    for track, share in by_side.items():  # of twelve tracks a side
        assert abs(share - simulated[track.split("/")[1]]) < 0.5
    assert [row["side"] for row in entry["thresholds"]] == ["shorter", "longer"]
    assert {3, 6, 12} <= {row["participants"] for row in entry["power"]}
    age = datetime.now(UTC) - datetime.fromisoformat(entry["created"])
    assert timedelta(0) <= age < timedelta(minutes=5)
    written = json.loads((tmp_path / "certificate.json").read_text())
    assert written[entry["protocol_hash"]] == entry


def test_preference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    entry = certified(PREFERENCE, tmp_path, capsys)
    assert set(entry["finds"]) == {"chi2", "mixed_model"}
    assert entry["power_test"].startswith("the mixed model")
    assert entry["power_test"] in entry["power_of"]
    assert set(entry["balance"]) == {"geodesic first", "fixed first"}


OPPOSITE = (
    PREFERENCE.replace('to = "b" }', 'to = "b", category = "walks" }')
    .replace('to = "a" }', 'to = "a", category = "dances" }')
    .replace(
        "prefer = { geodesic = 0.8, fixed = 0.2 }",
        "prefer = { walks = { geodesic = 0.9, fixed = 0.1 }, "
        "dances = { geodesic = 0.1, fixed = 0.9 } }",
    )
)


def test_opposite_effects_are_certified_by_category(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Pooled, two opposite preferences are none: the power is of each category."""
    protocol = tmp_path / "small.toml"
    protocol.write_text(OPPOSITE)
    options = ["--sets", "3", "--participants", "30", "--workers", "1", "--effect", "0.9"]
    out = ["--out", str(tmp_path / "certificate.json")]
    assert main(["certify", str(protocol), "--json", *options, *out]) == 0
    entry = json.loads(capsys.readouterr().out)
    assert set(entry["finds_by_category"]) == {"walks", "dances"}
    assert all(held["chi2"] == 1.0 for held in entry["finds_by_category"].values())
    assert {row["category"] for row in entry["power"]} == {"walks", "dances"}
    assert entry["recommended_for"].endswith("in every category")
    assert main(["certify", str(protocol), *options, *out]) == 0
    told = capsys.readouterr().out
    assert "chi2 finds the observer's preference of walks in 1.00 of studies" in told
    assert "power is that of the mixed model of people and motions" in told


def test_in_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    protocol = tmp_path / "small.toml"
    protocol.write_text(ODD_PAIR)
    out = str(tmp_path / "certificate.json")
    assert main(["certify", str(protocol), "--sets", "2", "--workers", "1", "--out", out]) == 0
    told = capsys.readouterr().out
    assert "settles at a proportion of" in told
    assert "people recommended" in told


def test_certificates_of_other_protocols_stay(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "certificate.json").write_text('{"other": {"protocol": "x"}}')
    entry = certified(PREFERENCE, tmp_path, capsys)
    written = json.loads((tmp_path / "certificate.json").read_text())
    assert set(written) == {"other", entry["protocol_hash"]}


def test_the_report_quotes_the_certificate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    entry = certified(ODD_PAIR, tmp_path, capsys)
    rng = np.random.default_rng(0)
    data = tmp_path / "data"
    rows = {"a": records.odd_pair_rows(rng), "b": records.odd_pair_rows(rng)}
    records.write_dataset(
        data, records.odd_pair_protocol(), rows, ProtocolHash=entry["protocol_hash"]
    )
    written = write_report([data])
    assert written.document["studies"][0]["certificate"] == entry
    page = written.page.read_text()
    assert "Certified (2 simulated studies of 3 people)" in page
    assert "before the data" not in page.split("What the design can show")[1][:900]


HELD = {
    "created": "2026-03-01T12:00:00+00:00",
    "participants": 6,
    "simulated_sets": 9,
    "power_of": "telling two thresholds apart",
    "power": [
        {"effect": effect, "participants": n, "power": effect * n / 100}
        for effect in (1.0, 2.0)
        for n in (6, 12, 18)
    ],
    "recommended_participants": 18,
    "recommended_for": "power 0.8 for a difference of 2 frames",
}


def quoted(tmp_path: Path, held: dict, *, participants: int = 12, **sidecar: object) -> str:
    """What a report says of the certificate `held`."""
    rng = np.random.default_rng(0)
    (tmp_path / "certificate.json").write_text(json.dumps({"mark": held}))
    protocol = records.odd_pair_protocol(participants=participants)
    rows = {"a": records.odd_pair_rows(rng)}
    data = records.write_dataset(
        tmp_path / "data", protocol, rows, **{"ProtocolHash": "mark", **sidecar}
    )
    study, notes = read([data])
    assert notes == []
    context = Context(study[0], screen(study[0]), certificates={"mark": held})
    return " ".join(certificate_section(context).text)


@pytest.mark.parametrize(
    ("created", "flip", "said"),
    [
        (HELD["created"], 1772409600.0, "Certified before the data (9"),
        (HELD["created"], 1772323200.0, "Certified after the first session of the data (9"),
        (HELD["created"], None, "Certified (9"),
        (None, 1772409600.0, "Certified (9"),
        ("yesterday", 1772409600.0, "Certified (9"),
        ("2026-03-01T12:00:00", 1772409600.0, "Certified (9"),
    ],
)
def test_when_it_was_certified_is_said_only_where_it_is_known(
    created: str | None, flip: float | None, said: str, tmp_path: Path
) -> None:
    sidecar = {} if flip is None else {"FirstFlip": flip}
    assert quoted(tmp_path, HELD | {"created": created}, **sidecar).startswith(said)


def test_the_power_quoted_is_that_of_the_protocols_own_people(tmp_path: Path) -> None:
    told = quoted(tmp_path, HELD)
    assert "18 people are recommended (power 0.8 for a difference of 2 frames)" in told
    assert (
        "with 12 people the power of telling two thresholds apart is .12 for an effect of 1 and "
        ".24 for an effect of 2." in told
    )
    assert "with 6 people" in quoted(tmp_path, HELD, participants=7)
    assert "with" not in quoted(
        tmp_path, {"participants": 7, "power": HELD["power"]}, participants=7
    )
    none = HELD | {"recommended_participants": None}
    assert "more people than could be tried are recommended" in quoted(tmp_path, none)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--sets", "1"], "--sets and --participants"),
        (["--stimuli", "nowhere"], "expected a stimulus set"),
        (["--effect", "3"], "--effect: expected a share"),
    ],
)
def test_refusals(
    options: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    protocol = tmp_path / "small.toml"
    protocol.write_text(PREFERENCE)
    base = ["certify", str(protocol), "--sets", "2", "--workers", "1"]
    assert main([*base, "--out", str(tmp_path / "c.json"), *options]) == 2
    assert message in capsys.readouterr().err


def test_clips_that_position_gives_away_are_named() -> None:
    clips = [
        {"motion": "walk", "length": 4, "measures": {"displacement_after": 0.11}},
        {"motion": "walk", "length": 6, "measures": {"displacement_after": 0.01}},
        {"motion": "walk", "length": 8, "measures": {}},
    ]
    (told,) = telltale(clips)
    assert "walk, length 4: the figure ends 11 cm" in told


def test_balance_within_sessions() -> None:
    table = pd.DataFrame(
        {"participant": ["a", "a", "b", "b"], "first_method": ["x", "x", "x", "y"]}
    )
    assert balance(table)["x first"] == {"share": 0.75, "least": 0.5, "most": 1.0}


def test_power_grows_with_people_and_effect() -> None:
    few = difference_power(2, 0.6, 12, 12, 0.05)
    assert few < difference_power(2, 0.6, 12, 24, 0.05)
    assert difference_power(0, 0.6, 12, 12, 0.05) == pytest.approx(0.05)
    # 100 sets at .05: three binomial standard errors are .065.
    assert preference_power(PowerJob(0.5, 12, 8, 0.05, 0.3, 100, (1,))) <= 0.05 + 0.066
    assert preference_power(PowerJob(0.75, 35, 8, 0.05, 0.3, 10, (2,))) == 1.0
    assert fewest({6: 0.5, 12: 0.85, 24: 0.9}) == 12
    assert fewest({6: 0.5}) is None
