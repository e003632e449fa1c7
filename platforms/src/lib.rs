//! What moves: the simulator and, later, drivers; and the profiles and worlds that come with soifra.

pub mod library;
pub mod sim;

pub use library::library;
