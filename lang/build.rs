//! Embeds the pages of `diagnostics/` by folder, so that a new page is a dropped-in file.

use std::{env, fs, path::Path};

fn main() {
    println!("cargo:rerun-if-changed=diagnostics");
    println!("cargo:rerun-if-changed=src/grammar.pest");
    let root = env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let mut pages: Vec<_> = fs::read_dir(Path::new(&root).join("diagnostics"))
        .into_iter()
        .flatten()
        .flatten()
        .map(|e| e.path())
        .filter(|p| p.extension().is_some_and(|e| e == "md"))
        .collect();
    pages.sort();
    let list: String = pages
        .iter()
        .filter_map(|p| p.file_stem()?.to_str().map(str::to_string))
        // Relative to the folder of the crate that is compiled: a shared target folder may serve several.
        .map(|code| {
            let path = format!("concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/diagnostics/{code}.md\")");
            format!("    ({code:?}, include_str!({path})),\n")
        })
        .collect();
    let out = format!("/// Code and page.\nconst PAGES: &[(&str, &str)] = &[\n{list}];\n");
    let to = Path::new(&env::var("OUT_DIR").unwrap_or_default()).join("pages.rs");
    if let Err(e) = fs::write(&to, out) {
        println!("cargo:warning=cannot write {}: {e}", to.display());
    }
}
