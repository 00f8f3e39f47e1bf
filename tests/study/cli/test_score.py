"""`segue score` on motions of whatever made them."""

import csv
import json
from pathlib import Path

import pytest
from PIL import Image

from study.cli import main


def test_a_motion_is_scored_frame_by_frame(
    sample_motions: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    walk = next(sample_motions.glob("humanoid3d_walk.*"))
    table, picture = tmp_path / "frames.csv", tmp_path / "score.png"
    arguments = [str(walk), "--csv", str(table), "--plot", str(picture), "--json", "--frames"]
    assert main(["score", *arguments]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert found["name"] == "humanoid3d_walk"
    assert found["naturalness"] == pytest.approx(found["plant_error"] + found["zmp_error"])
    assert found["ballistic_error"] is None
    with table.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == found["frames"] == len(found["course"])
    slides = [float(row[f"{side}_slide"] or "nan") for row in rows for side in ("left", "right")]
    told = [slide for slide in slides if slide == slide]
    assert sum(told) / len(told) == pytest.approx(found["plant_error"], abs=1e-5)
    beyond = [float(row["zmp_beyond"]) for row in rows if row["zmp_beyond"]]
    assert max(beyond) == pytest.approx(found["zmp_error"])
    with Image.open(picture) as drawn:
        assert min(drawn.size) > 500


def test_a_directory_is_scored_and_what_is_refused_is_said(
    sample_motions: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for path in sample_motions.glob("turn_left*.json"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "broken.bvh").write_text("HIERARCHY\n")
    assert main(["score", str(tmp_path)]) == 0
    told = capsys.readouterr()
    assert "turn_left0" in told.out
    assert "turn_left1" in told.out
    assert "broken.bvh" in told.err
    assert main(["score", str(tmp_path / "broken.bvh")]) == 2
    assert main(["score", str(tmp_path), "--plot", str(tmp_path / "a.png")]) == 2
    assert "one motion to draw, found 2" in capsys.readouterr().err


def test_masses_are_fitted_to_the_motions_that_are_named(
    sample_motions: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    walk = str(next(sample_motions.glob("humanoid3d_walk.*")))
    scores = []
    for more in ([], ["--masses", walk]):
        assert main(["score", walk, "--json", *more]) == 0
        (found,) = json.loads(capsys.readouterr().out)
        scores.append(found["zmp_error"])
    assert scores[1] <= scores[0] + 0.01
