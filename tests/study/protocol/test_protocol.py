"""Protocols: the shipped ones are sound, and every fault is reported at once with its place."""

import re
from pathlib import Path

import pytest

from analysis.screening import stated_rules
from stimuli.errors import InputError
from study.protocol.faults import find_line
from study.protocol.protocol import shipped
from study.trials.reading import load_protocol, parse_protocol, protocol_of

GOOD = """
name = "small"
task = "odd-pair"

[stimuli]
specification = "center-aligned"
reference = 10
lengths = [2, 6, 14]
motions = [{ name = "m", from = "a", to = "b" }]

[sets.sample]
a = { clip = "x", frame = 1 }
b = { clip = "y", frame = 2 }

[staircase]
rule = "levitt"
n_down = 2
stop = { visits = 10 }
"""


@pytest.mark.parametrize("name", shipped())
def test_shipped_protocols_have_no_fault(name: str) -> None:
    protocol = load_protocol(name)
    assert protocol.name == name
    assert {"sample", "cmu"} <= set(protocol.file.sets)
    assert protocol.file.source
    assert protocol_of(protocol.document).hash == protocol.hash


def test_the_hash_is_of_what_is_said_not_of_how() -> None:
    spaced = GOOD.replace("reference = 10", "reference   =   10   # as in the print")
    assert parse_protocol(spaced).hash == parse_protocol(GOOD).hash
    assert parse_protocol(GOOD.replace("= 10 }", "= 9 }")).hash != parse_protocol(GOOD).hash


def test_three_faults_are_three_lines_with_places() -> None:
    text = (
        GOOD.replace('rule = "levitt"', 'rule = "levit"')
        .replace("[2, 6, 14]", "[0, 6, 14]")
        .replace("b = {", "c = {")
    )
    with pytest.raises(InputError) as caught:
        parse_protocol(text, "small.toml")
    lines = str(caught.value).splitlines()
    assert any(re.match(r"small\.toml:8: stimuli\.lengths: .*1 frame or more", n) for n in lines)
    assert any(re.match(r"small\.toml:16: staircase\.rule: .*'leviti?t?'", n) for n in lines)
    assert any("sets.sample.b" in n for n in lines)
    assert any("sets.sample.c" in n for n in lines)
    assert len(lines) == 4


@pytest.mark.parametrize(
    ("change", "path", "word"),
    [
        (('task = "odd-pair"', 'task = "odd"'), "task", "odd-pair, preference"),
        (("reference = 10", "refrence = 10"), "stimuli.refrence", "mean reference"),
        (("frame = 1 }", "fram = 1 }"), "sets.sample.a.fram", "mean frame"),
        (('from = "a"', 'frm = "a"'), "stimuli.motions.0.frm", "mean from"),
        (("stop = { visits", "stop = { visit"), "staircase.stop.visit", "mean visits"),
        (("[staircase]", "rle = 1\n[staircase]"), "sets.sample.rle", "found 1"),
        (("task =", "rule = 1\ntask ="), "rule", "remove it"),
        (("frame = 1 }", "frame = -1 }"), "sets.sample.a.frame", "greater than or equal to 0"),
        (("n_down = 2", "down = 2"), "staircase.down", "takes no down"),
        (("stop = { visits = 10 }", "stop = {}"), "staircase.stop", "visits, reversals or trials"),
        (("[2, 6, 14]", "[6, 2]"), "stimuli.lengths", "ascending"),
        (('name = "m"', 'name = "../m"'), "stimuli.motions.0.name", "pattern"),
        (("[stimuli]", "methods = ['cut', 'fixed']\n[stimuli]"), "methods", "compares lengths"),
        (("reference = 10", "reference = 'geodesic'"), "stimuli.lengths", "need a reference"),
        (("[sets.sample]", "[keys]\nfirst = '2'\n[sets.sample]"), "keys.first", "that of second"),
        (("[sets.sample]", "[keys]\nquit = 'esc'\n[sets.sample]"), "keys.quit", "mean escape"),
        (("[sets.sample]", "[keys]\nfirst = ' '\n[sets.sample]"), "keys.first", "an empty one"),
        (("[sets.sample]", "[keys]\ngo_on = '%'\n[sets.sample]"), "keys.go_on", "keys are called"),
        (("[sets.sample]", "[observer]\nlapse = 0.1\n[sets.sample]"), "observer.slope", "add it"),
        (
            ("[staircase]", "[analysis]\nfunction = 'line'\n[staircase]"),
            "analysis.function",
            "weib",
        ),
    ],
)
def test_each_fault_is_named(change: tuple[str, str], path: str, word: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_protocol(GOOD.replace(*change))
    assert any(f": {path}: " in n and word in n for n in str(caught.value).splitlines())


def test_every_rule_of_exclusion_can_be_stated() -> None:
    rules = {
        "exclude_catch_below": 0.8,
        "exclude_missing_above": 0.2,
        "exclude_faster_than": 0.1,
        "exclude_slower_than": 20.0,
        "exclude_fewer_trials": 10,
    }
    stated = "".join(f"{key} = {value}\n" for key, value in rules.items())
    protocol = parse_protocol(f"{GOOD}\n[analysis]\n{stated}")
    assert {key: getattr(protocol.file.analysis, key) for key in rules} == rules
    assert len(stated_rules(dict(protocol.document))) == len(rules)


def test_a_syntax_error_has_its_line() -> None:
    with pytest.raises(InputError, match=r"^x\.toml:3: "):
        parse_protocol('name = "x"\n\ntask = = 2\n', "x.toml")


def test_an_unknown_name_lists_the_shipped() -> None:
    with pytest.raises(InputError, match="jnd-center"):
        load_protocol("jnd-centre")


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("task",), 3),
        (("stimuli", "lengths"), 8),
        (("stimuli", "motions", 0, "from"), 9),
        (("sets", "sample", "b", "frame"), 13),
        (("sets", "sample", "zzz"), 11),
        (("nothing",), None),
    ],
)
def test_lines_are_found_by_key(path: tuple[str | int, ...], line: int | None) -> None:
    assert find_line(GOOD, path) == line


INLINE = """
[sets.sample]
run = { clip = "y", fram = 2 }  # fram = 9
walk = { clip = "x", frame = 2 }
motions = [
    { name = "m" },
    { name = "n" },
]
from = 3
[[sets.more]]
name = "a"
[[sets.more]]
name = "b"
"""


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("sets", "sample", "run", "frame"), 3),
        (("sets", "sample", "run", "fram"), 3),
        (("sets", "sample", "walk", "frame"), 4),
        (("sets", "sample", "motions", 0, "name"), 6),
        (("sets", "sample", "motions", 1, "name"), 7),
        (("sets", "sample", "motions", 0, "from"), 6),
        (("sets", "more", 1, "name"), 13),
        (("sets", "more", 1, "zzz"), 12),
    ],
)
def test_a_key_is_looked_for_in_its_own_inline_table(
    path: tuple[str | int, ...], line: int
) -> None:
    assert find_line(INLINE, path) == line


def test_a_protocol_saved_by_notepad_is_read(tmp_path: Path) -> None:
    path = tmp_path / "p.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert load_protocol(path).name == "small"
