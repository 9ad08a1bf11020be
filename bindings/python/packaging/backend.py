"""Build backend: scikit-build-core, with the core inside source distributions.

The sources of the library lie two folders up.  A wheel is compiled from there;
a source distribution must carry them, so they are copied to ``core/`` while it
is made.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

from scikit_build_core.build import *  # noqa: F401,F403
from scikit_build_core.build import build_sdist as _build_sdist

_HERE = Path(__file__).resolve().parents[1]
_ROOT = _HERE.parents[1]
_CORE = ("CMakeLists.txt", "LICENSE", "include", "src", "bindings/cli", "bindings/readers")


# make compiles one file at a time unless it is told otherwise; Ninja as many as there are processors.
os.environ.setdefault("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))


def build_sdist(sdist_directory: str, config_settings: dict[str, Any] | None = None) -> str:
    core = _HERE / "core"
    if core.exists():
        # Made again from an unpacked source distribution.
        return _build_sdist(sdist_directory, config_settings)
    core.mkdir()
    try:
        for name in _CORE:
            source = _ROOT / name
            if source.is_dir():
                shutil.copytree(source, core / name, ignore=shutil.ignore_patterns("*.png"))
            else:
                shutil.copy2(source, core / name)
        return _build_sdist(sdist_directory, config_settings)
    finally:
        shutil.rmtree(core)
