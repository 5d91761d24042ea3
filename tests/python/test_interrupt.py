"""Ctrl-C stops long work, and leaves the interpreter in order."""

import os
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

import carat

# Each runs for seconds, and again and again if it is not stopped.
WORK = {
    "eigenmodes": "carat.eigenmodes(mesh, k=400)",
    "geodesics": "carat.HeatGeodesics(mesh)",
    "many_distances": "carat.HeatGeodesics(small).distance_many([[v] for v in range(5000)] * 8)",
    "poisson": "carat.Poisson(mesh, solver='cholesky').solve(1.0, dirichlet=0.0)",
    "assembly": "carat.discretize(mesh)",
    "callback": "carat.discretize(mesh, coefficient=lambda x: time.sleep(60))",
}


@pytest.mark.parametrize("name", WORK)
def test_ctrl_c(name):
    script = textwrap.dedent(
        f"""
        import time
        import carat
        mesh = carat.generate("plane-triangles", level=6)
        small = carat.generate("plane-triangles", level=4)
        print("ready", flush=True)
        try:
            while True:
                {WORK[name]}
        except KeyboardInterrupt:
            print("stopped", flush=True)
        print(carat.stiffness(small)[0].shape[0] == small.n_vertices, flush=True)
        """
    )
    process = subprocess.Popen(
        [sys.executable, "-X", "faulthandler", "-c", script], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    rest, _ = process.communicate(timeout=120)
    assert rest == "stopped\nTrue\n"
    assert process.returncode == 0


def test_handlers_run_in_time(surface):
    """Other signals are met too while work goes on, not at its end."""
    met = []
    before = signal.signal(signal.SIGALRM, lambda *_: met.append(time.perf_counter()))
    try:
        start = time.perf_counter()
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        carat.eigenmodes(carat.generate("plane-triangles", level=5), k=40)
        end = time.perf_counter()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert len(met) == 1 and met[0] < end
    assert end > start


def test_an_exception_of_a_handler_stops_the_work():
    class Timeout(Exception):
        pass

    def handler(*_):
        raise Timeout

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(Timeout):
            carat.eigenmodes(carat.generate("plane-triangles", level=6), k=300)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert np.isfinite(carat.HeatGeodesics(carat.generate("plane-quads")).distance(0)).all()
    assert os.getpid() > 0
