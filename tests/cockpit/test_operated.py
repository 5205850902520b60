from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import laticauda as lc
from laticauda.cockpit import Cockpit, Live
from laticauda.estimation import Estimate
from laticauda.operate.observer import Sight
from laticauda.operate.settings import Connection
from laticauda.robot import Joint

pytest.importorskip("viser")
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
ROBOT = lc.load_robot("mamba-modules")


class Page:
    """Stands for a browser's page: keeps what it is told."""

    def __init__(self):
        self.told = []

    def add_notification(self, title, text, **settings):
        self.told.append(text)


class Told:
    """Stands for a listener: knows what it is told."""

    def __init__(self, connection, robot, **mount):
        self.connection, self.robot = connection, robot
        self.sight, self.is_closed = Sight(None, "No lab there."), False

    def look(self):
        return self.sight

    def close(self):
        self.is_closed = True


@pytest.fixture
def cockpit(monkeypatch):
    monkeypatch.setattr("laticauda.operate.observer.Listener", Told)
    served = Cockpit(Live(lc.scenario(ROBOT, GAIT)), port=0)
    yield served
    served.close()


def shown(cockpit):
    for _ in range(5):
        cockpit.frame()


def estimate(x, time):
    n = ROBOT.planar().n_links
    return Estimate(
        time=time,
        status="tracking",
        age=0.0,
        center_of_mass=np.array([x, 1.0]),
        center_of_mass_velocity=np.zeros(2),
        heading=0.3,
        heading_rate=0.0,
        link_angle=np.full(n, 0.3),
        joint_angle=np.zeros(n - 1),
        joint_rate=np.zeros(n - 1),
        center_of_mass_std=0.0,
        heading_std=0.0,
    )


def clicked(cockpit, **fields):
    page, operated = Page(), cockpit.operated
    for name, value in fields.items():
        getattr(operated, f"_{name}").value = value
    operated._clicked(SimpleNamespace(client=page))
    return page.told


def test_the_operated_robot_is_drawn_where_it_is_and_the_simulated_one_makes_room(cockpit):
    operated = cockpit.operated
    assert clicked(cockpit, can="virtual:pool", mocap="10.0.0.2:22223", robot="mamba-modules") == []
    listener = operated._listener
    assert (listener.connection.can_channel, listener.connection.mocap_host) == ("pool", "10.0.0.2")
    shown(cockpit)
    assert operated._text.content == "**No lab there.**"
    for k in range(5):
        listener.sight = Sight(estimate(2.0 + 0.2 * k, float(k)), "")
        shown(cockpit)
    assert "speed over 5 s | **0.200 m/s**" in operated._text.content
    tail = operated._body._frames[0].position
    assert tail[0] < 2.8 < operated._body._frames[-1].position[0] + 0.2
    assert not cockpit._scene._body._root.visible
    operated._alone.value = False
    shown(cockpit)
    assert cockpit._scene._body._root.visible


def test_a_driven_fin_is_drawn_as_its_module_says(cockpit):
    own = lc.load_robot("mamba-fin")
    robot = replace(own, caudal_fin=replace(own.caudal_fin, joint=Joint()))
    operated, turned = cockpit.operated, []
    operated.connect(Connection(), robot)
    n, still = robot.planar().n_links, np.zeros(robot.planar().n_joints)
    straight = replace(estimate(2.0, 0.0), link_angle=np.full(n, 0.3), joint_angle=still, joint_rate=still)
    for angle in (0.0, 0.4):
        operated._listener.sight = Sight(straight, "", angle)
        shown(cockpit)
        w, _, _, z = operated._body._frames[-1].wxyz
        turned.append(2.0 * np.arctan2(z, w))
    assert turned[0] - turned[1] == pytest.approx(0.4)
    assert "| fin | **23 deg** |" in operated._text.content


def test_a_lab_that_goes_away_is_said_and_its_robot_stays_until_somebody_disconnects(cockpit):
    operated = cockpit.operated
    operated.connect(Connection(), ROBOT)
    listener = operated._listener
    listener.sight = Sight(estimate(2.0, 0.0), "The motion capture closed the connection.")
    shown(cockpit)
    assert operated._text.content.endswith("**The motion capture closed the connection.**")
    assert operated.is_on
    operated._left(None)
    shown(cockpit)
    assert listener.is_closed
    assert (operated._text.content, operated._body._frames) == ("", [])
    assert cockpit._scene._body._root.visible


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"mocap": "here"}, "`mocap` must be HOST:PORT, got 'here'."),
        ({"can": "udp_multicast:1.2.3.4"}, "`channel` must be an IPv4 multicast group"),
        ({"can": "spoon"}, "`interface` must be one of `virtual`, `udp_multicast`, `socketcan`"),
    ],
)
def test_an_address_that_is_none_is_refused_in_the_words_of_the_api(cockpit, fields, message):
    (told,) = clicked(cockpit, **fields)
    assert told.startswith(message)
    assert not cockpit.operated.is_on
