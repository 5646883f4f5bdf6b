# SPDX-License-Identifier: LGPL-3.0-or-later
"""The live page without a browser: controls, answers and refused requests."""

import json
import socket
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest

from protractile.dynamics.equilibrium import equilibrium
from protractile.geometry.typography import fixed
from protractile.runs import CASES
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.folder.cache import Cache
from protractile.runs.live import beam
from protractile.runs.live.controls import Draft
from protractile.runs.live.server import LivePage, Superseded, make_server
from protractile.runs.pipeline.models import build
from tests.runs.case_texts import table
from tests.runs.summaries import COARSE

LIFT = str(CASES / "lift.toml")
TIP = "Static tip deflection (t = 0), mm"


@pytest.fixture(scope="module")
def draft() -> Draft:
    return Draft.load(LIFT)


def test_controls_have_ranges_and_units(draft: Draft, tmp_path: Path) -> None:
    """Reference: the file, with an overlap of 1.2 m and a flange of 146 mm; equal joints share."""
    by_key = {control.key: control for control in draft.controls()}
    assert by_key["joint.play"].keys == ["joint[1].play", "joint[2].play"]
    assert [by_key[f"joint[{n}].extension"].value for n in (1, 2)] == [4.8, 4.4]
    assert by_key["gravity.angle"].range == (-90.0, 90.0)
    assert by_key["joint[2].extension"].range == pytest.approx((2.2, 5.6))
    assert by_key["payload.mass"].unit == "kg"
    assert by_key["joint.pad.length"].range == pytest.approx((0.012, 0.24))
    # Half the flange of the fly section less the width of the pads, 40 mm.
    assert draft.control("joint[2].pad.offset").range == pytest.approx((0.0, 0.033))
    path = tmp_path / "shown.toml"
    path.write_text(f'shown_units = "mm-t-s"\n{Path(LIFT).read_text("utf-8")}', encoding="utf-8")
    in_mm = Draft.load(str(path))
    control = in_mm.control("joint[1].play")
    assert control.help.startswith("the play in mm, the sum")
    # The mid-lines are 300 and 256 mm high; the flanges of 6 and 5 mm take 11 mm.
    assert (control.value, control.unit, control.range) == (3.0, "mm", (0.0, pytest.approx(33.0)))
    assert in_mm.changed({"joint[1].play": 4.5}).joints[0].play == 0.0045


def at_rest(draft: Draft, **changes: float) -> dict[str, Any]:
    """Return the answer of the page before the motion."""
    return next(beam.beam_results(draft.beam(draft.changed(changes)), draft, lambda: None))


def test_a_boom_without_loads_has_a_chart() -> None:
    """Reference: theory, no load and no deflection."""
    draft = Draft.load(str(COARSE))
    unloaded = {key: 0.0 for key in draft.keys if key.endswith("].load")}
    curves = at_rest(draft, **unloaded)["forces"]["data"]
    assert {np.any(curve["y"]) for curve in curves} == {False}


@pytest.mark.slow
@pytest.mark.usefixtures("empty_cache")
def test_beam_is_calibrated_by_a_shell_of_the_cache(tmp_path: Path, tools: BuildContext) -> None:
    """Reference: other code path, a calibrated beam of the case, also with another payload."""
    shell = table("[[model]]", name="shell", kind="shell", mesh_size=0.6, contact_tolerance="any")
    text, _, _ = Path(LIFT).read_text(encoding="utf-8").partition("[[model]]")
    (tmp_path / "lift.toml").write_text(text + shell, encoding="utf-8")
    draft = Draft.load(str(tmp_path / "lift.toml"))
    plain = dict(at_rest(draft)["rows"])
    assert plain["Stiffness of the beam"] == "of its sections;\nrun the shell to calibrate it"
    (made,) = draft.shells
    context = replace(tools, cache=Cache.of_user())
    build(draft.case, draft.boom, made, context)
    # The shell of the file calibrates the beam with another payload, too.
    changes = {"payload.mass": 100.0, "joint[1].play": 0.004}
    found = dict(at_rest(draft, **changes)["rows"])
    checked = draft.beam(draft.changed(changes))
    assert found["Stiffness of the beam"] == "calibrated by shell"
    (model,) = checked.case.models
    model = model.model_copy(update={"calibrated_by": made, "contact": None})
    built = build(checked.case, checked.boom, model, context)
    rest = equilibrium(built.system, built.system.load_at(0.0))
    assert found[TIP] == fixed(1e3 * float(built.system.observers["tip"].row @ rest), 1)
    assert found[TIP] != plain[TIP]


@pytest.fixture(scope="module")
def address(draft: Draft) -> Iterator[str]:
    server, address = make_server(LivePage(draft))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield address
    server.shutdown()
    server.server_close()


def sent(
    address: str, method: str, path: str, body: str | None = None, **headers: str
) -> tuple[int, str]:
    """Return status and text of an answer; a path that starts with / has no token."""
    where = urlsplit(address)
    connection = HTTPConnection(where.netloc, timeout=60)
    connection.request(method, path if path[:1] == "/" else where.path + path, body, headers)
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


def test_another_host_or_page_has_no_access(address: str) -> None:
    """Reference: by construction. A name that someone else resolves to this machine is no access.

    The browser gives the page that asks as the origin. Malformed requests keep the server alive.
    """
    for method, path in (("GET", "/"), ("GET", "/another/plotly.js"), ("POST", "/another/beam")):
        assert sent(address, method, path, "{}")[0] == 404
    assert {sent(address, "POST", "beam", x)[0] for x in ("", "{", "[]", "[" * 100_000)} == {400}
    assert urlsplit(address).hostname == "127.0.0.1"
    origin = address[: address.index("/", 7)]
    for method, path, body in (("GET", "", None), ("POST", "case", '{"values": {}}')):
        assert sent(address, method, path, body, Origin=origin)[0] == 200
        for header in ({"Host": "localhost"}, {"Origin": "http://a.org"}, {"Origin": "null"}):
            assert sent(address, method, path, body, **header)[0] == 404, (method, header)


def test_nothing_is_printed_for_a_closed_page(
    draft: Draft, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reference: by construction. A page may be closed at any moment."""
    server, address = make_server(LivePage(draft))
    # The end of the server waits for all its connections.
    server.daemon_threads = False
    threading.Thread(target=server.serve_forever, daemon=True).start()
    where = urlsplit(address)
    connection = HTTPConnection(where.netloc, timeout=60)
    connection.request("GET", f"{where.path}plotly.js")
    connection.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()
    server.shutdown()
    server.server_close()
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("case", "values", "key", "what"),
    [
        (LIFT, {"joint[1].play": None}, "joint[1].play", "must be a number of the case, got None"),
        (LIFT, {"payload.mass": 0}, "payload.mass", "must be a number greater than 0, got 0"),
        # 10⁷ outputs need more than 1 GB.
        (str(COARSE), {"time.duration": 1.0e4}, "time.duration",
         "10000 s are too long for this page, since the motion may take "),
    ],
)  # fmt: skip
def test_a_refusal_names_key(case: str, values: dict[str, Any], key: str, what: str) -> None:
    (line,) = LivePage(Draft.load(case)).lines("beam", {"tab": "1", "number": 1, "values": values})
    found = json.loads(line)
    assert (found["stage"], found["key"]) == ("refused", key)
    assert found["what"].startswith(what)


def test_a_large_run_is_asked_about(draft: Draft, monkeypatch: pytest.MonkeyPatch) -> None:
    page = LivePage(draft)
    monkeypatch.setattr(page.shells, "run", lambda case, file: iter([{"stage": "shell"}]))
    small = [part["stage"] for part in page.shell({"values": {}})]
    assert small == ["shell", "shell"]
    monkeypatch.setattr("protractile.runs.pipeline.estimates.MAX_TIME", 1.0)
    (question,) = page.shell({"values": {}})
    assert question["stage"] == "large"
    assert question["what"].endswith(" Start it anyway?")
    assert [part["stage"] for part in page.shell({"values": {}, "large": True})] == small


def test_tabs_do_not_wait_for_each_other(draft: Draft) -> None:
    """Reference: by construction. One tab has results at rest, and computes its motion."""
    page = LivePage(draft)
    newest = {"tab": "a", "number": 2, "values": {}}
    computing = page.beam(newest)
    assert next(computing)["stage"] == "rest"
    # An older request of a tab is not answered.
    assert list(page.lines("beam", newest | {"number": 1})) == []
    answer = list(page.lines("beam", {"tab": "b", "number": 1, "values": {}}))
    assert [json.loads(line)["stage"] for line in answer] == ["rest", "preview", "motion"]


def test_a_computation_ends_with_its_tab(
    address: str, draft: Draft, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: by construction. The computation itself would never end."""
    begun, ended = threading.Event(), threading.Event()

    def endless(checked: Any, draft: Draft, check_current: Callable[[], None]) -> Iterator[Any]:
        yield {"stage": "rest"}
        begun.set()
        with suppress(Superseded):
            while True:
                check_current()
        ended.set()

    monkeypatch.setattr("protractile.runs.live.server.beam_results", endless)
    where = urlsplit(address)
    connection = HTTPConnection(where.netloc, timeout=60)
    request = json.dumps({"tab": "closed", "number": 1, "values": {}})
    connection.request("POST", f"{where.path}beam", request)
    assert begun.wait(60)
    connection.close()
    assert ended.wait(60)
