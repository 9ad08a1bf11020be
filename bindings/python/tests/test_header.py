"""The package offers what include/hmf declares: each addition there fails here until it is bound."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import get_args

import foliations
import foliations._options
import foliations.foliation
import foliations.hierarchy
import pytest
from foliations import errors
from foliations._native import ffi, lib

PACKAGE = Path(__file__).resolve().parents[1]
HEADERS = next(path for path in (PACKAGE / "core/include/hmf", PACKAGE.parents[1] / "include/hmf") if path.exists())
TEXT = "".join((HEADERS / name).read_text(encoding="utf-8") for name in ("hmf.h", "applications.h", "pool.h"))
TEXT = re.sub(r"/\*.*?\*/", "", TEXT, flags=re.S)
CONSTANTS = {name: int(value) for name, value in re.findall(r"\b(HMF_\w+)(?: =)? (-?\d+)\b", TEXT)}
FUNCTIONS = re.findall(r"HMF_API[^;(]*?\b(hmf_\w+)\s*\(", TEXT)


def names(prefix: str) -> dict[str, int]:
    return {name[len(prefix) :]: value for name, value in CONSTANTS.items() if name.startswith(prefix)}


def test_header_was_understood() -> None:
    assert len(FUNCTIONS) >= 24 and {"hmf_solve", "hmf_quads"} <= set(FUNCTIONS)
    assert len(CONSTANTS) > 60


@pytest.mark.parametrize("function", FUNCTIONS)
def test_each_function_is_used(function: str) -> None:
    assert hasattr(lib, function)
    if function.endswith("_init"):
        return  # called by the name of the structure
    source = "".join(path.read_text(encoding="utf-8") for path in Path(foliations.__file__).parent.glob("*.py"))
    assert re.search(rf"\b_?lib(\.|, \"){function}\b", source)  # called, or its address taken


def test_constants_are_those_of_the_header() -> None:
    assert {name: getattr(lib, name) for name in CONSTANTS} == CONSTANTS


def test_statuses() -> None:
    expected = {"OK": CONSTANTS["HMF_OK"], "CANCELLED": CONSTANTS["HMF_CANCELLED"]}
    expected |= {f"LIMIT_{name}": value for name, value in names("HMF_LIMIT_").items()}
    expected |= {f"ERROR_{name}": value for name, value in names("HMF_ERROR_").items()}
    assert {status.name: status.value for status in foliations.Status} == expected


def test_elements_and_progress() -> None:
    assert {element.name: element.value for element in foliations.Element} == names("HMF_ELEMENT_")
    assert {answer.name: answer.value for answer in foliations.Progress} == names("HMF_PROGRESS_")


def test_each_error_has_a_class() -> None:
    for name, value in names("HMF_ERROR_").items():
        kind = errors.error_class(value)
        assert issubclass(kind, foliations.Error)
        assert (kind is foliations.InternalError) == (name in ("INTERNAL", "NULL")), name


@pytest.mark.parametrize(
    ("prefix", "literal"),
    [
        ("HMF_METHOD_", foliations._options.Method),
        ("HMF_COLLAPSE_", foliations.hierarchy.Collapse),
        ("HMF_LOOPS_", foliations.hierarchy.LoopsKind),
        ("HMF_LEAVES_", foliations.leaves.LeavesKind),
        ("HMF_PATH_", foliations.loops.LoopKind),
        ("HMF_CLASS_", foliations.ClassState),
    ],
)
def test_names_of_choices(prefix: str, literal: object) -> None:
    expected = {name.lower() for name in names(prefix)} - {"default"}
    assert set(get_args(literal)) == expected


def test_singularity_kinds() -> None:
    kinds = foliations.foliation._SINGULARITY_KINDS
    assert {kind.upper(): value for value, kind in kinds.items()} == names("HMF_SINGULAR_")


def test_lines_and_ends() -> None:
    assert {kind.upper(): value for value, kind in foliations.leaves._KINDS.items()} == names("HMF_LINE_")
    assert {end.upper(): value for value, end in foliations.leaves._ENDS.items()} == names("HMF_END_")


def fields(structure: str) -> set[str]:
    return {name for name, _ in ffi.typeof(structure).fields}


def test_options_are_keywords() -> None:
    hidden = {"struct_size", "reserved", "allocate", "release", "allocator_user"}
    hidden |= {"seam_edge_count", "point_count", "position_stride", "marked_count"}  # those of arrays
    common = {"foliation", "progress"}
    build = set(inspect.signature(foliations.Hierarchy.__init__).parameters)
    solve = set(inspect.signature(foliations.Hierarchy.solve).parameters)
    both = set(inspect.signature(foliations.solve).parameters)
    assert fields("hmf_hierarchy_options") - hidden == build - {"self", "positions", "triangles", "closed", "component", "progress"}
    start = {"self", "loops", "weights", "initial", "progress"}
    assert fields("hmf_solve_options") - hidden - {"start"} == solve - start
    assert (build | solve) - {"self"} == both
    parameterize = set(inspect.signature(foliations.Foliation.parameterize).parameters)
    assert fields("hmf_parameterize_options") - hidden == parameterize - common
    trace = set(inspect.signature(foliations.Foliation.trace).parameters)
    assert fields("hmf_trace_options") - hidden == trace - common
    quads = set(inspect.signature(foliations.Foliation.quads).parameters)
    assert fields("hmf_quad_options") - hidden == quads - common
    atlas = set(inspect.signature(foliations.Foliation.atlas).parameters)
    assert fields("hmf_atlas_options") - hidden == atlas - common


def test_reports_have_all_fields() -> None:
    hidden = {"struct_size", "reserved", "level_count", "history_count"}
    assert fields("hmf_report") - hidden == set(foliations.Report.__dataclass_fields__) - {"boundaries"}
    hidden = {"struct_size", "reserved", "vertex_count", "edge_count", "triangle_count"}
    assert fields("hmf_parameterization") - hidden == set(foliations.Parameterization.__dataclass_fields__)
    assert fields("hmf_chart_set") - hidden == set(foliations.Atlas.__dataclass_fields__) - {"_foliation"}
    assert fields("hmf_level_report") == set(foliations.LevelReport._fields)
    assert fields("hmf_history_entry") == set(foliations.HistoryEntry._fields)
    assert fields("hmf_line") == set(foliations.Leaf.__dataclass_fields__) - {"points", "edges"}
    assert fields("hmf_cylinder") - {"reserved"} == set(foliations.Cylinder.__dataclass_fields__)
    assert fields("hmf_singularity") == set(foliations.Singularity.__dataclass_fields__)


def test_each_call_with_a_control_takes_progress() -> None:
    """But hmf_energy and hmf_level, which are properties: Control-C ends them all the same."""
    control = ffi.typeof("hmf_control *")
    long = {name for name in FUNCTIONS if control in ffi.typeof(getattr(lib, name)).args}
    owners = {
        "hmf_hierarchy_create": foliations.Hierarchy.__init__,
        "hmf_loops": foliations.Hierarchy.loops,
        "hmf_foliation_from_loops": foliations.Hierarchy.initialize,
        "hmf_solve_cut_system": foliations.Hierarchy.solve,
        "hmf_foliation_from_values": foliations.Hierarchy.foliation,
        "hmf_suggest_marks": foliations.suggest_marks,
        "hmf_components": foliations.Components.__init__,
        "hmf_even_design": foliations.even_design,
    }
    for name in long - {"hmf_control_init", "hmf_energy", "hmf_level"}:
        short = name[len("hmf_") :]
        function = (
            owners.get(name) or getattr(foliations.Foliation, short, None) or getattr(foliations.Hierarchy, short)
        )
        assert "progress" in inspect.signature(function).parameters, name


def test_version() -> None:
    assert foliations.__version__ == ".".join(
        str(CONSTANTS[f"HMF_VERSION_{part}"]) for part in ("MAJOR", "MINOR", "PATCH")
    )
    from importlib.metadata import version

    assert version("foliations") == foliations.__version__


def test_metadata() -> None:
    """One name, and what a registry asks for."""
    from importlib.metadata import files, metadata

    about = metadata("foliations")
    assert about["Name"] == "foliations" and "hmf contributors" in about["Author"]
    assert about["License"] == "MIT" and len(about["Keywords"].split(",")) > 5
    assert any(path.name == "LICENSE" for path in files("foliations") or ())
