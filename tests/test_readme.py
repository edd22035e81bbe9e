"""What the README shows is true: its Python runs, its commands succeed, its table is the demo's."""

import doctest
import re
import shlex
from pathlib import Path

import matplotlib
import pytest
from typer.testing import CliRunner

from slmm.command.cli import app

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.DOTALL | re.MULTILINE)


@pytest.fixture(autouse=True)
def beside_the_examples(tmp_path, monkeypatch):
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)


def test_python():
    matplotlib.use("Agg")
    text = "\n".join(blocks("python"))
    test = doctest.DocTestParser().get_doctest(text, {}, "README.md", "README.md", 0)
    assert len(test.examples) > 10
    report: list[str] = []
    doctest.DocTestRunner(verbose=False).run(test, out=report.append)
    assert not report, "".join(report)


@pytest.mark.parametrize("text", [block for block in blocks("python") if ">>>" not in block])
def test_python_without_output(text):
    exec(compile(text, "README.md", "exec"), {})


def test_commands():
    commands = [shlex.split(line, comments=True) for block in blocks("sh") for line in block.splitlines()]
    # the database of one's own takes a minute to make
    commands = [words[1:] for words in commands if words[0] == "slmm" and "mine.nc" not in words]
    assert len(commands) >= 4
    for words in commands:
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, f"{words}: {result.stderr}"


def test_table_is_the_demo_s():
    shown = re.findall(r"^ {4}.*stress and energy$", README, flags=re.MULTILINE)
    printed = CliRunner().invoke(app, ["initiation", "examples/notch.toml"]).stdout.splitlines()
    printed = [line for line in printed if line.rstrip().endswith("stress and energy")]
    assert len(shown) == len(printed) == 10
    for here, there in zip(shown, printed, strict=True):
        # the last digits may differ between processors
        *numbers, _, _, _ = here.split()
        assert [float(x) for x in numbers] == pytest.approx([float(x) for x in there.split()[:-3]], rel=2e-3)


def test_table_of_crack_tips_is_the_command_s():
    shown = re.findall(r"^ {4,5}(\d [\d. -]*)$", README, flags=re.MULTILINE)
    shown = [row.split() for row in shown if len(row.split()) == 12]
    printed = CliRunner().invoke(app, ["forces", "examples/inclined_crack.frd"]).stdout.splitlines()
    printed = [row.split() for row in printed if re.match(r" *\d .*\d *$", row) and len(row.split()) == 12]
    assert len(shown) == len(printed) == 2
    for here, there in zip(shown, printed, strict=True):
        assert [float(x) for x in here] == pytest.approx([float(x) for x in there], rel=2e-3)


def test_table_of_simulated_fracture_is_the_command_s():
    shown = re.findall(r"^ {4}(\d+ to \d+ .*|Tensile toughness.*)$", README, flags=re.MULTILINE)
    printed = CliRunner().invoke(app, ["fracture", "examples/tensile_plate.toml"]).stdout
    assert len(shown) == 3
    numbers = r"[\d.]+"
    for line in shown:
        start = line.split("  ")[0].split("=")[0].strip()
        there = next(row for row in printed.splitlines() if row.strip().startswith(start))
        ours, theirs = (
            [float(x) for x in re.findall(numbers, row.rstrip("."))] for row in (line, there.rstrip("."))
        )
        assert theirs == pytest.approx(ours, rel=5e-3, abs=0.05)


def test_links_lead_somewhere():
    targets = re.findall(r"\]\(([^)]+)\)", README)
    assert targets
    for target in targets:
        assert (ROOT / target).exists(), target
