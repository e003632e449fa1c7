//! Names of source files that do not depend on the folder a command was started from: they go into graphs,
//! digests and traces.

use soifra_graph::span::Source;
use std::path::{Component, Path, PathBuf};

/// Names the files of a user as seen from the folder of `main`; those of the library keep their names.
pub fn name_from(main: &str, sources: &mut [Source]) {
    let folder = Path::new(main).parent().unwrap_or(Path::new(""));
    for s in sources {
        let shipped = s.path.starts_with("std/") || soifra_platforms::library().any(|(p, _)| *p == *s.path);
        if !shipped {
            s.path = from(folder, Path::new(&s.path)).to_string_lossy().replace('\\', "/");
        }
    }
}

/// The way from `folder` to `path`, both from the same place.
fn from(folder: &Path, path: &Path) -> PathBuf {
    let parts = |p: &Path| -> Vec<String> {
        p.components()
            .filter(|c| *c != Component::CurDir)
            .map(|c| c.as_os_str().to_string_lossy().into_owned())
            .collect()
    };
    let (folder, path) = (parts(folder), parts(path));
    let common = folder.iter().zip(&path).take_while(|(a, b)| a == b).count();
    folder[common..].iter().map(|_| "..".to_string()).chain(path[common..].iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_from_every_folder() {
        for (main, other) in [
            ("a.soi", "../lib/b.soi"),
            ("m/a.soi", "lib/b.soi"),
            ("/x/m/a.soi", "/x/lib/b.soi"),
            ("./m/a.soi", "lib/b.soi"),
            ("../a.soi", "../../lib/b.soi"),
        ] {
            let source = |p: &str| Source { path: p.into(), text: String::new() };
            let mut s = [source(main), source(other), source("std/prelude.soi")];
            name_from(main, &mut s);
            let names: Vec<&str> = s.iter().map(|s| s.path.as_str()).collect();
            assert_eq!(names, ["a.soi", "../lib/b.soi", "std/prelude.soi"], "{main}");
        }
    }
}
