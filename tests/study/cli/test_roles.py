"""`segue motions --roles FILE`: what a clip's joints were taken for, as overrides to start from."""

import tomllib

import pytest

from stimuli.motion import load_clip, write_walker
from study.cli import main


@pytest.fixture
def walker_file(tmp_path):
    return write_walker(tmp_path, 0)


def test_roles_are_printed_as_a_file_of_overrides(walker_file, capsys):
    assert main(["motions", "--roles", str(walker_file)]) == 0
    said = capsys.readouterr()
    skeleton = load_clip(walker_file).motion.skeleton
    expected = {role: skeleton.names[joint] for role, joint in skeleton.roles.items()}
    assert tomllib.loads(said.out) == {"roles": expected}
    assert '# left_toe = ""' in said.out
    assert said.err == ""


def test_overrides_given_are_in_what_is_printed(walker_file, tmp_path, capsys):
    given = tmp_path / "mine.toml"
    given.write_text('[roles]\nspine = "root"\n')
    assert main(["motions", "--roles", str(walker_file), "--overrides", str(given)]) == 0
    assert tomllib.loads(capsys.readouterr().out)["roles"]["spine"] == "root"


@pytest.mark.parametrize(
    ("words", "told"),
    [(["nowhere.bvh"], "expected a file to read"), (["a.fbx"], "BVH"),
     (["a.bvh", "b.bvh"], "expected one FILE, found another argument, b.bvh"),
     (["a.bvh", "--json"], "--roles: expected no --json beside it")],
)  # fmt: skip
def test_what_cannot_be_read_has_no_roles(tmp_path, monkeypatch, capsys, words, told):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.fbx").write_bytes(b"Kaydara FBX Binary")
    assert main(["motions", "--roles", *words]) == 2
    said = capsys.readouterr()
    assert told in said.err
    assert said.out == ""
