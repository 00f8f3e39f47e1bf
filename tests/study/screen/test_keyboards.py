"""The clock of an X server against the session's, found from round trips that are simulated."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.protocol.keys import KEY_NAMES
from study.screen.xkeys import TICK, fit_clock


@given(
    offset=st.floats(-1e5, 1e5),
    seed=st.integers(0, 2**32 - 1),
    delay=st.floats(1e-5, 5e-3),
)
def test_the_offset_lies_within_its_uncertainty(offset: float, seed: int, delay: float) -> None:
    generator = np.random.default_rng(seed)
    before = np.cumsum(generator.uniform(0.2e-3, 2e-3, 64))
    stamped = before + generator.uniform(0, delay, 64)
    after = stamped + generator.uniform(0, delay, 64)
    stamps = np.floor((stamped + offset) / TICK) * TICK
    fit = fit_clock(before, stamps, after)
    assert abs(fit.offset - offset) <= fit.uncertainty + 1e-7
    assert fit.uncertainty <= TICK / 2 + delay
    assert fit.jitter <= TICK + delay


def test_quick_round_trips_tell_the_offset_to_a_part_of_a_tick() -> None:
    generator = np.random.default_rng(3)
    before = np.cumsum(generator.uniform(0.5e-3, 1.5e-3, 64))
    stamps = np.floor((before + 5e-5 + 12.3456) / TICK) * TICK
    fit = fit_clock(before, stamps, before + 1e-4)
    assert fit.offset == pytest.approx(12.3456, abs=1.5e-4)
    assert fit.round_trip == pytest.approx(1e-4, abs=1e-9)


def test_a_clock_that_was_set_meanwhile_is_uncertain() -> None:
    before = np.arange(10) * 1e-3
    stamps = np.floor((before + np.repeat([1.0, 1.05], 5)) / TICK) * TICK
    fit = fit_clock(before, stamps, before + 1e-4)
    assert fit.uncertainty > 0.02


def test_every_key_has_a_name_in_x() -> None:
    from Xlib import XK

    codes = [XK.string_to_keysym(symbol) for symbol in KEY_NAMES.values()]
    assert all(codes)
    assert len(set(codes)) == len(codes)
