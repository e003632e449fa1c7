//! The engine: runs a mission on a platform, in virtual time.
//!
//! At an instant, in this order: the platform hands over readings and reports; an operator's inputs take
//! effect; outputs that were put off and letters arrive; units are released and evaluated, higher priority first, then in order of robot,
//! agent and unit; arbiters decide and commands are sent; goals, expectations and the done condition are
//! judged. Activations of one instant see other agents as they were before it: what they publish arrives
//! at least a microsecond later, and a parameter they set holds from the next activations on. Events are
//! raised within the agent and release units at the same instant, after those before them.

mod activate;
mod actuate;
mod admit;
mod batch;
mod board;
mod cast;
mod commit;
mod contacts;
mod cores;
mod devices;
mod directory;
mod env;
mod finish;
mod goals;
mod grid;
mod instant;
mod judge;
mod lives;
mod log;
mod minds;
mod operator;
mod planner;
mod post;
mod queue;
mod recorder;
mod regions;
pub mod report;
mod sampled;
mod senses;
mod setup;
pub(crate) mod snapshot;
mod store;
mod talks;
mod tidy;
mod troubles;
mod verdict;
mod work;

use crate::{Mission, Platform, Readings, Report, Scene, Time};
use activate::{Desk, Outcome as Evaluated, Release};
use actuate::Actuators;
use batch::Workers;
use board::Board;
use cast::Cast;
pub use cast::DEFAULT_LIFETIME;
use contacts::Contacts;
use cores::{CoreState, Tally};
use devices::DeviceState;
use directory::Directory;
use goals::Goals;
use judge::Judge;
use lives::Lives;
use minds::Minds;
use operator::Operator;
use planner::Planner;
use post::Mail;
use queue::Queue;
use recorder::Recorder;
use regions::Regions;
pub use report::{Outcome, RunReport};
use senses::Senses;
use serde::{Deserialize, Serialize};
pub use snapshot::Snapshot;
use soifra_graph::{Texts, planning::Pool};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::atomic::AtomicBool,
};
use store::Store;
use talks::Talks;
use troubles::Troubles;

/// One run of a mission.
pub struct Engine<'m> {
    mission: &'m Mission,
    scene: &'m Scene,
    platform: &'m mut dyn Platform,
    recorder: Recorder<'m>,
    stop: &'m AtomicBool,
    operator: Operator<'m>,
    seed: u64,
    texts: Texts,
    cast: Cast,
    regions: Regions,
    /// Units that a message on each topic sets off.
    subscribers: Vec<Vec<u32>>,
    /// Units that a reading sets off, by robot and sensor.
    on_reading: BTreeMap<(u32, u32), Vec<u32>>,
    /// The time limit.
    limit: Option<Time>,

    now: Time,
    /// The run goes on from a snapshot, behind the instant it was taken at.
    resumed: bool,
    /// The platform has no more to hand over, ever.
    over: bool,
    /// When the platform was polled last.
    polled: Time,
    params: Vec<f64>,
    new_params: Vec<(u32, Vec<f64>)>,
    minds: Minds,
    /// Status of each sub-goal as committed.
    subgoals: Vec<u8>,
    clocks: Vec<Clock>,
    /// Of each unit.
    tallies: Vec<Tally>,
    cores: Vec<CoreState>,
    /// Cores that something happened to.
    touched: Vec<u32>,
    devices: Vec<DeviceState>,
    senses: Senses,
    boards: Vec<Board>,
    mail: Mail,
    talks: Talks,
    /// Conversations that may be over.
    ended: Vec<u64>,
    /// Of each declared conversation.
    channels: Vec<TalkChannel>,
    directory: Directory,
    store: Store,
    /// Who could serve sub-goals.
    pool: Pool,
    planner: Planner,
    lives: Lives,
    /// How often each agent may fail within how long.
    restarts: Vec<Option<(u32, Time)>>,
    /// Agents that died during the present wave: what they evaluated in it does not count.
    reset: BTreeSet<u32>,
    troubles: Troubles,
    /// Units that a parameter sets off.
    on_param: BTreeMap<u32, Vec<u32>>,
    queue: Queue,
    actuators: Actuators,
    contacts: Contacts,
    goals: Goals,
    judge: Judge,
    faults: Vec<report::FaultReport>,
    /// Why the run is to be aborted.
    aborted: Option<String>,
    /// What was traced last of each robot and mover.
    poses: Vec<Option<([f64; 7], f64)>>,
    movers: BTreeMap<String, [f64; 7]>,

    // Room that is kept between instants.
    places: Vec<[f64; 3]>,
    arriving: Vec<u32>,
    readings: Readings,
    reports: Vec<Report>,
    releases: Vec<Release>,
    outcomes: Vec<Evaluated>,
    workers: Workers,
    desk: Desk,
    /// Activations and polls of the current instant.
    events: usize,
}

/// How the messages of a conversation travel.
#[derive(Debug, Clone)]
struct TalkChannel {
    delay: Time,
    loss: f64,
    capacity: usize,
    /// How long a side waits in each state.
    timeouts: Vec<Option<Time>>,
}

/// When a unit may be released again.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Clock {
    last: Option<Time>,
    /// Until when an activation runs.
    busy: Time,
    /// Whether it is to be woken.
    waiting: bool,
    /// A release waits that came without a letter.
    due: Option<Due>,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Due {
    release: Time,
    cause: Option<u64>,
}
