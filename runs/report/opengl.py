# SPDX-License-Identifier: LGPL-3.0-or-later
"""Test of rendering by VTK in another process, since VTK aborts without OpenGL."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

PROBE = f"from {__name__} import render_test_picture; render_test_picture()"
PROBE_SECONDS = 60.0
REMEDY = "install libegl1 and libgl1-mesa-dri beside pip's vtk, or give Debian's VTK a display"


class RenderingUnavailable(RuntimeError):
    """Error if VTK cannot render on this machine, with the reason."""


def render_test_picture() -> None:
    """Render a sphere as a test.

    Raises:
        ImportError: VTK is not installed.
        RuntimeError: the picture is empty.
    """
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=[32, 32])
    plotter.add_mesh(pyvista.Sphere(), color="black")
    picture = plotter.screenshot(return_img=True)
    plotter.close()
    if picture is None or picture.min() == picture.max():
        raise RuntimeError("VTK draws nothing")


def silence_stderr() -> None:
    """Silence stderr of this process, to which VTK and OpenGL write."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())


def require_opengl() -> None:
    """Check that VTK can render.

    Raises:
        RenderingUnavailable: VTK cannot render.
    """
    try:
        probe = subprocess.run(
            [sys.executable, "-c", PROBE], capture_output=True, text=True, timeout=PROBE_SECONDS
        )
    except subprocess.TimeoutExpired:
        raise timeout_error() from None
    if probe.returncode < 0:
        name = signal.Signals(-probe.returncode).name
        raise RenderingUnavailable(f"VTK finds no working OpenGL and dies of {name}; {REMEDY}")
    if probe.returncode > 0:
        *_, why = "it does not say why", *probe.stderr.strip().splitlines()
        if why == "ModuleNotFoundError: No module named 'pyvista'":
            raise RenderingUnavailable("pictures need pip install 'protractile[report]'")
        raise RenderingUnavailable(
            f"pyvista makes no picture: {why.removeprefix('RuntimeError: ')}"
        )


def timeout_error() -> RenderingUnavailable:
    """Return the error for a rendering process that does not respond."""
    return RenderingUnavailable(f"VTK makes no picture within {PROBE_SECONDS:g} s; {REMEDY}")
