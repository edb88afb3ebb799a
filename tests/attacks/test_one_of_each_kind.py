"""One attack of each kind, graded on this machine, at the best level that it gives.

All are tried in containers, at every level (test_attacks). These would hurt nobody if they
succeeded, and are found out by canaries: secrets in a home and in the environment, and listeners.
"""

import json
import os
import socket
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

from grader.run.processes import levels
from tests.attacks import handed_in
from tests.attacks.attacks import ATTACKS, EXERCISES, KINDS, LEVELS
from tests.attacks.observing import achieved

ROOT = Path(__file__).parents[2]
ONE_OF_EACH = (
    *("has_privileges", "kills_the_simulator", "lies_about_itself"),
    *("looks_at_processes", "many_threads_and_files", "misuses_the_link", "passes_on_a_message"),
    *("reaches_services", "reads_environment", "reads_home", "turns_on_the_spot"),
)
#: What holds a secret, or leads to one, on some system: by its documentation.
TOKENS = (
    *("GITHUB_TOKEN", "GH_TOKEN", "ACTIONS_RUNTIME_TOKEN", "ACTIONS_ID_TOKEN_REQUEST_TOKEN"),
    *("GITHUB_ENV", "GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY", "GITHUB_PATH"),
    *("CI_JOB_TOKEN", "CI_REGISTRY_PASSWORD", "CI_DEPLOY_PASSWORD", "CI_JOB_JWT_V2"),
    *("AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN", "AWS_CONTAINER_CREDENTIALS_RELATIVE_URI"),
    *("AZURE_CLIENT_SECRET", "GOOGLE_APPLICATION_CREDENTIALS", "KUBECONFIG", "DOCKER_AUTH_CONFIG"),
    *("SSH_AUTH_SOCK", "SSH_PRIVATE_KEY", "NETRC", "PIP_INDEX_URL", "TWINE_PASSWORD", "NPM_TOKEN"),
    *("SUBMISSION_ID", "GRADESCOPE_TOKEN", "CANVAS_TOKEN", "A_VARIABLE_THAT_NOBODY_KNOWS"),
    *("ROS_TOKEN", "PYTHON_TOKEN", "LC_TOKEN", "AMENT_TOKEN", "LANG_TOKEN", "GRADER_TOKEN"),
)
SECRET = "CANARY-environment-0f3a"


@pytest.fixture
def listeners():
    """Services of this machine, by the name that attacks know their address by."""
    name = f"\0service-{os.getpid()}"
    with ExitStack() as stack:
        tcp = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
        unix = stack.enter_context(socket.socket(socket.AF_UNIX))
        unix.bind(name)
        unix.listen()
        yield {"TCP": tcp, "ABSTRACT": unix}


def test_of_each_kind_there_is_one():
    assert {ATTACKS[name].kind for name in ONE_OF_EACH} == {*KINDS}


@pytest.mark.parametrize(
    "name",
    [name for name in ONE_OF_EACH if levels.here().level in LEVELS[ATTACKS[name].stopped_by]],
)
def test_it_gains_nothing(name, tmp_path, listeners):
    attack, home, out = ATTACKS[name], tmp_path / "home", tmp_path / "out"
    (home / ".ssh").mkdir(parents=True)
    for file in (".netrc", ".ssh/id_ed25519", "notes.txt"):
        (home / file).write_text(SECRET)
    (tmp_path / "exercise.yaml").write_text(
        f"exercise: turtlesim_challenge\n{EXERCISES[attack.exercise]}"
    )
    known = {
        **{"HOME": str(home), "TEMP": "/tmp", "UID": os.getuid(), "ADDRESS": "127.0.0.1"},
        **{"TCP": listeners["TCP"].getsockname()[1], "UDP": 9, "UNIX": str(home / "none")},
        "ABSTRACT": listeners["ABSTRACT"].getsockname()[1:].decode(),
    }
    submission = getattr(handed_in, attack.make)(tmp_path / "attacker", attack.program, known)
    words = ["run", submission, "--exercise", tmp_path / "exercise.yaml", "--out", out]
    done = subprocess.run(
        [sys.executable, "-m", "grader", *map(str, words)],
        cwd=ROOT,
        env=os.environ | dict.fromkeys(TOKENS, SECRET) | {"HOME": str(home)},
        capture_output=True,
        check=False,
    )
    said = done.stdout + done.stderr
    said += b"\n".join(path.read_bytes() for path in out.rglob("*") if path.is_file())
    assert done.returncode in attack.codes, said
    assert achieved(said) == []
    assert SECRET.encode() not in said
    assert b"\033" not in done.stdout + done.stderr
    for listener in listeners.values():
        listener.setblocking(False)
        with pytest.raises(BlockingIOError):
            listener.accept()
    if done.returncode == 0:
        result = json.loads((out / "result.json").read_text())
        assert result["score"] <= attack.most
        passed = {each["check"] for each in result["verdicts"] if each["status"] == "passed"}
        assert not passed & set(attack.lacks)
        assert attack.outcome in ("", result["run"]["outcome"])
