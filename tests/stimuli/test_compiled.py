"""Compiled loops need no place on the disk."""

from stimuli.compiled import compiled


def test_a_loop_that_cannot_be_kept_is_compiled_all_the_same() -> None:
    scope: dict[str, object] = {}
    exec("def double(x):\n    return 2 * x\n", scope)  # of no file, so with no place beside it
    double = compiled()(scope["double"])
    assert double(21) == 42
    assert not double.stats.cache_path
