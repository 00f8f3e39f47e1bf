"""`segue embed` as a user meets it, on generated walkers."""

import json
from pathlib import Path

import pytest
from PIL import Image

from stimuli.motion import load_clip, write_walker
from study.cli import main
from tests.browser import ask

ONE, OTHER = "generated-walker-0", "generated-walker-1"


@pytest.fixture(scope="module")
def walkers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("motions")
    for seed in range(2):
        write_walker(folder, seed)
    return folder


@pytest.fixture(autouse=True)
def place(tmp_path: Path, walkers: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SEGUE_MOTIONS", str(walkers))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_one_clip_is_embedded_drawn_and_resequenced(place: Path, capsys) -> None:
    words = ["embed", ONE, "--resequence", "2", "--seed", "3", "--json"]
    outs = ["--out", "e.png", "--out", "e.html", "--out", "r.bvh"]
    assert main([*words, *outs]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(told["residual_variance"]) == 10
    assert told["dimensions"] >= 3
    degrees = told["decoder"]["degrees"]
    assert set(degrees) == {"network", "nearest", "interpolated"}
    worse = degrees["network"] > degrees["nearest"]
    assert not worse or told["remark"].startswith("the network is worse than the nearest frame")
    motion = load_clip(place / "r.bvh").motion
    assert len(motion) == told["resequenced"]["frames"] == 60
    assert main(["score", "r.bvh", "--json"]) == 0
    again = json.loads(capsys.readouterr().out)[0]["naturalness"]
    assert again == pytest.approx(told["resequenced"]["naturalness"], abs=2e-3)
    with Image.open("e.png") as picture:
        assert picture.width > 1000
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 100
    page = Path("e.html").read_text(encoding="utf-8")
    assert f"{ONE}:7" in page
    assert "<script src=" not in page


def test_the_page_draws_both_clips_and_asks_for_nothing(place: Path, tmp_path: Path) -> None:
    assert main(["embed", ONE, OTHER, "--neighbours", "40", "--out", "e.html"]) == 0
    script = """
        const asked = performance.getEntriesByType("resource").map(entry => entry.name);
        const plot = document.querySelector(".js-plotly-plot");
        return { asked, clips: plot.data.map(curve => curve.name) };
    """
    told = ask(place / "e.html", script, tmp_path / "profile")
    assert told == {"asked": [], "clips": [ONE, OTHER]}


def test_two_clips_together_name_where_they_come_close(capsys) -> None:
    assert main(["embed", ONE, OTHER, "--neighbours", "40", "--dimensions", "4"]) == 0
    told = capsys.readouterr().out
    assert f"{ONE}:" in told
    assert f"is close to {OTHER}:" in told
    assert "% of pairs cost less" in told
    assert "decoded from 4 dimensions" in told


def test_a_blend_goes_the_same_way(capsys) -> None:
    ends = [f"{ONE}:20", f"{ONE}:33"]
    assert main(["blend", *ends, "--method", "manifold", "--out", "b.bvh", "--json"]) == 0
    done = json.loads(capsys.readouterr().out)
    assert done["method"] == "manifold"
    assert done["frames"] >= 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((ONE, "--dimensions", "11"), "expected from 1 to 10, found 11"),
        ((ONE, "--neighbours", "0"), "expected a whole number, 1 or more"),
        ((ONE, "--neighbours", "5000"), "neighbours of each of"),
        ((ONE, "--out", "r.bvh"), "expected a file name with .png or"),
        (("nobody",), "nobody"),
    ],
)
def test_what_cannot_be_is_refused(words: tuple[str, ...], said: str, capsys) -> None:
    try:
        code = main(["embed", *words])
    except SystemExit as end:
        code = end.code
    assert code == 2
    assert said in capsys.readouterr().err
    assert not list(Path().iterdir())
