"""Foreign words in our messages: hostile files put themselves into them."""


def brief(said: object, longest: int = 200) -> str:
    """What an error or a file says, on one line of at most ``longest`` characters."""
    line = " ".join(str(said).split())
    return line if len(line) <= longest else f"{line[: longest - 3]}..."
