//! What the design promises about the sources themselves.

mod dependencies;
mod names;
