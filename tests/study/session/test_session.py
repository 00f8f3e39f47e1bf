"""Sessions on a stage without a window: order, voids, replay_rows, resumption, simulation."""

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from stimuli.errors import InputError, InputWarning
from study.protocol.protocol import Protocol, shipped
from study.record.dataset import record_path
from study.record.sidecar import sidecar_of
from study.record.table import COMMON, Record, create
from study.session.conduct import replay_rows, rows_of_plan, run
from study.session.lab import Request, run_session
from study.session.progress import Progress, advance, begin, next_trial
from study.session.showing import ShownClip, arrange, settings_of
from study.session.simulation import rows, simulate
from study.session.stage import Answer, Nowhere, Presented, SessionLeft
from study.trials.deck import Card
from study.trials.observers import simulated
from study.trials.plan import Plan, make_plan
from study.trials.prompt import Prompt
from study.trials.reading import load_protocol, parse_protocol
from study.trials.tasks import TASKS, Screens
from study.trials.trial import ClipKey, Outcome, Trial

REFERENCES = {"locomotion": 10, "dance": 10}
PREFERENCE = """
name = "pairs"
task = "preference"
methods = ["geodesic", "fixed", "velocity"]
[stimuli]
motions = [{ name = "m", from = "a", to = "b" }, { name = "n", from = "b", to = "a" }]
[sets.sample]
a = { clip = "x", frame = 1 }
b = { clip = "y", frame = 2 }
[trials]
repeats = 4
[observer]
prefer = { geodesic = 0.9, fixed = 0.1, velocity = 0.3 }
"""


def jnd_plan(seed: int = 3, rehearsal: bool = False) -> Plan:
    return make_plan(load_protocol("jnd-center"), REFERENCES, seed, rehearsal)


def nobody(key: ClipKey) -> ShownClip:
    return ShownClip(blend=(80, 99))


@dataclass
class Faulty(Nowhere):
    """A stage that shows chosen presentations late, or is left before one."""

    late: dict[int, tuple[int, ...]] = field(default_factory=dict)
    leave_before: int | None = None
    shown: int = 0

    def present(self, screens: Screens, label: str) -> Presented:
        self.shown += 1
        if self.shown == self.leave_before:
            raise SessionLeft
        onset, _ = super().present(screens, label)
        return Presented(onset, (tuple(self.late.get(self.shown, ())),))


def advance_with(progress: Progress, drawn: tuple[Trial, Card], correct: bool) -> Progress:
    trial, card = drawn
    odd = trial.content.odd_pair
    outcome = Outcome(str(odd if correct else 3 - odd), 0.5, 0.0)
    return advance(progress, trial, card, outcome)


def new_record(tmp_path: Path, plan: Plan) -> Record:
    task = TASKS[plan.protocol.file.task]
    columns = (*COMMON, *task.columns)
    sidecar = sidecar_of(plan, task, observer="simulated", display={})
    return create(tmp_path / "x_beh.tsv", columns, sidecar)


def test_a_session_visits_every_track_until_it_ends(tmp_path: Path) -> None:
    plan = jnd_plan()
    record = new_record(tmp_path, plan)
    run(plan, Nowhere(6.0, 0.5), record, simulated(plan), nobody)
    tracks = record.sidecar["Tracks"]
    assert set(tracks) == {f"{m}/{s}" for m in REFERENCES for s in ("shorter", "longer")}
    assert all(track["stopped_by"] == "visits 10 and reversals 8" for track in tracks.values())
    table = record.rows()
    main = [row for row in table if row["phase"] == "main"]
    assert sum(track["trials"] for track in tracks.values()) == len(main)
    assert [row["phase"] for row in table[:2]] == ["practice", "practice"]
    assert [int(row["trial"]) for row in table] == list(range(1, len(table) + 1))
    for row in main:
        difference = int(row["length"]) - int(row["reference_length"])
        assert int(row["difference"]) == difference != 0
        assert (row["track"] == "longer") == (difference > 0)
        assert row["correct"] == str(int(row["response"] == row["odd_pair"]))
    onsets = np.array([float(row["onset"]) for row in table])
    assert (np.diff(onsets) >= 12.5).all()


def test_orders_are_balanced_by_chance() -> None:
    table = [row for seed in range(40) for row in rows(jnd_plan(seed))]
    n = len(table)
    for column in ("odd_pair", "odd_position"):
        ones = sum(row[column] == 1 for row in table)
        assert abs(ones - n / 2) < 4 * np.sqrt(n) / 2


def test_the_next_track_does_not_depend_on_the_answers() -> None:
    plan = jnd_plan(9)
    right = begin(plan)
    sequence = []
    for _ in range(12):
        drawn = next_trial(right)
        assert drawn is not None
        sequence.append((drawn[0].content.motion, drawn[0].content.track))
        right = advance_with(right, drawn, True)
    wrong = begin(plan)
    for expected in sequence:
        drawn = next_trial(wrong)
        assert drawn is not None
        assert (drawn[0].content.motion, drawn[0].content.track) == expected
        wrong = advance_with(wrong, drawn, False)


def test_the_same_seed_gives_the_same_session() -> None:
    assert list(rows(jnd_plan(4))) == list(rows(jnd_plan(4)))
    assert list(rows(jnd_plan(4))) != list(rows(jnd_plan(5)))


def test_void_trials_keep_their_row_and_are_asked_again(tmp_path: Path) -> None:
    plan = jnd_plan(11)
    record = new_record(tmp_path, plan)
    stage = Faulty(6.0, 0.5, late={5: (85,), 7: (10, 79, 100)})
    run(plan, stage, record, simulated(plan), nobody)
    table = record.rows()
    void = [row for row in table if row["void"] == "1"]
    assert [row["trial"] for row in void] == ["5"]
    again = [row for row in table if row["repeat_of"] == "5"]
    assert len(again) == 1
    assert again[0]["difference"] == void[0]["difference"]
    assert again[0]["motion"] == void[0]["motion"]
    assert table[6]["late_frames"] == "3"  # outside the blend: counted, and said
    counted = [row for row in table if row["phase"] == "main" and row["void"] == "0"]
    assert sum(t["trials"] for t in record.sidecar["Tracks"].values()) == len(counted)


def test_a_machine_that_is_too_slow_is_said_and_the_session_ends(tmp_path: Path) -> None:
    plan = jnd_plan(12)
    record = new_record(tmp_path, plan)
    stage = Faulty(6.0, 0.5, late=dict.fromkeys(range(10_000), (85,)))
    with pytest.warns(InputWarning, match="too slow"):
        run(plan, stage, record, simulated(plan), nobody)
    table = record.rows()
    assert record.sidecar["TooSlow"]
    assert record.sidecar["Finished"]
    voids = sum(row["void"] == "1" for row in table)
    assert 0 < voids <= max(2, 0.1 * len(table) + 1)
    repeats = Counter(row["repeat_of"] for row in table if row["repeat_of"] != "n/a")
    assert max(repeats.values()) <= 2


def test_breaks_come_after_their_number_of_answers(tmp_path: Path) -> None:
    protocol = parse_protocol(PREFERENCE.replace("repeats = 4", "repeats = 4\nbreak_every = 10"))
    plan = make_plan(protocol, {}, 5)
    told = []
    stage = Faulty(6.0, 0.5, late={1: (85,)})
    stage.tell = lambda text: told.append((stage.shown, text))  # type: ignore[method-assign]
    run(plan, stage, new_record(tmp_path, plan), simulated(plan), nobody)
    breaks = [shown for shown, text in told if "break" in text]
    assert breaks == [11, 21]


@pytest.mark.parametrize("leave", [1, 4, 30])
def test_a_session_that_was_left_goes_on_as_if_it_had_not_been(tmp_path: Path, leave: int) -> None:
    plan = jnd_plan(13)
    whole = new_record(tmp_path / "whole", plan)
    run(plan, Nowhere(6.0, 0.5), whole, simulated(plan), nobody)
    record = new_record(tmp_path / "left", plan)
    with pytest.raises(SessionLeft):
        run(plan, Faulty(6.0, 0.5, leave_before=leave), record, simulated(plan), nobody)
    assert not record.sidecar["Finished"]
    run(plan, Nowhere(6.0, 0.5), record, simulated(plan), nobody)

    def without_onset(row: dict[str, str]) -> dict[str, str]:
        return {key: value for key, value in row.items() if key != "onset"}

    assert list(map(without_onset, record.rows())) == list(map(without_onset, whole.rows()))
    assert record.sidecar["Tracks"] == whole.sidecar["Tracks"]


def test_an_edited_record_is_not_resumed(tmp_path: Path) -> None:
    plan = jnd_plan(14)
    record = new_record(tmp_path, plan)
    run(plan, Nowhere(6.0, 0.5), record, simulated(plan), nobody)
    table = record.rows()
    table[3]["length"] = "99"
    with pytest.raises(InputError, match="row 4 of the record"):
        replay_rows(plan, table)


def test_preferences_show_every_pair_with_balanced_orders() -> None:
    protocol = parse_protocol(PREFERENCE)
    plan = make_plan(protocol, {}, 5)
    table = list(rows(plan))
    assert len(table) == 2 * 3 * 4
    pairs = Counter((r["motion"], *sorted((r["first_method"], r["second_method"]))) for r in table)
    assert set(pairs.values()) == {4}
    methods = protocol.file.methods
    in_order = sum(
        methods.index(r["first_method"]) < methods.index(r["second_method"]) for r in table
    )
    assert in_order == len(table) / 2
    for row in table:
        chosen = row["first_method"] if row["response"] == "first" else row["second_method"]
        assert row["chosen_method"] in (chosen, None)


def test_simulated_people_prefer_as_their_protocol_says() -> None:
    protocol = parse_protocol(PREFERENCE.replace("repeats = 4", "repeats = 60"))
    table = list(rows(make_plan(protocol, {}, 6)))
    both = [r for r in table if {r["first_method"], r["second_method"]} == {"geodesic", "fixed"}]
    share = np.mean([r["chosen_method"] == "geodesic" for r in both])
    assert share == pytest.approx(0.9, abs=0.08)


def test_an_answer_that_comes_too_late_is_none() -> None:
    assert Nowhere(1.0, 0.0).ask(Prompt("?", {}), 5.0, Answer("first", 5.1)) == (None, None)
    assert Nowhere(1.0, 0.0).ask(Prompt("?", {}), 5.0, Answer("first", 4.9)) == ("first", 4.9)


def test_simulated_thresholds_are_the_protocols() -> None:
    text = shipped()["jnd-center"].read_text(encoding="utf-8")
    still = text.replace("spread = 1.0", "spread = 0.0").replace('rule = "wang"', 'rule = "levitt"')
    still = still.replace("8, 12,", "8, 9, 11, 12,").replace("[2, 4, 6,", "[2, 3, 4, 6,")
    protocol: Protocol = parse_protocol(still)
    table = [r for s in range(60) for r in rows(make_plan(protocol, REFERENCES, s))]
    for difference in (-7, 10):
        right = [r["correct"] for r in table if r["difference"] == difference]
        assert len(right) > 200
        assert np.mean(right) == pytest.approx(0.75, abs=4 * np.sqrt(0.75 * 0.25 / len(right)))


def test_simulation_into_records_is_byte_for_byte_the_same(tmp_path: Path) -> None:
    protocol = load_protocol("jnd-center")
    first = simulate(protocol, REFERENCES, 3, 8, tmp_path / "a")
    second = simulate(protocol, REFERENCES, 3, 8, tmp_path / "b")
    for one, other in zip(first, second, strict=True):
        assert one.read_bytes() == other.read_bytes()
        assert one.with_suffix(".json").read_bytes() == other.with_suffix(".json").read_bytes()
    more = simulate(protocol, REFERENCES, 1, 8, tmp_path / "a")
    assert more[0].name.startswith("sub-sim004")


def test_a_simulated_person_is_the_same_whoever_came_before(tmp_path: Path) -> None:
    protocol = load_protocol("jnd-center")
    whole = simulate(protocol, REFERENCES, 4, 8, tmp_path / "whole")
    simulate(protocol, REFERENCES, 2, 8, tmp_path / "parts")
    later = simulate(protocol, REFERENCES, 2, 8, tmp_path / "parts")
    assert [path.read_bytes() for path in later] == [path.read_bytes() for path in whole[2:]]
    assert later[0].read_bytes() != whole[0].read_bytes()


def test_a_rehearsal_takes_one_motion_and_short_tracks() -> None:
    table = list(rows(jnd_plan(2, rehearsal=True)))
    assert {row["motion"] for row in table} == {"locomotion"}
    assert len(table) == 8


def test_restart_needs_nothing_of_the_run_that_it_leaves(tmp_path: Path) -> None:
    protocol = load_protocol("jnd-center")
    folder = tmp_path / "set"
    folder.mkdir()
    clip = SimpleNamespace(hash="h", document={}, path=tmp_path / "clip", motion="dance")
    clip.path.touch()
    pairings = {name: {"reference_length": k} for name, k in REFERENCES.items()}
    manifest = SimpleNamespace(
        directory=folder, name=protocol.name, hash="s", clips=[clip], clip=lambda *_, **__: clip,
        pairings=pairings, specification="center-aligned", seconds=6.0, fps=30, frames=180,
    )  # fmt: skip
    left = record_path(tmp_path, "p1", protocol.label, 1)
    create(left, tuple(COMMON), {}).sidecar_path.unlink()
    request = Request("p1", tmp_path, observer="simulated", seed=1, restart=True)
    made = run_session(request, protocol, manifest, lambda _: True, lambda *_: Nowhere(6.0, 0.5))
    assert made.path == record_path(tmp_path, "p1", protocol.label, 2)
    assert left.read_text().splitlines()[1:] == []


def test_texts_name_the_protocols_keys_and_seconds() -> None:
    own = (
        '[keys]\nfirst = "f"\nsecond = "j"\ngo_on = "return"\n[presentation]\nanswer_seconds = 8\n'
    )
    protocol = parse_protocol(PREFERENCE + own)
    task = TASKS["preference"]
    settings = settings_of(make_plan(protocol, {}, 1), task)
    question = task.ask(protocol.file, None)
    assert "Press f for the first, j for the second" in settings.pages[0]
    assert "8 seconds" in settings.pages[0]
    assert "Press RETURN" in settings.pages[0]
    assert "f   the first\nj   the second" in question.text
    assert question.answers == {"f": "first", "j": "second"}
    assert "Press RETURN" in settings.pause


def test_layouts_rearrange_the_clips() -> None:
    a, b = ClipKey("a"), ClipKey("b")
    assert arrange(((a,), (b,)), "side-by-side") == ((a, b),)
    assert arrange(((a, b), (b, b)), "one-after-other") == ((a,), (b,), (b,), (b,))
    assert arrange(((a,), (b,)), None) == ((a,), (b,))


def test_a_protocol_without_an_observer_is_not_simulated() -> None:
    plan = make_plan(parse_protocol(PREFERENCE.split("[observer]")[0]), {}, 1)
    with pytest.raises(InputError, match=r"\[observer\]"):
        list(rows_of_plan(plan, Nowhere(1, 0), simulated(plan), nobody))
