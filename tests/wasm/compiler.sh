# For scripts to read in, at the root: gets what compiles for WebAssembly. Expects `flags`, a list of flags for cargo, and
# `libraries`, those of Rust's own that are needed; sets `target`, `outputs`, the folder of what is built, and completes the flags.
# Takes the compiler of rustup if that has the target, or Debian's as tests/cross.sh gets it; elsewhere says that it was
# skipped, and ends the script with status 3.
target=wasm32-unknown-unknown
outputs=${CARGO_TARGET_DIR:-target}/wasm

if [ ! -d "$(rustc --print sysroot)/lib/rustlib/$target" ]; then
  cross_home=${CROSS_HOME:-${XDG_CACHE_HOME:-$HOME/.cache}/umbra-cross}
  tests/cross.sh --setup --may-skip sources
  RUSTC=$cross_home/rustc185
  if [ ! -x "$RUSTC" ] || [ ! -e "$cross_home/r185/.src" ]; then
    echo "wasm: SKIPPED, no compiler for $target to be had here"
    exit 3
  fi
  CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=$(ls "$(rustc --print sysroot)"/lib/rustlib/*/bin/rust-lld)
  export RUSTC RUSTC_BOOTSTRAP=1 CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER
  flags+=("-Zbuild-std=$libraries")
  # What runs on the host is built already for the other targets.
  outputs=$cross_home/target/deb185
fi
flags+=(--target-dir "$outputs")
