"""A hook of the site: the notebooks of `examples/` as pages, with the outputs that they hold."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
PLOTLY = "application/vnd.plotly.v1+json"
SCRIPT = "plotly.min.js"


def on_files(files: Any, config: Any, **_: Any) -> Any:
    """Add a page for each notebook, and the program that draws their figures."""
    from mkdocs.structure.files import File
    from plotly.offline import get_plotlyjs

    for notebook in sorted(EXAMPLES.glob("*.ipynb")):
        files.append(File.generated(config, f"{notebook.stem}.md", content=page_of(notebook)))
    files.append(File.generated(config, SCRIPT, content=get_plotlyjs()))
    return files


def page_of(notebook: Path) -> str:
    """The Markdown of a notebook."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    parts = [f'<script src="{SCRIPT}"></script>']
    for number, cell in enumerate(cells):
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            # The notebook stands beside the data of the repository, the page in the guide.
            parts.append(source.replace("](../docs/", "]("))
            continue
        parts.append(f"```python\n{source}\n```")
        for place, output in enumerate(cell["outputs"]):
            parts.extend(_shown(output, f"figure-{number}-{place}"))
    return "\n\n".join(parts) + "\n"


def _shown(output: dict[str, Any], name: str) -> Iterator[str]:
    """The richest form of an output that a page can show."""
    data = {kind: _text(value) for kind, value in output.get("data", {}).items()}
    if PLOTLY in data:
        # "<" would end the script.
        figure = data[PLOTLY].replace("<", "\\u003c")
        yield f'<div id="{name}" style="height: 30rem"></div>'
        drawn = f'Plotly.newPlot("{name}", figure.data, figure.layout, {{responsive: true}});'
        yield f"<script>{{ const figure = {figure}; {drawn} }}</script>"
    elif "image/jpeg" in data:
        picture = data["image/jpeg"].replace("\n", "")
        words = html.escape(data["text/plain"], quote=True)
        yield f'<img alt="{words}" src="data:image/jpeg;base64,{picture}">'
    elif "text/html" in data:
        # Without empty lines, after which Markdown would begin again.
        lines = "\n".join(line for line in data["text/html"].splitlines() if line.strip())
        yield f'<div style="overflow-x: auto">\n{lines}\n</div>'
    else:
        yield f"```text\n{data.get('text/plain') or _text(output['text'])}\n```"


def _text(value: Any) -> str:
    if isinstance(value, list):
        return "".join(value)
    return value if isinstance(value, str) else json.dumps(value)
