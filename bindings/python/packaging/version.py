"""The version has one home: include/hmf/hmf.h."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any


def header() -> Path:
    package = Path(__file__).resolve().parents[1]
    for root in (package / "core", package.parents[1]):
        path = root / "include" / "hmf" / "hmf.h"
        if path.exists():
            return path
    raise FileNotFoundError("include/hmf/hmf.h is neither in core/ nor two folders up")


def dynamic_metadata(field: str, settings: dict[str, Any] | None = None) -> str:
    if field != "version":
        raise ValueError(f"only the version is dynamic, not {field}")
    text = header().read_text(encoding="utf-8")
    numbers = [re.search(rf"^#define HMF_VERSION_{part} (\d+)$", text, re.M) for part in ("MAJOR", "MINOR", "PATCH")]
    return ".".join(number[1] for number in numbers if number)
