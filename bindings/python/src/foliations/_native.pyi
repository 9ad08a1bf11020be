# Made at build time from include/hmf/hmf.h, see packaging/declarations.py.
from typing import Any

ffi: Any
lib: Any
