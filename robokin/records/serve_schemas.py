"""The JSON Schema of the answers of `robokin serve`."""

from __future__ import annotations

from robokin.records.schema_words import DRAFT, Schema, record, text, texts, whole

INPUT_ID: Schema = {"description": "The `id` of the question: any value. Absent where the question has none."}

FRONT: dict[str, Schema] = {
    "input_id": INPUT_ID,
    "status": {"const": 3, "description": "The exit status of the command. Absent where it is 0."},
    "notes": texts("What the command says on standard error, such as values outside the limits. Absent where nothing."),
}


def serve() -> Schema:
    """Of a line: a mistake, a list of documents, or the document of the question's command."""
    mistake = record(
        "A question that has no answer.",
        {
            "error": text("What is wrong, in a sentence."),
            "status": {
                "enum": [1, 2],
                "description": "2: the question is wrong; 1: a fault of robokin's own.",
            },
            "line": whole("The number of the line that the question stands on, from 1.", 1),
        },
        {"input_id": INPUT_ID},
    )
    several = record(
        "The documents of a command that prints a list of them.",
        {"documents": {"type": "array", "items": {"type": "object"}, "description": "What --json prints."}},
        FRONT,
    )
    answer: Schema = {
        "type": "object",
        "description": "The command's document, as `robokin schema COMMAND` says, behind input_id, status and notes.",
        "not": {"required": ["line", "error", "status"]},
    }
    return {
        "$schema": DRAFT,
        "title": "robokin serve, version 1",
        "description": "A line of robokin serve.",
        "anyOf": [{"$ref": f"#/$defs/{name}"} for name in ("mistake", "several", "answer")],
        "$defs": {"mistake": mistake, "several": several, "answer": answer},
    }
