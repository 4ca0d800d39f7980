"""Run Python scripts in forks of a process that has the libraries loaded.

Modules of the project are not loaded here: each script imports them anew from its own
working copy.
"""

import hashlib
import json
import os
import runpy
import signal
import socket
import sys
import traceback

# what scripts and Snakemake import, without the project's modules
import jinja2
import llvmlite.binding
import matplotlib.backends.backend_agg
import matplotlib.backends.backend_pdf
import matplotlib.figure
import matplotlib.tri
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
import snakemake.cli
import snakemake.dag
import snakemake.report.html_reporter
import snakemake.scheduling.job_scheduler
import snakemake.script
import snakemake.storage
import snakemake.workflow

_END_OF_PREAMBLE = "######## snakemake preamble end #########"
EMPTY = hashlib.sha256().hexdigest()
LOADED = (jinja2, llvmlite, matplotlib, netCDF4, numpy, pandas, scipy, skimage, sklearn, skopt)

_savefig = matplotlib.figure.Figure.savefig


def _as_drawn(figure: matplotlib.figure.Figure, buffer: object, **keywords: object) -> None:
    """Write a picture without its layout, and no PDF: both take most of the time of a figure.

    Tests of figures have them.
    """
    if keywords["format"] == "pdf":
        buffer.write(b"%PDF")
    else:
        figure.set_layout_engine("none")
        _savefig(figure, buffer, **keywords)


matplotlib.figure.Figure.savefig = _as_drawn


def serve(address: str) -> None:
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the forks
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(address)
        listener.listen(64)
        print("ready", flush=True)
        while True:
            connection, _ = listener.accept()
            if os.fork() == 0:
                listener.close()
                _handle(connection)
            connection.close()


def _handle(connection: socket.socket) -> None:
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    text, descriptors, _, _ = socket.recv_fds(connection, 2**16, 3)
    while not text.endswith(b"\n"):
        text += connection.recv(2**16)
    request = json.loads(text)
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
    connection.send(bytes([status]))
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

    from burstcast_workflow.tracking.results import note

    for output in job.output:
        note(output, EMPTY)


if __name__ == "__main__":
    serve(sys.argv[1])
