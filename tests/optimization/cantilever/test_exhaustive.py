"""All valid designs at once: how many there are, what each is worth, and their places."""

from itertools import product

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.optimization.cantilever.beam import Cantilever
from slmm.optimization.cantilever.brute_force import brute_force, ranks
from slmm.optimization.cantilever.exhaustive import all_designs, count_valid, design_of

GRIDS = [(2, 2), (3, 2), (2, 4), (4, 3), (5, 3), (3, 5), (6, 1), (5, 4)]


def code_of(design):
    """Code of a design (rows, columns)."""
    return sum(int(cell) << bit for bit, cell in enumerate(design[1:, 1:].T.ravel()))


def every_design(beam):
    """All designs of a small grid, valid or not."""
    bits = (beam.columns - 1) * (beam.rows - 1)
    return design_of(beam, np.arange(2**bits))


@pytest.mark.parametrize("grid", GRIDS)
def test_all_valid_designs_are_there_once_with_the_value_of_a_direct_solve(grid):
    beam = Cantilever(*grid)
    designs = every_design(beam)
    expected = beam.endpoint_displacement(designs)
    found = {}
    for block in all_designs(beam):
        for code, value in zip(block.code.ravel().tolist(), block.value.ravel(), strict=True):
            assert code not in found
            found[code] = value
    valid = np.flatnonzero(np.isfinite(expected))
    assert sorted(found) == valid.tolist()
    assert count_valid(beam) == len(valid)
    np.testing.assert_allclose([found[code] for code in valid], expected[valid], rtol=1e-9, atol=1e-13)


def test_the_published_number_of_valid_designs_and_that_of_larger_grids():
    assert count_valid(Cantilever(8, 5)) == 59_554_032
    assert count_valid(Cantilever(9, 5)) == 776_083_856
    assert count_valid(Cantilever(10, 5)) == 10_117_046_648
    # nothing tells the held edge from the top row
    assert count_valid(Cantilever(5, 8)) == 59_554_032


@given(st.integers(0, 2**28 - 1))
def test_codes_and_designs_are_one_another(code):
    design = design_of(Cantilever(8, 5), np.array(code))
    assert design[0].all() and design[:, 0].all()
    assert code_of(design) == code


def test_a_bit_is_a_cell_column_after_column():
    design = design_of(Cantilever(4, 3), np.array(0b000110))
    assert design[1:, 1:].T.ravel().tolist() == [False, True, True, False, False, False]


@pytest.mark.parametrize("grid", [(4, 3), (5, 4)])
def test_the_best_are_in_order_and_ranks_are_places_in_it(grid):
    beam = Cantilever(*grid)
    values = np.sort(beam.endpoint_displacement(every_design(beam)))
    values = values[np.isfinite(values)]
    few = brute_force(beam, best=7)
    np.testing.assert_allclose(few.endpoint_displacement, values[:7], rtol=1e-9, atol=1e-13)
    everything = brute_force(beam)
    assert int(everything.n_valid) == everything.sizes["rank"] == len(values)
    best = beam.endpoint_displacement(few.best_design.values[None])[0]
    assert best == pytest.approx(values[0], rel=1e-9)
    # each design has as many before it as are truly better
    asked = everything.endpoint_displacement.values[[5, 0, -1, 17]]
    better = [(everything.endpoint_displacement.values < v - 1e-8 * abs(v)).sum() for v in asked]
    assert ranks(beam, asked).tolist() == [1 + count for count in better]


def test_a_killed_brute_force_ends_with_the_same_result(tmp_path, monkeypatch):
    beam, journal = Cantilever(5, 4), tmp_path / "journal.npz"
    undisturbed = brute_force(beam, best=30)
    monkeypatch.setattr("slmm.optimization.cantilever.brute_force.INTERVAL", -1.0)

    def kill(share, word):
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        brute_force(beam, 30, kill, journal)
    shares = []
    resumed = brute_force(beam, 30, lambda share, word: shares.append(share), journal, resume=True)
    xr.testing.assert_identical(resumed, undisturbed)
    # what was known is not found again
    assert shares[0] > 0.3 and shares[-1] == 1.0
    with pytest.raises(ValueError, match="is there already"):
        brute_force(beam, 30, journal=journal)
    with pytest.raises(
        ValueError, match=r"is the journal of another run; this is Cantilever\(columns=5, rows=4\), best 31"
    ):
        brute_force(beam, 31, journal=journal, resume=True)
    for content in (b"no journal", b"", journal.read_bytes()[:200]):
        journal.write_bytes(content)
        with pytest.raises(ValueError, match="is no journal"):
            brute_force(beam, 30, journal=journal, resume=True)


@settings(max_examples=10, deadline=None)
@given(st.integers(2, 5), st.integers(1, 4))
def test_the_count_is_that_of_designs_that_hang_together(columns, rows):
    beam = Cantilever(columns, rows)
    if (columns - 1) * (rows - 1) <= 12:
        assert count_valid(beam) == beam.valid(every_design(beam)).sum()


def test_progress_runs_to_the_end_and_nonsense_is_refused():
    told = []
    brute_force(Cantilever(4, 3), progress=lambda share, text: told.append((share, text)))
    assert told[-1] == (1.0, "50 of 50 designs")
    with pytest.raises(ValueError, match="best = 0"):
        brute_force(Cantilever(4, 3), best=0)
    for grid, words in (
        ((20, 16), "62 free cells at most"),
        ((1, 3), "two columns at least"),
        ((9, 7), r"halves take \d+ GB"),
        ((2, 20), r"halves take \d+ GB"),
    ):
        for ask in (lambda beam: next(all_designs(beam)), brute_force):
            with pytest.raises(ValueError, match=words):
                ask(Cantilever(*grid))
    with pytest.raises(ValueError, match="more than 10 rows are not counted"):
        count_valid(Cantilever(48, 16))
    with pytest.raises(ValueError, match="nan has no place"):
        ranks(Cantilever(4, 3), [0.01, np.nan])
    assert ranks(Cantilever(4, 3), 0.0071696).tolist() == [1]


def test_rows_and_parts_that_only_the_other_half_holds_are_found():
    """An arch: the right half's lower part hangs on nothing but the left half's."""
    beam = Cantilever(6, 4)
    design = np.ones((4, 6), dtype=bool)
    design[1:, 1:] = False
    design[3, :] = True
    design[2, 5] = True
    (value,) = beam.endpoint_displacement(design[None])
    code = code_of(design)
    found = [b.value[b.code == code] for b in all_designs(beam) if (b.code == code).any()]
    assert np.concatenate(found) == pytest.approx([value], rel=1e-9)


def test_a_product_of_patterns_is_what_the_halves_are_made_of():
    beam = Cantilever(3, 3)
    assert {tuple(d[1:, 1:].ravel()) for d in every_design(beam)} == set(product([False, True], repeat=4))
