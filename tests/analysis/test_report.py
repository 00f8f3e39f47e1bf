"""The report whole: its files, its keys, and what it escapes."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from analysis.errors import NothingAnalysed
from analysis.report import write_report
from tests.analysis import records


@pytest.fixture(scope="module")
def written(jnd: Path, study_one: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("out")
    write_report([jnd, study_one], out)
    return out


def document(out: Path) -> dict:
    return json.loads((out / "report.json").read_text())


def test_files(written: Path) -> None:
    assert (written / "report.html").is_file()
    assert len(list((written / "figures").glob("*.svg"))) >= 4
    assert len(list((written / "tables").glob("*.csv"))) >= 3


def test_keys_of_a_comparison(written: Path) -> None:
    study = document(written)["studies"][0]
    assert {"protocol", "task", "participants", "trials", "excluded", "comparisons", "ratings",
            "psychometric", "text"} <= set(study)  # fmt: skip
    (comparison,) = study["comparisons"]
    assert comparison["a"] == "geodesic"
    assert comparison["category"] == "all"
    assert (comparison["n"], comparison["prefer_a"], comparison["df"]) == (280, 270, 1)
    assert comparison["chi2"] == pytest.approx(241.43, abs=0.005)
    assert len(comparison["per_motion"]) == 8
    assert any("χ²(1, N = 280) = 241.43, p < .001" in sentence for sentence in study["text"])


def test_keys_of_a_psychometric_entry(written: Path) -> None:
    study = document(written)["studies"][1]
    pooled = [
        entry
        for entry in study["psychometric"]
        if entry["motion"] == "all" and entry["participant"] == "all"
    ]
    assert [entry["side"] for entry in pooled] == ["shorter", "longer"]
    for entry in pooled:
        assert {"specification", "n", "location", "slope", "guess", "lapse", "log_likelihood",
                "deviance", "deviance_p", "threshold", "interval_method", "verdict",
                "staircase_threshold"} <= set(entry)  # fmt: skip
        threshold = entry["threshold"]
        assert threshold["at"] == 0.75
        low, high = (
            threshold[end] if f"{end}_reason" not in threshold else edge
            for end, edge in (("low", -np.inf), ("high", np.inf))
        )
        assert low < threshold["value"] < high
        assert set(entry["staircase_threshold"]) == {"stop_level", "reversal_mean"}
    assert pooled[0]["threshold"]["value"] < 0 < pooled[1]["threshold"]["value"]
    assert {entry["participant"] for entry in study["psychometric"]} > {"p00", "p05"}


def test_an_end_beyond_the_levels_is_told_everywhere_and_never_a_number(written: Path) -> None:
    """The shorter blends of this study end at −8, and their threshold lies at −7."""
    study = document(written)["studies"][1]
    entry = next(e for e in study["psychometric"] if e["side"] == "shorter")
    assert entry["threshold"]["low"] is None
    assert entry["threshold"]["low_reason"] == "beyond −8, the last level shown"
    assert any("95% CI [beyond −8, −" in sentence for sentence in study["text"])
    page = (written / "report.html").read_text()
    assert "beyond −8 to −" in page
    for told in study["psychometric"]:
        ends = [told["threshold"][end] for end in ("low", "high")]
        assert all(end is None or -8 <= end <= 12 for end in ends)


def test_the_page_needs_no_network_and_is_one_file(written: Path) -> None:
    page = (written / "report.html").read_text()
    assert page.count("<svg") >= 4
    assert not re.findall(r"(?:src|href)=\"(?!#)", page)
    assert "@import" not in page
    assert "<script" not in page


def test_text_from_logs_is_escaped(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    evil = "<script>alert(1)</script>$x_"
    rows = {"a": records.odd_pair_rows(rng, motions=(evil, "b")), "b": records.odd_pair_rows(rng)}
    protocol = records.odd_pair_protocol(title="<img src=x onerror=alert(1)>")
    written = write_report([records.write_dataset(tmp_path, protocol, rows)])
    page = written.page.read_text()
    assert "<script>" not in page
    assert "<img" not in page
    assert written.page == tmp_path / "derivatives" / "segue" / "report.html"


def test_a_report_of_nothing_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text("difference,correct\n4,n/a\n")
    with pytest.raises(NothingAnalysed, match="trials without an answer: 1 trial"):
        write_report([path], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_beside_a_study_that_counts_one_of_which_nothing_is_left_is_told(tmp_path: Path) -> None:
    empty, good = tmp_path / "empty.csv", tmp_path / "good.csv"
    empty.write_text("participant,difference,correct\nann,4,n/a\n")
    good.write_text("participant,difference,correct\nann,4,1\nbob,4,0\n")
    first, second = write_report([empty, good], tmp_path / "out").document["studies"]
    assert (first["trials"], first["excluded"], first["psychometric"]) == (0, 1, [])
    assert (first["participants"], first["participants_recorded"]) == (0, 1)
    assert first["participants_left_out"] == [
        {"participant": "ann", "reason": "no trial of theirs counts: practice, void or unanswered"}
    ]
    assert second["participants"] == 2


def test_the_same_record_gives_the_same_report(
    written: Path, jnd: Path, study_one: Path, tmp_path: Path
) -> None:
    again = write_report([jnd, study_one], tmp_path).page
    assert again.read_bytes() == (written / "report.html").read_bytes()


def test_rules_of_the_protocol_exclude_people(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    sessions = {}
    for person, right in (("good", 1), ("poor", 0)):
        rows = records.odd_pair_rows(rng)
        catch = [dict(rows[0], phase="catch", correct=right) for _ in range(5)]
        void = [dict(rows[1], void=1)]
        sessions[person] = rows + catch + void
    protocol = records.odd_pair_protocol(
        analysis={"exclude_catch_below": 0.8, "exclude_missing_above": 0.2}
    )
    written = write_report([records.write_dataset(tmp_path, protocol, sessions)])
    found = written.document["studies"][0]
    rules = {entry["rule"]: entry for entry in found["exclusions"]}
    assert rules["people with fewer than 80% of catch trials right"]["participants"] == ["poor"]
    assert rules["void trials (shown too late)"]["trials"] == 2
    assert {entry["participant"] for entry in found["psychometric"]} == {"all"}
    assert (found["participants"], found["participants_recorded"]) == (1, 2)
    assert found["participants_left_out"] == [
        {"participant": "poor", "reason": "people with fewer than 80% of catch trials right"}
    ]
    page = written.page.read_text()
    assert "2 people took part in 2 sessions" in page
    assert "The answers of 1 are analysed; left out are 1 person (poor: people with fewer" in page
