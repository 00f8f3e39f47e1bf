"""What was asked and how, in the words of a Methods section.

It says what the record, the protocol and the manifest hold, and is silent on what they leave open.
"""

from typing import Any

from analysis.psychometric.fit import LAPSE_BOUND
from analysis.report.context import Context
from analysis.report.parts import Section
from analysis.report.words import count, listing, share
from analysis.screening import stated_rules

_TASKS = {
    "odd-pair": "On each trial two pairs of clips were shown side by side, one pair after the "
    "other. One pair held the same clip twice, the other two clips that differed in blend length; "
    "participants said which pair held two different clips, and guessed when unsure.",
    "preference": "On each trial two clips of the same motions, joined by two methods, were shown "
    "and participants said which looked more natural.",
    "rating": "Participants watched a clip and rated it on five-point scales, then another, and "
    "at last compared the two.",
    "natural": "Participants watched a clip and said whether it looked natural.",
}

_QUESTIONS = {
    "odd-pair": "By how many frames must the length of a blend differ for people to see it?",
    "preference": "Which way of joining two motions do people find more natural?",
    "rating": "How realistic, and how noticeable, do people find the transitions compared?",
    "natural": "Which transitions do people call natural, and does a score predict it?",
}

_LEVITT_COUNTED = (
    "a transformed up-down staircase ({n_down} down, {n_up} up; Wetherill and Levitt, 1965)"
)
_STAIRCASES = {
    "levitt": "a transformed up-down staircase (Wetherill and Levitt, 1965)",
    "wang": "the staircase of Wang (2005): the difference shrank after two right answers in a row "
    "and otherwise grew",
    "weighted": "a weighted up-down staircase (Kaernbach, 1991)",
    "questplus": "QUEST+ (Watson, 2017)",
}


def asked_section(context: Context) -> Section:
    """The question of the study."""
    study = context.study
    sets = context.table("stimuli").get("motions")
    shown = [m for m in sets or () if isinstance(m, dict) and not m.get("example")]
    named = list(dict.fromkeys(str(m.get("of") or m.get("name")) for m in shown))
    facts = [("Question", _QUESTIONS[study.task]), ("Task", _TASKS[study.task])]
    if named:
        facts.append(("Motions", listing(named)))
    conditions = list(dict.fromkeys(str(m["condition"]) for m in shown if m.get("condition")))
    if conditions:
        facts.append(("Compared", listing(conditions)))
    methods = context.protocol.get("methods")
    if methods:
        facts.append(("Joined by" if conditions else "Methods", listing([str(m) for m in methods])))
    return Section("What was asked", facts=tuple(facts))


def methods_section(context: Context) -> Section:
    """A Methods paragraph ready to paste."""
    if not context.protocol:
        return Section("Methods", text=("The records hold no protocol to write Methods from.",))
    sentences = [
        *_stimuli(context),
        _TASKS[context.study.task],
        *_staircase(context),
        *_order(context),
        *_analysis(context),
    ]
    return Section("Methods", findings=(), text=(" ".join(sentences),))


def _stimuli(context: Context) -> list[str]:
    """What the protocol and the manifest hold of the clips; nothing that they leave open."""
    stimuli = context.table("stimuli")
    told = [f"{_opening(context)}{_layout(context)}."]
    reference = stimuli.get("reference")
    if reference is not None:
        told.append(
            "The reference blend lasted "
            + (
                "as long as the geodesic distance was least (Wang, 2005, V.1)"
                if reference == "geodesic"
                else count(int(reference), "frame")
            )
            + f"; {_lengths(stimuli)}."
        )
    methods = context.protocol.get("methods")
    if methods:
        told.append(f"Blend lengths were chosen by {listing([str(m) for m in methods])}.")
    return told


def _opening(context: Context) -> str:
    """What the stimuli were; of sessions simulated without any, what they were to be."""
    sets = [s.sidecar["StimulusSetHash"] for s in context.study.sessions
            if "StimulusSetHash" in s.sidecar]  # fmt: skip
    kind = context.table("stimuli").get("specification")
    kinds = f"{kind} transitions" if kind else "transitions"
    if sets and all(mark == "n/a" for mark in sets):
        return (
            "No stimuli were rendered for these answers; what follows is the protocol that they "
            f"stand for. Stimuli are {kinds} between captured human motions, to be rendered offline"
        )
    rendered = ", rendered offline" if sets else ""
    return f"Stimuli were {kinds} between captured human motions{rendered}"


def _layout(context: Context) -> str:
    """How long the clips are: as the protocol states it, else as the manifest counts it."""
    seconds = context.table("stimuli").get("seconds")
    if isinstance(seconds, int | float):
        return f" as clips of {seconds:g} s"
    frames = {
        entry["frames"]
        for entry in context.study.stimuli.values()
        if isinstance(entry.get("frames"), int)
    }
    return f" as clips of {count(frames.pop(), 'frame')}" if len(frames) == 1 else ""


def _lengths(stimuli: dict[str, Any]) -> str:
    lengths = stimuli.get("lengths")
    if lengths:
        return f"it was compared with lengths of {listing([str(n) for n in lengths])} frames"
    sides = [f"{side} by {listing([str(n) for n in stimuli[side]])} frames"
             for side in ("shorter", "longer") if stimuli.get(side)]  # fmt: skip
    return "it was compared with blends " + (" and ".join(sides) or "of other lengths")


def _staircase(context: Context) -> list[str]:
    rule = context.table("staircase")
    if not rule:
        return []
    name = str(rule.get("rule", ""))
    words = _STAIRCASES.get(name, f"the rule {name}")
    if name == "levitt" and {"n_down", "n_up"} <= set(_numbers(rule)):
        words = _LEVITT_COUNTED.format_map(_numbers(rule))
    stop = rule.get("stop")
    ends = {
        "visits": "a level had been answered {} times",
        "reversals": "it had turned {} times",
        "trials": "{} trials had been answered",
    }
    held = [ends[k].format(v) for k, v in stop.items() if k in ends] if stop else []
    until = f" A track ended when {' or '.join(held)}." if held else ""
    return [
        f"Differences followed {words}, with one track for each motion and side, interleaved."
        f"{until}"
    ]


def _numbers(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if isinstance(value, int | float)}


def _order(context: Context) -> list[str]:
    """In which order things came, as the trials themselves have it."""
    trials = context.screened.main
    told = []
    if context.study.task == "odd-pair":
        for column, words in (
            ("odd_pair", "The odd pair came first"),
            ("odd_position", "The odd clip was on the left"),
        ):
            if column in trials and trials[column].notna().any():
                known = trials[column].dropna()
                told.append(
                    f"{words} in {int((known == 1).sum())} of {count(len(known), 'trial')}."
                )
    if context.study.task == "preference" and len(trials):
        firsts = trials["first_method"].astype(str).value_counts().sort_index()
        each = [f"{name} in {n}" for name, n in firsts.items()]
        told.append(f"Of {count(len(trials), 'trial')}, {listing(each)} showed it first.")
    return told


def _analysis(context: Context) -> list[str]:
    stated = context.table("analysis")
    told = [f"Results were called significant below α = {share(context.alpha, 3).rstrip('0')}."]
    if context.study.task == "odd-pair":
        lapse = stated.get("lapse", "free")
        bound = share(float(stated.get("lapse_bound", LAPSE_BOUND)))
        told.insert(
            0,
            f"{str(stated.get('function', 'logistic')).capitalize()} functions with a guess rate "
            "of ½ and a lapse rate "
            + (f"free below {bound}" if lapse == "free" else f"of {share(float(lapse))}")
            + " were fitted to single trials by maximum likelihood, each side of the reference "
            f"apart; 95% intervals resample people, then trials within people "
            f"({int(stated.get('bootstrap', 2000)):,} times).",
        )
    rules = [words for _, words, _, _ in stated_rules(context.protocol)]
    if rules:
        told.append(f"Left out by rules set beforehand were {listing(rules)}.")
    return told
