"""The end of a topic: readers and writers of DDS, with the names and qualities of service that ROS 2 gives them."""

import os
import re
import time
from collections.abc import Callable, Iterator
from typing import Any

from cyclonedds.core import (
    DDSException,
    GuardCondition,
    InstanceState,
    Policy,
    Qos,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from laticauda.tank.operate.drivers import DeviceFailed
from laticauda.values import BadArgument

TOPIC = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
DOMAINS = range(233)
PATIENCE = 4.0  # for what is to be on the network [s, wall clock]
LOOKS = 0.02  # between two looks at what is on the network [s]
HEARS = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(100))  # of any publisher
SAYS = Qos(
    Policy.Reliability.Reliable(duration(seconds=0.1)),
    Policy.History.KeepLast(1),
    Policy.DataRepresentation(use_cdrv0_representation=True),
)
ANY = SampleState.Any | ViewState.Any | InstanceState.Any


def name_and_domain(address: str) -> tuple[str, int]:
    """The parts of an `address` NAME:DOMAIN; without a domain, it is that of the environment, as ROS 2 has it.

    Raises:
        ValueError: If the domain is none.
    """
    name, _, number = address.partition(":")
    number = number if ":" in address else os.environ.get("ROS_DOMAIN_ID", "") or "0"
    if not (number.isascii() and number.isdigit() and int(number) in DOMAINS):
        raise BadArgument(
            "address", f"must have a domain from {DOMAINS[0]} to {DOMAINS[-1]}, got {number!r}"
        )
    return name, int(number)


class Node:
    """One participant, and what it reads and writes.

    Args:
        domain: Its number.

    Raises:
        DeviceFailed: If the network cannot be used.
    """

    def __init__(self, domain: int) -> None:
        self.domain = domain
        try:
            self._participant: Any = DomainParticipant(domain)
            self._waits: Any = WaitSet(self._participant)
            self._guard: Any = GuardCondition(self._participant)
            self._waits.attach(self._guard)
        except DDSException as error:
            raise DeviceFailed(
                f"DDS domain {domain} cannot be joined: {error.msg}. Check the network, and CYCLONEDDS_URI."
            ) from error
        self._ends: dict[str, Any] = {}

    def read(self, topic: str, kind: Any) -> None:
        """Begin to hear a topic: with best effort, so that every publisher of it is heard.

        Args:
            topic: As ROS 2 says it.
            kind: Of its messages.
        """
        inner = DataReader(
            self._participant, Topic(self._participant, f"rt{topic}", kind), qos=HEARS
        )
        self._ends[topic] = inner
        self._waits.attach(ReadCondition(inner, ANY))

    def taken(self, topic: str) -> Iterator[Any]:
        """What has come by a topic since, oldest first; None stands for a message that makes no sense.

        Args:
            topic: That is read.
        """
        while True:
            try:
                found = self._ends[topic].take(N=1)
            except (DDSException, KeyError):
                raise
            except (
                Exception
            ):  # whatever the decoder finds to say of bytes that are none of its type
                yield None
                continue
            if not found:
                return
            if found[0].sample_info.valid_data:  # not the news that a publisher left
                yield found[0]

    def write(self, topic: str, kind: Any) -> None:
        """Begin to publish a topic: reliably, so that every subscriber of it hears.

        Args:
            topic: As ROS 2 says it.
            kind: Of its messages.
        """
        self._ends[topic] = DataWriter(
            self._participant, Topic(self._participant, f"rt{topic}", kind), qos=SAYS
        )

    def say(self, topic: str, message: Any) -> None:
        """Publish a message.

        Args:
            topic: That is written.
            message: Of its kind.
        """
        self._ends[topic].write(message)

    def is_heard(self, topic: str) -> bool:
        """Whether anybody subscribes to a topic that is written."""
        return self._ends[topic].get_publication_matched_status().current_count > 0

    def has_arrived(self, topic: str, patience: float) -> bool:
        """Whether all who subscribe have what was published last.

        Args:
            topic: That is written.
            patience: How long to wait for it [s, wall clock].
        """
        return bool(self._ends[topic].wait_for_acks(duration(seconds=patience)))

    def wait(self, longest: float) -> None:
        """Until something comes, or somebody wakes it.

        Args:
            longest: [s, wall clock].
        """
        self._waits.wait(duration(seconds=longest))
        self._guard.set(False)

    def wake(self) -> None:
        """End `wait`; from any thread, and also after `close`."""
        guard = self._guard
        if guard is not None:
            guard.set(True)

    def close(self) -> None:
        """Leave the network: what was made last goes first."""
        self._waits = self._guard = None
        self._ends.clear()
        self._participant = None


def waited(holds: Callable[[], bool], patience: float) -> bool:
    """Whether something holds within some time [s, wall clock]."""
    end = time.monotonic() + patience
    while not (held := holds()) and time.monotonic() < end:
        time.sleep(LOOKS)
    return held
