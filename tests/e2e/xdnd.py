"""Drops files on a window, as a file manager does: the source's side of the XDND protocol, version 5
(https://freedesktop.org/wiki/Specifications/XDND), through Xlib.
"""

import ctypes
import ctypes.util
import time
import urllib.parse

CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY = 33, 30, 31
REPLACE, VERSION = 0, 5

Long, Int = ctypes.c_long, ctypes.c_int
Id = ctypes.c_ulong  # windows, atoms


def event_type(*fields):
    head = [("type", Int), ("serial", ctypes.c_ulong), ("send_event", Int),
            ("display", ctypes.c_void_p)]
    return type("Event", (ctypes.Structure,), {"_fields_": head + list(fields)})


ClientMessage = event_type(("window", Id), ("message_type", Id), ("format", Int), ("l", Long * 5))
SelectionRequest = event_type(("owner", Id), ("requestor", Id), ("selection", Id), ("target", Id),
                              ("property", Id), ("time", Id))
SelectionNotify = event_type(("requestor", Id), ("selection", Id), ("target", Id),
                             ("property", Id), ("time", Id))


class Event(ctypes.Union):
    _fields_ = [("type", Int), ("client", ClientMessage), ("request", SelectionRequest),
                ("notify", SelectionNotify), ("room", Long * 24)]


def load_xlib():
    x = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
    x.XOpenDisplay.restype = ctypes.c_void_p
    x.XDefaultRootWindow.restype = x.XCreateSimpleWindow.restype = Id
    x.XInternAtom.restype = Id
    for name, arguments in {
        "XDefaultRootWindow": [], "XInternAtom": [ctypes.c_char_p, Int],
        "XCreateSimpleWindow": [Id, Int, Int, Int, Int, Int, Id, Id],
        "XSetSelectionOwner": [Id, Id, Id], "XPending": [], "XFlush": [], "XCloseDisplay": [],
        "XNextEvent": [ctypes.POINTER(Event)],
        "XSendEvent": [Id, Int, Long, ctypes.POINTER(Event)],
        "XChangeProperty": [Id, Id, Id, Int, Int, ctypes.c_char_p, Int],
    }.items():
        getattr(x, name).argtypes = [ctypes.c_void_p, *arguments]
    return x


class Source:
    """A client that has files to give."""

    def __init__(self, display):
        self.x = load_xlib()
        self.display = self.x.XOpenDisplay(display.encode())
        assert self.display, f"no display {display}"
        root = self.x.XDefaultRootWindow(self.display)
        self.window = self.x.XCreateSimpleWindow(self.display, root, 0, 0, 1, 1, 0, 0, 0)

    def close(self):
        self.x.XCloseDisplay(self.display)

    def atom(self, name):
        return self.x.XInternAtom(self.display, name.encode(), 0)

    def send(self, window, event):
        self.x.XSendEvent(self.display, window, 0, 0, ctypes.byref(event))
        self.x.XFlush(self.display)

    def message(self, target, name, *numbers):
        event = Event()
        event.client.type = CLIENT_MESSAGE
        event.client.window, event.client.message_type = target, self.atom(name)
        event.client.format = 32
        event.client.l[0] = self.window
        for i, number in enumerate(numbers):
            event.client.l[i + 1] = number
        self.send(target, event)

    def give(self, request, text):
        """Answers whoever asks for the selection."""
        self.x.XChangeProperty(self.display, request.requestor, request.property, request.target, 8,
                               REPLACE, text, len(text))
        event = Event()
        event.notify.type = SELECTION_NOTIFY
        for key in ("requestor", "selection", "target", "property", "time"):
            setattr(event.notify, key, getattr(request, key))
        self.send(request.requestor, event)

    def wait_for(self, name, text, seconds=30):
        """Until the target says `name`; whatever it asks for meanwhile it gets."""
        end = time.monotonic() + seconds
        event = Event()
        while time.monotonic() < end:
            if self.x.XPending(self.display) == 0:
                time.sleep(0.005)
                continue
            self.x.XNextEvent(self.display, ctypes.byref(event))
            if event.type == SELECTION_REQUEST:
                self.give(event.request, text)
            elif event.type == CLIENT_MESSAGE and event.client.message_type == self.atom(name):
                return list(event.client.l)
        raise AssertionError(f"no {name} from the window within {seconds} s")

    def drop(self, target, text, x, y):
        kind, action = self.atom("text/uri-list"), self.atom("XdndActionCopy")
        self.x.XSetSelectionOwner(self.display, self.atom("XdndSelection"), self.window, 0)
        self.message(target, "XdndEnter", VERSION << 24, kind, 0, 0)
        self.message(target, "XdndPosition", 0, x << 16 | y, 0, action)
        assert self.wait_for("XdndStatus", text)[1] & 1, "the window takes no files"
        self.message(target, "XdndDrop", 0, 0, 0, 0)
        # A flag by the protocol; GLFW puts the number of bytes there.
        assert self.wait_for("XdndFinished", text)[1], "the window did not take the files"


def drop_files(display, window, paths, x, y):
    """All at once; characters beyond ASCII and spaces travel percent-encoded."""
    lines = ["file://" + urllib.parse.quote(str(path)) for path in paths]
    source = Source(display)
    try:
        source.drop(window, ("\r\n".join(lines) + "\r\n").encode("ascii"), x, y)
    finally:
        source.close()
