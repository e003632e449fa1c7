//! `docs/language.md` is tested: its examples are checked, its grammar and tables are made from the sources,
//! its limits are tried out. `SOIFRA_BLESS=1` writes the generated parts anew.

mod blocks;
mod context;
mod examples;
mod glossary;
mod grammar;
mod limits;
mod links;
mod regions;
mod tables;

use soifra_lang::Loader;
use std::{
    fs,
    path::PathBuf,
    sync::{Mutex, MutexGuard, PoisonError},
};

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo tells the folder"))
        .join("..")
        .join(path)
}

/// Its text.
pub fn read(path: &str) -> String {
    let at = repository(path);
    fs::read_to_string(&at).unwrap_or_else(|e| panic!("{}: {e}", at.display()))
}

/// Held while a document is read and perhaps written anew: the tests run at the same time.
pub fn writing() -> MutexGuard<'static, ()> {
    static DOCUMENTS: Mutex<()> = Mutex::new(());
    DOCUMENTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The shipped profiles and worlds.
pub struct Library;

impl Loader for Library {
    fn load(&mut self, path: &str) -> Result<String, String> {
        fs::read_to_string(repository(path)).map_err(|e| e.to_string())
    }

    fn library(&self) -> Vec<(String, String)> {
        let mut out = Vec::new();
        for folder in ["platforms/profiles", "platforms/worlds"] {
            let mut files: Vec<PathBuf> =
                fs::read_dir(repository(folder)).unwrap().map(|e| e.unwrap().path()).collect();
            files.sort();
            for f in files {
                let name = f.file_name().unwrap().to_string_lossy().into_owned();
                out.push((format!("{folder}/{name}"), fs::read_to_string(&f).unwrap()));
            }
        }
        out
    }
}
