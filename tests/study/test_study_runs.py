"""Studies as they are run: killed and begun again, by two at once, on a cluster; the same bytes in the end."""

import csv
import io
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from studies import FEW, MANY, halted, laid, ran, results, surroundings

from drivesizer import cli
from drivesizer.study import run as study_run
from drivesizer.study import store
from drivesizer.study.store import locked

WAIT = 120.0  # s, for a process to come so far


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A study of 500 variants by one process without interruption: its folder's files."""
    folder = tmp_path_factory.mktemp("whole")
    laid(folder, MANY)
    done = ran(folder, "--processes", 1)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""  # no bar where no person looks
    assert done.stdout.startswith("500 variants: ")
    return results(folder / "study")


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """A study of 54 variants in this process: its folder's files."""
    folder = tmp_path_factory.mktemp("table")
    laid(folder, MANY.replace("steps: 25", "steps: 9").replace("steps: 20", "steps: 6"))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(sys, "argv", ["drivesizer", "study", "--processes", "1"])
        with pytest.raises(SystemExit) as end:
            cli.main()
    assert end.value.code == 0
    return results(folder / "study")


@pytest.fixture
def run(run, monkeypatch, tmp_path):
    """Run the command in an empty folder; its status, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    return partial(run, "study", "--processes", 1)


def until(condition, *, every=0.02):
    """Wait until something is so."""
    end = time.monotonic() + WAIT
    while not condition():
        assert time.monotonic() < end, "it never came so far"
        time.sleep(every)


def kept(folder):
    """The lines that a study has kept."""
    path = folder / "study" / "rows.jsonl"
    return path.read_bytes().splitlines(keepends=True) if path.exists() else []


def rows(data):
    return list(csv.DictReader(io.StringIO(data.decode())))


# --- tables -----------------------------------------------------------------------------------------------------------


def test_the_table_has_every_variant_in_order(table):
    found = rows(table["results.csv"])
    assert [int(row["variant"]) for row in found] == list(range(1, 55))
    masses = [20.0 + 70.0 * n / 8 for n in range(9)]
    assert [float(row["load.mass (kg)"]) for row in found] == pytest.approx([m for m in masses for _ in range(6)])
    assert {row["status"] for row in found} == {"pass", "fail"}
    for row in found:
        assert bool(row["set"]) == (row["status"] == "pass") == bool(row["mass_kg"])
        assert (float(row["smallest_margin"]) >= 0.0) == (row["status"] == "pass")
        assert bool(row["nearest_miss"]) == (row["status"] == "fail")


def test_heavier_is_never_easier(table):
    """A drive that fails with some mass fails with any larger one: more mass needs more of everything."""
    found = rows(table["results.csv"])
    for speed in {row["motion.speed (m/s)"] for row in found}:
        line = [row["status"] for row in found if row["motion.speed (m/s)"] == speed]
        assert line == sorted(line, reverse=True)  # pass before fail


def test_parquet_has_the_same_rows_with_their_types_and_units(table):
    parquet = pytest.importorskip("pyarrow.parquet")
    read = parquet.read_table(io.BytesIO(table["results.parquet"]))
    text = rows(table["results.csv"])
    assert read.column_names == list(text[0])
    assert read.schema.field("load.mass (kg)").metadata == {b"unit": b"kg"}
    kinds = {name: str(read.schema.field(name).type) for name in ("variant", "mass_kg", "status", "sets_examined")}
    assert kinds == {"variant": "int64", "mass_kg": "double", "status": "string", "sets_examined": "int64"}
    for ours, theirs in zip(read.to_pylist(), text, strict=True):
        assert {k: "" if v is None else str(v) for k, v in ours.items()} == theirs


def test_maps_are_there(table):
    names = {name for name in table if name.startswith("maps/")}
    expected = ("best_set", "mass", "price", "smallest_margin")
    assert names == {f"maps/{name}.{form}" for name in expected for form in ("svg", "png")}


# --- the same bytes, whatever happens ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_study_that_was_killed_goes_on_and_ends_the_same(whole, tmp_path):
    """Killed without warning in the middle, two lines damaged after that and the last torn, then by two processes."""
    laid(tmp_path, MANY)
    first = subprocess.Popen(halted(20, "--processes", 2), cwd=tmp_path, env=surroundings(), start_new_session=True)
    until(lambda: len(kept(tmp_path)) >= 20)
    os.kill(first.pid, signal.SIGKILL)
    first.wait()
    until(lambda: not _group(first.pid), every=0.2)  # its workers end as well
    lines = kept(tmp_path)
    assert not (tmp_path / "study" / "results.csv").exists()
    lines[3] = lines[3][:-40] + b"\n"
    lines[5] = lines[5].replace(b'"', b"'")
    lines[-1] = lines[-1][:-20]
    (tmp_path / "study" / "rows.jsonl").write_bytes(b"".join(lines))
    again = ran(tmp_path, "--processes", 2, "--no-maps")
    assert (again.returncode, again.stderr) == (0, "")
    after = kept(tmp_path)
    assert after[: len(lines) - 1] == lines[:-1] and len(after) == 500 + 3  # nothing else was computed twice
    assert results(tmp_path / "study") == without_maps(whole)


@pytest.mark.slow
def test_ctrl_c_stops_the_study_and_its_processes(tmp_path):
    laid(tmp_path, MANY)
    with subprocess.Popen(
        halted(2, "--processes", 2), cwd=tmp_path, env=surroundings(), start_new_session=True, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, encoding="utf-8",
    ) as study:  # fmt: skip
        until(lambda: len(kept(tmp_path)) >= 2)
        os.kill(study.pid, signal.SIGINT)
        out, err = study.communicate(timeout=WAIT)
    assert (study.returncode, out) == (130, "")
    assert err == "drivesizer: study: stopped; results so far are kept, and the same command resumes\n"
    until(lambda: not _group(study.pid), every=0.2)


def _group(leader):
    """The processes of a group that still are, those aside that have ended."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, group = path.read_text().rpartition(")")[2].split()[:3]
        except OSError:
            continue
        if int(group) == leader and state != "Z":
            found.append(path)
    return found


CLUSTER = """
import sys
from distributed import LocalCluster
if __name__ == "__main__":
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0")
    print(cluster.scheduler_address, *(nanny.pid for nanny in cluster.workers.values()), flush=True)
    sys.stdin.read()
    cluster.close()
"""


@pytest.fixture
def cluster(tmp_path):
    """Address of a Dask scheduler of two workers, and the number of each one's process."""
    pytest.importorskip("distributed")
    (tmp_path / "cluster.py").write_text(CLUSTER)
    with subprocess.Popen(
        [sys.executable, "cluster.py"], cwd=tmp_path, env=surroundings(), stdin=subprocess.PIPE,
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, encoding="utf-8",
    ) as running:  # fmt: skip
        yield running.stdout.readline().split()
        running.stdin.close()


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_gives_the_same(whole, cluster, tmp_path):
    """Two workers of a Dask scheduler, one of them killed in the middle."""
    laid(tmp_path, MANY)
    address, worker, _ = cluster
    with subprocess.Popen(
        halted(20, "--scheduler", address, "--no-maps"), cwd=tmp_path, env=surroundings(), stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, encoding="utf-8",
    ) as study:  # fmt: skip
        until(lambda: len(kept(tmp_path)) >= 20)
        os.kill(int(worker), signal.SIGKILL)
        (tmp_path / "go").touch()
        _, err = study.communicate(timeout=WAIT)
    assert (study.returncode, err) == (0, "")
    assert results(tmp_path / "study") == without_maps(whole)


def as_one(folder):
    """All chunks of a study, read as one table."""
    parquet = pytest.importorskip("pyarrow.parquet")
    return parquet.read_table(folder / "study" / "chunks")


def test_chunks_that_workers_wrote_are_the_table(table, run, tmp_path):
    """By two workers; a chunk is lost, one is half written, and the study goes on."""
    parquet = pytest.importorskip("pyarrow.parquet")
    laid(tmp_path, MANY.replace("steps: 25", "steps: 9").replace("steps: 20", "steps: 6"))
    words = "--chunks", "--no-maps", "--processes", 2
    assert run(*words)[0] == 0
    chunks = sorted((tmp_path / "study" / "chunks").iterdir())
    (tmp_path / "study" / "chunks" / f"{chunks[3].name}.part").write_bytes(chunks[3].read_bytes()[:100])
    chunks[3].unlink()
    times = [path.stat().st_mtime_ns for path in (chunks[0], chunks[-1])]
    status, out, err = run(*words)
    assert (status, err) == (0, "") and out.endswith(f"study{os.sep}chunks\n")
    assert sorted((tmp_path / "study" / "chunks").iterdir()) == chunks
    assert [path.stat().st_mtime_ns for path in (chunks[0], chunks[-1])] == times  # nothing else was computed again
    assert not (tmp_path / "study" / "rows.jsonl").exists()
    assert as_one(tmp_path).equals(parquet.read_table(io.BytesIO(table["results.parquet"])))
    status, out, err = run("--no-maps")
    assert (status, out, err.count("\n")) == (2, "", 1) and "with --chunks or without" in err


def test_chunks_without_pyarrow_are_one_line(run, tmp_path, monkeypatch):
    monkeypatch.setattr(store, "has_parquet", lambda: False)
    laid(tmp_path, FEW)
    status, out, err = run("--chunks")
    assert (status, out, err) == (2, "", "drivesizer: --chunks needs pyarrow; install drivesizer[study]\n")


@pytest.mark.slow
def test_chunks_of_a_cluster_are_the_table(whole, cluster, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    laid(tmp_path, MANY)
    done = ran(tmp_path, "--scheduler", cluster[0], "--no-maps", "--chunks")
    assert (done.returncode, done.stderr) == (0, "")
    assert as_one(tmp_path).equals(parquet.read_table(io.BytesIO(whole["results.parquet"])))


def without_maps(files):
    return {name: content for name, content in files.items() if not name.startswith("maps/")}


@pytest.mark.parametrize(
    ("address", "said"),
    [("tcp://127.0.0.1:9", "does not answer"), ("nonsense://x", "unknown address scheme"), ("here", "does not answer")],
)
def test_a_scheduler_that_is_not_there_is_one_line_within_seconds(run, tmp_path, monkeypatch, address, said):
    pytest.importorskip("distributed")
    laid(tmp_path, FEW)
    assert study_run._PATIENCE <= 10.0  # s; here less of it: a port that nobody has is tried for as long
    monkeypatch.setattr(study_run, "_PATIENCE", 1.0)
    start = time.monotonic()
    status, out, err = run("--scheduler", address)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert said in err and "e.g. tcp://10.0.0.5:8786" in err
    assert time.monotonic() - start < 30.0  # not a measure: that it does not wait for minutes
    assert not (tmp_path / "study").exists()


# --- one at a time, and one study a folder ----------------------------------------------------------------------------


@pytest.mark.slow
def test_a_second_process_is_refused(run, tmp_path):
    laid(tmp_path, FEW)
    (tmp_path / "study").mkdir()
    with locked(tmp_path / "study"):
        status, out, err = run()
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"drivesizer: study: process {os.getpid()} on " in err
    assert "is at work on this study; wait until it is done, or choose another folder with -o" in err
    assert run("--no-maps")[0] == 0  # the lock that it leaves behind is free


@pytest.mark.parametrize("name", ["study.json", "results.csv"])
def test_a_fresh_beginning_takes_away_no_input(name, run, tmp_path):
    """The study itself lies in its folder, under a name that its results have; nothing else is taken away either."""
    laid(tmp_path, FEW)
    folder = tmp_path / "kept"
    (folder / "maps").mkdir(parents=True)
    (folder / name).write_text(FEW.replace("robot.yaml", "../robot.yaml"))
    (folder / "maps" / "of_before.svg").write_text("<svg/>")
    before = {path: path.read_bytes() for path in folder.rglob("*.*")}
    status, out, err = run(folder / name, "-o", folder, "--no-maps", "--fresh")
    assert (status, out) == (2, "")
    assert (
        err == f"drivesizer: {folder / name}: cannot be removed, it is read in the same run; expected another folder\n"
    )
    assert {path: path.read_bytes() for path in before} == before


def test_a_study_without_a_passing_drive_is_status_1(run, tmp_path):
    laid(tmp_path, "spec: robot.yaml\nvary: {load.mass: [450 kg, -5 kg]}\n")
    status, out, err = run()
    assert (status, err) == (1, "")
    assert out.splitlines()[0] == "2 variants: 1 fail, 1 error; 18 drives examined"
