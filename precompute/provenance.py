"""How a model was made: command, solver and platform."""

from __future__ import annotations

import platform
import shlex
import sys

import numpy as np
import scipy
import skfem


def provenance(*program: str) -> dict[str, str]:
    """Attributes of a file that this run of a program makes."""
    return {
        "Conventions": "CF-1.8",
        "command": shlex.join([*program, *sys.argv[1:]]),
        "solver": f"SuperLU of scipy {scipy.__version__}, assembled by scikit-fem {skfem.__version__}",
        "platform": f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()}",
    }
