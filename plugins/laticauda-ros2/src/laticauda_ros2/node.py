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
"""Numbers of domains of DDS."""
PATIENCE = 4.0
"""How long it waits for what is to be on the network [s, wall clock]."""
LOOKS = 0.02
"""Time between two looks at what is on the network [s]."""
HEARS = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(100))
"""Quality of service of a reader, which any publisher matches."""
SAYS = Qos(
    Policy.Reliability.Reliable(duration(seconds=0.1)),
    Policy.History.KeepLast(1),
    Policy.DataRepresentation(use_cdrv0_representation=True),
)
"""Quality of service of a writer, which any subscriber matches."""
ANY = SampleState.Any | ViewState.Any | InstanceState.Any


def name_and_domain(address: str) -> tuple[str, int]:
    """The parts of an `address` NAME:DOMAIN; without a domain, it is that of the environment, as ROS 2 has it.

    Raises:
        ValueError: If the domain is none.
    """
    name, colon, number = address.partition(":")
    if not colon:
        number = os.environ.get("ROS_DOMAIN_ID", "") or "0"
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
        self._readers: dict[str, DataReader[Any]] = {}
        self._writers: dict[str, DataWriter[Any]] = {}

    def read(self, topic: str, kind: Any) -> None:
        """Begin to hear a topic: with best effort, so that every publisher of it is heard.

        Args:
            topic: As ROS 2 says it.
            kind: Of its messages.
        """
        dds_topic = Topic(self._participant, f"rt{topic}", kind)
        reader = DataReader(self._participant, dds_topic, qos=HEARS)
        self._readers[topic] = reader
        self._waits.attach(ReadCondition(reader, ANY))

    def taken(self, topic: str) -> Iterator[Any]:
        """What has come by a topic since, oldest first; None stands for a message that makes no sense.

        Args:
            topic: That is read.
        """
        while True:
            try:
                samples = self._readers[topic].take(N=1)
            except (DDSException, KeyError):
                raise
            except Exception:  # whatever the decoder says of bytes that are none of its type
                yield None
                continue
            if not samples:
                return
            (sample,) = samples
            if sample.sample_info.valid_data:  # not the news that a publisher left
                yield sample

    def write(self, topic: str, kind: Any) -> None:
        """Begin to publish a topic: reliably, so that every subscriber of it hears.

        Args:
            topic: As ROS 2 says it.
            kind: Of its messages.
        """
        dds_topic = Topic(self._participant, f"rt{topic}", kind)
        self._writers[topic] = DataWriter(self._participant, dds_topic, qos=SAYS)

    def say(self, topic: str, message: Any) -> None:
        """Publish a message.

        Args:
            topic: That is written.
            message: Of its kind.
        """
        self._writers[topic].write(message)

    def is_heard(self, topic: str) -> bool:
        """Whether anybody subscribes to a topic that is written."""
        return self._writers[topic].get_publication_matched_status().current_count > 0

    def has_arrived(self, topic: str, patience: float) -> bool:
        """Whether all who subscribe have what was published last.

        Args:
            topic: That is written.
            patience: How long to wait for it [s, wall clock].
        """
        return bool(self._writers[topic].wait_for_acks(duration(seconds=patience)))

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
        self._waits = None
        self._guard = None
        self._readers.clear()
        self._writers.clear()
        self._participant = None


def wait_until(holds: Callable[[], bool], patience: float) -> bool:
    """Wait until something holds, and return whether it did within some time [s, wall clock]."""
    end = time.monotonic() + patience
    while not holds():
        if time.monotonic() >= end:
            return False
        time.sleep(LOOKS)
    return True
