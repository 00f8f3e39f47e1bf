"""The report written: one page, one JSON document, tables and figures beside them."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from analysis.errors import InputError, NothingAnalysed
from analysis.files import write_atomic
from analysis.record import read
from analysis.report.across import across, document_of
from analysis.report.certificate_part import certificate_section, certificates
from analysis.report.context import Context, Report
from analysis.report.methods_part import asked_section, methods_section
from analysis.report.natural_part import report_natural
from analysis.report.parts import Findings, Section
from analysis.report.preference_part import report_preference
from analysis.report.provenance import provenance, provenance_section
from analysis.report.published import published_section
from analysis.report.rating_part import report_rating
from analysis.report.study_parts import exclusion_section, people_section, timing_section
from analysis.report.threshold_part import report_odd_pair
from analysis.report.words import count
from analysis.screening import screen

_ANALYSES: dict[str, Report] = {
    "odd-pair": report_odd_pair,
    "preference": report_preference,
    "rating": report_rating,
    "natural": report_natural,
}

_APART = {
    "rehearsal": "A rehearsal: short clips and short tracks.",
    "paced": "Paced: time ran faster or slower than for people.",
}
NOT_EVIDENCE = "These figures show that the study runs; they say nothing about how people see."


@dataclass(frozen=True, eq=False)
class StudyReport:
    """One study as the page and the document have it."""

    name: str
    title: str
    subtitle: str
    warnings: tuple[str, ...]
    sections: tuple[Section, ...]
    document: dict[str, Any]


@dataclass(frozen=True)
class Written:
    """Where the report is, and its document."""

    page: Path
    document: dict[str, Any]


def write_report(
    data: list[Path],
    out: Path | None = None,
    seed: int = 0,
    second_opinion: bool = False,
    columns: dict[str, str] | None = None,
) -> Written:
    """Read every record below `data` and write the report into `out`.

    `out` defaults to `derivatives/segue` in the first of `data`; `columns` gives the tables' own
    names for columns of ours. Raises InputError when no record is found, and NothingAnalysed
    when no trial of those found can be analysed.
    """
    studies, notes = read(data, columns)
    out = out or (data[0] if data[0].is_dir() else data[0].parent) / "derivatives" / "segue"
    known = certificates(data)
    contexts = [Context(study, screen(study), seed, second_opinion, known) for study in studies]
    _check_any(contexts)
    reports = [report_of(context) for context in contexts]
    tests, section = across(contexts)
    document = {
        "studies": [report.document for report in reports],
        "across": document_of(tests),
        "unread": notes,
    }
    if section is not None:
        reports.append(_across_report(section))
    for report in reports:
        _write_parts(report, out)
    text = json.dumps(clean(document), indent=2, ensure_ascii=False, allow_nan=False)
    write_atomic(out / "report.json", text + "\n")
    page = out / "report.html"
    write_atomic(page, page_of(reports, notes))
    return Written(page, document)


def _check_any(contexts: list[Context]) -> None:
    """Raise NothingAnalysed, with the first reasons, where no study has a trial that counts."""
    if any(len(context.screened.main) for context in contexts):
        return
    studies = [context.study for context in contexts]
    told = [line for study in studies for line in (*study.faults, *study.remarks)]
    rules = [
        f"{exclusion.rule}: {count(exclusion.trials, 'trial')}"
        for context in contexts
        for exclusion in context.screened.exclusions
        if exclusion.trials
    ]
    why = (told + rules)[:1] or ["the tables hold no row of an answered main trial"]
    raise NothingAnalysed(
        f"{', '.join(study.name for study in studies)}: expected trials to analyse, found none.\n"
        f"{why[0]}"
    )


def _write_parts(report: StudyReport, out: Path) -> None:
    """The figures and tables of a study, each a file."""
    for section in report.sections:
        for figure in section.figures:
            write_atomic(out / "figures" / f"{_stem(figure.name)}.svg", figure.svg)
        for table in section.tables:
            content = table.data.to_csv(index=False, lineterminator="\n")
            write_atomic(out / "tables" / f"{_stem(table.name)}.csv", content)


def _across_report(section: Section) -> StudyReport:
    return StudyReport(
        name="across the studies",
        title="Across the studies",
        subtitle="what no study says alone",
        warnings=(),
        sections=(section,),
        document={"trials": 0},
    )


def report_of(context: Context) -> StudyReport:
    """Analyse one study."""
    study = context.study
    main = context.screened.main
    findings = _findings(context) if len(main) else _nothing(context)
    published = published_section(context, findings.document)
    sections = (
        asked_section(context),
        people_section(context),
        exclusion_section(context),
        certificate_section(context),
        *findings.sections,
        *((published,) if published else ()),
        timing_section(context),
        methods_section(context),
        provenance_section(context),
    )
    return StudyReport(
        name=study.name,
        title=str(study.protocol.get("title") or study.name),
        subtitle=_subtitle(context),
        warnings=_warnings(context),
        sections=sections,
        document=_document(context, findings),
    )


def _document(context: Context, findings: Findings) -> dict[str, Any]:
    study, screened = context.study, context.screened
    return {
        "protocol": study.name,
        "task": study.task,
        "participants": len(screened.people),
        "participants_recorded": len(screened.people) + len(screened.left_out),
        "participants_left_out": [
            {"participant": person, "reason": reason} for person, reason in screened.left_out
        ],
        "trials": len(screened.main),
        "excluded": screened.excluded,
        "exclusions": [
            {
                "rule": exclusion.rule,
                "participants": list(exclusion.participants),
                "trials": exclusion.trials,
            }
            for exclusion in screened.exclusions
        ],
        "rehearsal": study.rehearsal,
        "rehearsals_left_out": len(study.set_aside),
        "faults": [*study.faults, *study.remarks],
        "remarks": list(study.remarks),
        "comparisons": [],
        "ratings": [],
        "psychometric": [],
        **findings.document,
        "text": findings.sentences,
        "methods": " ".join(methods_section(context).text),
        "certificate": context.certificate,
        "provenance": provenance(context),
    }


def _findings(context: Context) -> Findings:
    """The task's analysis; one that the records do not allow is named, and the rest goes on."""
    try:
        return _ANALYSES[context.study.task](context)
    except InputError as error:
        why = f"These records cannot be analysed: {error}"
        return Findings((Section("Results", text=(why,)),), {"error": str(error)})


def _nothing(context: Context) -> Findings:
    return Findings((Section("Results", text=("No trial is left to analyse.",)),))


def _subtitle(context: Context) -> str:
    source = context.protocol.get("source")
    parts = [context.study.name, f"task {context.study.task}"]
    return " · ".join(parts + ([str(source)] if source else []))


def _warnings(context: Context) -> tuple[str, ...]:
    study = context.study
    told = [f"{_APART[label]} {NOT_EVIDENCE}" for label in study.labels]
    observers = {str(session.sidecar.get("Observer", "human")) for session in study.sessions}
    if "simulated" in observers:
        who = "All" if observers == {"simulated"} else "Some"
        told.append(f"{who} answers here come from simulated observers, not from people.")
    return tuple(told)


def page_of(reports: list[StudyReport], notes: list[str]) -> str:
    """The page; everything but the drawings made here is escaped."""
    from jinja2 import Environment, PackageLoader
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("analysis.report", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["drawn"] = Markup
    trials = sum(report.document["trials"] for report in reports)
    studies = sum("protocol" in report.document for report in reports)
    subtitle = f"{count(studies, 'study', 'studies')}, {count(trials, 'trial')} analysed"
    if notes:
        subtitle += f"; {count(len(notes), 'file')} could not be read"
    return environment.get_template("page.html").render(
        title="How the transitions were seen",
        subtitle=subtitle,
        unread=notes,
        studies=reports,
        footer="Written by Segue. Numbers behind every figure: tables/ and report.json.",
    )


def clean(value: Any) -> Any:
    """JSON has no infinities: a number that is none becomes null; arrays become lists."""
    if isinstance(value, dict):
        return {str(key): clean(held) for key, held in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [clean(held) for held in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def _stem(name: str) -> str:
    """A name from a log as a file's stem: nothing in it can lead elsewhere."""
    return "".join(c if c.isalnum() or c in "-_" else "-" for c in name)[:120]
