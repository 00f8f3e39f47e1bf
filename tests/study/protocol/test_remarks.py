"""What a protocol may say but is told of: a camera that follows over a floor without marks."""

import warnings

import pytest

from stimuli.errors import InputWarning
from study.protocol.protocol import shipped
from study.protocol.schema import AppearanceTable
from study.trials.reading import load_protocol, parse_protocol

TEXT = """name = "mine"
task = "preference"
methods = ["fixed", "cut"]
[stimuli]
motions = [{ name = "m", from = "a", to = "b" }]
[sets.first]
a = { clip = "x", frame = 8 }
b = { clip = "y", frame = 2 }
[appearance]
"""


@pytest.mark.parametrize("ground", ["", 'ground = "none"\n', 'ground = "shadow"\n'])
def test_following_without_marks_on_the_floor_is_told_with_its_line(ground: str) -> None:
    with pytest.warns(InputWarning, match=r"protocol:10: appearance.camera: .*hides.*grid"):
        parse_protocol(TEXT + 'camera = "follow"\n' + ground)


def test_over_a_grid_it_is_not() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parse_protocol(TEXT + 'camera = "follow"\nground = "grid"\n')
        for name in shipped():
            load_protocol(name)


def test_what_only_point_lights_have_is_told_of_other_styles() -> None:
    with pytest.warns(InputWarning, match=r"protocol:10: appearance.control: only .*point-light"):
        parse_protocol(TEXT + 'control = "scrambled"\n')


def test_the_tables_of_looks_and_of_protocols_are_one() -> None:
    from dataclasses import asdict

    from stimuli.render.appearance import Appearance

    assert AppearanceTable().model_dump() == asdict(Appearance())
