//! What moves: the simulator, recordings of what moved, and, later, drivers; and the profiles and worlds that come with soifra.

pub mod library;
pub mod recording;
pub mod sim;

pub use library::library;
