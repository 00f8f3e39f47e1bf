"""What a study asks of a person, and what participants.tsv holds of one."""

from collections.abc import Mapping
from typing import NamedTuple

_YES_NO = ("yes", "no")
OLDEST = 89  # as BIDS has it: who is older is written as that, since few are


class Detail(NamedTuple):
    """A detail of a person: what is asked, and the answers that it may have; none: years."""

    asked: str
    answers: tuple[str, ...] = ()

    @property
    def told(self) -> str:
        """The question with its answers."""
        return f"{self.asked} ({', '.join(self.answers)})" if self.answers else self.asked

    def plain(self, text: str) -> str | None:
        """The answer where it is one of those that are asked for, which nobody is known by."""
        word = text.strip().lower()
        if self.answers:
            return word if word in self.answers else None
        return str(min(int(word), OLDEST)) if word.isdecimal() else None


QUESTIONS: Mapping[str, Detail] = {
    "age": Detail("age in years"),
    "sex": Detail("sex", ("female", "male", "other", "n/a")),
    "vision": Detail("normal or corrected-to-normal vision", _YES_NO),
    "naive": Detail("naive to the purpose of the study", _YES_NO),
    "animation_experience": Detail("experience in animation beyond games and film", _YES_NO),
}
PARTICIPANT_COLUMNS: Mapping[str, str] = {
    "participant_id": "the participant",
    **{name: question.told for name, question in QUESTIONS.items()},
    "observer": "human or simulated",
    "comments": "free comments after the session",
}
