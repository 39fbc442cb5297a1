"""The launcher: one process that starts ``mpirun`` and stands between it and the user."""

import codecs
import json
import os
import selectors
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from time import monotonic
from types import FrameType
from typing import IO, Any, TextIO

from pearlite_petsc.launch.channel import VARIABLE, Listener
from pearlite_petsc.launch.display import Display, Standing

STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGHUP)
LOOK_SECONDS = 0.2
DRAIN_SECONDS = 1.0
"""How long what the ranks wrote may take to arrive once mpirun has ended."""


class Launcher:
    """Runs one command of ``mpirun`` and returns the exit status that its ranks tell.

    Args:
        command: ``mpirun`` with everything that follows.
        display: What the user sees.
        environment: Variables of the ranks.
    """

    def __init__(
        self, command: Sequence[str], display: Display, environment: Mapping[str, str] = os.environ
    ) -> None:
        self._command, self._display = list(command), display
        self._environment = dict(environment)
        self._selector = selectors.DefaultSelector()
        self._process: subprocess.Popen[bytes] | None = None
        self._ranks: list[int] = []
        self._stop = self._stops = 0
        self._status: int | None = None

    def run(self) -> tuple[int | None, int, int]:
        """Run to the end.

        Returns:
            The status that the ranks told (None where they told none), mpirun's own (negative: the
            signal that ended it), and the signal that stopped the run (0 for none).

        Raises:
            OSError: ``mpirun`` cannot be started.
        """
        with ExitStack() as stack:
            listener = Listener()
            stack.callback(listener.close)
            stack.callback(self._selector.close)
            self._selector.register(listener.socket, selectors.EVENT_READ, self._greet(listener))
            for number in (*STOPS, signal.SIGTSTP):
                # What is ignored from the start (nohup, a job in the background) stays so.
                if signal.getsignal(number) is not signal.SIG_IGN:
                    before = signal.signal(number, self._on_signal)
                    stack.callback(signal.signal, number, before)
            process = subprocess.Popen(
                self._command,
                env={**self._environment, VARIABLE: listener.name},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                # Else Ctrl-C would reach mpirun, too, which kills what does not end at once.
                start_new_session=True,
            )
            stack.callback(_end, process)
            self._process = process
            if self._stop:
                process.terminate()
            self._follow(process)
            return self._status, process.returncode, self._stop

    def _follow(self, process: "subprocess.Popen[bytes]") -> None:
        pipes: list[tuple[IO[bytes] | None, TextIO]] = [
            (process.stdout, sys.stdout),
            (process.stderr, sys.stderr),
        ]
        open_pipes = set()
        for pipe, stream in pipes:
            if pipe is not None:
                open_pipes.add(pipe)
                forward = self._forward(pipe, stream, open_pipes)
                self._selector.register(pipe, selectors.EVENT_READ, forward)
        ended: float | None = None
        while True:
            for key, _ in sorted(self._selector.select(LOOK_SECONDS), key=_channels_first):
                key.data()
            if ended is None and process.poll() is not None:
                ended = monotonic()
            if ended is not None and (not open_pipes or monotonic() - ended > DRAIN_SECONDS):
                return

    def _greet(self, listener: Listener) -> Callable[[], None]:
        def greet() -> None:
            accepted = listener.accept()
            if accepted is None:
                return
            connection, process = accepted
            self._ranks.append(process)
            self._selector.register(connection, selectors.EVENT_READ, self._hear(connection))
            if self._stop:
                _send_signal(process, self._stop)

        return greet

    def _hear(self, connection: socket.socket) -> Callable[[], None]:
        pending = bytearray()

        def hear() -> None:
            try:
                received = connection.recv(1 << 16)
            except OSError:
                received = b""
            if not received:
                self._selector.unregister(connection)
                connection.close()
                return
            pending.extend(received)
            *whole, rest = pending.split(b"\n")
            pending[:] = rest
            for message in whole:
                for kind, content in json.loads(message).items():
                    self._take(kind, content)

        return hear

    def _take(self, kind: str, content: Any) -> None:
        if self._status is not None:
            return
        if kind == "line":
            self._display.line(content)
        elif kind == "trouble":
            self._display.trouble(content)
        elif kind == "stand":
            self._display.stand(Standing(**content))
        elif kind == "end":
            self._status = content["status"]
            if content["text"]:
                self._display.trouble(content["text"])

    def _forward(
        self, pipe: IO[bytes], stream: TextIO, open_pipes: set[IO[bytes]]
    ) -> Callable[[], None]:
        decoder = codecs.getincrementaldecoder("utf-8")(errors="replace")
        pending = ""

        def forward() -> None:
            nonlocal pending
            received = os.read(pipe.fileno(), 1 << 16)
            text = pending + decoder.decode(received, final=not received)
            cut = len(text) if not received else text.rfind("\n") + 1
            pending = text[cut:]
            if cut and (stream is sys.stdout or not self._is_banner()):
                self._display.pass_on(text[:cut], stream)
            if not received:
                self._selector.unregister(pipe)
                open_pipes.discard(pipe)
                pipe.close()

        return forward

    def _is_banner(self) -> bool:
        """Return whether all that can follow on standard error is mpirun's word on the end."""
        return self._status is not None or (self._stop != 0 and not self._ranks)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        if number == signal.SIGTSTP:
            self._pause()
            return
        self._stops += 1
        if not self._stop:
            self._display.stopping(signal.Signals(number).name)
        self._stop = self._stop or number
        if self._process is None:
            return
        if self._stops > 2:
            self._process.kill()
        elif self._stops > 1:
            self._process.terminate()
        elif self._ranks:
            for process in self._ranks:
                _send_signal(process, number)
        else:
            # Not there yet, or all on other machines, to which mpirun hands this one on.
            self._process.send_signal(signal.SIGUSR1)

    def _pause(self) -> None:
        """Stop with all ranks until somebody goes on with this process."""
        for process in self._ranks:
            _send_signal(process, signal.SIGSTOP)
        os.kill(os.getpid(), signal.SIGSTOP)
        for process in self._ranks:
            _send_signal(process, signal.SIGCONT)


def _end(process: "subprocess.Popen[bytes]") -> None:
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _channels_first(event: tuple[selectors.SelectorKey, int]) -> bool:
    return not isinstance(event[0].fileobj, socket.socket)


def _send_signal(process: int, number: int) -> None:
    with suppress(ProcessLookupError, PermissionError):
        os.kill(process, number)
