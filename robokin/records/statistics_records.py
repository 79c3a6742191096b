"""The statistics of a class as plain data."""

from __future__ import annotations

from typing import Any

from robokin.grading.class_statistics import ClassStatistics, QuestionStatistics
from robokin.records.envelope import envelope


def statistics_record(found: ClassStatistics) -> dict[str, Any]:
    """The document of `robokin check statistics`."""
    scores = found.student_scores
    return envelope("file", found.source, None) | {
        "students": len(found.students),
        "answers": found.answers,
        "right": found.right,
        "wrong": found.wrong,
        "score": found.score,
        "median": _median(scores),
        "lowest": scores[0],
        "highest": scores[-1],
        "known": found.known,
        "questions": [question_statistics_record(one) for one in found.questions],
        "mistakes": [
            {
                "mistake": one.name,
                "answers": one.answers,
                "part": one.answers / max(found.wrong, 1),
                "students": len(one.students),
                "questions": [{"id": id, "answers": count} for id, count in one.questions.items()],
            }
            for one in found.mistakes
        ],
    }


def question_statistics_record(one: QuestionStatistics) -> dict[str, Any]:
    """What a class did with a question."""
    return {
        "id": one.id,
        "kind": one.kind,
        "about": one.about,
        "answers": one.answers,
        "right": one.right,
        "unanswered": one.unanswered,
        "score": one.score,
        "statuses": [{"status": status, "answers": count} for status, count in one.statuses.most_common()],
        "mistakes": [{"mistake": name, "answers": count} for name, count in one.mistakes.most_common()],
    }


def statistics_rows(found: ClassStatistics) -> tuple[list[str], list[list[Any]]]:
    """The headings and rows of a CSV: a row a question, a column for each known mistake."""
    names = [one.name for one in found.mistakes]
    rows = [
        [one.id, one.kind, one.about, one.answers, one.right, one.unanswered, one.score,
         *(one.mistakes[name] for name in names)]
        for one in found.questions
    ]  # fmt: skip
    return ["id", "kind", "about", "answers", "right", "unanswered", "score", *names], rows


def _median(values: list[float]) -> float:
    """The middle of sorted values."""
    middle = len(values) // 2
    return values[middle] if len(values) % 2 else 0.5 * (values[middle - 1] + values[middle])
