"""Executes a notebook from top to bottom and stores what its cells give.

    python examples/execute.py NOTEBOOK [OUTPUT]

The cells run in the current folder, in one Python process without Jupyter; of the magics,
``%%writefile NAME`` is known. Without OUTPUT the notebook itself is rewritten.
"""

from __future__ import annotations

import ast
import base64
import contextlib
import io
import json
import sys
from pathlib import Path
from typing import Any

WRITE = "%%writefile "


def execute(notebook: dict[str, Any]) -> None:
    """Run the code cells of a notebook in order, and put their outputs into it."""
    names: dict[str, Any] = {"__name__": "__main__"}
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for number, cell in enumerate(code, start=1):
        cell["execution_count"] = number
        cell["outputs"] = _outputs("".join(cell["source"]), names, number)


def _outputs(source: str, names: dict[str, Any], number: int) -> list[dict[str, Any]]:
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        value = _run(source, names)
    outputs: list[dict[str, Any]] = []
    if text := printed.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": _lines(text)})
    if value is not None:
        result = {"output_type": "execute_result", "execution_count": number, "metadata": {}}
        outputs.append({**result, "data": shown(value)})
    return outputs


def _run(source: str, names: dict[str, Any]) -> Any:
    """Run a cell; the value of its last line, if that is an expression."""
    if source.startswith(WRITE):
        first, _, content = source.partition("\n")
        Path(first.removeprefix(WRITE).strip()).write_text(content + "\n", encoding="utf-8")
        print(f"Writing {first.removeprefix(WRITE).strip()}")  # noqa: T201 - as Jupyter does
        return None
    tree = ast.parse(source)
    last = tree.body[-1] if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    if last is not None:
        tree.body.pop()
    exec(compile(tree, "<cell>", "exec"), names)
    if last is None:
        return None
    return eval(compile(ast.Expression(last.value), "<cell>", "eval"), names)


def shown(value: Any) -> dict[str, Any]:
    """A value in the forms in which Jupyter would show it."""
    if hasattr(value, "to_plotly_json"):
        return {
            "application/vnd.plotly.v1+json": json.loads(value.to_json()),
            "text/plain": ["a Plotly figure: open the notebook in Jupyter to see it"],
        }
    data: dict[str, Any] = {"text/plain": _lines(repr(value))}
    if hasattr(value, "_repr_html_"):
        data["text/html"] = _lines(value._repr_html_())
    if hasattr(value, "_repr_jpeg_"):
        data["image/jpeg"] = base64.b64encode(value._repr_jpeg_()).decode()
    return data


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


def main() -> None:
    """Execute the notebook that the command line names."""
    file = Path(sys.argv[1])
    notebook = json.loads(file.read_text(encoding="utf-8"))
    # Cells import modules that they write, as in a notebook.
    sys.path.insert(0, str(Path.cwd()))
    execute(notebook)
    target = Path(sys.argv[2]) if len(sys.argv) > 2 else file
    target.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
