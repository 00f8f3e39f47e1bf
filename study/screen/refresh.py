"""The refresh rate of a screen: as the system states it, as measured, and what it does to clips."""

from dataclasses import dataclass
from typing import Any

from stimuli.errors import InputError
from study.screen.schedule import NOMINAL_REFRESH, divides, never_shown

AGREE = 0.03  # share by which what is measured may lie off what is stated


@dataclass(frozen=True)
class Refresh:
    """Rates in Hz; None where the system states none (a virtual screen), or none was measured."""

    stated: float | None
    measured: float | None

    @property
    def vsync(self) -> bool:
        """Whether flips wait for the screen; else the session paces itself by the clock."""
        return self.stated is not None

    @property
    def rate(self) -> float:
        """The rate that frames are planned by: measured, else stated, else the usual one."""
        if self.stated is None:
            return NOMINAL_REFRESH
        return self.measured or self.stated

    @property
    def disagree(self) -> bool:
        """Whether what is measured lies off what is stated by more than the measurement may."""
        if self.stated is None or self.measured is None:
            return False
        return abs(self.measured / self.stated - 1) > AGREE

    def facts(self) -> dict[str, object]:
        """For the record."""
        told = {"stated": self.stated, "measured": self.measured}
        return {
            "vsync": self.vsync,
            "refresh_rate": round(self.rate, 3) if self.vsync else None,
            "paced_at": round(self.rate, 3),
            **{f"refresh_rate_{name}": value and round(value, 3) for name, value in told.items()},
        }


def refresh_of(window: Any) -> Refresh:
    """The rates of the screen on which a PsychoPy window lies."""
    mode = window.winHandle.screen.get_mode()
    stated = float(getattr(mode, "rate", 0) or 0)
    if stated <= 0:
        return Refresh(None, None)
    measured = window.getActualFrameRate(infoMsg="")
    return Refresh(stated, None if measured is None else float(measured))


def notes_on(refresh: Refresh, fps: float, slow_allowed: bool, pace: float = 1.0) -> list[str]:
    """What the experimenter should know of this screen before clips of `fps` are shown on it.

    InputError for a screen that could never show some of their frames, unless that is allowed.
    """
    if not refresh.vsync or pace > 1:
        return []
    rate, told = refresh.rate, []
    if refresh.disagree:
        told.append(
            f"the system states {refresh.stated:g} Hz, {refresh.measured:.2f} Hz were measured: "
            "the measured rate is used, and both are recorded"
        )
    lost = never_shown(fps, rate)
    if lost > 0.01:
        what = f"a screen of {rate:.4g} Hz shows {100 * (1 - lost):.0f} % of the frames of a clip"
        if not slow_allowed:
            raise InputError(
                f"screen: expected at least {fps:g} refreshes a second for clips of {fps:g} "
                f"frames, found {rate:.4g} Hz, which could never show {100 * lost:.0f} % of them;\n"
                "set the screen to a higher rate, or say presentation.slow_screen_allowed = true"
            )
        told.append(f"{what}; the protocol allows it")
    elif not divides(fps, rate):
        ratio = rate / fps
        low = int(ratio)
        told.append(
            f"a screen of {rate:.4g} Hz shows the frames of a clip for {low} or {low + 1} "
            f"refreshes in turn ({ratio:.3g} on average); a rate that {fps:g} divides, such as 60 "
            "or 120 Hz, shows them evenly"
        )
    return told
