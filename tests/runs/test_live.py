# SPDX-License-Identifier: LGPL-3.0-or-later
"""The live page without a browser: controls, answers and refused requests."""

import json
import re
import socket
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from http.client import HTTPConnection
from pathlib import Path
from types import MappingProxyType
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest

from protractile.dynamics.equilibrium import equilibrium
from protractile.geometry.typography import fixed
from protractile.runs import CASES
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.schema import Case
from protractile.runs.folder.cache import Cache
from protractile.runs.live import beam
from protractile.runs.live.controls import Draft
from protractile.runs.live.server import LivePage, Superseded, make_server
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.run import run_case
from protractile.runs.process.bad_input import BadInput
from tests.runs.summaries import COARSE

POST = "POST {path}beam HTTP/1.1\r\nHost: {host}\r\nContent-Length: "
LIFT = str(CASES / "lift.toml")
TIP = "Static tip deflection (t = 0), mm"


@pytest.fixture(scope="module")
def draft() -> Draft:
    return Draft.load(LIFT)


def test_equal_numbers_of_joints_share_a_control(draft: Draft) -> None:
    by_key = {control.key: control for control in draft.controls()}
    assert by_key["joint.play"].keys == ["joint[1].play", "joint[2].play"]
    assert (by_key["joint[1].extension"].value, by_key["joint[2].extension"].value) == (4.8, 4.4)
    assert by_key["gravity.angle"].range == (-90.0, 90.0)
    # The overlap of the file is 1.2 m.
    assert by_key["joint[2].extension"].range == pytest.approx((2.2, 5.6))
    assert by_key["payload.mass"].unit == "kg"
    assert by_key["joint.pad.length"].range == pytest.approx((0.012, 0.24))
    assert [by_key[key].label for key in ("joint.play", "joint[2].extension", "gravity.angle")] == [
        "Play, all joints",
        "Extension, fly",
        "Luffing angle",
    ]
    assert draft.control("cylinder[1].depth").label == "cylinder[1].depth"
    # Half the flange of the fly section, 146 mm, less the width of the pads, 40 mm.
    assert draft.control("joint[2].pad.offset").range == pytest.approx((0.0, 0.033))


def test_controls_have_the_unit_of_the_case(tmp_path: Path) -> None:
    text = Path(LIFT).read_text(encoding="utf-8")
    path = tmp_path / "shown.toml"
    path.write_text(f'shown_units = "mm-t-s"\n{text}', encoding="utf-8")
    control = Draft.load(str(path)).control("joint[1].play")
    assert control.help.startswith("the play in mm, the sum")
    # The mid-lines are 300 and 256 mm high; the flanges of 6 and 5 mm take 11 mm.
    assert (control.value, control.unit, control.range) == (3.0, "mm", (0.0, pytest.approx(33.0)))
    changed = Draft.load(str(path)).changed({"joint[1].play": 4.5})
    assert changed.joints[0].play == 0.0045


def test_number_outside_the_boom_is_named(draft: Draft) -> None:
    with pytest.raises(BadInput) as caught:
        draft.beam(draft.changed({"joint[2].extension": 6.5}))
    assert caught.value.key.startswith("joint[2]")


def check_results(
    draft: Draft,
    changes: dict[str, float],
    case: Case,
    context: RunContext,
    monkeypatch: pytest.MonkeyPatch,
) -> dict[str, str]:
    """Compare the results of the page with a run of a case; return the rows of the page at rest."""
    kept: list[Any] = []
    make = beam.summary_table
    with monkeypatch.context() as patch:
        patch.setattr(beam, "summary_table", lambda results: kept.append(results) or make(results))
        checked = draft.beam(draft.changed(changes))
        found = list(beam.beam_results(checked, draft, lambda: None))
    assert [one["stage"] for one in found] == ["rest", "preview", "motion"]
    run = run_case(case, "", context)
    run.evaluate()
    own, other = kept[-1], run.results
    assert own.summary.models["beam"].first_peak == other.summary.models["beam"].first_peak
    assert own.rows == other.rows.where(model="beam", play=True)
    return dict(found[0]["rows"])


def test_a_boom_without_loads_has_a_chart() -> None:
    """Reference: theory, no load and no deflection."""
    draft = Draft.load(str(COARSE))
    unloaded = draft.changed({key: 0.0 for key in draft.keys if key.endswith("].load")})
    at_rest = next(beam.beam_results(draft.beam(unloaded), draft, lambda: None))
    curves = at_rest["forces"]["data"]
    assert curves
    assert not any(np.any(curve["y"]) for curve in curves)


@pytest.mark.slow
@pytest.mark.usefixtures("empty_cache")
@pytest.mark.parametrize("path", [COARSE, CASES / "slew.toml"], ids=lambda path: path.stem)
def test_the_beam_has_the_numbers_of_a_run(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: a run of the same beam at the tolerance of the page."""
    draft = Draft.load(str(path))
    check_results(draft, {}, draft.beam(draft.changed({})).case, RunContext(), monkeypatch)


@pytest.mark.slow
@pytest.mark.usefixtures("empty_cache")
def test_beam_is_calibrated_by_a_shell_of_the_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: other code path, a calibrated beam of the case, also with another payload."""
    pytest.importorskip("dolfinx", reason="shells need FEniCSx")
    from mpi4py import MPI

    shell = (
        '[[model]]\nname = "shell"\nkind = "shell"\nmesh_size = 0.3\ncontact_tolerance = "any"\n'
    )
    text, _, _ = Path(LIFT).read_text(encoding="utf-8").partition("[[model]]")
    (tmp_path / "lift.toml").write_text(text + shell, encoding="utf-8")
    draft = Draft.load(str(tmp_path / "lift.toml"))

    context = RunContext(MPI.COMM_SELF, cache=Cache.of_user())
    plain = check_results(draft, {}, draft.beam(draft.changed({})).case, context, monkeypatch)
    assert plain["Stiffness of the beam"] == "of its sections;\nrun the shell to calibrate it"
    (made,) = draft.shells
    tools = BuildContext(MPI.COMM_SELF, cache=context.cache)
    build(draft.case, draft.boom, made, tools)
    changed = {"payload.mass": 100.0, "joint[1].play": 0.004}
    case = draft.beam(draft.changed({})).case
    (plain_beam,) = case.models
    model = plain_beam.model_copy(update={"calibrated_by": made, "contact": None})
    calibrated = case.model_copy(update={"models": (model,)})
    found = check_results(draft, {}, calibrated, context, monkeypatch)
    assert found["Stiffness of the beam"] == "calibrated by shell"
    assert found[TIP] != plain[TIP]
    # The shell of the file calibrates the beam with another payload, too.
    other = draft.beam(draft.changed(changed))
    found = dict(next(beam.beam_results(other, draft, lambda: None))["rows"])
    assert found["Stiffness of the beam"] == "calibrated by shell"
    built = build(other.case, other.boom, model, tools)
    rest = equilibrium(built.system, built.system.load_at(0.0))
    assert found[TIP] == fixed(1e3 * float(built.system.observers["tip"].row @ rest), 1)


@pytest.fixture(scope="module")
def address(draft: Draft) -> Iterator[str]:
    server, address = make_server(LivePage(draft))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield address
    server.shutdown()
    server.server_close()


def sent(
    address: str,
    method: str,
    path: str,
    body: str | None = None,
    headers: Any = MappingProxyType({}),
) -> tuple[int, str]:
    """Return status and text of an answer; a path that starts with / has no token."""
    where = urlsplit(address)
    connection = HTTPConnection(where.netloc, timeout=60)
    connection.request(method, path if path[:1] == "/" else where.path + path, body, headers)
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


def test_the_page_is_there_with_its_token_alone(address: str) -> None:
    status, text = sent(address, "GET", "")
    assert (status, "joint.play" in text) == (200, True)
    assert sent(address, "GET", "/")[0] == 404
    assert sent(address, "GET", "/another/plotly.js")[0] == 404
    assert sent(address, "POST", "/another/beam", "{}")[0] == 404
    assert urlsplit(address).hostname == "127.0.0.1"


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "example.org"},
        {"Host": "localhost"},
        {"Origin": "http://example.org"},
        {"Origin": "null"},
    ],
)
def test_another_host_or_page_has_no_access(
    address: str, method: str, headers: dict[str, str]
) -> None:
    """Reference: by construction. A name that someone else resolves to this machine is no access.

    The browser gives the page that asks as the origin.
    """
    path, body = ("case", '{"values": {}}') if method == "POST" else ("", None)
    origin = {"Origin": address[: address.index("/", 7)]}
    assert sent(address, method, path, body, origin)[0] == 200
    assert sent(address, method, path, body, headers)[0] == 404


@pytest.mark.parametrize(
    ("request_", "closed"),
    [
        ("GET {path}plotly.js HTTP/1.1\r\nHost: {host}\r\n\r\n", True),
        (POST + "100000\r\n\r\n" + "[" * 100_000, False),
        (POST + "1" * 5000 + "\r\n\r\n", False),
        (POST + "9\r\n\r\n{{", True),
    ],
    ids=["closed", "deep", "long", "short"],
)  # fmt: skip
def test_nothing_is_printed_for_bad_connections(
    draft: Draft, request_: str, closed: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reference: by construction. A page may be closed at any moment."""
    server, address = make_server(LivePage(draft))
    # The end of the server waits for all its connections.
    server.daemon_threads = False
    threading.Thread(target=server.serve_forever, daemon=True).start()
    where = urlsplit(address)
    with socket.create_connection((where.hostname, where.port), timeout=60) as connection:
        connection.sendall(request_.format(path=where.path, host=where.netloc).encode())
        if closed:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        else:
            assert connection.recv(100).startswith((b"HTTP/1.0 400", b"HTTP/1.0 413"))
    server.shutdown()
    server.server_close()
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("body", ["", "{", "[]", "7"])
def test_malformed_request_keeps_the_server_alive(address: str, body: str) -> None:
    assert sent(address, "POST", "beam", body)[0] == 400
    assert sent(address, "GET", "")[0] == 200


@pytest.mark.parametrize(
    ("request_", "key", "what"),
    [
        ({}, "", "the request is not understood ('tab')"),
        ({"tab": "1", "number": 1, "values": {"joint[1].play": None}}, "joint[1].play",
         "must be a number of the case, got None"),
        ({"tab": "1", "number": 2, "values": {"payload.mass": 0}}, "payload.mass",
         "must be a number greater than 0, got 0"),
    ],
)  # fmt: skip
def test_a_refusal_names_key(address: str, request_: dict[str, Any], key: str, what: str) -> None:
    status, text = sent(address, "POST", "beam", json.dumps(request_))
    assert (status, json.loads(text)) == (200, {"stage": "refused", "key": key, "what": what})


def test_a_large_run_is_asked_about(draft: Draft, monkeypatch: pytest.MonkeyPatch) -> None:
    page = LivePage(draft)
    monkeypatch.setattr(page.shells, "run", lambda case, file: iter([{"stage": "shell"}]))
    small = [one["stage"] for one in page.shell({"values": {}})]
    assert small == ["shell", "shell"]
    monkeypatch.setattr("protractile.runs.pipeline.estimates.MAX_TIME", 1.0)
    (question,) = page.shell({"values": {}})
    assert question["stage"] == "large"
    assert re.fullmatch(r"The run may take .* GB and .*\. Start it anyway\?", question["what"])
    assert [one["stage"] for one in page.shell({"values": {}, "large": True})] == small


def test_an_older_request_of_a_tab_is_not_answered(draft: Draft) -> None:
    page = LivePage(draft)
    newest = {"tab": "a", "number": 2, "values": {}}
    first = next(page.beam(newest))
    assert first["stage"] == "rest"
    assert list(page.lines("beam", newest | {"number": 1})) == []


def test_tabs_do_not_wait_for_each_other(draft: Draft) -> None:
    """Reference: by construction. One tab has results at rest, and computes its motion."""
    page = LivePage(draft)
    long = page.beam({"tab": "a", "number": 1, "values": {}})
    assert next(long)["stage"] == "rest"
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


def test_a_long_motion_is_refused(tmp_path: Path) -> None:
    """Reference: by construction. 10⁷ outputs need more than 1 GB."""
    draft = Draft.load(str(COARSE))
    (line,) = LivePage(draft).lines(
        "beam", {"tab": "a", "number": 1, "values": {"time.duration": 1.0e4}}
    )
    found = json.loads(line)
    assert (found["stage"], found["key"]) == ("refused", "time.duration")
    assert re.fullmatch(
        r"10000 s are too long for this page, since the motion may take [0-9]+ GB and [0-9]+ min; "
        "make it shorter or time.output_step longer, or use `protractile run`",
        found["what"],
    )
