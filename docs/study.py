"""Write what the study found: docs/study.md, the card of its data, and two sentences of the README.

``python -m docs.study`` rewrites what stands between ``<!-- NAME -->`` marks; the tests fail where
it is out of date. A statement is made only where the database holds its rows.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from docs.study_answers import Answers
from docs.study_parts import REPOSITORY
from docs.study_published import Published
from docs.study_tables import Tables


class Findings(Answers, Tables, Published):
    """What the database says, as Markdown."""


PAGES: dict[str, tuple[str, ...]] = {
    "docs/study.md": (
        *(
            "measured",
            "advice",
            "main-finding",
            "changes",
            "models-finding",
            "models",
            "binary",
            "flann",
            "oblique",
            "turned",
            "criteria",
            "failures",
            "stale-keypoints",
        ),
        *("predictors", "presets", "learned", "extra", "pixels", "reached"),
    ),
    "study/README.md": ("parts", "versions", "dictionary"),
    "README.md": ("main-finding", "models-finding"),
}


def rendered(page: str, findings: Findings) -> str:
    """The text of a page with what the database says now; what needs more than it may stay."""
    text = (REPOSITORY / page).read_text(encoding="utf-8")
    for name in PAGES[page]:
        written: Callable[[], str | None] = getattr(findings, name.replace("-", "_"))
        between = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end of {name} -->)", re.DOTALL)
        place = between.search(text)
        if place is None:
            raise SystemExit(f"{page} has no place for {name}")
        if (told := written()) is not None:
            text = f"{text[: place.start()]}{place[1]}{told}\n{place[2]}{text[place.end() :]}"
    return text


if __name__ == "__main__":
    found = Findings()
    for page in PAGES:
        (REPOSITORY / page).write_text(rendered(page, found), encoding="utf-8")
