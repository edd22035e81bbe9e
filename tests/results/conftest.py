"""What the tests of result files share."""

import pytest
from vtu_file import file_of


@pytest.fixture
def vtu_of(tmp_path):
    def write(*arguments, **options):
        path = tmp_path / "model.vtu"
        path.write_bytes(file_of(*arguments, **options))
        return path

    return write
