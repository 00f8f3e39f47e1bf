"""How long a session is said to be."""

import numpy as np
import pytest

from study.session.duration import Duration, minutes_of, session_duration
from study.session.simulation import rows
from study.trials.plan import make_plan
from study.trials.reading import load_protocol, parse_protocol, protocol_of
from tests.study.session.test_session import PREFERENCE, REFERENCES


def test_trials_of_a_list_are_counted_and_timed() -> None:
    protocol = parse_protocol(PREFERENCE)
    duration = session_duration(protocol, {})
    assert (duration.least, duration.most) == (24, 24)
    assert duration.minutes == pytest.approx(24 * (2 * 6.0 + 0.5 + 0.75) / 60, rel=0.03)
    assert duration.told().startswith("a session has 24 trials and takes about 5 minutes")


def test_without_an_observer_the_count_is_the_same() -> None:
    bare = parse_protocol(PREFERENCE.split("[observer]")[0])
    assert session_duration(bare, {}).trials == 24


@pytest.mark.parametrize("observed", [True, False])
def test_tracks_take_about_as_long_as_simulated_people(observed: bool) -> None:
    protocol = load_protocol("jnd-center")
    people = [len(list(rows(make_plan(protocol, REFERENCES, seed)))) for seed in range(20, 60)]
    if not observed:
        document = {key: value for key, value in protocol.document.items() if key != "observer"}
        protocol = protocol_of(document)
    assert session_duration(protocol, REFERENCES).trials == pytest.approx(np.mean(people), rel=0.35)


def test_a_rehearsal_is_short() -> None:
    assert session_duration(load_protocol("jnd-center"), REFERENCES, rehearsal=True).trials == 8


@pytest.mark.parametrize(
    ("duration", "pace", "said"),
    [
        (Duration(8, 8, 0.3), 1.0, "a session has 8 trials and takes less than a minute"),
        (Duration(90, 101, 20.2), 1.0, "a session has about 96 trials and takes about 20 minutes"),
        (Duration(1, 1, 20.2), 20.0, "a session has 1 trial and takes about a minute"),
    ],
)
def test_in_words(duration: Duration, pace: float, said: str) -> None:
    assert duration.told(pace) == said


def test_the_last_trial_lasts_as_long_as_the_others() -> None:
    assert minutes_of([3.0, 33.0, 63.0]) == 1.5
    assert minutes_of([3.0]) == 0.0
