//! Can a conversation between two parties get stuck?
//!
//! A protocol is a machine of which each of its two roles keeps a copy. Sending a message moves the sender's
//! copy at once; receiving it moves the receiver's. The copies drift apart: while a message is under way, when
//! messages cross, when one is lost, when a time-out takes a copy on without the other role knowing. So the
//! question is about the protocol's *configurations*: both copies and the messages under way in both
//! directions. [`explore`] visits all that can be reached; [`faults`] is about what the protocol's states
//! already tell.
//!
//! # What is proven
//!
//! When the exploration is complete and finds nothing, then whatever the order in which things happen:
//!
//! - a message that arrives is expected, or comes to a copy that has ended and is dropped;
//! - whenever a role still waits, something can be counted on to happen.
//!
//! When the protocol's states form no ring of moves and time-outs, both roles take finitely many steps, so that
//! every conversation *ends* for all who know of it. When they do form one, but [`faults`] names no
//! [`Livelock`](Fault::Livelock), a conversation that does not end is one in which messages are sent for ever.
//!
//! # What is taken for granted
//!
//! - A message under way that is not lost arrives, in the order of sending; none is doubled.
//! - A time-out that is held elapses; how long that takes is not looked at, so that it may be before or after
//!   anything else, also when the durations would exclude it: what is found may never happen.
//! - A program that can send and is not said to be silent sends at some time. That it chooses a certain
//!   message at some time is not taken for granted.
//! - A role whose copy has taken no step, while the other's has, does not know of the conversation: it waits
//!   for nothing. (Else every protocol would be stuck when its first message is lost.)
//!
//! # What is not proven
//!
//! - Conversations without end are not found, except those of time-outs alone: in a ring of moves, the
//!   parties may send for ever, or one may while the other waits for a message that is never chosen.
//! - Queues hold no more than their capacity; what can happen with longer ones is only covered when no send
//!   ever waited ([`Explored::blocked`]).
//! - An unexpected message stays where it is, at the head of its queue, so that the exploration goes on with
//!   what happens when it arrives later. What a runtime does after the fault is not looked at.

mod configuration;
mod explore;
mod finding;
mod protocol;
mod structure;

#[cfg(test)]
mod tests;

pub use explore::{Explored, MOST, explore};
pub use finding::{Action, Finding, Silence, Step, Wait};
pub use protocol::{Move, Party, Protocol, Queues, Role, State};
pub use structure::{Fault, faults};
