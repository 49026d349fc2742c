"""Arguments and options that several commands take, and what their texts mean."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from scenes.errors import InputError
from scenes.file_names import is_text

# of every typer.Typer of ours
TYPER_STYLE: dict[str, Any] = {
    # plain help: rich's own costs three times the start-up
    "rich_markup_mode": None,
    "add_completion": False,
    # a defect of ours shows as a plain traceback, which can be pasted into an issue
    "pretty_exceptions_enable": False,
    "no_args_is_help": True,
    "context_settings": {"help_option_names": ["-h", "--help"]},
}

SCENE_HELP = "A shipped scene's name or the path of a Mitsuba XML file."

SceneArgument = Annotated[str, typer.Argument(metavar="SCENE", help=SCENE_HELP)]
Parameters = Annotated[
    list[str] | None,
    typer.Option("--parameter", "-p", metavar="NAME=VALUE", help="A $parameter of the scene; repeatable."),
]
Size = Annotated[
    tuple[int, int] | None,
    typer.Option("--size", metavar="W H", help="Image size in pixels; by default the scene's own."),
]
RelError = Annotated[
    float,
    typer.Option(
        help="Relative standard error to reach, at the 95th percentile of lit pixels of the scattering layer."
    ),
]
Percentile = Annotated[float, typer.Option(help="Percentile of the lit pixels at which that error has to be reached.")]
SampleLimit = Annotated[
    int | None, typer.Option(help="Samples a pixel, on average over the image, after which the reference stops.")
]
TimeLimit = Annotated[
    float, typer.Option(help="Seconds after which the reference stops where it is; 8 passes are always made.")
]


def parse_parameters(given: list[str] | None) -> dict[str, str]:
    """Names and values of `-p NAME=VALUE`; a value may hold further equals signs."""
    parameters: dict[str, str] = {}
    for text in given or []:
        name, equals, value = text.partition("=")
        if not (name and equals):
            raise InputError(f"-p {text} should be NAME=VALUE, such as -p sigma_t=0.2.")
        if name == "size":
            raise InputError(f"-p {text}: the size of the image is set by --size W H, and is no parameter of a scene.")
        if not is_text(text):
            raise InputError(f"-p {name} or its value holds bytes that are not UTF-8; correct it.")
        if name in parameters:
            raise InputError(f"-p {name} is given twice; leave one out.")
        parameters[name] = value
    return parameters


def given_beside(context: typer.Context, allowed: tuple[str, ...]) -> list[str]:
    """Options of the command line other than the allowed ones, as they are written there."""
    return [
        parameter.opts[0]
        for parameter in context.command.params
        if parameter.name not in allowed
        and getattr(context.get_parameter_source(parameter.name or ""), "name", "") == "COMMANDLINE"
    ]
