//! Looks through every instruction of a module for floats: `umbra-wasm-scan FILE.wasm`.
//!
//! Exit status 0: there are none; 1: there are, or the file is no such module; 2: bad usage. A module that hardly has code, or
//! lacks one of the functions it is to export, is no such module: nothing would have been looked at.

use std::collections::{BTreeMap, BTreeSet};
use std::process::ExitCode;

use wasmparser::{CompositeInnerType, Parser, Payload, ValType};

const EXPORTS: [&str; 18] = [
    "create",
    "destroy",
    "step",
    "hash",
    "buffer",
    "address",
    "length",
    "discard",
    "snapshot",
    "restore",
    "execute",
    "record",
    "record_step",
    "record_end",
    "verify",
    "read",
    "texts",
    "corpus",
];

/// The engine and its corpus have 200,000; half of them would not be all of it.
const FEWEST_INSTRUCTIONS: u64 = 100_000;

#[derive(Default)]
struct Findings {
    functions: u64,
    instructions: u64,
    exports: BTreeSet<String>,
    /// Functions that contain a float, and how often.
    floats: BTreeMap<String, u64>,
}

impl Findings {
    fn float(&mut self, what: String) {
        *self.floats.entry(what).or_default() += 1;
    }

    fn value(&mut self, kind: ValType, place: &str) {
        if matches!(kind, ValType::F32 | ValType::F64) {
            self.float(format!("{place} of type {kind}"));
        }
    }

    fn code(&mut self, body: &wasmparser::FunctionBody<'_>) -> wasmparser::Result<()> {
        self.functions += 1;
        for local in body.get_locals_reader()? {
            self.value(local?.1, "local");
        }
        for operator in body.get_operators_reader()? {
            self.instructions += 1;
            let text = format!("{:?}", operator?);
            let name = text.split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or_default();
            // F64Add, F32Const, I32TruncF64S, F32DemoteF64, I64ReinterpretF64, F32x4Mul, F16x8Add: all that handle floats
            // say so in their names, and nothing else does.
            if ["F16", "F32", "F64"].iter().any(|float| name.contains(float)) {
                self.float(format!("instruction {name}"));
            }
        }
        Ok(())
    }
}

fn scan(module: &[u8]) -> wasmparser::Result<Findings> {
    let mut findings = Findings::default();
    for payload in Parser::new(0).parse_all(module) {
        match payload? {
            Payload::TypeSection(force_groups) => {
                for kind in
                    force_groups.into_iter().collect::<Result<Vec<_>, _>>()?.iter().flat_map(|group| group.types())
                {
                    if let CompositeInnerType::Func(signature) = &kind.composite_type.inner {
                        signature.params().iter().for_each(|&kind| findings.value(kind, "parameter"));
                        signature.results().iter().for_each(|&kind| findings.value(kind, "result"));
                    }
                }
            }
            Payload::GlobalSection(globals) => {
                for global in globals {
                    findings.value(global?.ty.content_type, "global");
                }
            }
            Payload::ExportSection(exports) => {
                for export in exports {
                    findings.exports.insert(export?.name.to_owned());
                }
            }
            Payload::CodeSectionEntry(body) => findings.code(&body)?,
            _ => {}
        }
    }
    Ok(findings)
}

fn judge(file: &str) -> Result<Findings, String> {
    let module = std::fs::read(file).map_err(|error| error.to_string())?;
    let findings = scan(&module).map_err(|error| error.to_string())?;
    if let Some(missing) = EXPORTS.iter().find(|name| !findings.exports.contains(**name)) {
        return Err(format!("it does not export `{missing}`"));
    }
    if findings.instructions < FEWEST_INSTRUCTIONS {
        return Err(format!("it has {} instructions: too few for an engine", findings.instructions));
    }
    Ok(findings)
}

fn main() -> ExitCode {
    let [_, file] = &std::env::args().collect::<Vec<_>>()[..] else {
        eprintln!("usage: umbra-wasm-scan FILE.wasm");
        return ExitCode::from(2);
    };
    match judge(file) {
        Err(error) => {
            eprintln!("{file}: {error}");
            ExitCode::from(1)
        }
        Ok(Findings { functions, instructions, floats, .. }) => {
            println!(
                "{functions} functions, {instructions} instructions, {} with floats",
                floats.values().sum::<u64>()
            );
            floats.iter().for_each(|(what, count)| println!("  {count:>6} {what}"));
            if floats.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) }
        }
    }
}
