"""Whether the manifest is still the one that somebody signed with ``ssh-keygen -Y``."""

import subprocess
from pathlib import Path

from dea.audit.manifest import FILE
from dea.audit.verify import Finding
from dea.errors import InputError

SIGNATURE = FILE.with_name(f"{FILE.name}.sig")
NAMESPACE = "dea-study"


def signer(signers: Path) -> str:
    """Return who signed the manifest, one of the file ``signers`` (format of ``ssh-keygen``).

    Raises
    ------
    InputError
        If there is no signature or no file ``signers``, or nobody of it made it for any file.
    """
    if not SIGNATURE.exists():
        remedy = "Sign it with `make sign KEY=…`, or leave SIGNERS away"
        raise InputError("there is no signature", file=SIGNATURE, remedy=remedy)
    if not signers.is_file():
        raise InputError(
            f"there is no file {str(signers)!r}",
            field="SIGNERS",
            remedy="Name a file of lines NAME ssh-ed25519 AAAA…",
        )
    found = _keygen("find-principals", "-s", str(SIGNATURE), "-f", str(signers))
    names = found.stdout.splitlines()  # a name in quotes may hold blanks
    if found.returncode or not names:
        raise InputError(
            f"nobody in {signers} made it",
            file=SIGNATURE,
            remedy="Name the signer and the public key there: NAME ssh-ed25519 AAAA…",
        )
    return names[0]


def unsigned(signers: Path) -> list[Finding]:
    """Return a finding where the manifest is not the one that its signer signed.

    Raises
    ------
    InputError
        As :func:`signer`.
    """
    name = signer(signers)
    checked = _keygen(
        "verify", "-f", str(signers), "-I", name, "-n", NAMESPACE, "-s", str(SIGNATURE),
        text=FILE.read_text(encoding="utf-8"),
    )  # fmt: skip
    return [Finding(str(FILE), f"is not what {name} signed")] if checked.returncode else []


def _keygen(action: str, *options: str, text: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["ssh-keygen", "-Y", action, *options],
        input=text,
        capture_output=True,
        text=True,
        check=False,
    )
