//! Embeds the folders `profiles/` and `worlds/`. A new file there is found without touching any Rust.

use std::{
    env, fs,
    io::{Error, Result},
    path::{Path, PathBuf},
};

fn main() -> Result<()> {
    let root =
        PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or_else(|| Error::other("no manifest dir"))?);
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or_else(|| Error::other("no output dir"))?);
    let mut files = Vec::new();
    for folder in ["profiles", "worlds"] {
        println!("cargo:rerun-if-changed={folder}");
        gather(&root.join(folder), folder, &mut files)?;
    }
    files.sort();
    let mut text = String::from("const FILES: &[(&str, &str)] = &[\n");
    // Relative to the folder of the crate that is compiled: a shared target folder may serve several.
    for name in files {
        let path = format!("concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/{name}\")");
        text += &format!("    ({name:?}, include_str!({path})),\n");
    }
    text += "];\n";
    fs::write(out.join("library.rs"), text)
}

/// Names of all `.soi` files of a folder and those in it, with `/`.
fn gather(folder: &Path, name: &str, files: &mut Vec<String>) -> Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = format!("{name}/{}", path.file_name().unwrap_or_default().to_string_lossy());
        if path.is_dir() {
            gather(&path, &name, files)?;
        } else if path.extension().is_some_and(|e| e == "soi") {
            files.push(name);
        }
    }
    Ok(())
}
