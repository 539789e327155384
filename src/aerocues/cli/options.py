"""Options that several commands have in common, each defined once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from aerocues.defaults import LEAST_MEMORY


def _register_all(references: list[str] | None) -> list[str] | None:
    """Register the methods before anything is done with their names."""
    if references:
        import sys

        from aerocues.methods.plugins import register_class

        # A program that is installed does not look for modules where it is called.
        sys.path.insert(0, str(Path.cwd()))
        for reference in references:
            register_class(reference)
    return references


def _without_plugins(context: typer.Context, asked: bool) -> bool:
    """Leave out the plug-ins of packages, in this process and its workers, until the command ends.

    It comes before `--plugin`, which looks at the others' names.
    """
    if asked:
        import os

        from aerocues.methods.plugins import CHOICE, NO_PLUGINS

        before = os.environ.get(CHOICE)

        def restore() -> None:
            os.environ.pop(CHOICE)
            if before is not None:
                os.environ[CHOICE] = before

        context.call_on_close(restore)
        os.environ[CHOICE] = NO_PLUGINS
    return asked


NoPluginsOption = Annotated[
    bool,
    typer.Option(
        "--no-plugins",
        help="Leave out plug-ins of installed packages.",
        callback=_without_plugins,
        is_eager=True,
    ),
]
PluginOption = Annotated[
    list[str] | None,
    typer.Option(
        "--plugin",
        metavar="MODULE:CLASS",
        help="Add a method of your own, such as mymodule:SqrtSift; may be repeated.",
        callback=_register_all,
    ),
]
DatasetArgument = Annotated[
    str,
    typer.Argument(
        metavar="DATASET",
        help="A folder of images, or one of the kinds that 'aerocues datasets' lists.",
    ),
]
ResultsArgument = Annotated[
    Path, typer.Argument(metavar="RESULTS", help="A results folder, packed results or study:PART.")
]
ResultsArguments = Annotated[
    list[Path],
    typer.Argument(metavar="RESULTS", help="Results folders, packed results or study:PART."),
]
CombinationsOption = Annotated[
    str | None,
    typer.Option(
        metavar="GLOBS", help="Use only these combinations, such as 'ORB-*-HAM-BF,!*-BOOST-*'."
    ),
]
WithOption = Annotated[
    str | None,
    typer.Option(
        "--with", metavar="SETS", help="Use these sets of methods on request, too, such as extra."
    ),
]


def with_sets(combinations: str | None, sets: str | None) -> str | None:
    """Patterns of combinations that ask for sets of methods, too."""
    asked = [f"+{name.strip()}" for name in (sets or "").split(",") if name.strip()]
    return ",".join([*([combinations] if combinations else []), *asked]) or None


def given_options(context: typer.Context) -> dict[str, str]:
    """What the command line gives: names of parameters, and how the command line writes them."""
    found: dict[str, str] = {}
    for parameter in context.command.params:
        name = parameter.name or ""
        source = context.get_parameter_source(name)
        if source and source.name == "COMMANDLINE":
            dashed = [word for word in parameter.opts if word.startswith("--")]
            found[name] = dashed[0] if dashed else name.upper()
    return found


DetectorsOption = Annotated[
    str | None, typer.Option(metavar="GLOBS", help="Use only these detectors.")
]
DescriptorsOption = Annotated[
    str | None, typer.Option(metavar="GLOBS", help="Use only these descriptors.")
]
EverythingOption = Annotated[
    bool,
    typer.Option("--all", help="Use all combinations that can run, not only the meaningful ones."),
]
METHOD_PRESET = typer.Option(
    metavar="NAME", help="Method parameters: default, thesis, tuned or a preset file."
)
MethodPresetOption = Annotated[str, METHOD_PRESET]
MaxKeypointsOption = Annotated[
    int,
    typer.Option(
        min=0, metavar="N", help="Keep the N strongest keypoints of each image; 0 keeps all."
    ),
]
EqualFootingOption = Annotated[
    bool | None,
    typer.Option(
        "--equal-footing/--no-equal-footing",
        help="Lower thresholds of detectors until they find --max-keypoints; default: yes, but not "
        "for thesis or --from.",
    ),
]
RefineKeypointsOption = Annotated[
    bool | None,
    typer.Option(
        "--refine-keypoints/--no-refine-keypoints",
        help="Sharpen keypoints by comparing images; default: yes, but not for thesis.",
    ),
]
FeaturesWidthOption = Annotated[
    int | None,
    typer.Option(
        min=16, metavar="PIXELS", help="Find features in smaller images; the result stays large."
    ),
]
PairsOption = Annotated[
    str | None,
    typer.Option(
        metavar="HOW",
        help="Image pairs: consecutive[:K], exhaustive, gps[:K|:50m], overlap:0.3-0.9 or a file.",
    ),
]
SubsetOption = Annotated[
    str | None,
    typer.Option(
        metavar="GLOBS", help="Use only these images or folders, such as 'Layer3/pitch-90_yaw0'."
    ),
]
BandOption = Annotated[
    int | None,
    typer.Option(
        min=1, metavar="N", help="Band of multispectral images, 1 to the number of bands."
    ),
]
EveryOption = Annotated[
    str | None,
    typer.Option(
        metavar="TIME", help="Time between two frames of a video, such as 2s; 1s by default."
    ),
]
SequencesOption = Annotated[
    str | None,
    typer.Option(metavar="GLOBS", help="Use only these sequences, such as 'graf,b*'."),
]
MaxWidthOption = Annotated[
    int | None,
    typer.Option(min=0, metavar="PIXELS", help="Shrink wider images to this width; 0: full size."),
]
EQUALIZE = typer.Option(metavar="HOW", help="Equalise the illumination: none, histogram or clahe.")
EqualizeOption = Annotated[str, EQUALIZE]
WorkersOption = Annotated[
    int | None,
    typer.Option(min=1, metavar="N", help="Worker processes; by default one per core."),
]
MemoryLimitOption = Annotated[
    float | None,
    typer.Option(
        min=LEAST_MEMORY,
        metavar="GB",
        help="Memory limit of a worker; by default its share of 80 % of the memory.",
    ),
]
FeaturesOption = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="Folder of features: reuse those in it, and add new ones."),
]
RetryFailedOption = Annotated[
    bool, typer.Option("--retry-failed", help="Repeat what failed on this machine.")
]
UprightOption = Annotated[
    bool,
    typer.Option(
        "--upright", help="Turn images to a common heading, by quarters, before finding features."
    ),
]
SeedOption = Annotated[
    int,
    typer.Option(min=0, max=2**31 - 1, metavar="N", help="Seed of all random choices."),
]
TopOption = Annotated[int, typer.Option(min=1, metavar="N", help="Length of the table.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON.")]
FlightOption = Annotated[
    Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of the flight.")
]
SurveyOption = Annotated[
    str,
    typer.Option(
        metavar="NAME", help="airsimnh, airsimnh-natural, mini, or a JSON file with a mission."
    ),
]
FieldOfViewOption = Annotated[
    float, typer.Option("--fov", metavar="DEGREES", help="Horizontal field of view.")
]
ImageFormatOption = Annotated[
    str, typer.Option("--format", metavar="NAME", help="Image format: png or jpeg.")
]
