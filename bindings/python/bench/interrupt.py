"""How long Control-C takes on a mesh of a million edges: from the signal to KeyboardInterrupt.

    python interrupt.py [side of the pretzel, default 82: 1 008 600 edges]

A timer of the processor time raises the signal at moments spread over each
call.  Times are processor times, so other processes disturb little; the timer
itself is exact to some 4 ms.
"""

import signal
import sys
import time

import foliations
from foliations import sample


COUNT = 16


def interrupted(function, after):
    """Seconds from the signal to the exception, or None if the call was over before."""
    sent = []

    def handler(number, frame):
        raise KeyboardInterrupt

    signal.signal(signal.SIGPROF, handler)
    start = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, after)
    try:
        function()
        signal.setitimer(signal.ITIMER_PROF, 0)
    except KeyboardInterrupt:
        sent.append(time.process_time() - start - after)
    return sent[0] if sent else None


def main():
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 82
    positions, triangles = sample.pretzel(2, side=side)
    print(f"{3 * len(triangles) // 2} edges")
    hierarchy = foliations.Hierarchy(positions, triangles)
    for name, function in (
        ("build", lambda: foliations.Hierarchy(positions, triangles)),
        ("solve", hierarchy.solve),
        ("parameterize", hierarchy.solve().parameterize),
    ):
        start = time.process_time()
        function()
        whole = time.process_time() - start
        delays = [interrupted(function, whole * (k + 0.5) / COUNT) for k in range(COUNT)]
        delays = sorted(1000 * delay for delay in delays if delay is not None)
        print(
            f"{name}: {whole:.2f} s whole; {len(delays)} interrupts: median {delays[len(delays) // 2]:.0f} ms, "
            f"longest {delays[-1]:.0f} ms"
        )


if __name__ == "__main__":
    main()
