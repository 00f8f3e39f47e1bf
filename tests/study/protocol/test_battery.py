"""Batteries: several protocols in one session, in balanced orders."""

import json
import os
import subprocess
import sys
from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest

from stimuli.errors import InputError
from stimuli.motion import write_walker
from study.protocol.battery import battery_of, orders, shipped_batteries
from study.screen.virtual import virtual_screen
from study.trials.reading import load_protocol

ROOT = Path(__file__).resolve().parents[3]
PART = """
name = "{name}"
task = "natural"
methods = ["fixed", "cut"]
[stimuli]
seconds = 0.5
motions = [{{ name = "m", from = "a", to = "b" }}]
[sets.generated]
a = {{ clip = "generated-walker-0", frame = 3 }}
b = {{ clip = "generated-walker-1", frame = 5 }}
[appearance]
width = 160
height = 120
[observer]
natural = {{ fixed = 0.8, cut = 0.2 }}
"""


@pytest.mark.parametrize("count", [2, 3, 4, 5, 6, 7])
def test_each_protocol_comes_in_each_place_and_after_each_other_equally_often(count: int) -> None:
    rows = orders(tuple(map(str, range(count))))
    places = Counter((place, name) for row in rows for place, name in enumerate(row))
    after = Counter(pair for row in rows for pair in pairwise(row))
    assert set(places.values()) == {len(rows) // count}
    assert len(after) == count * (count - 1)
    assert len(set(after.values())) == 1


def test_shipped_batteries_name_protocols_that_ship() -> None:
    for name in shipped_batteries():
        battery = battery_of(name)
        assert battery is not None
        assert [load_protocol(member).name for member in battery.protocols] == list(
            battery.protocols
        )


def test_a_protocol_is_no_battery_and_a_bad_battery_says_why(tmp_path: Path) -> None:
    assert battery_of("study-one") is None
    assert battery_of("nothing") is None
    path = tmp_path / "b.toml"
    path.write_text('name = "b"\nprotocols = ["study-one"]\ncolour = 3\n')
    with pytest.raises(InputError) as caught:
        battery_of(str(path))
    assert len(str(caught.value).splitlines()) == 2


def test_a_battery_is_run_in_an_order_that_few_have_had(tmp_path: Path) -> None:
    for seed in (0, 1):
        write_walker(tmp_path / "motions", seed)
    for name in ("one", "two"):
        (tmp_path / f"{name}.toml").write_text(PART.format(name=name))
    (tmp_path / "both.toml").write_text('name = "both"\nprotocols = ["one.toml", "two.toml"]\n')
    own = {"SEGUE_MOTIONS": str(tmp_path / "motions"), "PYTHONPATH": str(ROOT)}

    def segue(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "study.cli", *words],
            cwd=tmp_path, env=os.environ | own, capture_output=True, text=True, timeout=200,
        )  # fmt: skip

    assert segue("render", "both.toml").returncode == 0
    done = segue("simulate", "both.toml", "--participants", "1", "--data", "simulated")
    assert done.returncode == 0
    assert len(list((tmp_path / "simulated").glob("sub-*/beh/*.tsv"))) == 2
    found = []
    with virtual_screen(640, 480):
        for person in ("p01", "p02"):
            words = ("run", "both.toml", "--participant", person, "--observer", "simulated")
            done = segue(*words, "--pace", "20", "--windowed")
            assert done.returncode == 0, done.stderr
            sidecars = (tmp_path / "data" / f"sub-{person}" / "beh").glob("*.json")
            parts = [json.loads(path.read_text())["Battery"] for path in sidecars]
            assert {part["position"] for part in parts} == {1, 2}
            found.append(tuple(parts[0]["order"]))
        again = segue(*words, "--pace", "20", "--windowed")
    assert again.returncode == 2
    assert "has finished both already" in again.stderr
    assert set(found) == set(orders(("one.toml", "two.toml")))
