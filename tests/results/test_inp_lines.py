"""Numbers of an input file are read as Fortran reads them."""

import pytest

from slmm.results.inp_lines import real


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2.1d5", 2.1e5), ("1.57D0", 1.57), ("1.5D+0", 1.5), ("1.5+3", 1500), ("-.5-1", -0.05), ("5.", 5), ("+3", 3),
        ("1Q2", 100), ("1.e-2", 0.01), (" 7 ", 7),
    ],
)  # fmt: skip
def test_numbers_are_read_as_fortran_reads_them(text, value):
    assert real(text) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    "text", ["", "d5", "1.5+", "1e", "inf", "nan", "1_0", "0x1", "1.5e3.2", "1 2", "--1"]
)
def test_what_fortran_does_not_read_is_no_number(text):
    with pytest.raises(ValueError, match="is no finite number"):
        real(text)
