"""Stack of the core, from the call graphs of gcc (-fcallgraph-info=su).

stack_use.py FOLDER_OF_CI_FILES

Three checks: no frame of unknown size or above 16 KiB; no chain of calls comes
back to where it was (recursion could grow with the input); the deepest chain
below a public function, the caller's hooks left out, is at most 64 KiB.
"""

import pathlib
import re
import sys

FRAME = 16 * 1024
CHAIN = 64 * 1024

# Recursion with a proven bound: (part of a name, times, why).
BOUNDED = [
    ("__introsort_loop", 64, "std::sort: 2 log2 n deep"),
    ("__introselect", 64, "std::nth_element: 2 log2 n deep"),
    ("__merge_sort", 64, "std::stable_sort: log2 n deep"),
    ("__inplace_stable_sort", 64, "std::stable_sort: log2 n deep"),
    ("__merge_adaptive", 64, "std::stable_sort: log2 n deep"),
    ("__merge_without_buffer", 64, "std::stable_sort: log2 n deep"),
    ("hmf::Memory::take(", 8, "an account in the account of a call: a hierarchy that a call makes for itself"),
    ("hmf::Memory::give(", 8, "likewise"),
    ("hmf::Memory::take_array(", 8, "likewise"),
    ("hmf::Memory::give_array(", 8, "likewise"),
    ("hmf::Charts::glued(", 2, "once more with both parts exchanged"),
    ("hmf::read_loop_set(", 2, "without loops once more, with those of the library"),
]

node = re.compile(r'node: \{ title: "([^"]*)" label: "([^"]*)"')
edge = re.compile(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"')
size = re.compile(r"(\d+) bytes \(([^)]*)\)")


def read(folder):
    frames, kinds, labels, calls = {}, {}, {}, {}
    for path in sorted(pathlib.Path(folder).glob("*.ci")):
        text = path.read_text()
        for title, label in node.findall(text):
            found = size.search(label)
            if found:
                frames[title], kinds[title] = int(found[1]), found[2]
            labels.setdefault(title, label.split("\\n")[0])
        for source, target in edge.findall(text):
            calls.setdefault(source, set()).add(target)
    return frames, kinds, labels, calls


def components(calls):
    """Strongly connected components with more than one function, or one that calls itself (Tarjan, without recursion)."""
    index, low, on_stack, stack, found = {}, {}, set(), [], []
    for root in sorted(calls):
        if root in index:
            continue
        work = [(root, iter(sorted(calls.get(root, ()))))]
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        while work:
            here, targets = work[-1]
            for target in targets:
                if target not in index:
                    index[target] = low[target] = len(index)
                    stack.append(target)
                    on_stack.add(target)
                    work.append((target, iter(sorted(calls.get(target, ())))))
                    break
                if target in on_stack:
                    low[here] = min(low[here], index[target])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[here])
                if low[here] == index[here]:
                    part = []
                    while True:
                        part.append(stack.pop())
                        on_stack.discard(part[-1])
                        if part[-1] == here:
                            break
                    if len(part) > 1 or here in calls.get(here, ()):
                        found.append(part)
    return found


def main():
    frames, kinds, labels, calls = read(sys.argv[1])
    if len(frames) < 100:
        print("not ok static stack: only", len(frames), "functions were read")
        return 1
    failed = 0

    large = [n for n in frames if frames[n] > FRAME or kinds[n] == "dynamic"]
    print(f"{'not ok' if large else 'ok'} static stack-frames: {len(frames)} functions, largest {max(frames.values())} bytes")
    for n in large:
        print("   ", frames[n], kinds[n], labels[n])
    failed |= bool(large)

    rings = [part for part in components(calls)
             if not all(any(word in labels.get(n, n) or word in n for word, _, _ in BOUNDED) for n in part)]
    print(f"{'not ok' if rings else 'ok'} static stack-recursion")
    for part in rings:
        print("   ", "; ".join(labels.get(n, n) for n in part))
    failed |= bool(rings)

    # Deepest chain; a bounded recursion counts as often as it may happen.
    depth = {}
    recursive = {n for part in components(calls) for n in part}

    def cost(n):
        times = next((t for word, t, _ in BOUNDED if word in labels.get(n, n) or word in n), 64)
        return frames.get(n, 0) * (times if n in recursive else 1)

    order, state = [], {}
    for root in sorted(calls):
        work = [(root, False)]
        while work:
            n, done = work.pop()
            if done:
                order.append(n)
            elif n not in state:
                state[n] = True
                work.append((n, True))
                work.extend((t, False) for t in calls.get(n, ()) if t not in state)
    for n in order:
        depth[n] = cost(n) + max((depth.get(t, 0) for t in calls.get(n, ()) if t != n), default=0)
    deepest = max(depth, key=depth.get)
    bad = depth[deepest] > CHAIN
    print(f"{'not ok' if bad else 'ok'} static stack-depth: {depth[deepest]} bytes below {labels.get(deepest, deepest)}")
    return 1 if failed or bad else 0


sys.exit(main())
