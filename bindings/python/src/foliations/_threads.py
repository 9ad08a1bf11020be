"""Threads of the library's pool, lent to the calls of one Python thread."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ._native import ffi, lib


class _Lent(threading.local):
    #: The pool of the innermost ``threads`` on this thread.
    pool: Any = None


_lent = _Lent()


@contextmanager
def threads(count: int = 0) -> Iterator[int]:
    """Uses threads for all calls of this package that this Python thread makes in the block.

        with foliations.threads():
            foliation = foliations.solve("mesh.obj")

    ``count`` is the number of threads, including the calling one, at most 256; 0: one for each
    processor. The block yields the actual number. Results are bit-identical for any number of
    threads. Blocks may be nested; the innermost one applies. It applies to calls of this Python
    thread only.
    """
    if not 0 <= count <= 256:
        raise ValueError(f"count is {count}; give a number of threads up to 256, or 0 for all processors")
    pool = ffi.gc(lib.hmf_pool_create(count), lib.hmf_pool_destroy)
    before, _lent.pool = _lent.pool, pool
    try:
        yield int(lib.hmf_pool_threads(pool))
    finally:
        _lent.pool = before
        ffi.release(pool)


def lent_threads() -> dict[str, Any]:
    """The fields of hmf_control that lend them; none outside of a block."""
    pool = _lent.pool
    if pool is None:
        return {}
    run = ffi.addressof(lib, "hmf_pool_run")
    return {"workers": lib.hmf_pool_threads(pool), "parallel_for": run, "parallel_user": pool}
