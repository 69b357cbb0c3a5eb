"""Runs of the program `fovea`."""
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile

from .results import read

_HERE = pathlib.Path(__file__).resolve().parent


class RunFailed(RuntimeError):
    """The program ended with another status than 0. `status` is that (README of sw/fovea), `said` what it said;
    `results` are those that it left nevertheless, complete or not, or None."""

    def __init__(self, status, said, results):
        lines = said.strip().splitlines()
        errors = [line for line in lines if line.startswith("fovea: ") and "warning" not in line]
        super().__init__((errors or lines or [f"fovea ended with status {status}"])[0])
        self.status, self.said, self.results = status, said, results


def program():
    """The program: what the environment variable FOVEA names, that of the build in this source tree, or the one of the
    PATH."""
    named = os.environ.get("FOVEA")
    built = _HERE.parents[2] / "build/release/fovea"
    found = named or (str(built) if built.is_file() else shutil.which("fovea"))
    if not found:
        raise FileNotFoundError("no program 'fovea' in the PATH; the environment variable FOVEA can name it")
    return found


def run(experiment, settings=None, *options, out=None, progress=False):
    """Runs an experiment: a file, or the name of a shipped one. Returns its Results.

    settings   values by key: {"clocks.ddr": "340MHz", "run.frames": 2}
    options    further options of `fovea run`: "--profile"
    out        folder for the results, which stay; None: a temporary folder that goes with the Results
    progress   the program shows its progress on the standard error stream
    Raises RunFailed; an interrupt (Ctrl-C) ends the program, which writes its partial results, and is raised then.
    """
    return _start("run", [str(experiment)], settings, ["--no-frames"] if out is None else [], options, out, progress)


def exec(program_file, arguments=(), settings=None, *options, out=None, progress=False):
    """Runs a program of one's own with its arguments, as `fovea exec`. What the program prints is in `printed`, its
    status in `status`. The other arguments are as of run()."""
    behind = [str(program_file), "--", *map(str, arguments)]
    return _start("exec", behind, settings, [], options, out, progress)


def replay(trace, settings=None, *options, out=None, progress=False):
    """Plays a bus trace, as `fovea replay`. The arguments are as of run()."""
    return _start("replay", [str(trace)], settings, [], options, out, progress)


def _start(command, words, settings, defaults, options, out, progress):
    kept = None
    if out is None:
        kept = tempfile.TemporaryDirectory(prefix="fovea-")
        out = pathlib.Path(kept.name) / "results"
    out = pathlib.Path(out)
    places = (out, out.with_name(out.name + ".partial"))
    before = [_written(folder) for folder in places]
    line = [program(), command, "-o", str(out), *defaults, *options]
    for key, value in (settings or {}).items():
        line += ["-s", f"{key}={str(value).lower() if isinstance(value, bool) else value}"]
    with subprocess.Popen(line + words, text=True, errors="replace", stdout=subprocess.PIPE, stdin=subprocess.DEVNULL,
                          stderr=None if progress else subprocess.PIPE) as process:
        try:
            printed, said = process.communicate()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)  # once more, where the terminal has sent it, does no harm
            process.communicate()
            raise
    # The status of `exec` is the program's own, unless there are no complete results.
    status, results = process.returncode, None
    for folder, earlier in zip(places, before):
        if results is None and _written(folder) not in (None, earlier):
            results = read(folder, partial=status != 0)
            results.printed, results.said, results.status = printed, said or "", status
            results._kept = kept  # removed with the results
    if status and not (command == "exec" and results and results.complete):
        raise RunFailed(status, said or printed, results)
    return results or read(out)


def _written(folder):
    """Tells the results in a folder from earlier ones; None: there are none."""
    file = folder / "stats.json"
    return (file.stat().st_ino, file.stat().st_mtime_ns) if file.is_file() else None
