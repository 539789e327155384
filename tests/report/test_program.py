"""The program of the page: its modules in one script, and the types they are checked by."""

from __future__ import annotations

import re
from graphlib import CycleError
from importlib.resources import files
from pathlib import Path

import pytest

from aerocues.report.program import EXPORT, IMPORT, program_of

APP = Path(str(files("aerocues.report") / "page" / "app"))


def _folder(place: Path, **modules: str) -> Path:
    for name, text in modules.items():
        file = place / f"{name.replace('__', '/')}.js"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return place


def test_imports_come_first_and_names_stay_apart(tmp_path: Path) -> None:
    folder = _folder(
        tmp_path,
        start='import {doubled} from "./basis/sums.js";\n\nconst own = 1;\n\nshow(doubled(own));\n',
        basis__sums='import {own} from "./more.js";\n\n'
        "export function doubled(x) { return own * x; }\n",
        basis__more="export const own = 2;\n",
        unused="throw new Error();\n",
    )
    assert program_of(folder) == (
        "const module_basis_more = (() => {\nconst own = 2;\nreturn {own};\n})();\n\n"
        "const module_basis_sums = (() => {\nconst {own} = module_basis_more;\n\n"
        "function doubled(x) { return own * x; }\nreturn {doubled};\n})();\n\n"
        "const module_start = (() => {\nconst {doubled} = module_basis_sums;\n\nconst own = 1;\n\n"
        "show(doubled(own));\nreturn {};\n})();\n"
    )


def test_modules_that_import_each_other_are_refused(tmp_path: Path) -> None:
    folder = _folder(
        tmp_path,
        start='import {a} from "./one.js";\n',
        one='import {b} from "./two.js";\nexport const a = 1;\n',
        two='import {a} from "./one.js";\nexport const b = 1;\n',
    )
    with pytest.raises(CycleError):
        program_of(folder)


def test_every_module_of_the_page_is_reached() -> None:
    assert program_of(APP).count("\nconst module_") + 1 == len(list(APP.rglob("*.js")))


@pytest.mark.parametrize("file", sorted(APP.rglob("*.js")), ids=lambda file: file.stem)
def test_modules_use_the_forms_that_are_put_together(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert len(re.findall(r"^\s*import\b", text, re.MULTILINE)) == len(IMPORT.findall(text))
    assert len(re.findall(r"^\s*export\b", text, re.MULTILINE)) == len(EXPORT.findall(text))
