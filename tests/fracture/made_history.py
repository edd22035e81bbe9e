"""Histories of parts whose stiffness is a formula."""

import numpy as np

from slmm.fracture.events import Event, Kind
from slmm.fracture.history import History, Outcome, Step

G_C = 2.0
#: compliance over the third power of the crack length, mm/N
C = 1e-3


def step(u_c, stiffness, kind=Kind.GROWTH, crack=0, length=1.0, arrested_by=""):
    event = Event(u_c, kind, np.zeros(2), np.array([1.0, 0.0]), tip=0)
    return Step(u_c, stiffness, event, crack, (0.0, 0.0), arrested_by, length, np.nan, 0.0, ())


def cantilevers(increment, first=10.0, last=20.0):
    """Two arms of a double cantilever beam of thickness 1, whose crack grows steadily: S = 1/(C a^3), G = G_C."""
    n = round((last - first) / increment)
    a = first + increment * np.arange(n + 1)
    u, S = a**2 * np.sqrt(2 * C * G_C / 3), 1 / (C * a**3)
    steps = [step(u[k], S[k], length=increment) for k in range(n)]
    return History(steps, Outcome.LARGEST, last_stiffness=S[n], last_u=u[n], next_u=u[n])


def steady_work(first=10.0, last=20.0):
    """The exact work of F on the way, N mm: F du = 4/3 G_C da while it grows."""
    return 0.5 * first * 2 * G_C / 3 + 4 / 3 * G_C * (last - first)
