//! Profiles and worlds are embedded by folder.

use soifra_platforms::library;

#[test]
fn every_file_of_the_folders_is_there() {
    let root =
        std::path::PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo tells the folder"));
    let names: Vec<&str> = library().map(|(name, _)| name).collect();
    assert!(names.is_sorted());
    for folder in ["profiles", "worlds"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{folder}/{}", path.file_name().unwrap().to_string_lossy());
            let text = library().find(|(n, _)| *n == name).map(|(_, t)| t.to_string());
            assert_eq!(text, Some(std::fs::read_to_string(&path).unwrap()), "{name}");
        }
    }
}
