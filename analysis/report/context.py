"""What every part of a study's report is written from."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from analysis.record import Study
from analysis.report.parts import Findings
from analysis.screening import Screened


@dataclass(frozen=True, eq=False)
class Context:
    """A study, its screened trials, and how it is analysed."""

    study: Study
    screened: Screened
    seed: int = 0
    second_opinion: bool = False
    certificates: dict[str, Any] = field(default_factory=dict)

    @property
    def certificate(self) -> dict[str, Any] | None:
        """What `segue certify` found of this protocol, by its hash."""
        marks = {str(s.sidecar.get("ProtocolHash")) for s in self.study.sessions}
        return next((self.certificates[mark] for mark in marks if mark in self.certificates), None)

    @property
    def protocol(self) -> dict[str, Any]:
        return self.study.protocol

    @property
    def alpha(self) -> float:
        """The significance level that the protocol states; .05 where it states none."""
        stated = self.table("analysis").get("alpha")
        return float(stated) if isinstance(stated, int | float) and 0 < stated < 1 else 0.05

    def table(self, name: str) -> dict[str, Any]:
        """A table of the protocol; empty when it is absent or no table."""
        found = self.protocol.get(name)
        return found if isinstance(found, dict) else {}

    @property
    def stem(self) -> str:
        """The study's name as the beginning of file names."""
        plain = re.sub(r"[^A-Za-z0-9]+", "-", self.study.name).strip("-").lower()[:40] or "study"
        return "-".join((plain, *self.study.labels))


Report = Callable[[Context], Findings]
