//! What stands for vision in a program that was built without it.

use super::{Overlay, Readings};
use soifra_runtime::objects::Frame;

/// Sees nothing.
#[derive(Debug, Default)]
pub struct Onlooker;

impl Onlooker {
    /// Sees nothing.
    pub fn look(&mut self, _: &Frame, _: &Readings) -> bool {
        false
    }

    /// Draws nothing.
    pub fn draw(&self, _: &mut Frame, _: Overlay) {}
}
