"""The tasks that a participant can be given, by name; adding one is adding a module."""

from collections.abc import Mapping

from study.trials.tasks import natural, odd_pair, preference, rating
from study.trials.tasks.task import Responder, Screens, Task, named_keys, pages_of

TASKS: Mapping[str, Task] = {
    task.name: task for task in (odd_pair.TASK, preference.TASK, rating.TASK, natural.TASK)
}

__all__ = ["TASKS", "Responder", "Screens", "Task", "named_keys", "pages_of"]
