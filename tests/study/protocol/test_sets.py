"""Stimulus sets of protocols: which set, which reference lengths, which studies are refused."""

from pathlib import Path

import pytest

from stimuli.errors import InputError
from stimuli.motion import Library, write_walker
from stimuli.sets import resolve
from study.protocol.sets import choose_set, references, set_spec
from study.session.lab import clips_of
from study.trials.plan import make_plan
from study.trials.reading import load_protocol, parse_protocol
from study.trials.trial import ClipKey

PROTOCOL = """
name = "sets"
task = "{task}"
{methods}
[stimuli]
{lengths}
motions = [{{ name = "m", from = "a", to = "b" }}]
[sets.captured]
a = {{ clip = "nowhere-to-be-found", frame = 1 }}
b = {{ clip = "nor-this", frame = 2 }}
[sets.generated]
a = {{ clip = "generated-walker-0", frame = 3 }}
b = {{ clip = "generated-walker-1", frame = 5 }}
"""
BY_GEODESIC = PROTOCOL.format(
    task="odd-pair", methods="", lengths='reference = "geodesic"\nshorter = [1]\nlonger = [1, 2]'
)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    folder = tmp_path_factory.mktemp("motions")
    for seed in (0, 1):
        write_walker(folder, seed)
    return Library([folder])


def test_the_first_set_whose_clips_are_found_is_taken(library: Library) -> None:
    protocol = parse_protocol(BY_GEODESIC)
    assert choose_set(protocol, library) == "generated"
    assert choose_set(protocol, library, "captured") == "captured"
    with pytest.raises(InputError, match="captured, generated"):
        choose_set(protocol, library, "mine")


def test_without_clips_every_set_says_what_it_lacks(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="captured lacks nor-this, nowhere-to-be-found"):
        choose_set(parse_protocol(BY_GEODESIC), Library([tmp_path]))


def test_geodesic_references_are_computed_from_the_motions(library: Library) -> None:
    from stimuli.sets import resolve

    protocol = parse_protocol(BY_GEODESIC)
    found = references(protocol, library)
    resolved = resolve(set_spec(protocol, None, library), library)
    assert found == {"m": resolved[0].reference_length}
    with pytest.raises(InputError, match="expected motions"):
        references(protocol, None)


def test_without_motions_the_observers_reference_stands_in() -> None:
    assert set(references(load_protocol("jnd-start-end"), None).values()) == {15}


def test_a_set_that_is_not_there_is_refused_even_where_no_clip_is_needed() -> None:
    for text in (load_protocol("jnd-center"), parse_protocol(BY_GEODESIC)):
        with pytest.raises(InputError, match=r"one of the sets .*found 'mine'"):
            references(text, None, "mine")


def test_every_clip_that_a_session_may_show_is_asked_for(library: Library) -> None:
    plan = make_plan(parse_protocol(BY_GEODESIC), {"m": 9}, 1)
    assert set(clips_of(plan)) == {ClipKey("m", length=k) for k in (9, 8, 10, 11)}


def test_methods_that_give_nearly_one_length_compare_nothing(library: Library) -> None:
    text = PROTOCOL.format(
        task="preference",
        methods='methods = ["geodesic", "fixed"]',
        lengths="methods_apart = 60",
    )
    with pytest.raises(InputError, match="m: expected lengths at least 60 frames apart"):
        resolve(set_spec(parse_protocol(text), None, library), library)
    assert set_spec(parse_protocol(text.replace("60", "0")), None, library).methods == (
        "geodesic",
        "fixed",
    )


def test_a_length_below_one_frame_is_refused_or_dropped() -> None:
    protocol = parse_protocol(BY_GEODESIC.replace("shorter = [1]", "shorter = [1, 2, 3]"))
    with pytest.raises(InputError, match=r"differences \[2, 3\]"):
        make_plan(protocol, {"m": 2}, 1)
    dropping = parse_protocol(
        BY_GEODESIC.replace("shorter = [1]", "shorter = [1, 2, 3]\ndrop_missing = true")
    )
    assert make_plan(dropping, {"m": 2}, 1).motions[0].shorter == (1,)


@pytest.mark.parametrize("name", ["jnd-center", "jnd-start-end"])
def test_nothing_before_the_blend_tells_the_clips_apart(name: str, sample_motions: Path) -> None:
    import numpy as np

    from stimuli.sets.layout import lay_out

    library = Library([sample_motions])
    spec = set_spec(load_protocol(name), "sample", library)
    for pairing in resolve(spec, library):
        reference = lay_out(spec, pairing, library, length=pairing.reference_length)
        for length in pairing.lengths:
            clip = lay_out(spec, pairing, library, length=length)
            before = min(clip.mixed[0], reference.mixed[0])
            for found, expected in (
                (clip.motion.rotations, reference.motion.rotations),
                (clip.motion.root, reference.motion.root),
            ):
                assert np.array_equal(found[:before], expected[:before])
