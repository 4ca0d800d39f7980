"""What the tests of selective rebuilds do to the scripts of Snakemake.

Python imports this file at its start where its directory is in PYTHONPATH. Scripts are handed over
to a process that has the libraries loaded (see job_server), since these tests run thousands of
jobs, whose time is the import of libraries.
"""

import os
import sys

_is_job = "/.snakemake/scripts/tmp" in sys.orig_argv[-1]
_address = os.environ.get("BURSTCAST_TEST_JOB_SERVER")
if _is_job and _address:
    import json
    import socket

    with socket.socket(socket.AF_UNIX) as _connection:
        _connection.connect(_address)
        _request = {
            "script": sys.orig_argv[-1],
            "directory": os.getcwd(),
            "environment": dict(os.environ),
        }
        socket.send_fds(_connection, [json.dumps(_request).encode() + b"\n"], [0, 1, 2])
        _status = _connection.recv(1)
    os._exit(_status[0] if _status else 137)
