"""Options of the solver, each in one place: name, type and words."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable
from typing import Any, Literal, TypedDict, TypeVar

from ._boundary import constant, structure

Method = Literal["newton", "whitehead", "single_level", "paper"]
_Function = TypeVar("_Function", bound=Callable[..., Any])


class RelaxOptions(TypedDict, total=False):
    """Fields of hmf_solve_options.

    method : "newton", "whitehead", "single_level" or "paper", optional
        "newton" (default): Newton steps on each level.  "whitehead":
        Whitehead moves on each level.  "single_level": Whitehead moves on
        your mesh alone.  "paper": as "whitehead", with the flips of the
        paper, which may make poles; for comparison.
    tolerance : float, optional
        Largest residual to reach, up to which a result counts as converged;
        default 1e-8.  The other methods than newton stop by
        ``energy_tolerance`` if none is given.
    energy_tolerance : float, optional
        The other methods: sweeps end when one lowers the energy by less than
        this part of it, default 1e-6.  It says nothing of the residual.
    time_limit : float, optional
        Seconds; default none.
    iteration_limit : int, optional
        Sweeps per level; default 100000.
    step_limit : int, optional
        newton: steps on the finest level; default none.  Unlike ``time_limit``,
        it gives the same result on every machine.
    """

    method: Method | None
    tolerance: float | None
    energy_tolerance: float | None
    time_limit: float | None
    iteration_limit: int | None
    step_limit: int | None


class SolveOptions(RelaxOptions, total=False):
    """The level to stop at.

    stop_level : int, optional
        Finest level to solve; default 0, your mesh; -1, the coarsest, is a preview.
    """

    stop_level: int | None


def takes(*options: Any) -> Callable[[_Function], _Function]:
    """For a function with ``**options``: they show in its signature, and in its documentation in place of {options}."""

    def show(function: _Function) -> _Function:
        signature = inspect.signature(function)
        parameters = [p for p in signature.parameters.values() if p.kind != p.VAR_KEYWORD]
        kinds = {name: kind for one in options for name, kind in one.__annotations__.items()}
        for name, kind in kinds.items():
            kind = getattr(kind, "__forward_arg__", kind)
            parameters.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind))
        function.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        lines = (function.__doc__ or "").split("\n")
        for i, line in enumerate(lines):
            if line.strip() == "{options}":
                words = "\n".join(inspect.cleandoc(one.__doc__).split("\n\n", 1)[1] for one in options)
                lines[i] = textwrap.indent(words, line[: line.index("{")])
        function.__doc__ = "\n".join(lines)
        return function

    return show


def solve_options(options: SolveOptions | RelaxOptions, **others: Any) -> Any:
    """hmf_solve_options."""
    fields: dict[str, Any] = dict(options)
    unknown = set(fields) - set(SolveOptions.__annotations__)
    if unknown:
        raise TypeError(f"there is no option {', '.join(sorted(unknown))}")
    fields["method"] = constant("METHOD", fields.get("method"), "method")
    return structure("hmf_solve_options", **fields, **others)
