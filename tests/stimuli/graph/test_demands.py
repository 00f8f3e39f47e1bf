"""Files of demands: what they may say, and all of their faults at once, each with its line."""

from pathlib import Path

import pytest

from stimuli.errors import InputError
from stimuli.graph import read_demands, unmet_faults

GOOD = """frames = 90
weights = { cuts = 2 }
body = [
    { at = 0, place = [0, 0], heading = 0 },
    { at = "end", place = [1, 2], heading = 90 },
]
joint = [{ at = 40, role = "head", place = [0, 1.7, 1], velocity = [0, 0, 1] }]
style = [{ from = 10, to = 20, label = "odd" }]
avoid = [{ centre = [5, 5], radius = 1 }, { low = [3, 3], high = [4, 4] }]

[[pose]]
at = 30
clip = "a"
frame = 12
"""


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "d.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_whole_file_is_read(tmp_path: Path) -> None:
    (demands,) = read_demands(written(tmp_path, GOOD)).figures
    assert demands.frames == 90
    assert [b["at"] for b in demands.of("body")] == [0, 89]
    assert demands.weights["cuts"] == 2.0
    assert [len(demands.of(kind)) for kind in ("joint", "style", "avoid", "pose")] == [1, 1, 2, 1]


def test_several_figures_are_told_apart(tmp_path: Path) -> None:
    first, last = (f"{{ at = {at}, place = [0, 1], heading = 9 }}" for at in ("0", '"end"'))
    bodies = f"body = [{first}, {last}]"
    text = "".join(f"[figures.{name}]\nframes = 60\n{bodies}\n" for name in ("one", "two"))
    figures = read_demands(written(tmp_path, text)).figures
    assert [(figure.name, figure.frames) for figure in figures] == [("one", 60), ("two", 60)]


def test_all_faults_are_told_at_once_each_with_its_line(tmp_path: Path) -> None:
    text = """frames = 1.5
body = [
    { at = 3, place = [0], heading = "n" },
    { at = 3, plce = [0, 0], heading = 0 },
]
joint = [{ at = -1, role = "", place = [0, 0, nan] }]
style = [{ from = 9, to = 3, label = "walk" }]
avoid = [
    { centre = [0, 0] },
    { low = [1, 1], high = [0, 2] },
    { low = [1, 1], high = [2, 2, 2] },
]
wieghts = { cuts = -1 }
shortest = 0
"""
    path = written(tmp_path, text)
    with pytest.raises(InputError) as refused:
        read_demands(path)
    told = str(refused.value).splitlines()
    for line, key in (
        (1, "frames"), (2, "body"), (3, "body.0.place"), (3, "body.0.heading"),
        (4, "body.1.plce"), (4, "body.1.at"), (6, "joint.0.at"), (6, "joint.0.role"),
        (6, "joint.0.place"), (7, "style.0.to"), (9, "avoid.0"), (10, "avoid.1.high"),
        (11, "avoid.2.high"), (13, "wieghts"), (14, "shortest"),
    ):  # fmt: skip
        assert any(entry.startswith(f"{path}:{line}: {key}: ") for entry in told), (line, key, told)
    assert any("did you mean weights?" in entry for entry in told)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("frames = ", "expected TOML"),
        ("frames = 60\nfigures = 3", "figures: expected tables"),
        ("frames = 60\n[figures.x]\nframes = 60", "expected only .figures.NAME."),
        ("frames = 60\nbody = 3", "body: expected a list of tables, found 3"),
    ],
)
def test_what_is_no_file_of_demands_is_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_demands(written(tmp_path, text))


def test_what_the_collection_does_not_have_is_told_with_its_line(tmp_path, bodies, graphs) -> None:
    collection = graphs.collection_of(
        bodies.wandering(40, 1), bodies.wandering(40, 2), labels=("odd", "even")
    )
    graph = graphs.with_edges(collection, 100)
    file = read_demands(written(tmp_path, GOOD))
    file.refuse(list(unmet_faults(file.figures[0], collection, graph)))
    text = GOOD.replace('"head"', '"tail"').replace('"odd"', '"sad"').replace("12", "99")
    bad = read_demands(written(tmp_path, text))
    with pytest.raises(InputError) as refused:
        bad.refuse(list(unmet_faults(bad.figures[0], collection, graph)))
    told = str(refused.value)
    for part in (":7: joint.0.role: expected a role",
                 ":8: style.0.label: expected one of even, odd",
                 ":14: pose.0.frame: expected 0 to 39 of a, found 99"):  # fmt: skip
        assert part in told


def test_poses_in_parts_that_are_not_connected_are_refused_with_both_named(
    tmp_path, bodies, graphs
) -> None:
    far = bodies.wandering(60, 2, speed=0.3)
    bent = far.rotations.copy()
    bent[:, 1:] = bodies.standing(1).rotations[:, :1]  # no pose of the other clip is like these
    collection = graphs.collection_of(
        bodies.wandering(60, 1, speed=0.3), type(far)(far.skeleton, bent, far.root)
    )
    graph = graphs.with_edges(collection, 4)
    assert not graph.joined[0, 1]
    assert not graph.joined[1, 0]
    text = (
        GOOD.replace('label = "odd"', 'label = "x"') + '[[pose]]\nat = 50\nclip = "b"\nframe = 3\n'
    )
    text = text.replace('style = [{ from = 10, to = 20, label = "x" }]\n', "")
    file = read_demands(written(tmp_path, text))
    with pytest.raises(
        InputError, match="in parts of the graph that are not connected, of a and of b"
    ):
        file.refuse(list(unmet_faults(file.figures[0], collection, graph)))
