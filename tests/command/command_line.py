"""Commands as they are typed, and what a refusal looks like."""

from typer.testing import CliRunner

from slmm.command.cli import app


def run(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def refused(result, *words):
    """Code 2, the reason on stderr, nothing on stdout, no traceback."""
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    for word in words:
        assert word in result.stderr
    return True
