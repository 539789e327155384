"""The page: one HTML file from the template, the program, plotly and the payload."""

from __future__ import annotations

import base64
import gzip
import html
import json
import re
from collections.abc import Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

from aerocues.errors import MethodUnavailableError
from aerocues.report.program import program_of

PLACE = re.compile(r"\{\{(title|style|payload|app|plotly)\}\}")
# Text that would end the surrounding element.
END_OF_ELEMENT = re.compile(r"</(?=script|style)", re.IGNORECASE)


def page_of(payload: Mapping[str, Any]) -> str:
    """The complete page, which loads nothing from elsewhere.

    Parameters
    ----------
    payload : mapping
        From `payload.payload_of`.
    """
    folder = files("aerocues.report") / "page"
    contents = {
        "title": html.escape(str(payload["title"])),
        "style": _inside_element(_read(folder / "style.css")),
        "payload": payload_text(payload),
        "app": _inside_element(_application(folder / "app")),
        "plotly": packed(_plotly()),
    }
    return PLACE.sub(lambda found: contents[found[1]], _read(folder / "index.html"))


def payload_text(payload: Mapping[str, Any]) -> str:
    """The payload as JSON, in which no text can start or end an HTML element."""
    text = json.dumps(payload, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")


def packed(text: str) -> str:
    """Text as the page unpacks it: gzip, in base64."""
    return base64.b64encode(gzip.compress(text.encode(), compresslevel=6, mtime=0)).decode("ascii")


def _read(file: Traversable) -> str:
    return file.read_text(encoding="utf-8")


def _inside_element(text: str) -> str:
    return END_OF_ELEMENT.sub(r"<\\/", text)


def _application(folder: Traversable) -> str:
    return f'(() => {{\n"use strict";\n{program_of(folder)}\n}})();'


def _plotly() -> str:
    try:
        from plotly.offline import get_plotlyjs
    except ImportError as error:
        raise MethodUnavailableError(
            f"the page needs plotly ({error}); install it: pip install plotly, or report "
            "where it is"
        ) from error

    return str(get_plotlyjs())
