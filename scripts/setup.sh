#!/usr/bin/env bash
# Makes everything that airlight needs, and nothing twice: the virtual environment .venv, OpenGL without a window
# (Mesa's software renderer where there is no other) and an LLVM that Dr.Jit works with. `make run` and `make test`
# call it each time; when there is nothing to do it takes some milliseconds.
#   scripts/setup.sh --check                   looks again at everything, also where an earlier call finished
#   PYTHON=/path/to/python scripts/setup.sh    makes .venv with that Python instead of the first one on PATH
set -euo pipefail
cd -P "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf 'setup: %s\n' "$*"; }
die() { printf 'setup: %s\n' "$*" >&2; exit 2; }

# The stamp says how far an earlier call came: no stamp, and .venv is unfinished; "packages", and they are all in it;
# the digest, and all is done. It names this folder too, as a .venv that was moved along with it no longer works.
stamp=.venv/.airlight-setup
digest=$(cat requirements.lock pyproject.toml scripts/setup.sh | sha256sum | cut -d ' ' -f 1)
reached=$([[ -x .venv/bin/python ]] && cat $stamp 2>/dev/null) || reached=
[[ $reached != "$digest $PWD" || ${1:-} == --check ]] || exit 0

# What is missing is found by trying it, so that nothing is installed where, say, a vendor's driver or LLVM 20 works.
drjit_loads() { .venv/bin/python -c 'import drjit'; }
gl_works() { .venv/bin/python -c 'import moderngl; moderngl.create_context(430, standalone=True, backend="egl")'; }
llvm_works() { .venv/bin/python -c 'from scenes.llvm import choose_llvm; raise SystemExit(not choose_llvm().usable)'; }

has_apt() { command -v apt-get >/dev/null && grep -qsiE '^ID(_LIKE)?=.*(debian|ubuntu)' /etc/os-release; }

as_root() { if ((EUID == 0)); then "$@"; else sudo "$@"; fi; }

lists_updated=
apt_update() {  # a new machine's package lists are missing or old; once is enough
    [[ -z $lists_updated ]] || return 0
    ((EUID == 0)) || command -v sudo >/dev/null || die "not root, and no sudo to install Debian packages with: $*"
    as_root apt-get update -qq || die "apt-get update failed: no network, or sudo refused"
    lists_updated=yes
}

apt_install() {
    apt_update "$@"
    say "installing Debian packages: $*"
    as_root env DEBIAN_FRONTEND=noninteractive DEBCONF_NOWARNINGS=yes apt-get install -y -qq --no-install-recommends \
        -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@" >/dev/null || die "apt-get install $* failed"
}

find_python() {
    local name names=(python3 python3.13 python3.12 python3.11)
    [[ -z ${PYTHON:-} ]] || names=("$PYTHON")
    for name in "${names[@]}"; do
        # Asked to run, not only looked up: pyenv leaves names on PATH for versions that it cannot start.
        if "$name" -c 'import sys; exit(not (3, 11) <= sys.version_info < (3, 14))' 2>/dev/null; then
            command -v "$name"
            return
        fi
    done
    return 1
}

make_venv() {
    local python version
    python=$(find_python) ||
        die "no Python 3.11 to 3.13 (tried ${PYTHON:-python3, python3.13, .12, .11}); name one: PYTHON=/path/to/python"
    version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then  # Debian keeps ensurepip in a package of its own
        has_apt || die "$python lacks ensurepip; install the package that has Python $version's venv module"
        apt_install "python$version-venv"
    fi
    say "making .venv with $python (Python $version)"
    rm -rf .venv  # unfinished, or of another folder
    "$python" -m venv .venv || die "$python -m venv .venv failed"
}

pip_install() { .venv/bin/python -m pip install -q --disable-pip-version-check "$@"; }

[[ $reached == *" $PWD" ]] || make_venv
say "installing the packages of requirements.lock"
rm -f $stamp  # a call that is interrupted while pip works leaves an unfinished .venv
pip_install --require-hashes -r requirements.lock || die "pip could not install requirements.lock; is the network up?"
echo "packages $PWD" >$stamp
pip_install --no-deps --no-build-isolation -e . || die "pip could not install airlight itself"

if ! drjit_loads 2>/dev/null && has_apt; then
    apt_install libatomic1  # linked to by Dr.Jit's and Mitsuba's wheels, but not in them
fi
reason=$(drjit_loads 2>&1) || die "Dr.Jit does not load ($(grep -m 1 ^ImportError <<<"$reason")); install that library"

if ! gl_works 2>/dev/null && has_apt; then
    apt_install libegl1 libgl1 libgl1-mesa-dri
fi
reason=$(gl_works 2>&1) || die "OpenGL 4.3 through EGL does not work (${reason##*$'\n'}). Install libEGL.so.1, \
libGL.so.1 and a driver (Mesa's llvmpipe needs no graphics card): Debian's libegl1, libgl1 and libgl1-mesa-dri, \
Fedora's libglvnd-egl, libglvnd-glx and mesa-dri-drivers, Arch's libglvnd and mesa"

if ! llvm_works && has_apt; then
    apt_update libllvm19
    for version in 19 20 18 17; do  # 19 is Debian 12's newest; 15 and 16 would end the process
        apt-cache show "libllvm$version" >/dev/null 2>&1 || continue
        apt_install "libllvm$version"
        llvm_works && break
    done
fi
llvm_works || say "found no LLVM that Dr.Jit works with, so references will be slow (Mitsuba's scalar_rgb). Install \
LLVM 17 or newer (the package llvm-libs of Fedora and Arch), or: .venv/bin/pip install karellen-llvm-core"

echo "$digest $PWD" >$stamp
say "done"
