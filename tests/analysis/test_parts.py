"""The parts of the report that only some studies have."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.mixed import MixedFit
from analysis.preferences import Contest
from analysis.report import Written, write_report
from analysis.report.preference_part import mixed_sentence
from analysis.report.study_parts import _round_counts
from study.cli import main
from tests.analysis import records

CLIPS = [f"{number:064x}" for number in range(20)]


def study(data: Path, **options: bool) -> dict:
    return write_report([data], **options).document["studies"][0]


def test_three_methods_have_a_scale(tmp_path: Path) -> None:
    rng, truth = np.random.default_rng(0), {"a": 1.0, "b": 0.2, "c": -1.2}
    sessions = {}
    for person in range(12):
        choices = []
        for motion in ("m", "n"):
            for pair in (("a", "b"), ("a", "c"), ("b", "c")):
                first, second = rng.permutation(pair)
                wins = rng.random() < 1 / (1 + np.exp(truth[second] - truth[first]))
                choices.append((motion, first, second, first if wins else second))
        sessions[f"p{person:02d}"] = records.preference_rows(choices)
    protocol = records.preference_protocol("three", methods=["a", "b", "c"], source="")
    found = study(records.write_dataset(tmp_path, protocol, sessions))
    assert [(entry["a"], entry["b"]) for entry in found["comparisons"]] == [
        ("a", "b"), ("a", "c"), ("b", "c"),
    ]  # fmt: skip
    assert [entry["method"] for entry in found["scale"]] == ["a", "b", "c"]
    assert any("Bradley-Terry" in sentence for sentence in found["text"])


def test_a_method_always_preferred_has_no_scale(tmp_path: Path) -> None:
    choices = [("m", "a", "b", "a"), ("m", "a", "c", "a"), ("m", "b", "c", "b")]
    rows = {f"p{n}": records.preference_rows(choices) for n in range(4)}
    protocol = records.preference_protocol("three", methods=["a", "b", "c"])
    found = study(records.write_dataset(tmp_path, protocol, rows))
    assert found["scale"] is None
    assert found["comparisons"][0]["mixed_model"]["estimate"] is None


def test_a_pooled_test_that_the_mixed_model_does_not_share_is_called_out() -> None:
    """Eight people of ten always choose a: 40 answers, but only ten people."""
    people = np.repeat(np.arange(10), 4)
    table = pd.DataFrame({"participant": people, "motion": "m", "chose_a": (people < 8) * 1})
    contest = Contest("a", "b", "all", table)
    assert contest.count.p is not None
    assert contest.count.p < 0.001
    shaky = MixedFit(2.0, -0.5, 4.5, 0.1, "mixed")
    assert "trust the mixed model" in mixed_sentence(contest, shaky, 0.01)
    firm = MixedFit(2.0, 1.0, 3.0, 0.001, "mixed")
    assert "disagree" not in mixed_sentence(contest, firm, 0.01)
    none = MixedFit(None, None, None, None, "mixed: not estimable, why")
    assert "gives no estimate (not estimable, why)" in mixed_sentence(contest, none, 0.01)


def test_unanswered_trials_are_counted_and_left_out(tmp_path: Path) -> None:
    choices = [("m", "a", "b", "a")] * 5 + [("m", "b", "a", None)] * 2
    rows = {"p1": records.preference_rows(choices), "p2": records.preference_rows(choices)}
    protocol = records.preference_protocol("two", methods=["a", "b"])
    found = study(records.write_dataset(tmp_path, protocol, rows))
    assert (found["trials"], found["excluded"]) == (10, 4)
    assert found["comparisons"][0]["n"] == 10


@pytest.fixture(scope="module")
def labelled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    rng, root = np.random.default_rng(1), tmp_path_factory.mktemp("labels")
    scores = rng.standard_normal(len(CLIPS))
    sessions = {
        f"p{person}": records.natural_rows(
            {
                clip: "unnatural" if rng.random() < 1 / (1 + np.exp(-3 * score)) else "natural"
                for clip, score in zip(CLIPS, scores, strict=True)
            }
        )
        for person in range(8)
    }
    records.write_dataset(root, records.natural_protocol(), sessions)
    (root / "stimuli").mkdir()
    for clip, score in zip(CLIPS, scores, strict=True):
        entry = {"motion": "walk", "measures": {"cost": score, "slide": None}}
        (root / "stimuli" / f"{clip}.json").write_text(json.dumps(entry))
    return root


def test_labels_against_the_scores_of_the_manifest(labelled: Path) -> None:
    found = study(labelled)
    (curve,) = found["receiver_curves"]
    assert curve["score"] == "cost"
    assert 0.5 < curve["low"] < curve["area"] < curve["high"] <= 1
    assert 0 < found["agreement"]["krippendorff_alpha"] < 1


def with_measures(root: Path, factor: float) -> Path:
    """An odd-pair study whose clips have a measure in proportion to their length."""
    rng = np.random.default_rng(2)
    sessions, lengths = {}, set()
    for person in range(4):
        rows = records.odd_pair_rows(rng, spread=0.3, slope=1.0)
        for row in rows:
            row["clip_a"], row["clip_b"] = "length-10", f"length-{row['length']}"
            lengths |= {10, row["length"]}
        sessions[f"p{person}"] = rows
    records.write_dataset(root, records.odd_pair_protocol(), sessions)
    (root / "stimuli").mkdir()
    for length in lengths:
        entry = {"measures": {"stretch": factor * length, "way_from_reference": length - 10.0}}
        (root / "stimuli" / f"length-{length}.json").write_text(json.dumps(entry))
    return root


def test_fits_against_what_was_shown(tmp_path: Path) -> None:
    found = study(with_measures(tmp_path, 0.1))
    fits = {fit["measure"]: fit for fit in found["against_shown"] if fit["side"] == "longer"}
    longer = fits["stretch"]
    pooled = next(
        entry
        for entry in found["psychometric"]
        if (entry["side"], entry["motion"], entry["participant"]) == ("longer", "all", "all")
    )
    nominal = pooled["threshold"]["value"]
    assert longer["threshold"]["value"] == pytest.approx(0.1 * nominal, rel=1e-3)
    assert longer["gain"] == pytest.approx(0, abs=1e-3)
    assert fits["way_from_reference"]["threshold"]["value"] == pytest.approx(nominal, rel=1e-3)


def test_what_stands_beside_a_threshold(tmp_path: Path) -> None:
    pytest.importorskip("psignifit")
    found = study(with_measures(tmp_path, 1.0), second_opinion=True)
    entry = next(
        entry
        for entry in found["psychometric"]
        if (entry["side"], entry["motion"], entry["participant"]) == ("longer", "all", "all")
    )
    value = entry["threshold"]["value"]
    assert entry["weber_fraction"] == pytest.approx(value / 10)
    assert entry["bias_reduced"]["value"] == pytest.approx(value, abs=1)
    assert entry["random_threshold"]["value"] == pytest.approx(value, abs=1.5)
    assert entry["second_opinion"]["value"] == pytest.approx(value, abs=1)
    assert {row["rule"] for row in entry["d_prime"]} == {"two-interval", "dual-pair"}
    assert {row["between"] for row in found["differences"]} == {"motions", "sides"}


def test_specifications_are_compared_across_studies(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    for name, specification, thresholds in (
        ("jnd-center", "center-aligned", {"longer": 9.0}),
        ("jnd-start-end", "start-end", {"longer": 4.0}),
    ):
        sessions = {
            f"p{n}": records.odd_pair_rows(
                rng, thresholds=thresholds, specification=specification, spread=0.3
            )
            for n in range(4)
        }
        protocol = records.odd_pair_protocol(name, stimuli={"specification": specification})
        records.write_dataset(tmp_path, protocol, sessions)
    written = write_report([tmp_path])
    (test,) = written.document["across"]
    assert (test["between"], test["side"]) == ("specifications", "longer")
    assert test["groups"] == ["center-aligned", "start-end"]
    assert test["p"] < 0.01
    assert "Across the studies" in written.page.read_text()


def test_late_frames_have_a_figure_and_methods_a_paragraph(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    rows = records.odd_pair_rows(rng)
    for number, row in enumerate(rows):
        row["late_frames"] = number % 3
    written = write_report(
        [records.write_dataset(tmp_path, records.odd_pair_protocol(), {"a": rows})]
    )
    page = written.page.read_text()
    assert "Late frames a trial." in page
    assert "mathdefault" not in page
    assert "$" not in page
    assert ">10</text>" in page
    late, worst = sum(n % 3 for n in range(len(rows))), 2
    cells = "".join(f"<td>{n}</td>" for n in (len(rows), late, worst))
    assert cells in page.replace(' class="words"', "")
    methods = written.document["studies"][0]["methods"]
    assert "a transformed up-down staircase (2 down, 1 up" in methods
    assert "a level had been answered 10 times" in methods
    assert "Beside the dissertation" in page


def test_no_frames_are_claimed_of_sessions_without_a_window(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    protocol = records.odd_pair_protocol()
    bare = records.write_dataset(
        tmp_path / "bare", protocol, {"a": records.odd_pair_rows(rng)}, Display={"kind": "none"}
    )
    written = write_report([bare], tmp_path / "one")
    page = written.page.read_text()
    assert "All sessions ran without a window: no frames were shown." in page
    assert "late frame" not in page
    assert "after the last frame" not in page
    assert "No stimuli were rendered" in written.document["studies"][0]["methods"]

    rows = records.odd_pair_rows(rng)
    shown = records.write_dataset(
        tmp_path / "shown", protocol, {"b": rows}, StimulusSetHash="c" * 64
    )
    written = write_report([bare, shown], tmp_path / "both")
    page = written.page.read_text()
    assert "1 session ran without a window" in page
    assert f"{len(rows)} of {len(rows)} trials were shown without a late frame" in page
    methods = written.document["studies"][0]["methods"]
    assert methods.startswith("Stimuli were center-aligned transitions")
    assert "rendered offline." in methods
    assert "as clips of" not in methods


def test_methods_say_what_record_and_manifest_hold_and_nothing_more(tmp_path: Path) -> None:
    rows = records.counted_preferences(40, 8, 8)
    protocol = records.preference_protocol(stimuli={"motions": []})
    data = records.write_dataset(tmp_path / "bare", protocol, rows, StimulusSetHash="c" * 64)
    silent = study(data)["methods"]
    for default in ("start-end", "as clips of", "camera", "ground plane", "balanced", "random"):
        assert default not in silent
    first = sum(row["first_method"] == "fixed" for own in rows.values() for row in own)
    assert f"Of 64 trials, fixed in {first} and geodesic in {64 - first} showed it first." in silent

    stated = records.preference_protocol(stimuli={"specification": "start-end", "seconds": 4})
    data = records.write_dataset(tmp_path / "stated", stated, rows, StimulusSetHash="c" * 64)
    assert (
        "start-end transitions between captured human motions, rendered offline as clips of 4 s"
        in (study(data)["methods"])
    )
    data = records.write_dataset(tmp_path / "shown", protocol, rows, StimulusSetHash="c" * 64)
    (data / "stimuli").mkdir()
    (data / "stimuli" / f"{'a' * 64}.json").write_text(json.dumps({"frames": 180}))
    assert "as clips of 180 frames" in study(data)["methods"]


def test_a_bias_of_place_is_not_told_from_a_method_that_always_came_first(tmp_path: Path) -> None:
    choices = [(f"m{n}", "geodesic", "fixed", "geodesic" if n % 4 else "fixed") for n in range(8)]
    rows = {f"p{n}": records.preference_rows(choices[n:] + choices[:n]) for n in range(4)}
    data = records.write_dataset(tmp_path, records.preference_protocol(), rows)
    text = " ".join(study(data)["text"])
    assert "Geodesic always came first: a bias of place and a preference for it are" in text
    assert "bias of place. " not in text


def test_comments_are_quoted_and_escaped(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    rows = {"a": records.odd_pair_rows(rng)}
    data = records.write_dataset(tmp_path, records.odd_pair_protocol(), rows)
    (data / "participants.tsv").write_text(
        "participant_id\tage\tcomments\nsub-a\t30\tall <b>alike</b>\nsub-z\t9\tnot here\n"
    )
    page = write_report([data]).page.read_text()
    assert "sub-a: “all &lt;b&gt;alike&lt;/b&gt;”" in page
    assert "not here" not in page


def test_a_rehearsal_alone_is_labelled(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    data = records.write_dataset(
        tmp_path, records.odd_pair_protocol(), {"a": records.odd_pair_rows(rng)}, Rehearsal=True
    )
    written = write_report([data])
    assert written.document["studies"][0]["rehearsal"]
    assert "A rehearsal:" in written.page.read_text()
    assert all("-rehearsal-" in name for name in files_of(written))


def files_of(written: Written) -> list[str]:
    out = written.page.parent
    return [path.name for kind in ("figures", "tables") for path in (out / kind).iterdir()]


def test_a_paced_session_is_named_as_paced(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    protocol, rows = records.odd_pair_protocol(), {"a": records.odd_pair_rows(rng)}
    paced = records.write_dataset(tmp_path / "paced", protocol, rows, Pace=20.0)
    written = write_report([paced], tmp_path / "one")
    page = written.page.read_text()
    assert "Paced: time ran faster" in page
    assert "rehearsal" not in page.lower()
    assert files_of(written)
    assert all(name.startswith("jnd-center-paced-") for name in files_of(written))

    real = records.write_dataset(tmp_path / "real", protocol, {"b": rows["a"]})
    written = write_report([paced, real], tmp_path / "both")
    assert "1 paced session, never pooled with others." in written.page.read_text()
    assert not any("paced" in name for name in files_of(written))


def test_a_missing_certificate_is_told_by_task(study_one: Path, tmp_path: Path) -> None:
    page = write_report([study_one], tmp_path).page.read_text()
    assert "no certificate of this protocol: the power of its tests" in page
    assert "staircase" not in page


def test_the_tables_tell_nothing_of_a_denied_fit_that_the_document_does_not(
    tmp_path: Path,
) -> None:
    """Chance answers: both sides are denied, whatever the fits have for numbers."""
    rng = np.random.default_rng(5)
    rows = [row | {"correct": number % 2} for number, row in enumerate(records.odd_pair_rows(rng))]
    data = records.write_dataset(tmp_path, records.odd_pair_protocol(), {"a": rows})
    written = write_report([data])
    tables = written.page.parent / "tables"
    table = pd.read_csv(tables / "jnd-center-center-aligned-thresholds.csv")
    assert {entry["deviance_p"] for entry in written.document["studies"][0]["psychometric"]} == {
        None
    }
    assert (table["verdict"] != "ok").all()
    assert table[["value", "slope", "lapse", "deviance", "deviance_p"]].isna().all(axis=None)
    page = written.page.read_text()
    assert "Most visited" in page
    assert "Last level" not in page


def test_counts_of_an_axis_are_whole_and_round() -> None:
    assert _round_counts(3) == [0, 1, 2, 3]
    assert _round_counts(60) == [0, 5, 10, 20, 50]


def test_one_trial_was_shown_in_time(tmp_path: Path) -> None:
    rows = records.odd_pair_rows(np.random.default_rng(0))[:1]
    data = records.write_dataset(tmp_path, records.odd_pair_protocol(), {"a": rows})
    assert "1 of 1 trial was shown without a late frame" in write_report([data]).page.read_text()


def test_a_weber_fraction_has_no_sign(jnd: Path, tmp_path: Path) -> None:
    text = " ".join(write_report([jnd], tmp_path).document["studies"][0]["text"])
    fractions = re.findall(r"Weber fraction d/k of (\w+) blends is (\S+)\.(?: |$)", text)
    assert [side for side, _ in fractions] == ["shorter", "longer"]
    assert all(0 < float(value) < 2 for _, value in fractions)


def test_intervals_stay_on_one_line(study_one: Path, tmp_path: Path) -> None:
    page = write_report([study_one], tmp_path).page.read_text()
    assert '<th scope="col">95% interval</th>' in page
    assert re.search(r"<td>[\d.]+ to [\d.]+</td>", page)


def test_the_footnote_on_thresholds_stands_by_thresholds_only(
    study_one: Path, jnd: Path, tmp_path: Path
) -> None:
    footnote = "thresholds are printed without a proportion"
    for data, stands in ((study_one, False), (jnd, True)):
        page = write_report([data], tmp_path / data.name).page.read_text()
        assert "Beside the dissertation" in page
        assert (footnote in page) == stands


@pytest.mark.parametrize(
    ("people", "motions", "said"),
    [
        (12, 8, "With people and motions as random effects the log odds"),
        (12, 1, "Without random effects, which these answers cannot tell, the log odds"),
        (1, 8, "Without random effects, which these answers cannot tell, the log odds"),
    ],
)
def test_the_random_effects_named_are_those_fitted(
    people: int, motions: int, said: str, tmp_path: Path
) -> None:
    answers = people * motions
    sessions = records.counted_preferences(answers * 5 // 8, people, motions)
    data = records.write_dataset(tmp_path, records.preference_protocol(), sessions)
    text = " ".join(write_report([data]).document["studies"][0]["text"])
    assert said in text
    assert "of nothing" not in text
    assert ("random intercepts of" in text) == said.startswith("With ")


def test_files_that_cannot_be_read_are_named(
    study_one: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stranger = tmp_path / "stranger.csv"
    stranger.write_text("a,b\n1,2\n")
    out = tmp_path / "out"
    assert main(["report", str(study_one), str(stranger), "--out", str(out)]) == 0
    told = capsys.readouterr()
    assert told.out == f"{out / 'report.html'}\n"
    assert f"{stranger}: expected the columns of a record" in told.err
    page = (out / "report.html").read_text()
    assert f"{stranger}: expected the columns of a record" in page
    assert "1 file could not be read" in page
