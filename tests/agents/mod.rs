//! The missions of agents: who is allocated, what is delivered whoever dies, and what their charts show.

mod allocation;
mod couriers;
