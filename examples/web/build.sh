#!/usr/bin/env bash
# Builds the C interface as a module of WebAssembly, `umbra_physics.wasm` beside this script. Says that it is skipped, with exit
# status 3, where there is no compiler for it.
#   examples/web/build.sh && python3 -m http.server --directory examples/web --bind 127.0.0.1 8000
set -euo pipefail
cd "$(dirname "$0")/../.."
flags=(--quiet --profile web --locked --manifest-path capi/Cargo.toml)
libraries=std,panic_abort
. tests/wasm/compiler.sh
cargo rustc "${flags[@]}" --lib --crate-type cdylib --target "$target"
cp "$outputs/$target/web/umbra_physics_capi.wasm" examples/web/umbra_physics.wasm
