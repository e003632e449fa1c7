//! The profiles and worlds that are part of the program, embedded by folder.

include!(concat!(env!("OUT_DIR"), "/library.rs"));

/// Every `.soi` file under `profiles/` and `worlds/`: path from there, and text, in order of path.
pub fn library() -> impl Iterator<Item = (&'static str, &'static str)> {
    FILES.iter().copied()
}
