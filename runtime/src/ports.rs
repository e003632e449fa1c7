//! The port contract: what the runtime asks of whatever moves. The simulator and drivers implement
//! [`Platform`]; nothing above it knows which of them it talks to. And what it asks of whoever keeps the time
//! ([`Pacer`]), through whom an operator acts on a run.

use crate::{objects::Frame, time::Time, trace::Event};
use std::sync::Arc;

/// Readings handed over by one poll. Registers of all readings lie in one arena.
#[derive(Debug, Default)]
pub struct Readings {
    /// The readings, in order of delivery, then robot, then sensor.
    pub items: Vec<Reading>,
    /// Register values; a reading's are `registers[from..to]`.
    pub registers: Vec<f64>,
    /// Images.
    pub images: Vec<Arc<Frame>>,
}

impl Readings {
    /// Appends a reading with its registers.
    pub fn push(&mut self, robot: u32, sensor: u32, captured: Time, delivered: Time, registers: &[f64]) {
        let from = self.registers.len() as u32;
        self.registers.extend_from_slice(registers);
        self.items.push(Reading {
            robot,
            sensor,
            captured,
            delivered,
            from,
            to: self.registers.len() as u32,
            image: None,
        });
    }

    /// Appends an image.
    pub fn push_image(
        &mut self,
        robot: u32,
        sensor: u32,
        captured: Time,
        delivered: Time,
        image: Arc<Frame>,
    ) {
        self.push(robot, sensor, captured, delivered, &[0.0]);
        if let Some(reading) = self.items.last_mut() {
            reading.image = Some(self.images.len() as u32);
        }
        self.images.push(image);
    }

    /// Forgets everything, keeps the memory.
    pub fn clear(&mut self) {
        self.items.clear();
        self.registers.clear();
        self.images.clear();
    }
}

/// A stamped reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Robot, by index in [`crate::scene::Scene::robots`].
    pub robot: u32,
    /// Sensor, by index among the `sensor` components of the robot's platform.
    pub sensor: u32,
    /// When the world was as it says.
    pub captured: Time,
    /// When it arrived; never before `captured`.
    pub delivered: Time,
    /// First register in the arena.
    pub from: u32,
    /// One past the last register.
    pub to: u32,
    /// Index in [`Readings::images`], for a camera; its register counts for nothing then.
    pub image: Option<u32>,
}

/// A platform reports something besides readings.
#[derive(Debug, Clone, PartialEq)]
pub enum Report {
    /// Two bodies touch (simulators only). Indices of robots; `None` is a thing of the world, named.
    ContactBegin {
        /// When.
        at: Time,
        /// First robot.
        robot: u32,
        /// Second robot, if it is one.
        other: Option<u32>,
        /// Name of the other body.
        with: String,
    },
    /// The same two parted.
    ContactEnd {
        /// When.
        at: Time,
        /// First robot.
        robot: u32,
        /// Second robot, if it is one.
        other: Option<u32>,
        /// Name of the other body.
        with: String,
    },
    /// The platform of a robot is lost; its safe action has been started by the platform itself.
    Lost {
        /// When.
        at: Time,
        /// Robot.
        robot: u32,
        /// Why.
        reason: String,
    },
    /// A recording is over: nothing more is handed over, and the run ends at this instant unless something else
    /// ends it.
    Over {
        /// When.
        at: Time,
    },
}

/// Everything that moves in one run: simulated robots, driven robots, or both.
///
/// No call blocks. A driver owns its threads and hands over what has arrived.
pub trait Platform {
    /// The next instant at which [`Platform::poll`] would deliver something; `None` when nothing is due
    /// unless a command comes.
    fn next_due(&self) -> Option<Time>;

    /// Advances to `now` (never backwards) and hands over all readings with `delivered <= now` and all
    /// reports since the last poll.
    fn poll(&mut self, now: Time, readings: &mut Readings, reports: &mut Vec<Report>);

    /// Time passes until `now`, and nothing is handed over yet: what is to be computed until then can be
    /// computed now. Called on the way to an instant that is far ahead.
    fn advance(&mut self, _now: Time) {}

    /// Sends a command to actuator `actuator` (index among the `actuator` components of the robot's
    /// platform). It holds until the next command or until `expires`, when the safe action starts.
    fn send(&mut self, now: Time, robot: u32, actuator: u32, command: &[f64], expires: Time);

    /// Starts the robot's safe action and returns its name.
    fn safe_action(&mut self, now: Time, robot: u32) -> &'static str;

    /// Starts what the robot does when the run is over, and returns its name: the safe action unless it has
    /// something of its own, such as to land.
    fn finish(&mut self, now: Time, robot: u32) -> &'static str {
        self.safe_action(now, robot)
    }

    /// World truth, where there is a simulator that knows it.
    fn truth(&self) -> Option<&dyn WorldTruth>;
}

/// What is really so, at the last poll. Only `done`, `expect`, metrics and reports may see it.
pub trait WorldTruth {
    /// True pose in `map`: x y z qx qy qz qw.
    fn pose(&self, robot: u32) -> [f64; 7];
    /// True position in `map`: what [`WorldTruth::pose`] begins with.
    fn position(&self, robot: u32) -> [f64; 3] {
        let [x, y, z, ..] = self.pose(robot);
        [x, y, z]
    }
    /// Path length in metres since the start.
    fn path_length(&self, robot: u32) -> f64;
    /// Contacts this robot took part in, each counted once from touch to parting.
    fn collisions(&self, robot: u32) -> u32;
    /// Whether it is in contact.
    fn in_collision(&self, robot: u32) -> bool;
    /// Contacts of all robots, each counted once.
    fn total_collisions(&self) -> u32;
    /// Movers: name and pose, for traces and pictures.
    fn movers(&self) -> Vec<(String, [f64; 7])>;
}

/// Holds a run to a pace: that of the wall clock, or of a recording. Without one a run goes on as fast as it is
/// computed. A pacer decides when an instant happens, never what happens at it: the inputs that it hands over
/// are recorded, and nothing else of it reaches the run.
pub trait Pacer {
    /// The run begins, at `now`.
    fn begin(&mut self, _now: Time) {}

    /// The run is about to go from the instant `now` to the later instant `next`. Returns the instant to go to,
    /// once that is due: `next`, or, when an operator does something before that, an earlier one after `now`,
    /// with what is done at it put into `inputs`. Returns at once when the run is to stop.
    fn pace(&mut self, now: Time, next: Time, inputs: &mut Vec<Input>) -> Time;
}

/// Something an operator does to a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// In the operator's words.
    pub text: String,
    /// What it means.
    pub operation: Operation,
}

/// What an operator can do.
#[derive(Debug, Clone, PartialEq)]
pub enum Operation {
    /// An agent dies.
    Kill {
        /// `agent@robot`.
        agent: String,
    },
    /// A parameter of the mission is changed.
    Set {
        /// Its name.
        param: String,
        /// Its new value; [`crate::Mission::parameter`] makes them.
        registers: Vec<f64>,
    },
    /// The run ends, with every robot's safe action.
    Stop,
}

impl Input {
    /// As it is recorded.
    pub fn event(&self) -> Event {
        let (operation, agent, param, registers) = match &self.operation {
            Operation::Kill { agent } => ("kill", Some(agent.clone()), None, Vec::new()),
            Operation::Set { param, registers } => ("set", None, Some(param.clone()), registers.clone()),
            Operation::Stop => ("stop", None, None, Vec::new()),
        };
        Event::Input { text: self.text.clone(), operation: operation.into(), agent, param, registers }
    }

    /// From its record.
    pub fn of(event: &Event) -> Option<Input> {
        let Event::Input { text, operation, agent, param, registers } = event else { return None };
        let operation = match operation.as_str() {
            "kill" => Operation::Kill { agent: agent.clone()? },
            "set" => Operation::Set { param: param.clone()?, registers: registers.clone() },
            "stop" => Operation::Stop,
            _ => return None,
        };
        Some(Input { text: text.clone(), operation })
    }
}
