#!/usr/bin/env bash
# The corpus on many architectures: builds `umbra-selftest` for each, runs it, and compares its digests with each other and
# with src/selftest/golden.txt.
#   tests/cross.sh [--may-skip] [TARGET or group...]     groups: quick (default), ci, all, x86, prebuilt, src
#   tests/cross.sh --setup [TARGET or group...]          only gets what the targets need, `sources` those of the compiler
#   tests/cross.sh --list                                names the targets
# Prints a line a target: its name, the digest of all scenes, the compiler, the seconds to build and to run.
# Exit status 0: every target ran and agrees; 1: one failed or differs; 2: bad usage; 3: all that ran agree, but one could
# not be run (0 with --may-skip).
#
# x86-64 is built by rustup's compilers, other targets by Debian's of the oldest version we answer for, which has their
# libraries: unpacked into a folder, not installed. Foreign machines are qemu's, WebAssembly is node's, and 32-bit x86 runs
# on the machine itself. Needs Debian bookworm on amd64 with root for apt-get, and cargo; what is missing makes a skip.
# Environment: CROSS_HOME, the folder (default ~/.cache/umbra-cross); CROSS_JOBS, how many compilers at once (default: one
# a processor).
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1

debian=1.85.0+dfsg3-1~deb12u3 # of rustc-web and all that goes with it: one version for host and targets
home=${CROSS_HOME:-${XDG_CACHE_HOME:-$HOME/.cache}/umbra-cross}
outputs=$home/target
unpacked=$home/r185
jobs=${CROSS_JOBS:-$(nproc)}

# Debian has the libraries of these; those of the others are built from its sources. Checked: with overflow checks and debug
# assertions, in the profile of that name.
prebuilt="i686-unknown-linux-gnu aarch64-unknown-linux-gnu armv7-unknown-linux-gnueabihf s390x-unknown-linux-gnu
  s390x-unknown-linux-gnu/checked powerpc64le-unknown-linux-gnu"
# WebAssembly has vectors where the build says so: a module cannot ask.
from_source="riscv64gc-unknown-linux-gnu mips-unknown-linux-gnu wasm32-wasip1 wasm32-wasip1/simd128"
# stable: rustup's; nightly: if it is there; msrv: Debian's.
x86="x86_64/stable-o3 x86_64/stable-checked x86_64/stable-native x86_64/stable-parallel x86_64/nightly-o3 x86_64/msrv-o3"
quick="x86_64/stable-o3 x86_64/stable-checked i686-unknown-linux-gnu s390x-unknown-linux-gnu"
ci="mips-unknown-linux-gnu"

say() { echo "$*" >&2; }
usage() {
  sed -n '4,6p' "$0" >&2
  say "targets:" $x86 $prebuilt $from_source
  exit 2
}

# Target -> the architecture as Debian names it for libraries of Rust (none: from source), as GNU does, as qemu does, and as
# Debian does for the C library.
describe() {
  arch='' gnu='' qemu='' libc=''
  case $1 in
    aarch64-*) arch=arm64 gnu=aarch64-linux-gnu qemu=aarch64 libc=arm64 ;;
    armv7-*) arch=armhf gnu=arm-linux-gnueabihf qemu=arm libc=armhf ;;
    i686-*) arch=i386 gnu=i686-linux-gnu qemu=none libc=i386 ;;
    s390x-*) arch=s390x gnu=s390x-linux-gnu qemu=s390x libc=s390x ;;
    powerpc64le-*) arch=ppc64el gnu=powerpc64le-linux-gnu qemu=ppc64le libc=ppc64el ;;
    riscv64gc-*) gnu=riscv64-linux-gnu qemu=riscv64 libc=riscv64 ;;
    mips-*) gnu=mips-linux-gnu qemu=mips libc=mips ;;
    wasm32-wasip1*) ;;
    *) return 1 ;;
  esac
}

known() {
  case " $(echo $x86 $prebuilt $from_source) " in *" $1 "*) return 0 ;; *) return 1 ;; esac
}

is_bookworm() {
  [ "$(. /etc/os-release 2>/dev/null && echo "${VERSION_CODENAME:-}")-$(uname -m)" = bookworm-x86_64 ]
}

# Installs what is missing of these packages.
install() {
  local missing=() package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} = 0 ] && return
  if ! is_bookworm || [ "$(id -u)" != 0 ]; then
    reason="no ${missing[*]}, and no way to install it"
    return 1
  fi
  say "installing ${missing[*]}"
  local said
  if ! said=$(apt-get update -qq &&
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" 2>&1); then
    say "$said"
    reason="apt-get could not install ${missing[*]}"
    return 1
  fi
}

# Unpacks the compiler (host), its library for the architectures given, or its sources (src). apt keeps lists of its own for
# the foreign architectures: those of the system stay as they are.
unpack() {
  local packages=() wanted deb
  for wanted in "$@"; do
    [ -e "$unpacked/.$wanted" ] && continue
    case $wanted in
      host) packages+=("rustc-web=$debian" "libstd-rust-web-1.85=$debian" "libstd-rust-web-dev:amd64=$debian" libllvm19) ;;
      src) packages+=("rust-web-src=$debian") ;;
      *) packages+=("libstd-rust-web-dev:$wanted=$debian") ;;
    esac
  done
  [ ${#packages[@]} = 0 ] && return
  if ! is_bookworm; then
    reason="the compiler for it is Debian bookworm's"
    return 1
  fi
  local debs=$home/debs apt=$home/apt
  rm -rf "$debs" && mkdir -p "$debs" "$apt/lists/partial" "$apt/cache/archives/partial" "$unpacked"
  cat >"$apt/apt.conf" <<CONF
#clear APT::Architectures;
APT::Architectures { "amd64"; "arm64"; "armhf"; "i386"; "s390x"; "ppc64el"; };
Dir::State::lists "$apt/lists"; Dir::Cache "$apt/cache"; Acquire::Languages "none";
APT::Sandbox::User "root";
CONF
  say "unpacking ${packages[*]}"
  # A list that cannot be read may be one that is not needed: the download tells.
  APT_CONFIG=$apt/apt.conf apt-get update -qq >/dev/null 2>&1
  if ! (cd "$debs" && APT_CONFIG=$apt/apt.conf apt-get download -qq "${packages[@]}" >&2); then
    reason="apt-get could not download ${packages[*]}"
    return 1
  fi
  for deb in "$debs"/*.deb; do
    case $deb in
      *rust-web-src*) set -- --wildcards './usr/src/rustc-*/library*' './usr/lib/rustlib/src*' ;;
      *) set -- --exclude=./usr/share ;;
    esac
    if ! dpkg-deb --fsys-tarfile "$deb" | tar -x -C "$unpacked" "$@"; then
      reason="$deb cannot be unpacked"
      return 1
    fi
  done
  for deb in "$debs"/*.deb; do
    case $deb in
      */rustc-web_*) touch "$unpacked/.host" ;;
      */rust-web-src_*) touch "$unpacked/.src" ;;
      */libstd-rust-web-dev_*) deb=${deb%.deb} && touch "$unpacked/.${deb##*_}" ;;
    esac
  done
  rm -rf "$debs" "$apt"
  # A compiler with a new time stamp makes cargo build everything again.
  printf '#!/bin/sh\nLD_LIBRARY_PATH=%s exec %s "$@"\n' \
    "$unpacked/usr/lib/x86_64-linux-gnu" "$unpacked/usr/bin/rustc" >"$home/rustc185.new"
  chmod +x "$home/rustc185.new"
  cmp -s "$home/rustc185.new" "$home/rustc185" || mv "$home/rustc185.new" "$home/rustc185"
  rm -f "$home/rustc185.new"
}

rust_lld() { ls "$(rustc --print sysroot)"/lib/rustlib/*/bin/rust-lld 2>/dev/null | head -1; }

# Gets what a target needs; sets `reason` if it cannot be had.
provide() {
  reason=''
  case $1 in
    x86_64/stable-*) return ;;
    x86_64/nightly-*)
      rustup toolchain list 2>/dev/null | grep -q ^nightly && return
      reason="no nightly compiler is installed"
      return 1
      ;;
    x86_64/msrv-*)
      unpack host
      return
      ;;
    sources)
      unpack host src
      return
      ;;
  esac
  describe "$1"
  unpack host "${arch:-src}" || return
  if [ "${1%/*}" = wasm32-wasip1 ]; then
    command -v node >/dev/null || install nodejs || return
    install wasi-libc || return
    if [ -z "$(rust_lld)" ]; then
      reason="no rust-lld beside rustc"
      return 1
    fi
    local own=$unpacked/usr/lib/rustlib/wasm32-wasip1/lib/self-contained
    mkdir -p "$own" && cp /usr/lib/wasm32-wasi/{crt1-command.o,crt1-reactor.o,libc.a} "$own"
    return
  fi
  local packages=("gcc-${gnu/_/-}" "libc6-dev-$libc-cross")
  [ "$qemu" = none ] || packages+=(qemu-user-static)
  install "${packages[@]}"
}

# Builds for a target; the program is then `program`, run by `runner`.
build() {
  local flags=(-p umbra-selftest --bin umbra-selftest -j "$jobs") features= directory=$outputs/${1//\//-} profile=release
  local variables=() name
  runner=()
  case $1 in
    *-checked) variables+=(CARGO_PROFILE_RELEASE_OPT_LEVEL=0 CARGO_PROFILE_RELEASE_DEBUG_ASSERTIONS=true
      CARGO_PROFILE_RELEASE_OVERFLOW_CHECKS=true) ;;
    */checked) profile=checked ;;
    *-native) variables+=(RUSTFLAGS=-Ctarget-cpu=native) ;;
    *-parallel) features=parallel ;;
    */simd128) variables+=(RUSTFLAGS=-Ctarget-feature=+simd128) ;;
  esac
  program=$directory/release/umbra-selftest
  case $1 in
    x86_64/nightly-*) variables+=(RUSTUP_TOOLCHAIN=nightly) ;;
    x86_64/msrv-*) variables+=("RUSTC=$home/rustc185") ;;
    x86_64/*) ;;
    *)
      describe "$1"
      local triple=${1%/*}
      # One folder for all of them: what runs on the host is built once.
      directory=$outputs/deb185
      flags+=(--target "$triple")
      variables+=("RUSTC=$home/rustc185")
      name=CARGO_TARGET_$(echo "$triple" | tr 'a-z-' 'A-Z_')_LINKER
      program=$directory/$triple/$profile/umbra-selftest
      if [ "$triple" = wasm32-wasip1 ]; then
        variables+=("$name=$(rust_lld)")
        program+=.wasm
        runner=(node --no-warnings tests/wasi.mjs)
      elif [ "$qemu" = none ]; then
        variables+=("$name=$gnu-gcc")
        runner=("/usr/$gnu/lib/ld-linux.so.2" --library-path "/usr/$gnu/lib")
      else
        variables+=("$name=$gnu-gcc")
        runner=("qemu-$qemu-static" -L "/usr/$gnu")
      fi
      [ -n "$arch" ] || {
        variables+=(RUSTC_BOOTSTRAP=1)
        flags+=(-Zbuild-std=std,panic_abort)
      }
      ;;
  esac
  compiler=$(env -u RUSTC -u RUSTFLAGS "${variables[@]}" sh -c '"${RUSTC:-rustc}" --version' | cut -d ' ' -f 2)
  env -u RUSTC -u RUSTFLAGS -u CARGO_BUILD_TARGET "${variables[@]}" \
    cargo build --profile $profile "${flags[@]}" --locked --features "$features" --target-dir "$directory"
}

may_skip='' only_setup='' targets=()
for argument in "$@"; do
  case $argument in
    --may-skip) may_skip=1 ;;
    --setup) only_setup=1 ;;
    --list) printf '%s\n' $x86 $prebuilt $from_source && exit ;;
    quick) targets+=($quick) ;;
    ci) targets+=($ci) ;;
    all) targets+=($x86 $prebuilt $from_source) ;;
    x86) targets+=($x86) ;;
    prebuilt) targets+=($prebuilt) ;;
    src) targets+=($from_source) ;;
    sources) [ -n "$only_setup" ] || usage && targets+=("$argument") ;;
    *) known "$argument" || usage && targets+=("$argument") ;;
  esac
done
[ ${#targets[@]} -gt 0 ] || targets=($quick)

# All downloads at once, then each target by itself: what one lacks, others need not lack.
if [ ${#targets[@]} -gt 1 ] && is_bookworm; then
  wanted=() packages=()
  for target in "${targets[@]}"; do
    case $target in
      x86_64/msrv-*) wanted+=(host) ;;
      x86_64/*) ;;
      *)
        describe "$target"
        wanted+=(host "${arch:-src}")
        [ -z "$gnu" ] || packages+=("gcc-${gnu/_/-}" "libc6-dev-$libc-cross")
        [ -z "$gnu" ] || [ "$qemu" = none ] || packages+=(qemu-user-static)
        [ "${target%/*}" != wasm32-wasip1 ] || packages+=(wasi-libc)
        ;;
    esac
  done
  unpack $(printf '%s\n' "${wanted[@]}" | sort -u)
  # One after the other: where apt empties its cache after an update, as in containers, it would take away what is being
  # installed.
  install $(printf '%s\n' "${packages[@]}" | sort -u)
fi

golden=$(awk '$1 == "all" { print $3 }' src/selftest/golden.txt)
log=$(mktemp) && printed=$(mktemp)
trap 'rm -f "$log" "$printed"' EXIT
status=0 skipped=''
for target in "${targets[@]}"; do
  if ! provide "$target"; then
    echo "$target SKIPPED: $reason"
    skipped=1
    continue
  fi
  [ -z "$only_setup" ] || continue
  start=$SECONDS
  if ! build "$target" >"$log" 2>&1; then
    echo "$target FAILED: it does not build"
    tail -25 "$log" >&2
    status=1
    continue
  fi
  built=$SECONDS
  if ! "${runner[@]}" "$program" >"$printed" 2>"$log"; then
    echo "$target FAILED: the program says why"
    tail -25 "$log" >&2
    status=1
  fi
  digest=$(awk '$1 == "all" { print $3 }' "$printed")
  printf '%-32s %-16s rustc %-8s built in %3d s, ran in %3d s\n' \
    "$target" "${digest:-none}" "$compiler" $((built - start)) $((SECONDS - built))
  if [ "$digest" != "$golden" ]; then
    echo "$target DIFFERS: the golden digest is $golden; here are the scenes that do"
    diff <(grep -v '^#' src/selftest/golden.txt) "$printed"
    status=1
  fi
done
[ $status = 0 ] || exit $status
[ -z "$skipped" ] || [ -n "$may_skip" ] || exit 3
