"""`segue graph` as a user meets it, on generated walkers."""

import json
from pathlib import Path

import pytest

from stimuli.motion import load_clip, write_walker
from study.cli import main

DEMANDS = """frames = 80
body = [
    { at = 0, place = [0, 0], heading = 0 },
    { at = "end", place = [0.3, 2.5], heading = 20 },
]
avoid = [{ centre = [3, 3], radius = 0.5 }]
"""


@pytest.fixture(scope="module")
def walkers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("motions")
    for seed in range(3):
        write_walker(folder, seed)
    return folder


@pytest.fixture(autouse=True)
def place(tmp_path: Path, walkers: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("SEGUE_MOTIONS", str(walkers))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(DEMANDS)
    return tmp_path


def test_a_graph_is_built_once_kept_and_shown(place: Path, capsys) -> None:
    assert main(["graph", "build", "--tau", "6", "--json"]) == 0
    built = json.loads(capsys.readouterr().out)
    kept = Path(built.pop("file"))
    assert kept.is_relative_to(place / "cache")
    assert built["clips"] == 3
    assert built["edges"] > 100
    assert main(["graph", "show", "--tau", "6", "--out", "g.png", "--reach", "2",
                 "--reach-out", "r.png", "--json"]) == 0  # fmt: skip
    shown = json.loads(capsys.readouterr().out)
    assert shown["floor_m2"] > 0
    assert built.items() <= shown.items()
    assert (place / "g.png").stat().st_size > 10_000
    assert (place / "r.png").stat().st_size > 10_000
    assert len(list(kept.parent.iterdir())) == 1
    assert main(["graph", "show", "--tau", "6", "--connected", "--json"]) == 0
    inside = json.loads(capsys.readouterr().out)
    assert inside["clips"] == inside["connected"] == built["connected"]
    assert inside["outside"] == []
    assert set(inside["leads_on_until"]) == set(built["leads_on_until"]) - set(built["outside"])


def test_a_graph_too_large_for_memory_says_what_to_do(
    place: Path, capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr("stimuli.graph.search_space", full)
    assert main(["graph", "search", "d.toml", "--tau", "6"]) == 2
    assert "Take a smaller --tau or fewer clips" in capsys.readouterr().err


def test_a_search_says_what_is_missed_and_writes_motion_answer_and_picture(
    place: Path, capsys
) -> None:
    words = ["graph", "search", "d.toml", "--tau", "6", "--mutations", "20000"]
    assert main([*words, "--out", "walk.bvh", "--plot", "plan.png"]) == 0
    told = capsys.readouterr().out
    assert "answer 1: S = " in told
    assert "body 2: at 79: " in told
    assert "avoid 1: not entered" in told
    assert len(load_clip(place / "walk.bvh").motion) == 80
    assert (place / "plan.png").stat().st_size > 10_000
    answer = json.loads((place / "walk.json").read_text())
    assert sum(p["to_frame"] - p["from_frame"] + 1 for p in answer["pieces"]) == 80
    assert answer["score"] == pytest.approx(sum(answer["terms"].values()))
    (place / "d.toml").write_text(DEMANDS.replace("[0.3, 2.5]", "[0.6, 2.2]"))
    assert main([*words, "--near", "walk.json", "--json", "--count", "2"]) == 0
    edited = json.loads(capsys.readouterr().out)["answers"]
    assert edited[0]["frames"] == 80
    assert main([*words, "--json"]) == 0
    first = json.loads(capsys.readouterr().out)
    assert main([*words, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == first


def test_figures_of_a_file_are_searched_apart(place: Path, capsys) -> None:
    body = DEMANDS[: DEMANDS.index("avoid")]
    (place / "two.toml").write_text(f"[figures.one]\n{body}\n[figures.two]\n{body}")
    words = ["graph", "search", "two.toml", "--tau", "6", "--mutations", "4000"]
    assert main([*words, "--out", "walk.bvh", "--plot", "both.png", "--json"]) == 0
    assert [a["figure"] for a in json.loads(capsys.readouterr().out)["answers"]] == ["one", "two"]
    assert {"walk-one.bvh", "walk-two.bvh", "walk-one.json"} <= {p.name for p in place.iterdir()}


def test_a_path_and_a_blend_go_the_same_way(place: Path, capsys) -> None:
    ends = ["generated-walker-0:3", "generated-walker-0:33"]
    assert main(["graph", "path", *ends, "--tau", "30", "--json", "--out", "p.bvh"]) == 0
    path = json.loads(capsys.readouterr().out)
    assert len(load_clip(place / "p.bvh").motion) == path["frames"] + 1
    assert main(["blend", *ends, "--method", "motion-graph", "--tau", "30", "--out", "b.bvh",
                 "--json"]) == 0  # fmt: skip
    assert json.loads(capsys.readouterr().out)["frames"] == path["frames"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("build", "--tau", "0"), "--tau"),
        (("build", "--clips", "zz*"), "expected clips of such names"),
        (("build", "--out", "g.txt"), ".npz"),
        (("show", "--graph", "none.npz"), "no such file"),
        (("search", "none.toml"), "expected a file of demands"),
        (("path", "generated-walker-0", "generated-walker-1:3"), "expected CLIP:FRAME"),
        (("path", "nobody:1", "generated-walker-1:3"), "expected a clip of the collection"),
        (("search", "d.toml", "--near", "d.toml"), "expected an answer"),
        (("build", "--scheduler", "tcp://127.0.0.1:1"), "expected a Dask scheduler"),
    ],
)
def test_bad_input_is_said_in_a_line_or_two(capsys, words: tuple[str, ...], said: str) -> None:
    try:
        code = main(["graph", *words, *([] if "--tau" in words else ["--tau", "6"])])
    except SystemExit as left:
        code = int(left.code or 0)
    told = capsys.readouterr().err
    assert code == 2
    assert said in told
    assert "Traceback" not in told


def test_a_graph_from_a_cluster_is_the_same_file(place: Path, capsys) -> None:
    """A real scheduler and two workers on this machine."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None, protocol="tcp",
    ) as cluster:  # fmt: skip
        words = ["graph", "build", "--tau", "6"]
        assert main([*words, "--out", "there.npz", "--scheduler", cluster.scheduler_address]) == 0
    assert main([*words, "--out", "here.npz"]) == 0
    assert (place / "here.npz").read_bytes() == (place / "there.npz").read_bytes()
