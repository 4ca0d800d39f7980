"""A Slurm of one machine for tests: no systemd, no cgroups, no database, all on the loopback.

Everything lives in one directory and is started and stopped by process id. Two places outside of it
are needed, and given back: ``/etc/slurm/slurm.conf``, since job steps lose the variable that names
another file, and munge's socket in ``/run/munge``.
"""

import os
import shutil
import signal
import socket
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

PACKAGES = ("slurmctld", "slurmd", "slurm-client", "munge")
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "srun", "scancel", "sinfo")
SLURM_CONF = Path("/etc/slurm/slurm.conf")
MUNGE_SOCKET = Path("/run/munge/munge.socket.2")

CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
# a job that is requeued waits for this long
AuthInfo=cred_expire=5
CredType=cred/munge
StateSaveLocation={directory}/state
SlurmdSpoolDir={directory}/spool
SlurmctldPidFile={directory}/run/slurmctld.pid
SlurmdPidFile={directory}/run/slurmd.pid
SlurmctldLogFile={directory}/log/slurmctld.log
SlurmdLogFile={directory}/log/slurmd.log
# without cgroups and without a database
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
MpiDefault=none
# a job that exceeds the memory that it asked for is killed: its use is sampled every second
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
JobAcctGatherParams=OverMemoryKill
# several jobs per node: cores and memory are handed out
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
DefMemPerCPU=500
ReturnToService=2
KillWait=5
# finished jobs are remembered until the test has looked at them
MinJobAge=3600
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory={memory} State=UNKNOWN
PartitionName=test Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def reason_not_to_run() -> str | None:
    """Why there cannot be a Slurm here; None where there can."""
    if os.name != "posix" or not Path("/proc/self").exists():
        return "Slurm's daemons need Linux"
    if os.geteuid() != 0:
        return "only root can start Slurm's daemons (and install them)"
    if not installed() and shutil.which("apt-get") is None:
        return "Slurm is not installed, and there is no apt-get to install it"
    if SLURM_CONF.exists() or SLURM_CONF.is_symlink():
        return f"this machine has a Slurm of its own: {SLURM_CONF} exists"
    if MUNGE_SOCKET.exists():
        return f"a munge is running on this machine: {MUNGE_SOCKET} exists"
    return None


def installed() -> bool:
    """Whether all programs are there."""
    return all(shutil.which(program) for program in PROGRAMS)


def install() -> str | None:
    """Install Debian's packages without starting them; return the reason if that fails."""
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    # where there is a systemd, packages would start their daemons; this keeps them from it
    policy = Path("/usr/sbin/policy-rc.d")
    own_policy = not policy.exists()
    if own_policy:
        policy.write_text("#!/bin/sh\nexit 101\n")
        policy.chmod(0o755)
    try:
        for command in (
            ["apt-get", "update", "-qq"],
            ["apt-get", "install", "-y", "-qq", "--no-install-recommends", *PACKAGES],
        ):
            done = subprocess.run(command, env=environment, capture_output=True, text=True)
            if done.returncode:
                return f"{' '.join(command)} failed: {done.stderr.strip()[-400:]}"
    finally:
        if own_policy:
            policy.unlink()
    return None if installed() else "Slurm's packages are installed, but its programs are not found"


@dataclass(frozen=True)
class Job:
    """A job as Slurm remembers it."""

    number: int
    state: str
    memory_mib: int
    rules: str


class OneMachineSlurm:
    """The daemons: start, look at jobs, stop.

    Parameters
    ----------
    directory
        For configuration, state and logs; short, since sockets live in it.
    cores, memory_mib
        What the one node has to give.
    """

    def __init__(self, directory: Path, cores: int, memory_mib: int) -> None:
        self._directory = directory
        self._cores = cores
        self._memory_mib = memory_mib
        self._daemons: list[tuple[str, int]] = []

    def start(self) -> None:
        """Start munge, the controller and the node, and wait until it takes jobs."""
        for name in ("run", "state", "spool", "log"):
            (self._directory / name).mkdir(parents=True, exist_ok=True)
            (self._directory / name).chmod(0o755)
        configuration = self._directory / "slurm.conf"
        configuration.write_text(
            CONFIGURATION.format(
                host=socket.gethostname().split(".")[0],
                directory=self._directory,
                cores=self._cores,
                memory=self._memory_mib,
                controller_port=_free_port(),
                node_port=_free_port(),
            )
        )
        SLURM_CONF.parent.mkdir(parents=True, exist_ok=True)
        SLURM_CONF.symlink_to(configuration)
        self._start_munge()
        self._start("slurmctld", "-c")
        self._start("slurmd")
        self._wait_for(
            lambda: "idle" in self._ask("sinfo", "--noheader", "--format=%t"), "the node"
        )

    def _start_munge(self) -> None:
        MUNGE_SOCKET.parent.mkdir(parents=True, exist_ok=True)
        MUNGE_SOCKET.parent.chmod(0o755)
        key = self._directory / "run" / "munge.key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(1024))
        self._start(
            "munged",
            f"--key-file={key}",
            f"--socket={MUNGE_SOCKET}",
            f"--pid-file={self._directory}/run/munged.pid",
            f"--log-file={self._directory}/log/munged.log",
            f"--seed-file={self._directory}/run/munged.seed",
            "--num-threads=2",
            "--force",
        )

    def _start(self, daemon: str, *arguments: str) -> None:
        done = subprocess.run([daemon, *arguments], capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{daemon} does not start: {done.stderr}\n{self.logs()}")
        pid_file = self._directory / "run" / f"{daemon}.pid"
        self._wait_for(lambda: pid_file.exists() and pid_file.read_text().strip() != "", daemon)
        self._daemons.append((daemon, int(pid_file.read_text())))

    def _wait_for(self, condition, what: str, seconds: float = 60) -> None:
        deadline = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > deadline:
                raise TimeoutError(f"{what} is not ready after {seconds} s\n{self.logs()}")
            time.sleep(0.5)

    def stop(self) -> None:
        """Cancel what runs, stop the daemons that were started here, and tidy up."""
        if self._daemons and self._daemons[-1][0] == "slurmd":
            subprocess.run(["scancel", "--user=root"], capture_output=True)
            time.sleep(1)
        for _, pid in reversed(self._daemons):
            _stop(pid)
        self._daemons.clear()
        if SLURM_CONF.is_symlink() and SLURM_CONF.readlink().parent == self._directory:
            SLURM_CONF.unlink()

    def _ask(self, *command: str) -> str:
        return subprocess.run(command, capture_output=True, text=True).stdout

    def jobs(self) -> list[Job]:
        """All jobs so far, finished ones too, in the order of submission."""
        lines = self._ask(
            *("squeue", "--noheader", "--states=all", "--sort=i", "--format=%i|%T|%m|%k")
        ).splitlines()
        jobs = []
        for line in lines:
            number, state, memory, rules = line.split("|", 3)
            jobs.append(Job(int(number), state, _mebibytes(memory), rules))
        return jobs

    def cancel(self, job: Job) -> None:
        """Kill a running job."""
        subprocess.run(["scancel", str(job.number)], check=True)

    def requeue(self, job: Job) -> None:
        """Stop a running job, and start it again under its number."""
        subprocess.run(["scontrol", "requeue", str(job.number)], check=True)

    def fail_node(self, job: Job) -> None:
        """Let the node go down under a running job, and come back."""
        node = ["scontrol", "update", f"nodename={socket.gethostname().split('.')[0]}"]
        subprocess.run([*node, "state=down", "reason=test"], check=True)
        self._wait_for(
            lambda: {other.number: other.state for other in self.jobs()}[job.number] != "RUNNING",
            "the failure",
        )
        subprocess.run([*node, "state=resume"])  # unless it has come back by itself

    def logs(self) -> str:
        """Ends of the daemons' logs."""
        return "\n".join(
            f"--- {path.name}\n" + "\n".join(path.read_text(errors="replace").splitlines()[-30:])
            for path in sorted((self._directory / "log").glob("*.log"))
        )


def _free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def _mebibytes(text: str) -> int:
    """Memory as Slurm writes it: 500M, 1.50G."""
    factor = {"K": 1 / 1024, "M": 1, "G": 1024, "T": 1024**2}[text[-1]]
    return round(float(text[:-1]) * factor)


def _stop(pid: int) -> None:
    for number, seconds in ((signal.SIGTERM, 20), (signal.SIGKILL, 5)):
        try:
            os.kill(pid, number)
        except ProcessLookupError:
            return
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            # a daemon whose parent is this very container's init may stay a zombie
            status = Path(f"/proc/{pid}/stat")
            if not status.exists() or status.read_text().rpartition(")")[2].split()[0] == "Z":
                return
            time.sleep(0.2)
