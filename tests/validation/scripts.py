"""The scripts of validation/, and the checks that they return."""

import importlib
import sys
from pathlib import Path

FOLDER = Path(__file__).parents[2] / "validation"

# The scripts import one another as they do when started by hand.
sys.path.insert(0, str(FOLDER))


def script(name):
    return importlib.import_module(name)


def of(checks, case="", quantity=""):
    found = [check for check in checks if case in check.case and quantity in check.quantity]
    assert found, f"no check of {quantity} in {case}"
    return found
