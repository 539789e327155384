"""A study: the results of many measurements as one database."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.errors import StoreError
from aerocues.notebooks import as_html
from aerocues.phrases import count
from aerocues.results.combination_columns import METHODS
from aerocues.results.cpu_times import with_cpu_times
from aerocues.results.measured_results import Results
from aerocues.results.packing import folder_content, zipped
from aerocues.results.schema import Column, polars_schema
from aerocues.results.store import Store
from aerocues.results.study_place import NAME, part_folder, part_names, study_folder
from aerocues.results.whole_files import write_whole

if TYPE_CHECKING:
    import polars as pl

PART = "part"
FACTS = "study"
"""Key of what is told of a part in its ``run.json``."""

PARTS: tuple[Column, ...] = (
    Column(PART, "string", "", "name of the part: a folder, and PART in study:PART"),
    Column("title", "string", "", "what was measured"),
    Column("dataset", "string", "", "name of the dataset"),
    Column("preset", "string", "", "preset of parameters and protocol"),
    Column("max_width", "string", "px", "width to which wider images were shrunk; full: none"),
    Column("max_keypoints", "integer", "count", "most keypoints of an image; 0: all"),
    Column("combinations", "integer", "count", "combinations with rows"),
    Column("pairs", "integer", "count", "pairs of images with rows"),
    Column("rows", "integer", "count", "rows in the table results"),
    Column("ok", "integer", "count", "rows with the status ok"),
    Column("models", "integer", "count", "rows in the table reconstructions"),
    Column("finished", "string", "", "finished steps: rounds of combinations, models"),
    Column("again", "integer", "count", "rows that were measured again to check them"),
    Column("identical", "integer", "count", "of these, rows with the same quality"),
    Column("cpu_hours", "float", "h", "CPU time of measuring the covered rows and models"),
    Column("covered", "integer", "count", "rows and models that cpu_hours covers"),
    Column("licence", "string", "", "terms of the images"),
    Column("aerocues", "string", "", "version of aerocues"),
    Column("opencv", "string", "", "version of OpenCV"),
    Column("machine", "string", "", "kind of machine"),
)
"""The columns of the table ``parts``."""


class Study:
    """Results of many measurements, a part each, and queries over all of them.

    Parameters
    ----------
    place : str or path, optional
        A folder of results folders, a zip file of one, or the web address of such a file, which is
        downloaded once; by default `AEROCUES_STUDY`, or ``study/database`` of the checkout.

    Raises
    ------
    AerocuesError
        If there is no study, or it cannot be downloaded.
    """

    def __init__(self, place: str | Path | None = None) -> None:
        self._folder = study_folder(place)

    @property
    def folder(self) -> Path:
        """The folder of the parts."""
        return self._folder

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the parts, sorted."""
        return part_names(self._folder)

    def part(self, name: str) -> Results:
        """The results of a part; StoreError if there is none of that name."""
        return Results(part_folder(self._folder, name))

    def parts(self) -> pl.DataFrame:
        """One row per part, see `PARTS`."""
        import polars as pl

        rows = [part_facts(name, self.part(name)) for name in self.names]
        return pl.DataFrame(rows, schema=polars_schema(PARTS), orient="row")

    def table(self) -> pl.DataFrame:
        """The rows of all parts: the name of the part, then columns as in `schema.COLUMNS`."""
        return self._all(Results.table)

    def reconstructions(self) -> pl.DataFrame:
        """The reconstructions of all parts, with the name of the part."""
        return self._all(Results.reconstructions)

    def sql(self, query: str) -> pl.DataFrame:
        """Answer an SQL query over the tables ``parts``, ``results`` and ``reconstructions``.

        Raises
        ------
        StoreError
            If the query is not a read-only query, or fails.
        """
        from aerocues.results.queries import answer

        tables = {
            "parts": self.parts(),
            "results": self.table(),
            "reconstructions": self.reconstructions(),
        }
        return answer(query, tables, listing="aerocues study --columns")

    def pack(self, file: str | Path) -> Path:
        """Write all parts into one zip file, which `Study` can open elsewhere.

        Raises
        ------
        StoreError
            If the file cannot be written.
        """
        from aerocues.results.export import write_file

        files = (path for path in sorted(self._folder.rglob("*")) if path.is_file())
        named = {path.relative_to(self._folder).as_posix(): path.read_bytes() for path in files}
        write_file(Path(file), zipped(named))
        return Path(file)

    def __repr__(self) -> str:
        parts = self.parts()
        rows, models = int(parts["rows"].sum()), int(parts["models"].sum())
        return (
            f"Study {self._folder}: {count(len(parts), 'part')}, {count(rows, 'row')} and "
            f"{count(models, 'reconstruction')}"
        )

    def _repr_html_(self) -> str:
        return as_html(repr(self), self.parts())

    def _all(self, table: Callable[[Results], pl.DataFrame]) -> pl.DataFrame:
        import polars as pl

        return pl.concat(
            table(self.part(name)).select(pl.lit(name).alias(PART), pl.all()) for name in self.names
        )


def add_part(study: str | Path, name: str, results: str | Path, facts: Mapping[str, Any]) -> Path:
    """Store a results folder as a part of a study, without what ties it to this machine.

    It stays a results folder, which `aerocues.run` can continue; clouds, references and the places
    of the images are left out. Times become CPU times, see `with_cpu_times`.

    Parameters
    ----------
    study : path
        Folder of the study, made where it is missing.
    name : str
        Of the part: small letters, digits, ``-`` and ``_``.
    results : path
        The results folder.
    facts : mapping
        What is told of the part, in JSON types: ``title``, ``licence``, ``cpu_hours``, and
        ``steps``: objects by name, with ``finished`` where a step is, and the number ``rows`` that
        ``cpu_hours`` covers; ``verified``: an object with the numbers ``again`` and ``identical``.

    Returns
    -------
    Path
        The folder of the part.

    Raises
    ------
    StoreError
        If the name is not one, or a file cannot be read or written.
    """
    if not NAME.fullmatch(name):
        raise StoreError(f"{name!r} cannot name a part; use small letters, digits, - and _")
    store, folder = Store.open(Path(results)), Path(study) / name
    told = {**without_places(store.run()), FACTS: dict(facts)}
    planned, models = store.planned(), store.reconstructions()
    rows = store.rows().join(planned.select("row_key"), on="row_key", how="semi")
    content = folder_content(told, planned, with_cpu_times(rows), models if len(models) else None)
    try:
        for file in content:
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
        write_whole({folder / file: data for file, data in content.items()})
    except OSError as error:
        raise StoreError(
            f"cannot write to {folder}: {error.strerror}; grant access or free space"
        ) from error
    return folder


def without_places(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The record of a run without the paths of the machine that it ran on."""
    dataset = {k: v for k, v in (settings.get("dataset") or {}).items() if k != "source"}
    read = {k: _without_folder(v) for k, v in dataset.get("settings", {}).items()}
    kept = {k: v for k, v in settings.items() if k != "features"}
    return {**kept, "dataset": {**dataset, "settings": read}}


def _without_folder(value: Any) -> Any:
    """A value; of the path of a file, its name."""
    return Path(value).name if isinstance(value, str) and Path(value).is_absolute() else value


def part_facts(name: str, results: Results) -> dict[str, Any]:
    """The row of a part in the table ``parts``."""
    rows, settings = results.table(), results.settings
    facts, versions = settings.get(FACTS) or {}, settings.get("versions") or {}
    dataset, steps = settings.get("dataset") or {}, facts.get("steps", {})
    models = len(results.reconstructions())
    made = sum(step.get("rows", 0) for step in steps.values())
    return {
        PART: name,
        "title": facts.get("title"),
        "dataset": dataset.get("name"),
        "preset": settings.get("preset"),
        "max_width": str((dataset.get("settings") or {}).get("max_width", "full")),
        "max_keypoints": None if rows.is_empty() else rows["max_keypoints"][0],
        "combinations": rows.select(METHODS).n_unique(),
        "pairs": rows["pair"].n_unique(),
        "rows": len(rows),
        "ok": int((rows["status"] == "ok").sum()),
        "models": models,
        "finished": ", ".join(name for name, step in steps.items() if step.get("finished")),
        **{name: (facts.get("verified") or {}).get(name, 0) for name in ("again", "identical")},
        "cpu_hours": facts.get("cpu_hours"),
        "covered": min(made, len(rows) + models),
        "licence": facts.get("licence"),
        "aerocues": versions.get("aerocues"),
        "opencv": versions.get("opencv"),
        "machine": (settings.get("machine") or {}).get("name"),
    }
