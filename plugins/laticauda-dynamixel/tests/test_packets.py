import pytest

from laticauda_dynamixel.packets import Instruction, Packet, Reader, crc16, encode_packet

# The examples of the vendor's e-Manual: what is sent, and what a servo answers.
EXAMPLES = [
    (Packet(1, Instruction.PING, b""), "FF FF FD 00 01 03 00 01 19 4E"),
    (
        Packet(1, Instruction.STATUS, bytes([0, 0x06, 0x04, 0x26])),
        "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D",
    ),
    (
        Packet(1, Instruction.READ, bytes([0x84, 0, 4, 0])),
        "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15",
    ),
    (
        Packet(1, Instruction.STATUS, bytes([0, 0xA6, 0, 0, 0])),
        "FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0",
    ),
    (
        Packet(1, Instruction.WRITE, bytes([0x74, 0, 0, 2, 0, 0])),
        "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89",
    ),
    (Packet(1, Instruction.REBOOT, b""), "FF FF FD 00 01 03 00 08 2F 4E"),
]


@pytest.mark.parametrize(("packet", "text"), EXAMPLES)
def test_packets_are_those_of_the_vendors_manual(packet, text):
    assert encode_packet(packet) == bytes.fromhex(text)
    assert Reader().feed(bytes.fromhex(text)) == [packet]


def test_data_that_look_like_a_header_are_stuffed():
    packet = Packet(3, Instruction.STATUS, b"\0\xff\xff\xfd\x00\xff\xff\xfd")
    assert b"\xff\xff\xfd\xfd" in encode_packet(packet)
    assert Reader().feed(encode_packet(packet)) == [packet]


def test_packets_are_found_between_noise_and_in_pieces():
    packet = Packet(7, Instruction.STATUS, bytes(range(40)))
    stream = (
        b"\xff\xff\x00junk\xff\xff\xfd\x00\x01\xff\xff"
        + encode_packet(packet)
        + b"\xff\xff"
        + encode_packet(packet)
    )
    reader = Reader()
    packets = []
    for byte in stream:
        packets += reader.feed(bytes([byte]))
    assert packets == [packet, packet]


def test_a_packet_with_a_wrong_byte_is_none():
    good = encode_packet(Packet(7, Instruction.STATUS, b"\0\1\2\3"))
    for place in range(4, len(good)):
        bad = bytearray(good)
        bad[place] ^= 1
        assert Packet(7, Instruction.STATUS, b"\0\1\2\3") not in Reader().feed(bytes(bad))
    assert crc16(b"") == 0
