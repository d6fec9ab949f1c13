"""Runs pytest, or ends with 77 (skipped) where it or numpy is missing."""

import importlib.util
import sys

if any(importlib.util.find_spec(name) is None for name in ("numpy", "pytest")):
    print("skipped: numpy and pytest are needed")
    sys.exit(77)

import pytest

sys.exit(pytest.main(["-p", "no:cacheprovider", "-q", *sys.argv[1:]]))
