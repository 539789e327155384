"""A hook of the site: pages as Markdown of the site needs them.

Links to files outside of the guide become their paths: in the repository they lead somewhere; the
site holds the guide and the notebooks alone. Marks of generated tables go, for a table that follows
a comment without a blank line would stay text; so does what only the tests read: that the output of
a block is exact.
"""

from __future__ import annotations

import re
from typing import Any

OUTSIDE = re.compile(r"\[([^\]]+)\]\(\.\./([^)]+)\)")
NOTEBOOK = re.compile(r"\(\.\./examples/(\w+)\.ipynb\)")
EXACT = re.compile(r"^```console exact$", re.MULTILINE)
MARK = re.compile(r"^<!-- .* -->$", re.MULTILINE)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """The text of a page as the site shows it.

    >>> on_page_markdown("see [examples](../examples)")
    'see examples (`examples` in the repository)'
    >>> on_page_markdown("see [my photos](../examples/my_photos.ipynb)")
    'see [my photos](my_photos.md)'
    """
    markdown = NOTEBOOK.sub(r"(\1.md)", EXACT.sub("```console", markdown))
    return MARK.sub("", OUTSIDE.sub(r"\1 (`\2` in the repository)", markdown))
