# Sourced by app/run, tests/run and the others: packages, configuring, building. Nothing here runs by itself.
# Set before sourcing: root (the checkout). Changes nothing outside the checkout but Debian packages.

say() { printf '%s\n' "$*" >&2; }
stop() {  # stop WHAT REMEDY
  say ""
  say "Stopped: $1"
  say "What to do: $2"
  exit 1
}

# What a tool would put in the home or a shared temporary folder goes below build/ instead.
keep_inside_the_tree() {
  mkdir -p "$root/build/tmp"
  export TMPDIR="$root/build/tmp"
  export CCACHE_DIR="${CCACHE_DIR:-$root/build/ccache}"
  export XDG_CACHE_HOME="$root/build/home/cache" XDG_CONFIG_HOME="$root/build/home/config" XDG_DATA_HOME="$root/build/home/data"
  mkdir -p "$XDG_CACHE_HOME" "$XDG_CONFIG_HOME" "$XDG_DATA_HOME"
}

package_names() { sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$@"; }

missing_packages() {
  local name
  while read -r name; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || echo "$name"
  done < <(package_names "$@")
}

ensure_packages() {  # ensure_packages LIST...
  command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
    stop "this is not a Debian system" "use Debian 12, or install the libraries named in packaging/packages.txt by your own means and build with: cmake --preset release && cmake --build --preset release"
  local missing as_root=""
  missing=$(missing_packages "$@" | tr '\n' ' ')
  [ -n "${missing// /}" ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || stop "packages are missing and there is no sudo: $missing" "run as root: apt-get install --no-install-recommends $missing"
    as_root="sudo"
  fi
  say "Installing packages: $missing"
  local log="$root/build/packages.log"
  mkdir -p "$root/build"
  # The lists may be empty (a fresh machine) or old: fetch them first.
  $as_root apt-get update >"$log" 2>&1 || { tail -n 5 "$log" >&2; stop "the package lists could not be fetched" "check the network and /etc/apt/sources.list; the whole output is in $log"; }
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing >>"$log" 2>&1 ||
    { tail -n 15 "$log" >&2; stop "packages could not be installed" "see $log; then run this again"; }
}

# build PRESET [CMAKE ARGUMENT...]: configure when needed, compile; quiet unless something goes wrong.
build() {
  local preset=$1 folder="$root/build/$1" log="$root/build/$1.log"
  shift
  mkdir -p "$root/build"
  # A build folder that was moved or copied with its checkout is of no use.
  if [ -f "$folder/CMakeCache.txt" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt"; then
    rm -rf "$folder"
  fi
  if [ ! -f "$folder/build.ninja" ] || [ $# -gt 0 ]; then
    say "Configuring ($preset)"
    (cd "$root" && cmake --preset "$preset" "$@") >"$log" 2>&1 || { tail -n 25 "$log" >&2; stop "the build could not be configured" "read the lines above; the whole output is in $log"; }
  fi
  say "Building ($preset)"
  (cd "$root" && cmake --build --preset "$preset" --parallel "$(jobs_for_memory)") >"$log" 2>&1 ||
    { grep -E -A 8 'error|FAILED' "$log" | head -n 60 >&2; stop "the program could not be built" "read the lines above; the whole output is in $log"; }
}

# One compiler for each core, but no more than the memory holds (the heaviest file takes about 1 GB).
jobs_for_memory() {
  local cores free_gb
  cores=$(nproc)
  free_gb=$(awk '/MemAvailable/ {print int($2 / 1500000)}' /proc/meminfo)
  [ "$free_gb" -ge 1 ] || free_gb=1
  echo $((cores < free_gb ? cores : free_gb))
}
