"""Connections of uvicorn with deadlines: half-sent requests and unread answers hold none."""

import socket
from asyncio import TimerHandle, Transport
from contextlib import suppress
from math import inf
from typing import Any, ClassVar

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol


class Connection(H11Protocol):
    """A connection that ends if its client does not send a request, or read an answer, in time.

    uvicorn itself waits for ever, and each waiting connection is an open file. Between requests
    its own `timeout_keep_alive` counts alone.
    """

    SECONDS: ClassVar[dict[type, float]] = {h11.IDLE: 10.0, h11.SEND_BODY: 60.0}
    """By what the client has to send: the head, and the body."""
    PROGRESS = 1 << 16
    """Bytes within that time with which a body gets more time."""
    UNREAD_SECONDS = 60.0
    """Time in which a client that an answer waits for has to read some of it."""

    _timer: TimerHandle | None = None
    _reading: TimerHandle | None = None
    _expected: Any = None
    _received = 0

    def connection_made(self, transport: Transport) -> None:  # pyright: ignore
        super().connection_made(transport)
        # Else the system takes megabytes, and for minutes a slow reader looks like none.
        if hasattr(socket, "TCP_NOTSENT_LOWAT"):
            connection = transport.get_extra_info("socket")
            with suppress(OSError):  # Some sandboxes have no such option.
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, 1 << 16)
        self._expect(h11.IDLE)

    def connection_lost(self, exc: Exception | None) -> None:
        self._expect(None)
        self._stop_waiting()
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        super().pause_writing()
        self._wait_for_reader()

    def resume_writing(self) -> None:
        self._stop_waiting()
        super().resume_writing()

    def _wait_for_reader(self, unread: float = inf) -> None:
        """End the connection if as many bytes as before wait to be read."""
        waiting = self.transport.get_write_buffer_size()
        if waiting >= unread:
            self.transport.abort()  # A close would wait until all is read.
        else:
            self._reading = self.loop.call_later(
                self.UNREAD_SECONDS, self._wait_for_reader, waiting
            )

    def _stop_waiting(self) -> None:
        if self._reading:
            self._reading.cancel()

    def data_received(self, data: bytes) -> None:
        self._received += len(data)
        super().data_received(data)

    def handle_events(self) -> None:
        super().handle_events()
        expected = self.conn.their_state
        if expected is h11.IDLE and not self.conn.trailing_data[0] and self.cycle:
            expected = None  # Between requests the client owes nothing.
        if expected is not self._expected:
            self._expect(expected)

    def _expect(self, what: Any) -> None:
        if self._timer:
            self._timer.cancel()
        self._expected, self._received = what, 0
        seconds = self.SECONDS.get(what)
        self._timer = self.loop.call_later(seconds, self._end) if seconds else None

    def _end(self) -> None:
        if self._expected is h11.SEND_BODY and self._received >= self.PROGRESS:
            self._expect(h11.SEND_BODY)
        elif not self.transport.is_closing():
            self.transport.close()
