//! Tests of the language, in one binary.

mod docs;
mod format;
