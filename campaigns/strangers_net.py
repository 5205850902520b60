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
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

PROGRAM = "import sys; from laticauda.cli import main; sys.exit(main())"
STORED = Path(__file__).with_suffix(".csv")
PATIENCE = 300.0  # for a program that compiles on a busy computer [s]
CANARY = "stranger_canary"
Row = tuple[str, str, str]


# ---- programs ------------------------------------------------------------------------------------


@contextlib.contextmanager
def serving(
    words: str, *, inside: tuple[str, ...] = (), **environment: str
) -> Iterator[tuple[Any, dict[str, Any]]]:
    """A command that serves, and the line that it prints."""
    run = [*inside, sys.executable, "-c", PROGRAM, *words.split()]
    with tempfile.TemporaryFile("w+") as told:
        process = subprocess.Popen(
            run,
            stdout=subprocess.PIPE,
            stderr=told,
            text=True,
            env=os.environ | environment,
            stdin=subprocess.DEVNULL,
        )
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            told.seek(0)
            assert line, f"{words}: {told.read()}"
            facts = json.loads(line) if line.startswith("{") else {}
            process.said = lambda: (told.flush(), told.seek(0), told.read())[-1]  # type: ignore[attr-defined]
            yield process, facts
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(20.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def megabytes(pid: int, what: str = "VmRSS") -> float:
    """Memory of a process: now, or the most that it ever was (VmHWM) [MB]."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(status.split(f"{what}:")[1].split()[0]) * 1024 / 1e6


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

    found = set[str]()
    for one in (process := psutil.Process(pid), *process.children(recursive=True)):
        with contextlib.suppress(psutil.NoSuchProcess, psutil.ZombieProcess):
            for each in one.net_connections(kind="inet"):
                if each.laddr and (
                    each.status == psutil.CONN_LISTEN or each.type == socket.SOCK_DGRAM
                ):
                    found.add(
                        f"{'tcp' if each.type == socket.SOCK_STREAM else 'udp'} {each.laddr.ip}:{each.laddr.port}"
                    )
    return found


def is_here(address: str) -> bool:
    """Whether only this computer can reach it: loopback, or a group (whose interface `groups` says)."""
    number = ipaddress.ip_address(address.split()[1].rpartition(":")[0])
    return number.is_loopback or number.is_multicast


def groups(group: str) -> set[str]:
    """The interfaces on which a group was joined."""
    number, device, found = socket.inet_aton(group)[::-1].hex().upper(), "", set[str]()
    for line in Path("/proc/net/igmp").read_text().splitlines()[1:]:
        words = line.split()
        if not line.startswith("\t"):
            device = words[1]
        elif words[0] == number:
            found.add(device)
    return found


def listeners(options: argparse.Namespace) -> Iterator[Row]:
    for name, words in SERVERS.items():
        with serving(words) as (process, _):
            found, joined = set[str](), set[str]()
            for _ in range(40 if "lab" in name else 4):  # a listener tries again and again
                found |= sockets_of(process.pid)
                joined |= groups("239.74.163.77")
                time.sleep(0.25)
            where = ", ".join(
                sorted(f"{one.split()[0]} {one.split()[1].rpartition(':')[0]}" for one in found)
            )
            good = found and all(map(is_here, found)) and joined <= {"lo"}
            interfaces = f", joined on {', '.join(joined)}" if joined else ""
            yield (
                "listeners",
                name,
                f"{'loopback' if good else 'BEYOND LOOPBACK'}: {where}{interfaces}",
            )
    with tempfile.TemporaryDirectory() as folder:
        import laticauda as lc

        run, trial = (
            Path(folder) / "run.nc",
            Path(__file__).parent.parent / "examples" / "lab" / "trial.toml",
        )
        lc.swim(
            "mamba", lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7), 20.0
        ).save(run)
        for name, words in OTHERS.items():
            words = (
                words.replace("RUN", str(run))
                .replace("OUT", f"{folder}/{name}")
                .replace("TRIAL", str(trial))
            )
            found: set[str] = set()
            process = subprocess.Popen(
                [sys.executable, "-c", PROGRAM, *words.split()],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            end = time.monotonic() + 15.0
            while process.poll() is None and time.monotonic() < end:
                with contextlib.suppress(Exception):  # it may end at any moment
                    found |= sockets_of(process.pid)
                time.sleep(0.02)
            process.kill()
            process.wait()
            good = all(map(is_here, found))
            yield (
                "listeners",
                name,
                f"{'loopback' if good else 'BEYOND LOOPBACK'}: {', '.join(sorted(found)) or 'none'}",
            )


# ---- tokens --------------------------------------------------------------------------------------

ASKING = """
import http.client, json, socket, sys
what, host, port, token = sys.argv[1:]
try:
    if what == "serve":
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
                got = len(wire.recv(timeout=30)) > 0
        except Exception:
            got = False
        said = {(200, True): "answered", (403, False): "refused"}
        print(said.get((page.status, got), page.status))
except OSError:
    print("not reached")
"""


@contextlib.contextmanager
def other_computer() -> Iterator[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    """An address, and what to write before a command so that it runs there, and on another computer."""
    near, far = f"lt{os.getpid() % 10000}a", f"lt{os.getpid() % 10000}b"

    def ip(words: str) -> bool:
        return subprocess.run(["ip", *words.split()], capture_output=True).returncode == 0

    made = shutil.which("ip") is not None and ip(f"netns add {near}") and ip(f"netns add {far}")
    made = made and ip(f"link add {near} netns {near} type veth peer name {far} netns {far}")
    try:
        if made:
            for name, address in ((near, "10.211.7.1/30"), (far, "10.211.7.2/30")):
                for words in (
                    f"addr add {address} dev {name}",
                    f"link set {name} up",
                    "link set lo up",
                ):
                    assert ip(f"-n {name} {words}")
            yield "10.211.7.1", ("ip", "netns", "exec", near), ("ip", "netns", "exec", far)
        else:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
                probe.connect(("192.0.2.1", 9))  # nothing is sent
                yield probe.getsockname()[0], (), ()
    finally:
        for name in (near, far):
            ip(f"netns del {name}")


def tokens(options: argparse.Namespace) -> Iterator[Row]:
    with other_computer() as (address, here, there):
        way = "from another network namespace" if there else "by this computer's own address"
        for name, words in (
            ("serve", "serve --json --port 0"),
            ("cockpit", "cockpit --json --port 0"),
        ):
            for host in ("127.0.0.1", "0.0.0.0"):
                with serving(f"{words} --host {host}", inside=here) as (_, facts):
                    if name == "serve":
                        port, token = facts["port"], facts["token"]
                    else:
                        port, _, rest = (
                            facts["address"]
                            .removeprefix("http://")
                            .rpartition(":")[2]
                            .partition("/")
                        )
                        token = rest.strip("/")
                    said = {"no token": "", "a wrong one": "a" * 24, "the token": token}
                    found = list[str]()
                    for what, given in said.items() if token else [("no token", "")]:
                        run = [
                            *there,
                            sys.executable,
                            "-c",
                            ASKING,
                            name,
                            address,
                            str(port),
                            given,
                        ]
                        done = subprocess.run(run, capture_output=True, text=True, timeout=PATIENCE)
                        found.append(f"{what}: {done.stdout.strip() or done.stderr[-200:]}")
                    yield "tokens", f"{name} --host {host}, {way}", "; ".join(found)


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

        self.done, usual, counted = 0, server.Session, self

        class Counting(usual):
            def answer(self, line: bytes) -> bytes:
                counted.done += 1
                return super().answer(line)

        server.Session = Counting  # type: ignore[misc]
        self.undo = lambda: setattr(server, "Session", usual)


def origins(options: argparse.Namespace) -> Iterator[Row]:
    import viser
    from playwright.sync_api import sync_playwright

    from laticauda.connect import Server

    class Page(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(b"<html><body>a page of somebody else's</body></html>")

        def log_message(self, *_: Any) -> None: ...

    chromium, protocol, counted = shutil.which("chromium"), f"viser-v{viser.__version__}", Counted()
    evil = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Page)
    threading.Thread(target=evil.serve_forever, daemon=True).start()
    rules = "--host-resolver-rules=MAP evil.example 127.0.0.1"
    try:
        with (
            serving("cockpit --json --port 0") as (_, facts),
            Server(port=0) as server,
            sync_playwright() as playwright,
        ):
            ports = {"cockpit": int(facts["address"].rpartition(":")[2]), "serve": server.port}
            found = playwright.chromium.launch(
                executable_path=chromium, args=["--no-sandbox", rules]
            )
            for name, port in ports.items():
                ways = {
                    "its own page": f"http://127.0.0.1:{port}",
                    "a page of another port": f"http://127.0.0.1:{evil.server_port}",
                    "a page of another host": f"http://evil.example:{evil.server_port}",
                    "a rebound host name": f"http://evil.example:{port}",
                }
                for way, origin in ways.items():
                    if name == "serve" and way == "its own page":
                        continue  # it has none
                    page, before = found.new_page(), counted.done
                    rebound = "evil.example" if "rebound" in way else "127.0.0.1"
                    if (
                        way == "a rebound host name"
                    ):  # the page came while the name still led elsewhere
                        page.route(
                            "**/attack",
                            lambda route: route.fulfill(
                                body="<html></html>", content_type="text/html"
                            ),
                        )
                        page.goto(f"{origin}/attack")
                    else:
                        page.goto(origin)
                    got = page.evaluate(
                        ATTACK, [f"http://{rebound}:{port}/", f"ws://{rebound}:{port}/", protocol]
                    )
                    page.close()
                    given = {kind: what for kind, what in got.items() if what != "nothing"}
                    shown = (
                        ", ".join(f"{kind} {what} characters" for kind, what in given.items())
                        or "nothing"
                    )
                    done = f"; requests done: {counted.done - before}" if name == "serve" else ""
                    yield "origins", f"{name}, {way}", f"gets {shown}{done}"
            own = Client(server.port)
            known = "observation" in own.ask("reset")
            own.close()
            yield (
                "origins",
                "serve, a client of this computer",
                f"gets {'its answers' if known else 'NOTHING'}",
            )
            found.close()
    finally:
        counted.undo()
        evil.shutdown()


# ---- greedy clients ------------------------------------------------------------------------------

ALL = (
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
    longest = client.ask("step", duration=1e4).get("error", "")
    most = float(longest.split("<= ")[1].split()[0]) if "<= " in longest else 0.5
    for _ in range(3):
        client.ask("step", duration=0.99 * most)
        client.ask("get", series=list(ALL))
        client.ask("get", series=["link_angle"])


def swallow(client: Client, chance: random.Random) -> None:
    """Ask for large answers ahead, and read none of them."""
    line = {
        "do": "run",
        "duration": 20,
        "sample_interval": 0.01,
        "series": ["joint_angle"],
        "n_links": 150,
    }
    client.wire.settimeout(5.0)
    with contextlib.suppress(OSError):
        client.wire.sendall((json.dumps(line) + "\n").encode() * 50)
        time.sleep(5.0)


def babble(client: Client, chance: random.Random) -> None:
    """The largest requests that there may be, of what takes the most memory when it is read."""
    for _ in range(5):
        piece = chance.choice(("[]", "{}", '{"a":0}', '"a"', "1e3", "[[[]]]"))
        client.stream.write(
            b'{"do":"reset","references":['
            + ",".join([piece] * (1_000_000 // (len(piece) + 1))).encode()
        )
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


def feast(port: int, clients: int, seconds: float, seed: int) -> int:
    """Greedy clients for so long; how many requests series they got through."""
    end, count = time.monotonic() + seconds, [0] * clients

    def eat(i: int) -> None:
        chance = random.Random(f"{seed} {i}")
        for k in range(10_000):
            with contextlib.suppress(OSError, ValueError):
                client = Client(port)
                try:
                    GREED[(i + k) % len(GREED)](client, chance)
                finally:
                    client.close()
                count[i] += 1
            if time.monotonic() > end:
                return

    threads = [threading.Thread(target=eat, args=(i,)) for i in range(clients)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return sum(count)


def greedy(options: argparse.Namespace) -> Iterator[Row]:
    with serving("serve --json --port 0") as (process, facts):
        before = megabytes(process.pid)
        count = feast(facts["port"], 16, options.seconds, options.seed)
        good, end = Client(facts["port"]), time.monotonic()
        known = "observation" in good.ask("reset")
        took = time.monotonic() - end
        good.close()
        most, after = megabytes(process.pid, "VmHWM"), megabytes(process.pid)
        answer = f"most {most:.0f} MB, before {before:.0f} MB, after {after:.0f} MB; {count} visits"
        yield (
            "greedy",
            f"16 clients, {options.seconds:g} s",
            answer if known else f"NOT ANSWERED AFTER {took:.0f} s",
        )


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


def hostile_line(chance: random.Random) -> bytes:
    """One line that a friend would not send."""
    kind = chance.randrange(8)
    if kind == 0:
        return chance.randbytes(chance.choice((1, 10, 1000))).replace(b"\n", b"")
    message = {"do": chance.choice(("reset", "step", "set", "get", "run"))}
    if message["do"] == "step" and chance.random() < 0.5:
        message["duration"] = chance.choice((0.05, 0.2))  # type: ignore[assignment]
    if message["do"] == "run":
        message["duration"] = 0.5  # type: ignore[assignment]
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
        return chance.choice(
            (
                b"GET / HTTP/1.1\r",
                b"\x16\x03\x01\x02\x00",
                b"NaN",
                b'{"do":"step","duration":Infinity}',
            )
        )
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
            said = stream.readline()
            if not said:
                break
            reply = json.loads(said)
            if "The server failed" in str(reply.get("error", "")):
                return f"{line[:200]!r}: {reply['error']}"
        if chance.random() < 0.2:
            wire.setsockopt(
                socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\x00\x00\x00\x00\x00\x00\x00"
            )
    except OSError:
        pass
    finally:
        with contextlib.suppress(OSError):
            stream.close()
        wire.close()
    return ""


def talked(port: int, count: int, seed: int) -> list[str]:
    """So many conversations; what was wrong."""
    found = list[str]()
    for k in range(count):
        if wrong := converse(port, random.Random(f"{seed} {k}")):
            found.append(wrong)
        if k % 100 == 99:
            good = Client(port)
            if "observation" not in good.ask("reset"):
                found.append(f"no answer to a friend after {k + 1}")
            good.close()
    return found


def talks(options: argparse.Namespace) -> Iterator[Row]:
    with serving("serve --json --port 0") as (process, facts):
        talked(facts["port"], 200, options.seed + 1)  # what is compiled and kept is compiled now
        before = megabytes(process.pid)
        found = talked(facts["port"], options.talks, options.seed)
        grown = megabytes(process.pid) - before
        traces = process.said().count("Traceback")
        alive = process.poll() is None
    faults = f"{len(found)} faults, {traces} tracebacks"
    yield (
        "talks",
        f"{options.talks} conversations",
        f"{faults}, {'alive' if alive else 'DEAD'}, {grown:+.0f} MB",
    )
    for wrong in found[:5]:
        yield "talks", "fault", wrong


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


def poisoned(folder: Path, seed: int) -> list[tuple[str, Callable[[], object]]]:
    """Files and messages in which names, expressions and pickles stand where texts, numbers and arrays should."""
    import laticauda as lc
    from laticauda import scenarios
    from laticauda.connect import Session

    chance = random.Random(seed)
    words = (
        CANARY,
        f"{CANARY}:Evil",
        f"{CANARY}.Evil",
        f"__import__('{CANARY}')",
        f"!!python/name:{CANARY}.Evil",
    )
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    trial = lc.swim("mamba", gait, 1.0)
    cases = list[tuple[str, Callable[[], object]]]()
    toml = scenarios.run_to_toml(lc.build_scenario("mamba", gait, 1.0))
    lines = toml.splitlines()
    for k in [i for i, line in enumerate(lines) if "=" in line]:
        name = lines[k].split("=")[0]
        changed = "\n".join([*lines[:k], f'{name}= "{chance.choice(words)}"', *lines[k + 1 :]])
        cases.append(("scenario", functools.partial(scenarios.run_from_toml, changed)))
        kind = "\n".join(
            [*lines[:k], f'{name}= {{kind = "{chance.choice(words)}"}}', *lines[k + 1 :]]
        )
        cases.append(("scenario", functools.partial(scenarios.run_from_toml, kind)))
    for name in FIELDS[4:]:
        for given in (chance.choice(words), {"kind": chance.choice(words)}, [chance.choice(words)]):
            line = json.dumps({"do": "run", "duration": 0.1, name: given}).encode()
            cases.append(("message", functools.partial(Session().answer, line)))
    for ending in (".nc", ".mcap", ".parquet", ".mat"):
        good = folder / f"good{ending}"
        trial.save(good)
        content = good.read_bytes()
        texts = [b"mamba", b"lateral", b"planar", b"polynomial", b"prescribed", b"laticauda"]
        for k, text in enumerate(texts):
            bad = folder / f"text-{k}{ending}"
            bad.write_bytes(
                content.replace(text, CANARY.encode()[: len(text)].ljust(len(text), b"_"))
            )
            cases.append((f"file {ending}", functools.partial(lc.load_trial, bad)))
        raw = folder / f"pickle{ending}"
        raw.write_bytes(pickle.dumps(Evil()))
        cases.append((f"file {ending}", functools.partial(lc.load_trial, raw)))
    import scipy.io

    scipy.io.savemat(folder / "objects.mat", {"trial": np.array([CANARY, 1.0], dtype=object)})
    np.savez(folder / "objects.npz", trial=np.array([Evil()], dtype=object))
    (folder / "objects.npz").rename(folder / "npz.mat")
    for name in ("objects.mat", "npz.mat"):
        cases.append(("file .mat", functools.partial(lc.load_trial, folder / name)))
    import xarray

    dataset = trial.to_dataset()
    for key in dataset.attrs:
        bad = folder / f"attribute-{key}.nc"
        poison = dataset.assign_attrs({key: chance.choice(words)})
        xarray.Dataset.to_netcdf(poison, bad, engine="netcdf4")
        cases.append(("attribute", functools.partial(lc.load_trial, bad)))
    return cases


def code_here(seed: int) -> dict[str, Any]:
    """Try all of it in this process, under an audit hook: what was seen."""
    seen, tried, watching = list[str](), 0, False

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if watching and event in WATCHED:
            told = repr(arguments)[:5000]
            if event.startswith(("pickle", "subprocess", "os.")) or CANARY in told:
                seen.append(f"{event} {told[:200]}")

    with tempfile.TemporaryDirectory() as name:
        folder, mark = Path(name), Path(name) / "mark"
        os.environ["STRANGER_MARK"] = str(mark)
        (folder / f"{CANARY}.py").write_text(
            f"open({str(mark)!r}, 'w').close()\nclass Evil: pass\n"
        )
        sys.path.insert(0, str(folder))
        cases = poisoned(folder, seed)
        sys.addaudithook(hook)
        kinds: dict[str, int] = {}
        for kind, work in cases:
            watching = True
            with contextlib.suppress(Exception):
                work()
            watching = False
            if mark.exists():
                seen.append(f"{kind}: it ran")
                mark.unlink()
            kinds[kind] = kinds.get(kind, 0) + 1
            tried += 1
        found, watching = seen.copy(), True
        __import__(CANARY)  # which the hook has to see
        watching = False
        if not any(one.startswith("import") for one in seen[len(found) :]) or not mark.exists():
            found.append("the hook is blind")
        return {"tried": tried, "seen": found, "kinds": kinds}


def code(options: argparse.Namespace) -> Iterator[Row]:
    run = [sys.executable, __file__, "--code-here", str(options.seed)]
    done = subprocess.run(run, capture_output=True, text=True, timeout=600.0)
    found = (
        json.loads(done.stdout.splitlines()[-1])
        if done.stdout
        else {"tried": 0, "seen": [done.stderr[-300:]]}
    )
    kinds = ", ".join(f"{count} x {kind}" for kind, count in found.get("kinds", {}).items())
    answer = (
        "; ".join(found["seen"][:3])
        if found["seen"]
        else "none imported, compiled, run or unpickled"
    )
    yield "code", f"{found['tried']} poisoned inputs ({kinds})", answer


# ---- all -----------------------------------------------------------------------------------------

QUESTIONS = {one.__name__: one for one in (listeners, tokens, origins, greedy, talks, code)}


def stored() -> list[Row]:
    """The answer that is kept."""
    if not STORED.exists():
        return []
    with STORED.open(newline="") as file:
        return [(row["question"], row["asked"], row["answer"]) for row in csv.DictReader(file)]


def store(name: str, rows: list[Row]) -> None:
    """Keep an answer beside those to other questions."""
    kept = [row for row in stored() if row[0] != name] + rows
    order = list(QUESTIONS)
    with STORED.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("question", "asked", "answer"))
        table.writerows(sorted(kept, key=lambda row: order.index(row[0])))


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
