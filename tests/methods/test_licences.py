from __future__ import annotations

from dataclasses import replace
from email.message import Message

import pytest

from aerocues.methods import licences, plugins
from aerocues.methods.licences import is_permissive, licence_of, why_not_licensed
from aerocues.methods.registry import Methods


@pytest.mark.parametrize(
    "licence",
    [
        *("BSD-3-Clause", "3-Clause BSD License", "New BSD License", "BSD", "mit", "MIT-CMU"),
        *("The MIT License", "Apache Software License", "Apache License, Version 2.0", "ISC"),
        *("ISC License (ISCL)", "The Unlicense (Unlicense)", "zlib/libpng License"),
        "BSD-2-Clause AND Apache-2.0 WITH LLVM-exception",
        "BSD-3-Clause AND 0BSD AND MIT AND Zlib AND CC0-1.0",
        *(
            "GPL-3.0-only OR MIT",
            "(GPL-2.0 or MIT) AND ISC",
            "MIT OR GPL-3.0-only AND BSD-3-Clause",
        ),
    ],
)
def test_permissive_licences(licence: str) -> None:
    assert is_permissive(licence)


@pytest.mark.parametrize(
    "licence",
    [
        *("", "GPL-3.0-only", "MIT AND GPL-3.0-only", "MIT (non-commercial)", "MITRE", "2.0"),
        "BSD License, GNU General Public License v3 (GPLv3)",
        "MIT License, GNU General Public License v3 or later (GPLv3+)",
        *("(MIT OR GPL-3.0) AND LGPL-2.1", "Apache-2.0 with Commons Clause", "GPL-2.0-or-later"),
        *("Mozilla Public License 2.0 (MPL 2.0)", "Other/Proprietary License"),
    ],
)
def test_licences_with_duties(licence: str) -> None:
    assert not is_permissive(licence)


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"License-Expression": "MIT", "License": "BSD"}, "MIT"),
        (
            {"License": "Copyright (c) 2001\n\nAll rights", "Classifier": "License :: X :: BSD"},
            "BSD",
        ),
        ({"License": "BSD", "Classifier": "License :: OSI Approved"}, "BSD"),
        ({"License": "MIT", "Classifier": "License :: Free for non-commercial use"}, None),
        ({"License": "Copyright (c) 2001\nAll rights"}, None),
        ({"License": "Permission is hereby granted " * 9}, None),
        ({}, None),
    ],
)
def test_where_a_distribution_states_its_licence(
    monkeypatch: pytest.MonkeyPatch, fields: dict[str, str], expected: str | None
) -> None:
    stated = Message()
    for name, value in fields.items():
        stated[name] = value
    monkeypatch.setattr(licences, "metadata", lambda name: stated)
    found = licence_of("magic 1.0")
    assert found == (expected or fields.get("Classifier", "").rpartition("::")[2].strip() or None)


def test_each_kind_has_its_own_methods(monkeypatch: pytest.MonkeyPatch, methods: Methods) -> None:
    # A matcher of another package that is called like OpenCV's detector.
    mine = replace(methods.matchers["BF"], name="ORB", origin="no-such-distribution 1")
    known = replace(methods, matchers={**methods.matchers, "ORB": mine})
    monkeypatch.setattr(plugins, "installed_methods", lambda: known)
    names = ["ORB-ORB-HAM-BF", "SIFT-SIFT-L2-ORB", "PIXELMAP-NONE-NONE-PIXELMAP"]
    assert why_not_licensed(names, "permissive") == {
        "SIFT-SIFT-L2-ORB": "the licence of ORB is not known"
    }
    monkeypatch.setitem(licences.KNOWN, "pixelmap-python", "GPL-3.0-only")
    found = why_not_licensed(["ORB-NONE-NONE-PIXELMAP"], "permissive")
    assert found == {"ORB-NONE-NONE-PIXELMAP": "the licence of PIXELMAP is GPL-3.0-only"}


def test_who_brings_a_method() -> None:
    assert licence_of("opencv") == "Apache-2.0"
    assert licence_of("no-such-distribution-anywhere") is None
    assert licence_of("numpy") is not None
    names = ["ORB-ORB-HAM-BF", "SIFT-SIFT-L2-EXACT", "COLMAP-SIFT-L2-COLMAP", "MAGIC-ORB-HAM-BF"]
    found = why_not_licensed(names, "permissive")
    assert found == {"MAGIC-ORB-HAM-BF": "the licence of MAGIC is not known"}
