"""Chooses the LLVM library that Dr.Jit compiles Mitsuba's kernels with, before either of them is loaded.

Left alone, Dr.Jit takes the first `libLLVM.so` that the system finds. With LLVM 15 and 16 (Debian's Mesa brings 15)
Dr.Jit 1.5 then ends the whole process at the first kernel that takes a minimum ("Cannot select: fminimum"), which no
`except` can catch. So each candidate has to compile such a kernel in a process of its own first.
"""

from __future__ import annotations

import contextlib
import functools
import glob
import importlib.metadata
import json
import os
import re
import site
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from scenes.errors import InputError
from scenes.replacing import replacing

VARIABLE = "DRJIT_LIBLLVM_PATH"  # where Dr.Jit itself looks first

_TIMEOUT = 30.0  # s; a probe takes 0.2 s, so this only ends one that hangs
_NAME = re.compile(r"libLLVM(?:-(\d+)[\d.]*)?\.so(?:\.(\d+))?[\d.]*")  # libLLVM-15.so.1, libLLVM.so.19.1, libLLVM.so

# The minimum is what LLVM 15 and 16 abort on; an abort is an answer here, so it leaves no core file.
_PROBE = """
import resource
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
import drjit as dr
from drjit.llvm import Float
y = dr.maximum(dr.minimum(dr.arange(Float, 16), 3.0), 1.0)
assert (y[0], y[15]) == (1.0, 3.0)
print("LLVM", ".".join(map(str, dr.detail.llvm_version())))
"""


@dataclass(frozen=True)
class Llvm:
    """An LLVM library that Dr.Jit works with."""

    path: str
    version: str


@dataclass(frozen=True)
class Rejected:
    """An LLVM library that was passed over; `reason` continues a sentence that begins with its path."""

    path: str
    reason: str


@dataclass(frozen=True)
class LlvmChoice:
    """The library to use, if there is one, and those tried before it.

    `asked_for` is what the user had put into DRJIT_LIBLLVM_PATH. It is tried first: if it was passed over, it is
    `rejected[0]`.
    """

    usable: Llvm | None
    rejected: tuple[Rejected, ...]
    asked_for: str | None = None


@functools.cache
def choose_llvm() -> LlvmChoice:
    """Find the first LLVM library that Dr.Jit works with.

    Tried in order: DRJIT_LIBLLVM_PATH, the system's libraries from the newest version down, and the library of the
    wheel `karellen-llvm-core` where that is installed.

    Returns
    -------
    LlvmChoice
        `usable` is None where no library passes; Mitsuba's `llvm_*` variants must not be used then.
    """
    asked_for = os.environ.get(VARIABLE) or None
    rejected: list[Rejected] = []
    for path in _candidates(asked_for):
        result = _remembered(path) or _probe(path)
        if isinstance(result, Llvm):
            _remember(result)
            return LlvmChoice(result, tuple(rejected), asked_for)
        rejected.append(result)
    return LlvmChoice(None, tuple(rejected), asked_for)


def prepare() -> LlvmChoice:
    """Choose the library and make Dr.Jit use it; to be called before `drjit` or `mitsuba` is imported.

    Raises
    ------
    RuntimeError
        If `drjit` is imported already and may have settled on another library.
    """
    choice = choose_llvm()
    if choice.usable is not None and os.environ.get(VARIABLE) != choice.usable.path:
        if "drjit" in sys.modules:
            raise RuntimeError("scenes.llvm.prepare() has to be called before drjit is imported")
        os.environ[VARIABLE] = choice.usable.path
    return choice


def _candidates(asked_for: str | None) -> list[str]:
    """List the libraries to try, best first, each once whatever names it has."""
    folders = ["/usr/lib/*", "/usr/lib/llvm*/lib*", "/usr/lib64", "/usr/lib64/llvm*/lib*", "/usr/local/lib"]
    system = [path for folder in folders for path in glob.glob(f"{folder}/libLLVM*.so*")] + _known_to_loader()
    wheel = [path for root in (sys.prefix, site.getuserbase()) for path in glob.glob(f"{root}/lib/libLLVM*.so*")]
    paths = [asked_for] if asked_for else []
    for group in (system, wheel):
        real = {os.path.realpath(path) for path in group if _NAME.fullmatch(os.path.basename(path))}
        paths += sorted(real, key=lambda path: (-_major(path), path))
    return list(dict.fromkeys(paths))


def _known_to_loader() -> list[str]:
    """List the LLVM libraries that the dynamic loader finds by name, wherever they lie."""
    for ldconfig in ("/sbin/ldconfig", "ldconfig"):  # an ordinary user's PATH may lack /sbin
        with contextlib.suppress(OSError):
            listing = subprocess.run([ldconfig, "-p"], capture_output=True, text=True, check=False).stdout
            return re.findall(r"=> (/\S*/libLLVM\S*)$", listing, flags=re.MULTILINE)
    return []


def _major(path: str) -> int:
    """Read the major version off a library's file name; 0 where the name does not say."""
    match = _NAME.fullmatch(os.path.basename(path))
    return int(match[1] or match[2] or 0) if match else 0


def _probe(path: str) -> Llvm | Rejected:
    """Compile and run a small kernel with the library at `path`, in a process that may die of it."""
    if "/" in path and not os.path.exists(path):  # without a slash it is a name for the dynamic loader
        return Rejected(path, "does not exist")
    # -P: a file of the working directory named like a module must not be imported in its place
    command = [sys.executable, "-P", "-c", _PROBE]
    environment = {**os.environ, VARIABLE: path}
    try:
        run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=_TIMEOUT, check=False)
    except subprocess.TimeoutExpired:
        return Rejected(path, f"does not answer within {_TIMEOUT:.0f} s")
    version = re.search(r"^LLVM ([\d.]+)$", run.stdout, flags=re.MULTILINE)
    if run.returncode == 0 and version:
        return Llvm(path, version[1])
    if missing := re.search(r"^(?:ImportError|ModuleNotFoundError): (.*)$", run.stderr, flags=re.MULTILINE):
        return Rejected(path, f"cannot be tried, as drjit does not load ({missing[1]})")
    known = f" (LLVM {_major(path)})" if _major(path) else ""
    if run.returncode < 0:
        return Rejected(path, f"aborts Dr.Jit's process{known}")
    return Rejected(path, f"is too old for Dr.Jit{known}" if "too old" in run.stderr else "cannot be loaded")


def _memory() -> Path:
    """Name the file that remembers the last library that passed, so that the next start need not probe it."""
    return Path(platformdirs.user_cache_dir("airlight"), "llvm.json")


def _key(path: str) -> list[str | int] | None:
    """Collect what a remembered answer depends on; None where `path` is no file whose change would be seen."""
    try:
        stat = os.stat(path)
    except OSError:
        return None
    return [os.path.abspath(path), stat.st_size, stat.st_mtime_ns, importlib.metadata.version("drjit"), sys.executable]


def _remembered(path: str) -> Llvm | None:
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError):  # missing or damaged: the probe answers
        entry = json.loads(_memory().read_text(encoding="utf-8"))
        if entry["key"] == _key(path):
            return Llvm(path, str(entry["version"]))
    return None


def _remember(llvm: Llvm) -> None:
    key = _key(llvm.path)
    if key is None or _remembered(llvm.path) == llvm:
        return
    with contextlib.suppress(InputError, OSError):  # a home that cannot be written only costs the probe each time
        _memory().parent.mkdir(parents=True, exist_ok=True)
        with replacing(_memory()) as beside:
            beside.write_text(json.dumps({"key": key, "version": llvm.version}), encoding="utf-8")
