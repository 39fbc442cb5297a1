"""The channel between the ranks of a run and its launcher, on one machine.

A Unix socket without a file (an abstract address), whose name the launcher hands on in an
environment variable and through which only processes of the same user are heard. Each message is
one line of JSON with one key, the kind of message.
"""

import json
import logging
import os
import secrets
import signal
import socket
import struct
from contextlib import suppress
from dataclasses import asdict
from threading import Lock, Thread
from typing import Any

from pearlite_petsc.launch.display import Standing

_log = logging.getLogger(__name__)

VARIABLE = "PEARLITE_LAUNCHER"


class Channel:
    """A rank's end; a ``Screen``. A launcher that dies stops the rank as SIGTERM would."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket, self._lock, self._closed = connection, Lock(), False
        Thread(target=self._watch, daemon=True).start()

    @classmethod
    def connect(cls) -> "Channel | None":
        """Return the channel to the launcher, None where none can be reached."""
        name = os.environ.get(VARIABLE)
        if not name:
            return None
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            connection.connect(f"\0{name}")
        except OSError:
            # A rank on another machine than the launcher.
            connection.close()
            return None
        return cls(connection)

    def close(self) -> None:
        """Say no more."""
        self._closed = True
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def line(self, text: str) -> None:
        """Show a line for good."""
        self._send("line", text)

    def trouble(self, text: str) -> None:
        """Show a line about something wrong, on standard error."""
        self._send("trouble", text)

    def stand(self, standing: Standing) -> None:
        """Show where the run stands until it is told otherwise."""
        self._send("stand", asdict(standing))

    def stopping(self, signal_name: str) -> None:
        """The launcher has said so already: the signal came from it."""

    def end(self, status: int, text: str = "") -> None:
        """Tell the exit status of the run and what went wrong; nothing is heard after it."""
        self._send("end", {"status": status, "text": text})
        self.close()

    def _send(self, kind: str, content: Any) -> None:
        try:
            with self._lock:
                self._socket.sendall(json.dumps({kind: content}).encode() + b"\n")
        except OSError as error:
            _log.debug("message lost (%s): %s", error, content)

    def _watch(self) -> None:
        try:
            while self._socket.recv(1):
                pass
        except OSError:
            pass
        if not self._closed:
            os.kill(os.getpid(), signal.SIGTERM)


class Listener:
    """The launcher's end: waits for ranks."""

    def __init__(self) -> None:
        self.name = f"pearlite-{secrets.token_hex(16)}"
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.bind(f"\0{self.name}")
        self.socket.listen(64)

    def close(self) -> None:
        """Hear nobody any more."""
        self.socket.close()

    def accept(self) -> tuple[socket.socket, int] | None:
        """Return a rank's connection and its process, None for a stranger's."""
        connection, _ = self.socket.accept()
        size = struct.calcsize("3i")
        credentials = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, size)
        process, user, _ = struct.unpack("3i", credentials)
        if user != os.getuid():
            connection.close()
            return None
        return connection, process
