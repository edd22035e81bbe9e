"""Settings of all tests."""

import os

from hypothesis import settings

# the same examples in every run of CI: a failure there is the change's, not the dice's
settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("here", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "here")

#: a script that wants VTK
collect_ignore = ["data/vtk_files.py"]
