# Functions that scripts/demo and scripts/test share; both source this file from the repository's root.

say() {
    printf '%s\n' "$*" >&2
}

# Finds cargo, even if no new shell was opened since rustup installed it.
need_cargo() {
    if ! command -v cargo >/dev/null && [ -f "${CARGO_HOME:-$HOME/.cargo}/env" ]; then
        . "${CARGO_HOME:-$HOME/.cargo}/env"
    fi
    if ! command -v cargo >/dev/null; then
        say "cargo was not found. Install Rust from https://rustup.rs, then run this again."
        exit 1
    fi
}

on_debian() {
    command -v apt-get >/dev/null && command -v dpkg-query >/dev/null
}

# install_missing REASON PACKAGE...: installs the Debian packages that are missing.
install_missing() {
    local reason="$1" package
    local missing=()
    shift
    for package in "$@"; do
        if [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" != installed ]; then
            missing+=("$package")
        fi
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    local sudo=()
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            say "$reason: please have an administrator run: apt-get install ${missing[*]}"
            exit 1
        fi
        sudo=(sudo)
    fi
    say "$reason: installing ${missing[*]} with apt-get"
    "${sudo[@]}" apt-get update -q >&2
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -q -y --no-install-recommends "${missing[@]}" >&2
}
