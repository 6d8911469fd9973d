#!/usr/bin/env python3
"""Runs a scenario on several ranks: the same results, a killed and a hanging rank, resuming on another number of ranks.

usage: scenario_test.py SETTLE FOLDER, the program and a folder for its results."""
import filecmp
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

settle, folder = sys.argv[1], pathlib.Path(sys.argv[2])
options = ["--threads", "1", "--quiet"]


def run(name, ranks, *more, duration="0.2", wait=True, environment=None, spheres=1500):
    command = [settle, "--spheres", str(spheres), *options, "--duration", duration, "--ranks", str(ranks), "--out", str(folder / name), *more]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env={**os.environ, **(environment or {})})
    if not wait:
        return process
    out, error = process.communicate(timeout=300)
    assert process.returncode == 0, f"{command}: exit code {process.returncode}: {error}"
    return out


def fingerprint(name):
    return json.loads((folder / name / "summary.json").read_text())["fingerprint"]


def ranks_of(launcher):
    """Process ids of the ranks that a scenario has started, the first rank first."""
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = path.read_text().split("\0")
        except OSError:
            continue
        if words[0].endswith("settle") and str(folder) in " ".join(words) and int(path.parent.name) != launcher:
            environment = (path.parent / "environ").read_bytes()
            rank = int(environment.split(b"OMPI_COMM_WORLD_RANK=")[1].split(b"\0")[0])
            found.append((rank, int(path.parent.name)))
    return [process for _, process in sorted(found)]


def same_frames(prefix, file, ranks):
    """Whether the frames of a run are the same on one and more ranks, but where they state the folder, on_1, and the number of ranks."""
    here, there = [(folder / f"{prefix}on_{n}" / file).read_bytes() for n in (1, ranks)]
    return len(here) == len(there) and {pair for pair in zip(here, there) if pair[0] != pair[1]} <= {(1, ranks), (ord("1"), ord(str(ranks)))}


def stop_one(name, stop, ranks):
    """Stops the last rank by a signal once a checkpoint is there; all must end within a minute, with one line."""
    process = run(name, ranks, duration="20", wait=False)
    end = time.time() + 60
    while len(ranks_of(process.pid)) < ranks and time.time() < end:
        time.sleep(0.05)
    time.sleep(3)
    victims = ranks_of(process.pid)
    assert len(victims) == ranks, f"expected {ranks} ranks, found {len(victims)}"
    began = time.time()
    os.kill(victims[-1], stop)
    out, error = process.communicate(timeout=120)
    took = time.time() - began
    lines = [line for line in error.splitlines() if line.startswith(("settle", "rank"))] # not what MPI says
    print(f"{name}: exit code {process.returncode} after {took:.1f} s: {lines}")
    assert process.returncode in (3, 4) and took < 60 and len(lines) <= 2 and "--resume" in error, error
    assert not ranks_of(process.pid), "a rank is left"


shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
run("on_1", 1)
for ranks in (2, 3):
    run(f"on_{ranks}", ranks)
    assert fingerprint(f"on_{ranks}") == fingerprint("on_1"), f"other bits on {ranks} ranks"
    for file in ("settle.csv", "settle.ckpt.h5"):
        assert filecmp.cmp(folder / "on_1" / file, folder / f"on_{ranks}" / file, shallow=False), file
    assert same_frames("", "settle.vtkhdf", ranks)
# only the first rank writes
assert {path.name for path in (folder / "on_2").iterdir()} == {path.name for path in (folder / "on_1").iterdir()}

# scenarios with other parts: a membrane, a platen and time steps that change; ties, recorders, bladders and fines; an outlet that opens; a drum that begins to turn
specimen = pathlib.Path(__file__).resolve().parents[1] / "scenarios" / "small"
others = {
    "triaxial": ["--config", specimen / "specimen.cfg", "--grading", specimen / "grading.csv"],
    "ballast_box": ["--rock-scale", "2", "--width", "0.26", "--cycles", "1", "--steps-per-cycle", "1000"],
    "ballast_box dynamic": ["--model", "dynamic", "--run", "II.3", "--rock-scale", "3", "--porosity", "0.45", "--cycles", "1", "--frequency", "10", "--fouling-voxel", "0.04"],
    "long_track": ["--bays", "4", "--rock-scale", "3", "--porosity", "0.45", "--duration", "0.02", "--beds", "none"],
    "long_track mud": ["--bays", "3", "--run", "II.3", "--fouling-kind", "clay", "--fouling-voxel", "0.04", "--gap", "0.001", "--rock-scale", "3", "--porosity", "0.45", "--duration", "0.4", "--beds", "none"],
    "silo": ["--spheres", "600", "--diameter", "0.02", "--duration", "0.3", "--window", "0.05,0.2"],
    "drum": ["--small-spheres", "400", "--large-spheres", "100", "--small-radius", "0.004", "--large-radius", "0.008", "--duration", "0.05"],
}
for name, words in others.items():
    for ranks in (1, 2, 3):
        out = folder / f"{name.replace(' ', '_')}_on_{ranks}"
        command = [pathlib.Path(settle).with_name(name.split()[0]), *words, "--threads", "1", "--quiet", "--ranks", ranks, "--out", out]
        subprocess.run([str(word) for word in command], check=True, timeout=600, stdout=subprocess.DEVNULL)
    alone = folder / f"{name.replace(' ', '_')}_on_1"
    files = sorted(path.name for path in alone.iterdir() if path.name.endswith((".csv", ".ckpt.h5")))
    assert len(files) > 1, files
    for ranks in (2, 3):
        out = folder / f"{name.replace(' ', '_')}_on_{ranks}"
        assert fingerprint(out.name) == fingerprint(alone.name), f"{name}: other bits on {ranks} ranks"
        for file in files:
            assert filecmp.cmp(alone / file, out / file, shallow=False), f"{name}: {file} on {ranks} ranks"
        for file in (path.name for path in alone.glob("*.vtkhdf")):
            assert same_frames(f"{name.replace(' ', '_')}_", file, ranks), f"{name}: {file} on {ranks} ranks"
    print(f"{name}: the same bits on 1, 2 and 3 ranks, also of {', '.join(files)}")

# a track that is interrupted while its bay is made goes on from its folder
out = folder / "interrupted_bay"
track = [str(word) for word in (pathlib.Path(settle).with_name("long_track"), *others["long_track"], "--threads", "1", "--quiet", "--out", out)]
begun = subprocess.Popen(track, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
time.sleep(2)
begun.send_signal(signal.SIGINT)
assert begun.wait(60) == 130 and (out / "bay.ckpt.h5").exists()
subprocess.run([*track, "--resume", str(out)], check=True, timeout=300, stdout=subprocess.DEVNULL)
assert fingerprint(out.name) == fingerprint("long_track_on_1"), "other bits after an interruption"

# a track with mud and hanging ties goes on with another number of ranks
out = folder / "mud_resumed"
mud = [str(word) for word in (pathlib.Path(settle).with_name("long_track"), *others["long_track mud"], "--threads", "1", "--quiet", "--out", out)]
at = mud.index("--duration") + 1
subprocess.run([*mud[:at], "0.2", *mud[at + 1:], "--ranks", "2"], check=True, timeout=300, stdout=subprocess.DEVNULL)
subprocess.run([*mud, "--ranks", "3", "--resume", str(out)], check=True, timeout=300, stdout=subprocess.DEVNULL)
assert fingerprint(out.name) == fingerprint("long_track_mud_on_1"), "other bits of mud after resuming"

# a track goes on from the bay that was made for it
out = folder / "made_bay"
shutil.copytree(folder / "long_track_mud_on_1", out)
(out / "long_track.ckpt.h5").unlink()
subprocess.run([*mud[:-1], str(out), "--resume", str(out)], check=True, timeout=300, stdout=subprocess.DEVNULL)
assert fingerprint(out.name) == fingerprint("long_track_mud_on_1"), "other bits on a bay that was read"

# slabs too thin for their bodies
refused = subprocess.run([settle, "--spheres", "100", "--ranks", "4", "--out", str(folder / "thin")], capture_output=True, text=True, timeout=60)
assert refused.returncode == 2 and "expected at most" in refused.stderr, refused.stderr

# a shorter run on two ranks goes on with three
run("resumed", 2, duration="0.1")
shutil.copytree(folder / "resumed", folder / "resumed_on_1")
for name, ranks in (("resumed", 3), ("resumed_on_1", 1)):
    run(name, ranks, "--resume", str(folder / name))
    assert fingerprint(name) == fingerprint("on_1"), f"other bits after resuming on {ranks} ranks"

# a scene that is too large for the memory of one rank, and not for that of two
many = [settle, "--spheres", "300000", "--length-ratio", "4", "--threads", "1", "--quiet"]


def large(out, *more):
    return subprocess.run([*many, "--out", str(folder / out), *more], capture_output=True, text=True, timeout=300)


needed = large("none", "--duration", "0.0005", "--memory", "0.2").stderr
most = 0.7 * float(re.search(r"needs about (\S+) GiB", needed).group(1))
refused = large("none", "--duration", "0.0005", "--memory", f"{most:.3f}")
assert refused.returncode == 2 and "expected a number that fits" in refused.stderr, refused.stderr
for duration, more in (("0.0005", []), ("0.001", ["--resume", str(folder / "large")])):
    on_two = large("large", "--duration", duration, "--memory", f"{most:.3f}", "--ranks", "2", *more)
    assert on_two.returncode == 0, on_two.stderr
assert large("enough", "--duration", "0.001").returncode == 0 and fingerprint("large") == fingerprint("enough")

# one rank alone finds that it cannot write
out = folder / "gone"
process = run("gone", 2, duration="5", wait=False)
while process.poll() is None and not (out / "settle.vtkhdf").exists():
    time.sleep(0.1)
shutil.rmtree(out)
out.touch()
_, error = process.communicate(timeout=60)
assert process.returncode == 4 and "cannot write" in error, (process.returncode, error)

# the first rank's disk takes longer than any message may: the others wait for it
preload = folder / "slow_writes.so"
subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", preload, specimen.parent / "faults" / "slow_writes.c"], check=True)
began = time.time()
run("slow", 2, duration="0.02", environment={"LD_PRELOAD": str(preload), "BRIS_FIRST_SYNC_SECONDS": "50"})
run("fast", 1, duration="0.02")
took = time.time() - began
print(f"with a file that takes 50 s: {took:.0f} s")
assert took > 50 and fingerprint("slow") == fingerprint("fast")
# also within a frame
began = time.time()
run("slow_frame", 2, duration="0.0001", environment={"LD_PRELOAD": str(preload), "BRIS_FIRST_LARGE_WRITE_SECONDS": "50"}, spheres=100000)
took = time.time() - began
print(f"with a field of a frame that takes 50 s: {took:.0f} s")
assert took > 50 and (folder / "slow_frame" / "summary.json").exists()

stop_one("killed", signal.SIGKILL, 2)
stop_one("hanging", signal.SIGSTOP, 2)
wrong = subprocess.run([settle, "--ranks", "0"], capture_output=True, text=True)
assert wrong.returncode == 2, wrong
print("passed")
