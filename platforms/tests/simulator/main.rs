//! The simulator against closed forms, analytic geometry and itself.

mod contacts;
mod flight;
mod kinematics;
mod library;
mod movers;
mod noise;
mod refused;
mod scenes;
mod schedule;
mod sensors;
mod swarm;
mod water;
