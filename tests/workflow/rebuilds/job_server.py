"""Run Python scripts in forks of a process that has the libraries loaded.

Modules of the project are those of the working copy: each has a process of its own with the modules
loaded that planning imports, and another one as soon as a source has changed.
"""

import gc
import hashlib
import importlib
import json
import os
import runpy
import signal
import socket
import subprocess
import sys
import traceback
from contextlib import suppress
from functools import cache, partialmethod
from pathlib import Path

# ruff: noqa: F401
# what scripts and Snakemake import, without the project's modules
import argparse_dataclass
import jinja2
import llvmlite.binding
import matplotlib.backends.backend_pdf
import matplotlib.figure
import matplotlib.tri
import nbformat
import netCDF4
import numpy
import pandas
import scipy.integrate
import scipy.linalg
import scipy.signal
import scipy.sparse
import scipy.spatial
import scipy.stats
import skimage.measure
import sklearn.ensemble
import sklearn.linear_model
import skopt
import smart_open
import snakemake.cli
import snakemake.dag
import snakemake.report.html_reporter
import snakemake.scheduling.job_scheduler
import snakemake.script
import snakemake.storage
import snakemake.workflow
from matplotlib.backends.backend_agg import FigureCanvasAgg

_END_OF_PREAMBLE = "######## snakemake preamble end #########"
EMPTY = hashlib.sha256().hexdigest()


def _small(figure: matplotlib.figure.Figure, buffer: object, **keywords: object) -> None:
    """Draw a picture once, small, without its layout, and no PDF: these take most of the time.

    Tests of figures have them.
    """
    if keywords["format"] == "pdf":
        buffer.write(b"%PDF")
    else:
        figure.set_layout_engine("none")
        figure.set_dpi(20)
        FigureCanvasAgg(figure).print_png(buffer)


matplotlib.figure.Figure.savefig = _small


def _handed_over(_: object, address: str, script: str, edit: bool = False) -> None:
    """Run a job's script in a fork of the process that has all modules loaded."""
    request = {"script": script, "directory": os.getcwd(), "environment": dict(os.environ)}
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(address)
        socket.send_fds(connection, [json.dumps(request).encode() + b"\n"], [0, 1, 2])
        if status := (connection.recv(1) or b"\x89")[0]:  # as if it were killed
            raise subprocess.CalledProcessError(status, script)


def serve(address: str) -> None:
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the forks
    gc.freeze()  # or each fork would search, and so copy, all that is loaded
    snakemake.script.PythonScript.execute_script = partialmethod(_handed_over, address)
    loaded, copy = {}, socket.socket(socket.AF_UNIX)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(address)
        listener.listen(64)
        print("ready", flush=True)
        while True:
            connection, _ = listener.accept()
            text, descriptors, _, _ = socket.recv_fds(connection, 2**16, 3)
            while not text.endswith(b"\n"):
                text += connection.recv(2**16)
            files = [connection.detach(), *descriptors]
            sources = Path(json.loads(text)["environment"]["PYTHONPATH"].partition(":")[0])
            if (state := _state(sources)) != loaded:
                copy.close()
                loaded, copy = state, _with_modules_of(sources, [listener.fileno(), *files])
            socket.send_fds(copy, [text], files)
            for file in files:
                os.close(file)


def _modules(sources: Path) -> list[Path]:
    return [path for path in sorted(sources.rglob("*.py")) if path.stem != "__main__"]


def _state(sources: Path) -> dict[Path, tuple[int, int]]:
    """Times and sizes of modules, and of what they read when they are imported."""
    files = [*_modules(sources), *sources.parent.glob("workflow/*.yaml")]
    return {path: (path.stat().st_mtime_ns, path.stat().st_size) for path in files}


def _with_modules_of(sources: Path, unwanted: list[int]) -> socket.socket:
    """Way to a process that has the modules of a working copy loaded, and forks for each request.

    Each message is one request; the first of its files is the connection that waits for the status.
    """
    here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    if os.fork():
        there.close()
        return here
    for file in [here.detach(), *unwanted]:
        os.close(file)
    sys.path.insert(0, str(sources))
    for path in _modules(sources):
        name = ".".join(path.relative_to(sources).with_suffix("").parts)
        with suppress(Exception):  # it fails again in the run that needs it
            importlib.import_module(name.removesuffix(".__init__"))
    with suppress(Exception):
        _ask_for_versions()
    snakemake.cli.get_argument_parser()  # finds all plugins
    sys.path.remove(str(sources))
    gc.freeze()
    while True:
        text, files, _, _ = socket.recv_fds(there, 2**18, 4)
        if not text:
            os._exit(0)
        if os.fork() == 0:
            there.close()
            _handle(json.loads(text), *files)
        for file in files:
            os.close(file)


def _ask_for_versions() -> None:
    """Find out once what each job asks for."""
    from burstcast_workflow.tracking import environment

    environment.numpy_blas = cache(environment.numpy_blas)
    environment.environment()
    for library in (*environment.LIBRARIES, "matplotlib", "netCDF4", "pandas", "threadpoolctl"):
        environment.library_version(library)


def _handle(request: dict, connection: int, *descriptors: int) -> None:
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    for number, descriptor in enumerate(descriptors):
        os.dup2(descriptor, number)
        os.close(descriptor)
    os.chdir(request["directory"])
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.path[:0] = [path for path in os.environ.get("PYTHONPATH", "").split(":") if path]
    sys.stdin, sys.stdout, sys.stderr = (
        open(number, mode, buffering=1, closefd=False)  # noqa: SIM115
        for number, mode in enumerate(["r", "w", "w"])
    )
    status = _run(request)
    sys.stdout.flush()
    sys.stderr.flush()
    os.write(connection, bytes([status]))
    os._exit(0)


def _run(request: dict) -> int:
    try:
        if "script" in request:
            sys.argv = [request["script"]]
            sys.path.insert(0, os.path.dirname(request["script"]))
            pretended = os.environ.get("BURSTCAST_TEST_PRETEND")
            if pretended and request["script"].endswith(pretended):
                _pretend(request["script"])
            else:
                runpy.run_path(request["script"], run_name="__main__")
        else:
            sys.argv = ["snakemake", *request["arguments"]]
            snakemake.cli.main(request["arguments"])
    except SystemExit as leave:
        if isinstance(leave.code, str):  # which Python itself writes
            print(leave.code, file=sys.stderr)
        return leave.code if isinstance(leave.code, int) else int(leave.code is not None)
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def _pretend(script: str) -> None:
    """Make empty outputs: all of a job, as Snakemake sees it, but the work."""
    with open(script) as stream:
        preamble, marker, _ = stream.read().partition(_END_OF_PREAMBLE)
    assert marker, "Snakemake begins its scripts differently now"
    scope: dict = {"__file__": script}
    exec(preamble, scope)  # what Snakemake says of the job
    job = scope["snakemake"]
    for output in job.output:
        with open(output, "w"):
            pass

    from burstcast_workflow.tracking import results

    making = results.Making(results.parameters_hash(job.params), {})
    for output in job.output:
        results.note(output, EMPTY, results.place_in(job.config["results"], output), making)


if __name__ == "__main__":
    serve(sys.argv[1])
