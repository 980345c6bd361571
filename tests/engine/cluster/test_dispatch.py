"""Blocks are computed once each and in order, whatever the devices do meanwhile."""

import threading
import time
from concurrent.futures import Future
from dataclasses import dataclass, field

import numpy as np
import pytest

from microcosmos.cluster.dispatch import Answer, Disagreement, Dispatcher, Work
from microcosmos.search import Stopped, never


def settle(work, pending, scale=2.0, seconds=1.0):
    if pending.set_running_or_notify_cancel():
        pending.set_result(Answer({"value": np.array([scale * work.items])}, seconds))


@dataclass(eq=False)
class ByHand:
    """A device that answers when the test says so."""

    name: str
    capacity: int = 2
    waiting: list = field(default_factory=list)
    given: list = field(default_factory=list)
    errors: list = field(default_factory=list)

    def submit(self, work):
        pending = Future()
        self.waiting.append((work, pending))
        self.given.append(int(work.items))
        return pending

    def fail(self, error):
        self.errors.append(error)

    def answer(self, scale=2.0, seconds=1.0):
        settle(*self.waiting.pop(0), scale, seconds)

    def answer_all(self, **given):
        while self.waiting:
            self.answer(**given)


def works(count):
    return [Work("spec", "program", np.float32(i + 1)) for i in range(count)]


@pytest.fixture
def computing():
    """Start a dispatcher in a thread; return a function that ends with its results."""
    threads = []

    def begin(dispatcher, count, stop=never):
        outcome = {}

        def run():
            try:
                outcome["found"] = dispatcher.compute(works(count), stop)
            except BaseException as error:
                outcome["error"] = error

        thread = threading.Thread(target=run)
        thread.start()
        threads.append(thread)

        def end():
            thread.join(10)
            assert not thread.is_alive()
            if "error" in outcome:
                raise outcome["error"]
            return [float(one["value"][0]) for one in outcome["found"]]

        return end

    yield begin
    for thread in threads:
        thread.join(10)


def until(condition):
    end = time.monotonic() + 10
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def in_order(count):
    return [2.0 * (i + 1) for i in range(count)]


def test_results_come_in_the_order_of_the_blocks(computing):
    quick, slow = ByHand("quick"), ByHand("slow")
    end = computing(Dispatcher(lambda: [slow, quick]), 5)
    until(lambda: len(slow.waiting) == len(quick.waiting) == 2)
    quick.answer_all()
    until(lambda: quick.waiting)
    quick.answer_all()
    slow.answer_all()
    assert end() == in_order(5)


def test_a_device_has_no_more_blocks_in_flight_than_its_capacity(computing):
    one, two = ByHand("one", capacity=1), ByHand("two", capacity=2)
    end = computing(Dispatcher(lambda: [one, two]), 6)
    until(lambda: len(one.waiting) + len(two.waiting) == 3)
    for _ in range(3):
        assert (len(one.waiting), len(two.waiting)) == (1, 2)
        left = 6 - len(one.given) - len(two.given)
        if left:
            two.answer()
            until(lambda left=left: 6 - len(one.given) - len(two.given) == left - 1)
    one.answer_all()
    two.answer_all()
    assert end() == in_order(6)
    assert sorted(one.given + two.given) == list(range(1, 7))


def test_a_late_block_is_computed_twice_and_the_first_answer_counts(computing):
    hanging, other = ByHand("hanging", capacity=1), ByHand("other", capacity=1)
    dispatcher = Dispatcher(lambda: [hanging, other])
    end = computing(dispatcher, 2)
    until(lambda: hanging.waiting and other.waiting)
    other.answer(seconds=0.02)
    until(lambda: other.waiting)
    assert other.given[-1] == hanging.given[0]
    other.answer(seconds=0.02)
    assert end() == in_order(2)
    assert dispatcher.seconds == pytest.approx(0.04)
    # The hanging device answers during the next generation, with the same bits.
    end = computing(dispatcher, 2)
    until(lambda: other.waiting)
    hanging.answer(seconds=5.0)
    until(lambda: hanging.waiting)
    hanging.answer()
    other.answer()
    assert end() == in_order(2)
    assert dispatcher.seconds == pytest.approx(2.04)


def late_block(computing, *others):
    """A dispatcher, a device with a block that another has answered meanwhile, and the end."""
    broken, other = ByHand("broken", capacity=1), ByHand("other", capacity=1)
    devices = [broken, other, *others]
    dispatcher = Dispatcher(lambda: devices)
    end = computing(dispatcher, len(devices))
    until(lambda: all(one.waiting for one in devices))
    other.answer(seconds=0.02)
    until(lambda: other.waiting)
    assert other.given[-1] == broken.given[0]
    other.answer(seconds=0.02)
    return dispatcher, broken, other, end


NAMES = "other and broken computed different results"


def test_two_answers_that_differ_are_an_error_that_names_both(computing):
    slow = ByHand("slow", capacity=1)
    _, broken, _, end = late_block(computing, slow)
    broken.answer(scale=2.001)
    with pytest.raises(Disagreement, match=NAMES):
        end()


def test_an_answer_that_differs_is_noticed_in_the_next_generation_too(computing):
    dispatcher, broken, other, end = late_block(computing)
    assert end() == in_order(2)
    end = computing(dispatcher, 1)
    until(lambda: other.waiting)
    broken.answer(scale=2.001)
    with pytest.raises(Disagreement, match=NAMES):
        end()


def test_a_failure_that_a_device_raises_ends_the_generation(computing):
    class Own(ByHand):
        def fail(self, error):
            raise error

    own = Own("own")
    end = computing(Dispatcher(lambda: [own]), 1)
    until(lambda: own.waiting)
    own.waiting.pop()[1].set_exception(ZeroDivisionError("by a plug-in"))
    with pytest.raises(ZeroDivisionError, match="by a plug-in"):
        end()


def test_a_device_whose_connection_is_lost_takes_no_block(computing):
    class Lost(ByHand):
        def submit(self, work):
            raise OSError("no scheduler")

        def fail(self, error):
            super().fail(error)
            devices[:] = [other]

    lost, other = Lost("lost"), ByHand("other", capacity=1)
    devices = [lost, other]
    end = computing(Dispatcher(lambda: list(devices)), 3)
    for count in (1, 2, 3):
        until(lambda count=count: len(other.given) == count)
        other.answer()
    assert end() == in_order(3)
    assert {str(error) for error in lost.errors} == {"no scheduler"}


def test_it_stops_between_answers_and_cancels_what_is_under_way(computing):
    device, stop = ByHand("device"), threading.Event()
    dispatcher = Dispatcher(lambda: [device])
    end = computing(dispatcher, 4, stop.is_set)
    until(lambda: len(device.waiting) == 2)
    stop.set()
    with pytest.raises(Stopped):
        end()
    assert all(pending.cancelled() for _, pending in device.waiting)
    device.waiting.clear()
    end = computing(dispatcher, 1)
    until(lambda: device.waiting)
    device.answer()
    assert end() == in_order(1)


def test_any_coming_and_going_gives_the_same_results():
    rng = np.random.default_rng(5)

    class Random(ByHand):
        """Answers by itself after some time, fails at times, and leaves at times."""

        def submit(self, work):
            pending = super().submit(work)
            fate, delay = rng.random(), rng.random() * 0.02
            if fate < 0.8:
                threading.Timer(delay, settle, (work, pending)).start()
            elif fate < 0.9:
                pending.set_exception(RuntimeError("lost"))
            else:  # It hangs until it is gone.
                threading.Timer(0.3, self.leave).start()
            return pending

        def fail(self, error):
            self.leave()

        def leave(self):
            if self in there:
                there.remove(self)

    there = [Random("0")]
    joining = threading.Event()

    def join():
        number = 0
        while not joining.wait(0.05):
            if len(there) < 4:
                number += 1
                there.append(Random(str(number)))

    thread = threading.Thread(target=join)
    thread.start()
    try:
        dispatcher = Dispatcher(lambda: list(there))
        for _ in range(5):
            found = dispatcher.compute(works(12), never)
            assert [float(one["value"][0]) for one in found] == in_order(12)
    finally:
        joining.set()
        thread.join()
