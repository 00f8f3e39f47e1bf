"""Compiled loops: loaded when there is enough to do, compiled also where nothing can be kept."""

import numba
import numpy as np
import pytest

from stimuli import compiled
from stimuli.motion.formats.bvh_write import write_bvh
from stimuli.motion.formats.numbers import parse_numbers


def total(values: np.ndarray) -> float:
    """A loop like any other."""
    found = 0.0
    for value in values:
        found += value
    return found


@pytest.mark.parametrize("keeps", [True, False])
def test_a_loop_is_compiled_also_where_there_is_no_place_to_keep_it(monkeypatch, keeps):
    known, asked = numba.njit, []

    def njit(*functions, **options):
        if functions or "nogil" not in options:  # Numba's own
            return known(*functions, **options)
        asked.append(options.pop("cache", False))
        if asked[-1] and not keeps:
            raise RuntimeError("cannot cache function: no locator available")
        return known(**options)

    monkeypatch.setattr(numba, "njit", njit)
    loop = compiled.compiled(nogil=True)(total)
    assert loop(np.arange(5.0)) == 10.0
    assert asked == ([True] if keeps else [True, False])


def test_loops_are_worth_loading_once_enough_is_done(monkeypatch):
    monkeypatch.setattr(compiled, "_done_so_far", lambda done=[0]: done)
    monkeypatch.delitem(compiled.sys.modules, "numba")
    assert not compiled.worth_loading(compiled.ENOUGH // 2)
    assert not compiled.worth_loading(compiled.ENOUGH // 4)
    assert compiled.worth_loading(compiled.ENOUGH)
    assert compiled.worth_loading(0)


def test_numbers_are_scanned_whatever_was_read_before(tmp_path, bodies):
    path = tmp_path / "a.bvh"
    write_bvh(bodies.wandering(5, 1), path)
    text = path.read_bytes()
    numbers = text[text.index(b"Frame Time:") :].split(b"\n", 1)[1]
    assert parse_numbers(path, numbers).tolist() == [float(word) for word in numbers.split()]
