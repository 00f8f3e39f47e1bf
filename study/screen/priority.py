"""Whether this user may have the real-time priority that psychtoolbox's keyboard needs."""

import os
import sys
import threading

GROUP = "psychtoolbox"
LIMITS = f"/etc/security/limits.d/99-{GROUP}limits.conf"
PERMIT = (
    f"to let this user time keys by real-time priority, put `@{GROUP} - rtprio 50`, "
    f"`@{GROUP} - nice -20` and `@{GROUP} - memlock unlimited` into {LIMITS}, make the user a "
    f"member of the group {GROUP}, and log in again"
)


def may_have_priority() -> bool:
    """Whether a thread of this user may have the real-time priority that psychtoolbox takes.

    Tried in a thread that ends with the trial, and nothing else runs at that priority. Systems
    other than Linux permit it to everybody.
    """
    found: list[bool] = []
    thread = threading.Thread(target=lambda: found.append(_raised()))
    thread.start()
    thread.join()
    return found == [True]


def _raised() -> bool:
    if sys.platform != "linux":
        return True
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except OSError:
        return False
    return True
