//! Who serves which task: the allocation that the planner-matcher makes before a run and repairs during it.
//!
//! An *agent* is collaborative (it serves any number of tasks) or exclusive (it serves at most one, if need
//! be several needs of that one). A *task* is a sub-goal on a robot. It has *ways*, the best first; a way has
//! *needs*; a need has *candidates*, the best first. A task is served when every need of one of its ways has
//! an available agent.
//!
//! What [`Matcher::solve`] promises, in this order:
//!
//! 1. No exclusive agent serves two tasks, and no agent serves that is not available.
//! 2. A task is served if, and only if, it can be served together with all earlier tasks that are served. So
//!    all are served whenever that is possible. Where one agent is enough for each task (one need in each
//!    way), as many are served as possible; where tasks need several agents at a time, an early task may
//!    stand against several later ones.
//! 3. Preference where it costs nothing: no served task could have an earlier way, or earlier candidates in
//!    its way, with agents that no other task holds.
//! 4. A task that is not served is told why ([`Refusal`]), with as few competing tasks as will do.
//!
//! The other operations of [`Matcher`] repair an allocation. They keep 1; they serve a task if, and only if,
//! that is possible without refusing one that is served at present; and they leave a task alone unless its
//! agents are lost or needed elsewhere. They do not look for earlier ways and candidates for tasks that they
//! leave alone, and they do not refuse a late task in favour of an early one.
//!
//! Deciding 2 is easy where one agent is enough for each task, and also for tasks of one way whose needs have
//! no candidate in common: augmenting paths. These cases are always decided. In general it is as hard as
//! three-dimensional matching: the search is complete, but it gives up after [`STEP_LIMIT`] steps in one
//! component (tasks that compete with each other, over whatever detour) or in one repair, and tasks that it
//! then cannot decide about are [`Outcome::Undecided`]. So are some tasks that compete with a task of more
//! than 1024 forms: that does not happen with seven needs in a way, if it is the only one. The limit also
//! bounds how long 3 and 4 are pursued.

mod catalogue;
mod check;
mod components;
mod conflict;
mod holdings;
mod matcher;
mod outcome;
mod pigeonholes;
mod problem;
mod search;
mod seating;
mod work;

pub use check::check;
pub use matcher::{Matcher, STEP_LIMIT};
pub use outcome::{Change, Changes, Choice, Outcome, Refusal};
pub use problem::{Agent, Need, Place, Problem, Task, Way};
