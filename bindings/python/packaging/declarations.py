"""Makes the low-level module foliations._native from include/hmf/hmf.h, applications.h, pool.h, and readers.h of the readers.

    python declarations.py HEADER ... PROGRESS.c OUTPUT.c

The declarations that cffi reads are the headers themselves without comments and
preprocessor lines; their integer constants stay.  The C compiler then checks
them against the real headers, so the layer cannot drift from them: what a header
adds is in the module after the next build, what it takes away is missing.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

# Of progress.c, which lets Python run only every few milliseconds.
THROTTLE = """
typedef struct hmf_python_throttle { double interval; double last; int32_t answer; void *watch; } hmf_python_throttle;
extern "Python" int32_t hmf_python_progress(void *watch, double fraction);
int32_t hmf_python_throttled(void *throttle, double fraction);
"""


def declarations(header: str) -> str:
    """The part of a C header that cffi understands; ValueError if it holds anything else."""
    text = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    text = re.sub(r"\\\n", " ", text)
    kept: list[str] = []
    depth = 0  # of conditionals; 1 is the include guard
    for line in text.splitlines():
        directive = re.match(r"\s*#\s*(\w+)\s*(.*)", line)
        if not directive:
            if depth <= 1:
                kept.append(line)
            continue
        word, rest = directive[1], directive[2].strip()
        if word in ("if", "ifdef", "ifndef"):
            depth += 1
        elif word == "endif":
            depth -= 1
        elif word == "define" and depth <= 1:
            constant = re.fullmatch(r"(HMF_\w+)\s+(-?\d+|0x[0-9a-fA-F]+)[uU]?", rest)
            if constant:
                kept.append(f"#define {constant[1]} {constant[2]}")
            elif not re.fullmatch(r"HMF_\w+_H", rest):
                raise ValueError(f"no rule for: #define {rest}")
    return re.sub(r"\bHMF_API\b", "", "\n".join(kept))


def main() -> None:
    from cffi import FFI

    *headers, progress, output = (Path(argument) for argument in sys.argv[1:])
    ffi = FFI()
    for header in headers:
        ffi.cdef(declarations(header.read_text(encoding="utf-8")))
    ffi.cdef(THROTTLE)
    ffi.set_source("foliations._native", progress.read_text(encoding="utf-8"))
    ffi.emit_c_code(str(output))


if __name__ == "__main__":
    main()
