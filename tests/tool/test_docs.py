#!/usr/bin/env python3
"""The examples of the documentation run, and its figures agree: test_docs.py HMF (see docs/run_examples.py)."""

import os
import subprocess
import sys
from pathlib import Path

if os.environ.get("HMF_WITH_SANITIZERS"):
    sys.exit(77)  # the tests of the tool run with sanitizers, and the C examples would have to be built with them
root = next(folder for folder in Path(__file__).resolve().parents if (folder / "docs/run_examples.py").is_file())
commands = [["docs/check_pages.py"], ["docs/run_examples.py", sys.argv[1]]]
sys.exit(max(subprocess.run([sys.executable, root / script, *rest]).returncode for script, *rest in commands))
