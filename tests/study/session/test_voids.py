"""When a trial was shown too badly to count."""

import pytest

from study.session.voids import VOID

BLENDS = [[(80, 99), (82, 95)], [(40, 50), None]]


@pytest.mark.parametrize(
    ("rule", "allowed", "late", "void"),
    [
        ("late-in-blend", 0, [(79, 100), ()], False),
        ("late-in-blend", 0, [(80,), ()], True),
        ("late-in-blend", 0, [(99,), ()], True),
        ("late-in-blend", 0, [(), (7,)], True),  # nobody knows where the second clip's blend is
        ("late-in-blend", 0, [], False),
        ("late-frames", 2, [(1, 2), ()], False),
        ("late-frames", 2, [(1, 2), (3,)], True),
        ("never", 0, [tuple(range(180))] * 2, False),
    ],
)
def test_each_rule(rule: str, allowed: int, late: list[tuple[int, ...]], void: bool) -> None:
    assert VOID[rule](allowed, late, BLENDS) == void
