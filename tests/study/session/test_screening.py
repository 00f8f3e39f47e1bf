"""Who practised enough, and who paid attention."""

from pathlib import Path

import pytest

from study.cli.telling import Teller
from study.protocol.protocol import shipped
from study.record.sidecar import sidecar_of
from study.record.table import COMMON, create
from study.session.conduct import replay_rows, run
from study.session.screening import pass_mark
from study.session.showing import ShownClip
from study.session.stage import Answer, Interrupted, Nowhere, Presented
from study.trials.observers import Simulated, simulated
from study.trials.plan import Plan, make_plan
from study.trials.prompt import Prompt
from study.trials.reading import parse_protocol
from study.trials.tasks import TASKS, Screens
from study.trials.trial import ClipKey, Outcome, Trial

MORE = """
practice_criterion = 0.75
practice_most = 12
catch_every = 4
"""


def plan_of(seed: int = 4, more: str = MORE, presentation: str = "") -> Plan:
    text = shipped()["jnd-center"].read_text(encoding="utf-8")
    text = text.replace("practice = 2\n", f"practice = 4\n{more}") + presentation
    return make_plan(parse_protocol(text), {"locomotion": 10, "dance": 10}, seed)


def kept(plan: Plan, path: Path, stage: Nowhere, observer: Simulated | None = None) -> dict:
    task = TASKS[plan.protocol.file.task]
    sidecar = sidecar_of(plan, task, observer="simulated", display={})
    record = create(path / "x_beh.tsv", (*COMMON, *task.columns), sidecar)
    run(plan, stage, record, observer or simulated(plan), lambda key: ShownClip())
    assert replay_rows(plan, record.rows()).number == len(record.rows())
    return {"rows": record.rows(), **record.sidecar}


def always(right: bool) -> Simulated:
    """Somebody who is right, or wrong, each time."""
    return Simulated(lambda trial, draw: str(trial.odd_pair if right else 3 - trial.odd_pair))


@pytest.mark.parametrize(("trials", "mark"), [(4, None), (5, 5), (10, 9), (20, 15), (0, None)])
def test_the_pass_mark_is_the_least_that_guessing_seldom_reaches(
    trials: int, mark: int | None
) -> None:
    assert pass_mark(trials) == mark


def test_practice_goes_on_until_its_criterion_or_its_most(tmp_path: Path) -> None:
    good = kept(plan_of(), tmp_path / "good", Nowhere(6.0, 0.5), always(True))
    assert good["Practice"] == {"trials": 4, "reached": True}
    poor = kept(plan_of(), tmp_path / "poor", Nowhere(6.0, 0.5), always(False))
    assert poor["Practice"] == {"trials": 12, "reached": False}
    assert [row["phase"] for row in poor["rows"][:13]] == ["practice"] * 12 + ["main"]


def test_catch_trials_are_held_against_chance(tmp_path: Path) -> None:
    good = kept(plan_of(), tmp_path / "good", Nowhere(6.0, 0.5), always(True))["Catch"]
    assert good["passed"]
    assert good["right"] == good["trials"] > 10
    poor = kept(plan_of(), tmp_path / "poor", Nowhere(6.0, 0.5), always(False))["Catch"]
    assert not poor["passed"]
    assert poor["right"] == 0


class Again(Nowhere):
    """Somebody who wants to see the second trial again, and pauses in the third."""

    asked = 0
    paused = 0

    def present(self, screens: Screens, label: str) -> Presented:
        if label == "trial 3" and not self.paused:
            raise Interrupted
        return super().present(screens, label)

    def ask(self, question: Prompt, seconds: float | None, planned: Answer | None) -> Answer:
        self.asked += 1
        if self.asked in (2, 3):
            assert "again" in question.answers.values()
            return Answer("again", 0.4)
        if self.asked == 4:
            assert "again" not in question.answers.values()
        return super().ask(question, seconds, planned)

    def pause(self) -> None:
        self.paused += 1


def test_replays_are_allowed_so_often_and_counted_and_a_pause_shows_the_trial_again(
    tmp_path: Path,
) -> None:
    plan = plan_of(more="", presentation="\n[presentation]\nreplays = 2\n")
    stage = Again(6.0, 0.5)
    found = kept(plan, tmp_path / "again", stage)
    assert [row["replays"] for row in found["rows"][:4]] == ["0", "2", "0", "0"]
    assert stage.paused == 1
    plain = kept(plan_of(more=""), tmp_path / "plain", Nowhere(6.0, 0.5))
    without = [{k: v for k, v in row.items() if k not in ("onset", "replays")}
               for table in (found, plain) for row in table["rows"]]  # fmt: skip
    half = len(found["rows"])
    assert without[:half] == without[half:]


class Told(Nowhere):
    """A stage that remembers what it told."""

    def tell(self, text: str) -> None:
        self.__dict__.setdefault("said", []).append(text)

    thank = tell


def test_consent_pages_and_debriefing_come_in_their_order(tmp_path: Path) -> None:
    texts = (
        '\n[instructions]\nconsent = "You may leave."\nwelcome = "Welcome."\n'
        'pages = ["One.", "Two."]\ndebriefing = "It was about blends."\n'
    )
    stage = Told(6.0, 0.5)
    found = kept(plan_of(more="", presentation=texts), tmp_path, stage)
    said = [text for text in stage.said if not text.startswith("Take a short break")]
    assert said[:4] == ["You may leave.", "Welcome.", "One.", "Two."]
    assert said[4:] == ["It was about blends.", "Thank you. The session is over."]
    assert found["Consent"].endswith("+00:00")
    assert "One." in found["Instructions"]


def test_the_experimenters_line_says_where_a_session_stands() -> None:
    teller = Teller(20)
    trial = Trial(3, "main", ClipKey("m"))
    teller(trial, Outcome("1", 0.52, 1.0, late_frames=2, void=True))
    line = teller.line(trial, Outcome(None, None, 1.0))
    assert line.startswith("trial 3 of about 20 (main), no answer, 0:0")
    assert line.endswith("late frames in 1, 1 asked again")
