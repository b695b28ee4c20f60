"""Signals that ask a run to stop: Ctrl-C, SIGTERM, and SIGHUP, when the terminal closes.

While the water is computed they are noted, and the step is finished; before and after they end what is being done.
Python handles signals in the main thread; in others nothing here does anything. A SIGHUP that is ignored (nohup) stays
ignored.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

WORDS = {"SIGINT": "Ctrl-C", "SIGTERM": "SIGTERM", "SIGHUP": "SIGHUP"}


def _wanted() -> dict[int, str]:
    """Number and word of the signals that are not ignored, those that the system knows."""
    numbers = {getattr(signal, name): word for name, word in WORDS.items() if hasattr(signal, name)}
    hangup = getattr(signal, "SIGHUP", None)
    return {n: word for n, word in numbers.items() if not (n == hangup and signal.getsignal(n) == signal.SIG_IGN)}


@contextmanager
def as_interrupts() -> Iterator[None]:
    """A signal that would end the process raises KeyboardInterrupt with its name, as Ctrl-C does by itself."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, _: Any) -> None:
        raise KeyboardInterrupt(WORDS[signal.Signals(number).name])

    before = {n: signal.getsignal(n) for n in _wanted() if signal.getsignal(n) == signal.SIG_DFL}
    for number in before:
        signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def noted() -> Iterator[list[str]]:
    """A list that gets the reason when one of the signals comes; a second one of its kind acts as before."""
    reasons: list[str] = []
    if threading.current_thread() is not threading.main_thread():
        yield reasons
        return
    wanted = _wanted()
    before = {number: signal.getsignal(number) for number in wanted}

    def note(number: int, _: Any) -> None:
        reasons.append(wanted[number])
        signal.signal(number, before[number])

    for number in wanted:
        signal.signal(number, note)
    try:
        yield reasons
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
