"""What participants read: in letters large enough to read from a metre, within every window."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from stimuli.errors import InputError
from study.protocol.schema import Instructions
from study.screen.texts import letter_height
from study.screen.virtual import virtual_screen
from study.trials.reading import parse_protocol
from tests.study.screen.pictures import texts_of
from tests.study.session.test_session import PREFERENCE

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize("size", [(1024, 768), (1920, 1080), (2560, 1440)])
def test_all_texts_of_all_protocols_can_be_read_from_a_metre_and_none_runs_over(
    size: tuple[int, int],
) -> None:
    """Read back from a real window: capitals under .7 degrees, nothing drawn at its edges."""
    found = seen_on(size)
    assert found["size"] == list(size)
    assert 0.7 <= found["degrees"] < 0.8
    assert len(found["texts"]) > 20
    assert [told["text"] for told in found["texts"] if told["edge"]] == []
    assert {told["letters"] for told in found["texts"]} == {1.0}
    pages = {told["text"][:7]: told["pages"] for told in found["texts"]}
    assert (pages["Consent"] > 1) == (size[0] < 2560)
    assert pages["Thank y"] == 1


def seen_on(size: tuple[int, int]) -> dict[str, Any]:
    with virtual_screen(*size):
        done = subprocess.run(
            [sys.executable, "-m", "tests.study.screen.pictures", "check"],
            cwd=ROOT, capture_output=True, text=True, timeout=200, check=False,
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout))


def test_a_screen_that_lies_about_its_width_has_letters_by_its_height() -> None:
    """3840 pixels said to be a metre across, as X servers of 96 dots an inch say."""
    assert letter_height((3840, 2160), 101.6 / 3840) == 90.0
    assert letter_height((1920, 1080), 53.0 / 1920) == pytest.approx(61.5, abs=0.1)


def test_every_text_can_be_in_the_studys_own_language() -> None:
    """Of a study that writes all of its texts nothing else is read."""
    own = {name: f'"{name}: по-русски"' for name in Instructions.model_fields} | {
        "pages": '["страница по-русски"]', "replay": '"{again}: по-русски ({left})"',
        "interrupted": '"{go_on}, {quit}: по-русски"',
    }  # fmt: skip
    table = "\n".join(f"{name} = {text}" for name, text in own.items())
    read = texts_of(parse_protocol(f"{PREFERENCE}\n[instructions]\n{table}\n"))
    assert len(read) == len(own)
    assert [text for text in read if "по-русски" not in text] == []


@pytest.mark.parametrize("text", ['interrupted = "{first} goes on"', 'replay = "{} again"'])
def test_what_a_text_cannot_name_is_refused_by_line(text: str) -> None:
    line = len(f"{PREFERENCE}\n[instructions]\n".splitlines()) + 1
    with pytest.raises(InputError, match=rf":{line}: instructions\..*expected no braces but"):
        parse_protocol(f"{PREFERENCE}\n[instructions]\n{text}\n")
