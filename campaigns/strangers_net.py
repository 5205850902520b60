"""What can a stranger do: another page, another computer, a client that is greedy or mad, a file that came by mail?

Each question starts real programs and real connections; nothing leaves this computer.

    listeners   where does every command that serves listen, and on which interface has it joined a multicast group?
    tokens      what gets a client on another computer: a network namespace with a veth of its own, or, where that
                cannot be made, this computer's own address?
    origins     what gets a page of somebody else's in Chromium, of another port, and under a rebound host name?
    greedy      how much memory do 16 greedy clients of `serve` take?
    talks       do 2 000 hostile conversations end it, lead to a traceback, or take memory?
    code        does any text or array of a message or of a file get imported, compiled, run or unpickled?

    python campaigns/strangers_net.py [--only NAME ...] [--seed N] [--talks N] [--seconds N] [--store]

The answer of 2026-11-23 (2 cores, loaded; greedy in 100 s) is in campaigns/strangers_net.csv; the
tests run a slice.
"""

import argparse
import contextlib
import csv
import functools
import http.server
import ipaddress
import json
import os
import pickle
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

PROGRAM = "import sys; from laticauda.cli import main; sys.exit(main())"
STORED = Path(__file__).with_suffix(".csv")
PATIENCE = 300.0
"""How long a program is waited for that compiles on a busy computer [s]."""
CANARY = "stranger_canary"
"""Name of a module that nobody must import."""


class Row(NamedTuple):
    """A line of the answer."""

    question: str
    asked: str
    answer: str


# ---- programs ------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Served:
    """A command that serves."""

    process: subprocess.Popen[str]
    facts: dict[str, Any]
    """What the line says that it prints first."""
    errors: IO[str]
    """What it writes to its standard error."""

    @property
    def pid(self) -> int:
        return self.process.pid

    def read_errors(self) -> str:
        self.errors.flush()
        self.errors.seek(0)
        return self.errors.read()


@contextlib.contextmanager
def serving(words: str, *, inside: tuple[str, ...] = ()) -> Iterator[Served]:
    """A command that serves, from its first line until it is interrupted."""
    command = [*inside, sys.executable, "-c", PROGRAM, *words.split()]
    with tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
            stdin=subprocess.DEVNULL,
        )
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            errors.seek(0)
            assert line, f"{words}: {errors.read()}"
            facts: dict[str, Any] = {}
            if line.startswith("{"):
                facts = json.loads(line)
            yield Served(process=process, facts=facts, errors=errors)
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(20.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def megabytes(pid: int, field: str = "VmRSS") -> float:
    """Memory of a process: now, or the most that it ever was (VmHWM) [MB]."""
    status = Path(f"/proc/{pid}/status").read_text()
    kilobytes, *_ = status.split(f"{field}:")[1].split()
    return int(kilobytes) * 1024 / 1e6


class Client:
    """Speaks to `serve`."""

    def __init__(self, port: int, host: str = "127.0.0.1", timeout: float = PATIENCE) -> None:
        self.wire = socket.create_connection((host, port), timeout=timeout)
        self.stream = self.wire.makefile("rwb")

    def ask(self, request: str, **fields: Any) -> dict[str, Any]:
        self.stream.write(json.dumps({"do": request, **fields}).encode() + b"\n")
        self.stream.flush()
        return json.loads(self.stream.readline() or b'{"error": "hung up on"}')

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self.stream.close()
        self.wire.close()


def is_answered(port: int) -> bool:
    """Whether a client of this computer gets an answer of `serve`."""
    client = Client(port)
    reply = client.ask("reset")
    client.close()
    return "observation" in reply


# ---- listeners -----------------------------------------------------------------------------------

BUS = "udp_multicast:239.74.163.77:43177"
SERVERS = {
    "cockpit": "cockpit --json --port 0",
    "serve": "serve --json --port 0",
    "lab": f"lab --json --port 0 --robot mamba-modules --position 0 0.5 --bus {BUS}",
}
OTHERS = {
    "swim": "swim --duration 2000 --json",
    "sweep": "sweep --vary gait.amplitude=0.1:0.6:400 --duration 400 --output OUT",
    "optimize": "optimize --output OUT",
    "view": "view RUN --video OUT.mp4",
    "replay": "replay RUN --json",
    "operate": f"operate TRIAL --bus {BUS} --output OUT",
}
"""Commands that should listen nowhere; they are looked at while they run, whatever comes of it."""


def sockets_of(pid: int) -> set[str]:
    """Where a process and its children listen, or take datagrams."""
    import psutil

    sockets = set[str]()
    parent = psutil.Process(pid)
    for process in (parent, *parent.children(recursive=True)):
        with contextlib.suppress(psutil.NoSuchProcess, psutil.ZombieProcess):
            for connection in process.net_connections(kind="inet"):
                is_datagram = connection.type == socket.SOCK_DGRAM
                listens = connection.status == psutil.CONN_LISTEN
                if connection.laddr and (is_datagram or listens):
                    protocol = "udp" if is_datagram else "tcp"
                    address = connection.laddr
                    sockets.add(f"{protocol} {address.ip}:{address.port}")
    return sockets


def host_of(address: str) -> str:
    """The host of an address PROTOCOL HOST:PORT."""
    host, _, _ = address.split()[1].rpartition(":")
    return host


def is_here(address: str) -> bool:
    """Whether only this computer can reach it: loopback, or a group (whose interface `groups` says)."""
    number = ipaddress.ip_address(host_of(address))
    return number.is_loopback or number.is_multicast


def groups(group: str) -> set[str]:
    """The interfaces on which a group was joined."""
    number_of_group = socket.inet_aton(group)[::-1].hex().upper()
    interfaces = set[str]()
    interface = ""
    for line in Path("/proc/net/igmp").read_text().splitlines()[1:]:
        words = line.split()
        if not line.startswith("\t"):
            interface = words[1]
        elif words[0] == number_of_group:
            interfaces.add(interface)
    return interfaces


def listeners(options: argparse.Namespace) -> Iterator[Row]:
    for name, words in SERVERS.items():
        yield Row("listeners", name, look_at_server(name, words))
    with tempfile.TemporaryDirectory() as folder_name:
        import laticauda as lc

        folder = Path(folder_name)
        gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
        lc.swim("mamba", gait, 20.0).save(folder / "run.nc")
        for name, words in OTHERS.items():
            yield Row("listeners", name, look_at_other(fill_in(words, folder, name)))


def look_at_server(name: str, words: str) -> str:
    """Where a command that serves listens."""
    sockets = set[str]()
    interfaces = set[str]()
    n_looks = 40 if "lab" in name else 4  # a listener tries again and again
    with serving(words) as served:
        for _ in range(n_looks):
            sockets |= sockets_of(served.pid)
            interfaces |= groups("239.74.163.77")
            time.sleep(0.25)
    is_good = bool(sockets) and all(map(is_here, sockets)) and interfaces <= {"lo"}
    places = sorted(f"{address.split()[0]} {host_of(address)}" for address in sockets)
    answer = f"{verdict_on_place(is_good)}: {', '.join(places)}"
    if interfaces:
        answer += f", joined on {', '.join(interfaces)}"
    return answer


def look_at_other(words: str) -> str:
    """Where a command listens that should listen nowhere."""
    sockets = set[str]()
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words.split()],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    end = time.monotonic() + 15.0
    while process.poll() is None and time.monotonic() < end:
        with contextlib.suppress(Exception):  # it may end at any moment
            sockets |= sockets_of(process.pid)
        time.sleep(0.02)
    process.kill()
    process.wait()
    is_good = all(map(is_here, sockets))
    return f"{verdict_on_place(is_good)}: {', '.join(sorted(sockets)) or 'none'}"


def fill_in(words: str, folder: Path, name: str) -> str:
    """A command of `OTHERS`, with the files that it reads and writes."""
    trial = Path(__file__).parent.parent / "examples" / "lab" / "trial.toml"
    words = words.replace("RUN", str(folder / "run.nc"))
    words = words.replace("OUT", str(folder / name))
    return words.replace("TRIAL", str(trial))


def verdict_on_place(is_good: bool) -> str:
    return "loopback" if is_good else "BEYOND LOOPBACK"


# ---- tokens --------------------------------------------------------------------------------------

ASKING = """
import http.client, json, socket, sys
server, host, port, token = sys.argv[1:]
try:
    if server == "serve":
        wire = socket.create_connection((host, int(port)), timeout=30)
        wire.sendall(json.dumps({"do": "reset", **({"token": token} if token else {})}).encode() + b"\\n")
        reply = json.loads(wire.makefile("rb").readline())
        print("answered" if "observation" in reply else "refused")
    else:
        wire = http.client.HTTPConnection(host, int(port), timeout=30)
        wire.request("GET", f"/{token}/" if token else "/")
        page = wire.getresponse()
        import viser, websockets.sync.client as client
        try:
            with client.connect(f"ws://{host}:{port}/{token}", subprotocols=[f"viser-v{viser.__version__}"]) as wire:
                has_answered = len(wire.recv(timeout=30)) > 0
        except Exception:
            has_answered = False
        answers = {(200, True): "answered", (403, False): "refused"}
        print(answers.get((page.status, has_answered), page.status))
except OSError:
    print("not reached")
"""


class Network(NamedTuple):
    """Two computers, or what stands for them."""

    address: str
    """Address of the first."""
    on_first: tuple[str, ...]
    """What to write before a command so that it runs on the first."""
    on_second: tuple[str, ...]
    """What to write before a command so that it runs on the second; nothing if there is only one."""


def run_ip(words: str) -> bool:
    """Whether the command `ip` succeeds."""
    return subprocess.run(["ip", *words.split()], capture_output=True).returncode == 0


def connect_namespaces(near: str, far: str) -> bool:
    """Make two network namespaces with a veth between them; whether that can be done."""
    return (
        shutil.which("ip") is not None
        and run_ip(f"netns add {near}")
        and run_ip(f"netns add {far}")
        and run_ip(f"link add {near} netns {near} type veth peer name {far} netns {far}")
    )


def own_address() -> str:
    """This computer's own address."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(("192.0.2.1", 9))  # nothing is sent
        return probe.getsockname()[0]


@contextlib.contextmanager
def other_computer() -> Iterator[Network]:
    """Two network namespaces, or this computer alone."""
    near = f"lt{os.getpid() % 10000}a"
    far = f"lt{os.getpid() % 10000}b"
    addresses = {near: "10.211.7.1", far: "10.211.7.2"}
    try:
        if not connect_namespaces(near, far):
            yield Network(own_address(), (), ())
            return
        for name, address in addresses.items():
            assert run_ip(f"-n {name} addr add {address}/30 dev {name}")
            assert run_ip(f"-n {name} link set {name} up")
            assert run_ip(f"-n {name} link set lo up")
        on_first = ("ip", "netns", "exec", near)
        on_second = ("ip", "netns", "exec", far)
        yield Network(addresses[near], on_first, on_second)
    finally:
        for name in addresses:
            run_ip(f"netns del {name}")


class Door(NamedTuple):
    """Where a server is, and what it asks for."""

    port: str
    token: str
    """"" if it asks for none."""


def door_of(name: str, facts: dict[str, Any]) -> Door:
    """What the first line of a server says."""
    if name == "serve":
        return Door(str(facts["port"]), facts["token"])
    _, _, port_and_path = facts["address"].removeprefix("http://").rpartition(":")
    port, _, path = port_and_path.partition("/")
    return Door(port, path.strip("/"))


def tokens(options: argparse.Namespace) -> Iterator[Row]:
    with other_computer() as network:
        way = "by this computer's own address"
        if network.on_second:
            way = "from another network namespace"
        for name in ("serve", "cockpit"):
            for host in ("127.0.0.1", "0.0.0.0"):
                words = f"{name} --json --port 0 --host {host}"
                with serving(words, inside=network.on_first) as served:
                    door = door_of(name, served.facts)
                    answers = ask_with_tokens(network, name, door)
                yield Row("tokens", f"{name} --host {host}, {way}", "; ".join(answers))


def ask_with_tokens(network: Network, name: str, door: Door) -> list[str]:
    """What a server answers to another computer, without a token and with some."""
    tried = {"no token": ""}
    if door.token:
        tried |= {"a wrong one": "a" * 24, "the token": door.token}
    command = [*network.on_second, sys.executable, "-c", ASKING, name, network.address, door.port]
    answers = list[str]()
    for title, token in tried.items():
        process = subprocess.run(
            [*command, token], capture_output=True, text=True, timeout=PATIENCE
        )
        answers.append(f"{title}: {process.stdout.strip() or process.stderr[-200:]}")
    return answers


# ---- origins -------------------------------------------------------------------------------------

ATTACK = """async ([http, ws, protocol]) => {
  const got = {};
  const tried = async (name, work) => {
    try { got[name] = await Promise.race([work(), new Promise(r => setTimeout(() => r("nothing"), 30000))]); }
    catch (e) { got[name] = "nothing"; }
  };
  await tried("fetch", async () => { const r = await fetch(http); return r.ok ? (await r.text()).length : "nothing"; });
  await tried("post", async () => {
    const r = await fetch(http, {method: "POST", body: '{"do": "run", "duration": 1}\\n'.repeat(2)});
    return r.ok ? (await r.text()).length : "nothing"; });
  await tried("blind post", async () => {
    await fetch(http, {method: "POST", mode: "no-cors", body: '\\n{"do": "run", "duration": 1}\\n'});
    return "nothing"; });
  await tried("socket", () => new Promise(r => {
    const s = new WebSocket(ws, [protocol]);
    s.onmessage = e => r(e.data.size || e.data.length); s.onerror = s.onclose = () => r("nothing"); }));
  await tried("frame", () => new Promise(r => {
    const f = document.createElement("iframe"); f.src = http; document.body.append(f);
    f.onload = () => {
      let text = ""; try { text = f.contentDocument.body.innerText; } catch (e) { text = ""; }
      const ours = location.origin == new URL(http).origin && text && !/This server|refused to connect/.test(text);
      r(ours ? text.length : "nothing"); }; }));
  return got;
}"""


class Counted:
    """Sessions of a server in this process, and how many requests they have done."""

    def __init__(self) -> None:
        from laticauda.connect import server

        self.n_done = 0
        counter = self
        original = server.Session

        class Counting(original):
            def answer(self, line: bytes) -> bytes:
                counter.n_done += 1
                return super().answer(line)

        server.Session = Counting  # type: ignore[misc]
        self.undo = lambda: setattr(server, "Session", original)


class StrangersPage(http.server.BaseHTTPRequestHandler):
    """A page of somebody else's."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<html><body>a page of somebody else's</body></html>")

    def log_message(self, *_: Any) -> None: ...


REBOUND = "a rebound host name"
"""Way of an attack: the page came while the name still led elsewhere."""


def origins(options: argparse.Namespace) -> Iterator[Row]:
    from playwright.sync_api import sync_playwright

    from laticauda.connect import Server

    counted = Counted()
    strangers_server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), StrangersPage)
    threading.Thread(target=strangers_server.serve_forever, daemon=True).start()
    rules = "--host-resolver-rules=MAP evil.example 127.0.0.1"
    try:
        with (
            serving("cockpit --json --port 0") as cockpit,
            Server(port=0) as server,
            sync_playwright() as playwright,
        ):
            chromium = playwright.chromium.launch(
                executable_path=shutil.which("chromium"), args=["--no-sandbox", rules]
            )
            cockpit_port = int(cockpit.facts["address"].rpartition(":")[2])
            pages = pages_that_attack(cockpit_port, strangers_server.server_port)
            for way, origin in pages.items():
                loot = attack(chromium, way, origin, cockpit_port)
                yield Row("origins", f"cockpit, {way}", f"gets {loot}")
            pages = pages_that_attack(server.port, strangers_server.server_port)
            del pages["its own page"]  # it has none
            for way, origin in pages.items():
                n_before = counted.n_done
                loot = attack(chromium, way, origin, server.port)
                n_done = counted.n_done - n_before
                yield Row("origins", f"serve, {way}", f"gets {loot}; requests done: {n_done}")
            loot = "its answers" if is_answered(server.port) else "NOTHING"
            yield Row("origins", "serve, a client of this computer", f"gets {loot}")
            chromium.close()
    finally:
        counted.undo()
        strangers_server.shutdown()


def pages_that_attack(port: int, strangers_port: int) -> dict[str, str]:
    """Origins of pages that attack a server, by their way."""
    return {
        "its own page": f"http://127.0.0.1:{port}",
        "a page of another port": f"http://127.0.0.1:{strangers_port}",
        "a page of another host": f"http://evil.example:{strangers_port}",
        REBOUND: f"http://evil.example:{port}",
    }


def attack(chromium: Any, way: str, origin: str, port: int) -> str:
    """What a page gets of a server on a port."""
    import viser

    page = chromium.new_page()
    target = f"127.0.0.1:{port}"
    if way == REBOUND:
        target = f"evil.example:{port}"
        page.route(
            "**/attack",
            lambda route: route.fulfill(body="<html></html>", content_type="text/html"),
        )
        page.goto(f"{origin}/attack")
    else:
        page.goto(origin)
    protocol = f"viser-v{viser.__version__}"
    results = page.evaluate(ATTACK, [f"http://{target}/", f"ws://{target}/", protocol])
    page.close()
    loot = [
        f"{kind} {n_characters} characters"
        for kind, n_characters in results.items()
        if n_characters != "nothing"
    ]
    return ", ".join(loot) or "nothing"


# ---- greedy clients ------------------------------------------------------------------------------

ALL_SERIES = (
    "link_angle",
    "joint_angle",
    "joint_rate",
    "joint_angle_ref",
    "joint_torque",
    "center_of_mass",
    "work",
)


def hoard(client: Client, chance: random.Random) -> None:
    """Fill a log with as much as is allowed, and ask for all of it again and again."""
    n = chance.choice((9, 50, 200))
    client.ask("reset", robot="mamba", n_links=n, sample_interval=1e-3)
    refusal = client.ask("step", duration=1e4).get("error", "")
    longest = 0.5
    if "<= " in refusal:
        longest = float(refusal.split("<= ")[1].split()[0])
    for _ in range(3):
        client.ask("step", duration=0.99 * longest)
        client.ask("get", series=list(ALL_SERIES))
        client.ask("get", series=["link_angle"])


def swallow(client: Client, chance: random.Random) -> None:
    """Ask for large answers ahead, and read none of them."""
    request = {
        "do": "run",
        "duration": 20,
        "sample_interval": 0.01,
        "series": ["joint_angle"],
        "n_links": 150,
    }
    line = json.dumps(request) + "\n"
    client.wire.settimeout(5.0)
    with contextlib.suppress(OSError):
        client.wire.sendall(line.encode() * 50)
        time.sleep(5.0)


def babble(client: Client, chance: random.Random) -> None:
    """The largest requests that there may be, of what takes the most memory when it is read."""
    for _ in range(5):
        piece = chance.choice(("[]", "{}", '{"a":0}', '"a"', "1e3", "[[[]]]"))
        n_pieces = 1_000_000 // (len(piece) + 1)
        references = ",".join([piece] * n_pieces).encode()
        client.stream.write(b'{"do":"reset","references":[' + references)
        client.stream.write(b"]}\n")
        client.stream.flush()
        client.stream.readline()


def shift(client: Client, chance: random.Random) -> None:
    """Other water, other joints, other models, all the time."""
    flows = ({"kind": "uniform", "velocity": [0.1, 0.0]}, "vortex", "street", "turbulence")
    for _ in range(4):
        client.ask(
            "reset", current=chance.choice(flows), joints=chance.choice(("prescribed", "pd"))
        )
        client.ask("reset", model="spatial", n_links=chance.choice((5, 20, 60)), robot="mamba")
        client.ask("step", duration=0.5)


GREED = (hoard, swallow, babble, hoard, hoard, shift)


def send_greedy_clients(port: int, n_clients: int, seconds: float, seed: int) -> int:
    """Greedy clients for so long; how many visits they made."""
    end = time.monotonic() + seconds
    n_visits = [0] * n_clients

    def visit(i: int) -> None:
        chance = random.Random(f"{seed} {i}")
        for k in range(10_000):
            be_greedy = GREED[(i + k) % len(GREED)]
            with contextlib.suppress(OSError, ValueError):
                client = Client(port)
                try:
                    be_greedy(client, chance)
                finally:
                    client.close()
                n_visits[i] += 1
            if time.monotonic() > end:
                return

    threads = [threading.Thread(target=visit, args=(i,)) for i in range(n_clients)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return sum(n_visits)


def greedy(options: argparse.Namespace) -> Iterator[Row]:
    with serving("serve --json --port 0") as served:
        port = served.facts["port"]
        before = megabytes(served.pid)
        n_visits = send_greedy_clients(port, 16, options.seconds, options.seed)
        start = time.monotonic()
        is_friend_answered = is_answered(port)
        time_taken = time.monotonic() - start
        most, after = megabytes(served.pid, "VmHWM"), megabytes(served.pid)
    answer = f"most {most:.0f} MB, before {before:.0f} MB, after {after:.0f} MB; {n_visits} visits"
    if not is_friend_answered:
        answer = f"NOT ANSWERED AFTER {time_taken:.0f} s"
    yield Row("greedy", f"16 clients, {options.seconds:g} s", answer)


# ---- hostile conversations -----------------------------------------------------------------------

FIELDS = (
    "do", "id", "protocol", "token", "robot", "n_links", "water", "ground", "parameters", "coefficients", "current",
    "model", "joints", "dt", "ramp", "offset_bandwidth", "center_of_mass", "heading", "root", "depth", "pitch", "roll",
    "sample_interval", "gait", "offset", "pitch_offset", "references", "enabled", "thrusts", "deflections", "duration",
    "series", "since",
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    None, True, 0, -1, 1, 0.5, 1e-308, 1e308, -1e300, 2**63, 10**400, "", "mamba", "../../etc/passwd", "/dev/zero",
    "s3://a/b", "\x00", "\ud800", "a" * 5000, CANARY, f"{CANARY}:Evil", f"__import__('{CANARY}')", [], {}, [[]], [1],
    [0.1, 0.2], [1e308] * 8, ["time"] * 50, {"kind": CANARY}, {"kind": "sum", "flows": []}, {"kind": 3},
    {"kind": "turbulence", "modes": 10**9}, {"source": "/etc/passwd"}, {"amplitude": [1]}, {"__class__": CANARY},
    "prescribed", "pd", "servo", "planar", "lateral_undulation",
)  # fmt: skip


OTHER_LINES = (
    b"GET / HTTP/1.1\r",
    b"\x16\x03\x01\x02\x00",
    b"NaN",
    b'{"do":"step","duration":Infinity}',
)
"""Lines of other protocols, and numbers that JSON does not have."""
RESET_AT_CLOSE = b"\x01\x00\x00\x00\x00\x00\x00\x00"
"""Value of SO_LINGER with which closing resets the connection."""


def hostile_line(chance: random.Random) -> bytes:
    """One line that a friend would not send."""
    kind = chance.randrange(8)
    if kind == 0:
        return chance.randbytes(chance.choice((1, 10, 1000))).replace(b"\n", b"")
    message: dict[str, Any] = {"do": chance.choice(("reset", "step", "set", "get", "run"))}
    if message["do"] == "step" and chance.random() < 0.5:
        message["duration"] = chance.choice((0.05, 0.2))
    if message["do"] == "run":
        message["duration"] = 0.5
    for name in chance.sample(FIELDS, chance.choice((0, 1, 1, 2, 4))):
        message[name] = chance.choice(VALUES)
    line = json.dumps(message).encode()
    if kind == 1:
        return line[: chance.randrange(len(line))]
    if kind == 2:
        place = chance.randrange(len(line))
        return line[:place] + bytes([chance.choice(b'{}[]",:0\\x00\xff')]) + line[place:]
    if kind == 3:
        depth = chance.choice((10, 1000, 100_000))
        return b'{"do":"reset","gait":' + chance.choice((b"[", b'{"gait":')) * depth
    if kind == 4:
        return chance.choice(OTHER_LINES)
    return line


def converse(port: int, chance: random.Random) -> str:
    """A conversation; what is wrong with what was answered, "" for nothing."""
    wire = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
    stream = wire.makefile("rwb")
    try:
        for _ in range(chance.randrange(1, 8)):
            line = hostile_line(chance)
            stream.write(line + b"\n")
            stream.flush()
            if chance.random() < 0.1:
                break
            if not line.strip():
                continue
            answer = stream.readline()
            if not answer:
                break
            reply = json.loads(answer)
            if "The server failed" in str(reply.get("error", "")):
                return f"{line[:200]!r}: {reply['error']}"
        if chance.random() < 0.2:
            wire.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET_AT_CLOSE)
    except OSError:
        pass
    finally:
        with contextlib.suppress(OSError):
            stream.close()
        wire.close()
    return ""


def converse_often(port: int, n_talks: int, seed: int) -> list[str]:
    """So many conversations; what was wrong."""
    faults = list[str]()
    for k in range(n_talks):
        fault = converse(port, random.Random(f"{seed} {k}"))
        if fault:
            faults.append(fault)
        if k % 100 == 99 and not is_answered(port):
            faults.append(f"no answer to a friend after {k + 1}")
    return faults


def talks(options: argparse.Namespace) -> Iterator[Row]:
    with serving("serve --json --port 0") as served:
        port = served.facts["port"]
        converse_often(port, 200, options.seed + 1)  # what is compiled and kept is compiled now
        before = megabytes(served.pid)
        faults = converse_often(port, options.talks, options.seed)
        growth = megabytes(served.pid) - before
        n_tracebacks = served.read_errors().count("Traceback")
        state = "alive" if served.process.poll() is None else "DEAD"
    answer = f"{len(faults)} faults, {n_tracebacks} tracebacks, {state}, {growth:+.0f} MB"
    yield Row("talks", f"{options.talks} conversations", answer)
    for fault in faults[:5]:
        yield Row("talks", "fault", fault)


# ---- code ----------------------------------------------------------------------------------------

WATCHED = (
    "import",
    "compile",
    "exec",
    "pickle.find_class",
    "subprocess.Popen",
    "os.system",
    "os.exec",
    "os.posix_spawn",
)


class Evil:
    """Unpickled, it would leave a mark."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os.system, (f"echo {CANARY} > $STRANGER_MARK",)


class Case(NamedTuple):
    """A poisoned input."""

    kind: str
    work: Callable[[], object]
    """Takes it in."""


WORDS = (
    CANARY,
    f"{CANARY}:Evil",
    f"{CANARY}.Evil",
    f"__import__('{CANARY}')",
    f"!!python/name:{CANARY}.Evil",
)
"""Names and expressions that nobody must import, or compute."""
TEXTS_OF_FILES = (b"mamba", b"lateral", b"planar", b"polynomial", b"prescribed", b"laticauda")
"""Texts that stand in files of trials."""


def poisoned(folder: Path, seed: int) -> list[Case]:
    """Files and messages in which names, expressions and pickles stand where texts, numbers and arrays should."""
    import laticauda as lc

    chance = random.Random(seed)
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    trial = lc.swim("mamba", gait, 1.0)
    return [
        *poisoned_scenarios(lc.build_scenario("mamba", gait, 1.0), chance),
        *poisoned_messages(chance),
        *poisoned_files(trial, folder),
        *poisoned_objects(folder),
        *poisoned_attributes(trial, folder, chance),
    ]


def poisoned_scenarios(scenario: Any, chance: random.Random) -> Iterator[Case]:
    from laticauda import scenarios

    lines = scenarios.run_to_toml(scenario).splitlines()
    for k, line in enumerate(lines):
        if "=" not in line:
            continue
        key = line.split("=")[0]
        for value in (f'"{chance.choice(WORDS)}"', f'{{kind = "{chance.choice(WORDS)}"}}'):
            text = "\n".join([*lines[:k], f"{key}= {value}", *lines[k + 1 :]])
            yield Case("scenario", functools.partial(scenarios.run_from_toml, text))


def poisoned_messages(chance: random.Random) -> Iterator[Case]:
    from laticauda.connect import Session

    for name in FIELDS[4:]:
        for value in (chance.choice(WORDS), {"kind": chance.choice(WORDS)}, [chance.choice(WORDS)]):
            line = json.dumps({"do": "run", "duration": 0.1, name: value}).encode()
            yield Case("message", functools.partial(Session().answer, line))


def poisoned_files(trial: Any, folder: Path) -> Iterator[Case]:
    """Files with the canary in the place of a text, and with a pickle in the place of everything."""
    import laticauda as lc

    for ending in (".nc", ".mcap", ".parquet", ".mat"):
        good = folder / f"good{ending}"
        trial.save(good)
        content = good.read_bytes()
        for k, text in enumerate(TEXTS_OF_FILES):
            canary = CANARY.encode()[: len(text)].ljust(len(text), b"_")
            bad = folder / f"text-{k}{ending}"
            bad.write_bytes(content.replace(text, canary))
            yield Case(f"file {ending}", functools.partial(lc.load_trial, bad))
        pickled = folder / f"pickle{ending}"
        pickled.write_bytes(pickle.dumps(Evil()))
        yield Case(f"file {ending}", functools.partial(lc.load_trial, pickled))


def poisoned_objects(folder: Path) -> Iterator[Case]:
    import scipy.io

    import laticauda as lc

    scipy.io.savemat(folder / "objects.mat", {"trial": np.array([CANARY, 1.0], dtype=object)})
    np.savez(folder / "objects.npz", trial=np.array([Evil()], dtype=object))
    (folder / "objects.npz").rename(folder / "npz.mat")
    for name in ("objects.mat", "npz.mat"):
        yield Case("file .mat", functools.partial(lc.load_trial, folder / name))


def poisoned_attributes(trial: Any, folder: Path, chance: random.Random) -> Iterator[Case]:
    import xarray

    import laticauda as lc

    dataset = trial.to_dataset()
    for key in dataset.attrs:
        bad = folder / f"attribute-{key}.nc"
        poison = dataset.assign_attrs({key: chance.choice(WORDS)})
        xarray.Dataset.to_netcdf(poison, bad, engine="netcdf4")
        yield Case("attribute", functools.partial(lc.load_trial, bad))


class Watchman:
    """An audit hook that notes what runs, while it watches."""

    def __init__(self) -> None:
        self.is_watching = False
        self.seen: list[str] = []
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.is_watching or event not in WATCHED:
            return
        shown = repr(arguments)[:5000]
        if event.startswith(("pickle", "subprocess", "os.")) or CANARY in shown:
            self.seen.append(f"{event} {shown[:200]}")

    @contextlib.contextmanager
    def watching(self) -> Iterator[None]:
        self.is_watching = True
        try:
            yield
        finally:
            self.is_watching = False


def code_here(seed: int) -> dict[str, Any]:
    """Try all of it in this process, under an audit hook: what was seen."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        mark = folder / "mark"
        os.environ["STRANGER_MARK"] = str(mark)
        canary = f"open({str(mark)!r}, 'w').close()\nclass Evil: pass\n"
        (folder / f"{CANARY}.py").write_text(canary)
        sys.path.insert(0, str(folder))
        cases = poisoned(folder, seed)
        watchman = Watchman()
        for case in cases:
            with watchman.watching(), contextlib.suppress(Exception):
                case.work()
            if mark.exists():
                watchman.seen.append(f"{case.kind}: it ran")
                mark.unlink()
        seen = watchman.seen.copy()
        with watchman.watching():
            __import__(CANARY)  # which the hook has to see
        seen_of_canary = watchman.seen[len(seen) :]
        is_seen = any(event.startswith("import") for event in seen_of_canary)
        if not is_seen or not mark.exists():
            seen.append("the hook is blind")
        kinds = Counter(case.kind for case in cases)
        return {"tried": len(cases), "seen": seen, "kinds": kinds}


def code(options: argparse.Namespace) -> Iterator[Row]:
    command = [sys.executable, __file__, "--code-here", str(options.seed)]
    process = subprocess.run(command, capture_output=True, text=True, timeout=600.0)
    result: dict[str, Any] = {"tried": 0, "seen": [process.stderr[-300:]], "kinds": {}}
    if process.stdout:
        result = json.loads(process.stdout.splitlines()[-1])
    kinds = ", ".join(f"{count} x {kind}" for kind, count in result["kinds"].items())
    answer = "none imported, compiled, run or unpickled"
    if result["seen"]:
        answer = "; ".join(result["seen"][:3])
    yield Row("code", f"{result['tried']} poisoned inputs ({kinds})", answer)


# ---- all -----------------------------------------------------------------------------------------

QUESTIONS = {
    question.__name__: question for question in (listeners, tokens, origins, greedy, talks, code)
}


def stored() -> list[Row]:
    """The answer that is kept."""
    if not STORED.exists():
        return []
    with STORED.open(newline="") as file:
        return [Row(**row) for row in csv.DictReader(file)]


def store(name: str, rows: list[Row]) -> None:
    """Keep an answer beside those to other questions."""
    others = [row for row in stored() if row.question != name]
    order = list(QUESTIONS)
    with STORED.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(Row._fields)
        table.writerows(sorted(others + rows, key=lambda row: order.index(row.question)))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", nargs="*", default=list(QUESTIONS))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--talks", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--store", action="store_true")
    parser.add_argument("--code-here", type=int)
    options = parser.parse_args()
    if options.code_here is not None:
        print(json.dumps(code_here(options.code_here)))
        return
    for name in options.only:
        rows = list[Row]()
        for row in QUESTIONS[name](options):
            print(*row, sep=" | ", flush=True)
            rows.append(row)
        if options.store:
            store(name, rows)


if __name__ == "__main__":
    main()
