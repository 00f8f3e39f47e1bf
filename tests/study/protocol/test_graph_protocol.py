"""The protocol `graph`, and what is refused of a method that needs a collection."""

from pathlib import Path

import pytest

from stimuli.errors import InputError
from stimuli.motion import Library
from stimuli.sets import resolve
from study.protocol.protocol import shipped
from study.protocol.sets import set_spec
from study.trials.reading import load_protocol


def test_the_ways_of_the_sample_set_last_at_most_three_seconds(sample_motions: Path) -> None:
    library = Library([sample_motions])
    protocol = load_protocol("graph")
    found = resolve(set_spec(protocol, "sample", library), library)
    assert len(found) == 8
    for pairing in found:
        assert 15 <= pairing.methods["motion-graph"] <= 90


def test_a_set_without_a_collection_is_refused_with_its_line(tmp_path: Path) -> None:
    text = shipped()["graph"].read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("collection")]
    path = tmp_path / "p.toml"
    path.write_text("\n".join(lines).replace('"start-end"', '"center-aligned"'))
    with pytest.raises(InputError) as refused:
        load_protocol(str(path))
    told = str(refused.value)
    for name in ("sample", "cmu"):
        line = lines.index(f"[sets.{name}]") + 1
        assert f"p.toml:{line}: sets.{name}.collection: motion-graph needs a collection" in told
    assert "stimuli.specification: motion-graph leaves and reaches" in told
