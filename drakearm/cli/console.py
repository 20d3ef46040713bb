"""What the command line prints. All texts are shown as they are: square brackets in a name or path are no markup."""

from rich.console import Console
from rich.text import Text

console = Console(markup=False, emoji=False)


def say(text: str) -> None:
    """Prints a line. Where it is longer than the terminal is wide, the terminal wraps it."""
    console.print(text, soft_wrap=True)


def show_error(error: Exception) -> None:
    """Prints an error on stderr."""
    Console(stderr=True).print(Text.assemble(("error:", "red"), f" {error}"), soft_wrap=True)
