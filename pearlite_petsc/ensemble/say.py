"""Messages to the user, who may have gone: a closed pipe or a dead launcher stops no run."""

import logging
from typing import TextIO

_log = logging.getLogger(__name__)


def say(stream: TextIO, text: str) -> None:
    """Write a text and send it off; what cannot be written is only logged."""
    try:
        stream.write(text)
        stream.flush()
    except (OSError, ValueError) as error:
        _log.debug("message lost (%s): %s", error, text.rstrip())
