//! Judges the run: done condition, expectations and metrics, over world truth and beliefs.

use super::{
    cast::Cast,
    contacts::Contacts,
    cores::Tally,
    goals::Goals,
    regions::Regions,
    sampled::Gathered,
    store::{AgentShelf, Made, Store},
    verdict::{Answer, Track},
};
use crate::{
    Mission, Scene, Time, WorldTruth,
    mission::{code::Condition, start},
};
use soifra_graph::{
    Execution, Function, Own, Run, Truth,
    eval::{Block, Env, Fault, FaultKind, Memory},
    reason,
};

/// What conditions of the mission are about.
pub(crate) struct Court<'a> {
    pub mission: &'a Mission,
    pub scene: &'a Scene,
    pub cast: &'a Cast,
    pub states: &'a [f64],
    pub tallies: &'a [Tally],
    pub params: &'a [f64],
    pub truth: Option<&'a dyn WorldTruth>,
    pub contacts: &'a Contacts,
    pub goals: &'a Goals,
    pub regions: &'a Regions,
    pub store: &'a Store,
    /// Objects that were made meanwhile: for what is judged now, and no longer.
    pub made: Vec<Made>,
    pub now: Time,
    pub robot: Option<u32>,
}

impl Env for Court<'_> {
    fn now(&self) -> Result<f64, FaultKind> {
        Ok(self.now.seconds())
    }

    fn steps(&self) -> Result<f64, FaultKind> {
        Ok(self.scene.step.map_or(0.0, |s| (self.now.0 / s.0.max(1)) as f64))
    }

    fn own(&self, which: Own, out: &mut [f64]) -> Result<(), FaultKind> {
        let robot = self.robot.ok_or(FaultKind::Unavailable("the robot"))?;
        start::own(self.scene, robot, which, out)
    }

    fn truth(&self, robot: u32, which: Truth, out: &mut [f64]) -> Result<(), FaultKind> {
        let truth = self.truth.ok_or(FaultKind::Unavailable("world truth"))?;
        if robot as usize >= self.scene.bodies().len() {
            return Err(FaultKind::Malformed);
        }
        let number = match which {
            Truth::Pose => {
                let pose = truth.pose(robot);
                if out.len() != pose.len() {
                    return Err(FaultKind::Malformed);
                }
                out.copy_from_slice(&pose);
                return Ok(());
            }
            Truth::PathLength => truth.path_length(robot),
            Truth::Collisions => f64::from(self.contacts.of_robot[robot as usize]),
            Truth::InCollision => f64::from(u8::from(self.contacts.touches(robot))),
        };
        *out.first_mut().ok_or(FaultKind::Malformed)? = number;
        Ok(())
    }

    fn run(&self, which: Run) -> Result<f64, FaultKind> {
        Ok(match which {
            Run::Collisions => f64::from(self.contacts.total),
            Run::InCollision => f64::from(u8::from(self.contacts.any())),
        })
    }

    fn believed(&self, robot: u32, agent: u32, state: u32, out: &mut [f64]) -> Result<(), FaultKind> {
        let Some(i) = self.cast.find(robot, agent) else {
            return Err(FaultKind::Unavailable("the state of an agent that the robot does not run"));
        };
        let layout = &self.mission.agents[agent as usize].states;
        let range = layout.range(state as usize).ok_or(FaultKind::Malformed)?;
        let base = self.cast.instances[i].states;
        let value = self.states.get(base + range.start..base + range.end).ok_or(FaultKind::Malformed)?;
        if value.len() != out.len() {
            return Err(FaultKind::Malformed);
        }
        out.copy_from_slice(value);
        Ok(())
    }

    fn executed(&self, robot: u32, agent: u32, unit: u32, which: Execution) -> Result<f64, FaultKind> {
        let Some(i) = self.cast.find(robot, agent) else {
            return Err(FaultKind::Unavailable("a unit of an agent that the robot does not run"));
        };
        let units = self.cast.instances[i].units as usize;
        let tally = self.tallies.get(units + unit as usize).ok_or(FaultKind::Malformed)?;
        Ok(match which {
            Execution::Activations => tally.activations as f64,
            Execution::Misses => tally.misses as f64,
            Execution::Response => tally.response.seconds(),
        })
    }

    fn service(&mut self, which: Function, args: &[f64], out: &mut [f64]) -> Result<(), FaultKind> {
        if which == Function::TruePlace {
            return self.true_place(args, out);
        }
        let services = self.mission.services().ok_or(FaultKind::Unavailable("a service"))?;
        // Like an agent behind the last one: what it makes has numbers of its own.
        let instance = self.cast.instances.len() as u32;
        let truth = self.truth.is_some();
        let (store, scene, made) = (self.store, self.scene, &mut self.made);
        let mut shelf = AgentShelf { store, made, instance, scene, truth, threads: 1 };
        services.call(which, args, &mut shelf, out)
    }

    fn achieved(&self, goal: u32) -> Result<bool, FaultKind> {
        self.goals.achieved(goal).ok_or(FaultKind::Malformed)
    }

    fn robots(&self) -> Result<u32, FaultKind> {
        Ok(self.scene.bodies().len() as u32)
    }

    fn robot_of_group(&self, group: u32) -> Option<u32> {
        self.scene.robots.iter().position(|r| r.group == group).map(|r| r as u32)
    }

    fn robot(&self) -> Option<u32> {
        self.robot
    }

    fn set_robot(&mut self, robot: Option<u32>) {
        self.robot = robot;
    }

    fn inside(&self, point: [f64; 3], region: u32) -> Result<bool, FaultKind> {
        self.regions.inside(point, region)
    }
}

impl Court<'_> {
    /// Registers of an optional point: where the mover of that number is.
    fn true_place(&self, args: &[f64], out: &mut [f64]) -> Result<(), FaultKind> {
        let truth = self.truth.ok_or(FaultKind::Unavailable("world truth"))?;
        let ([number], [tag, at @ ..]) = (args, out) else { return Err(FaultKind::Malformed) };
        let declared = self.scene.world.iter().filter(|p| &*p.role == "mover").count();
        let movers = truth.movers();
        let mover = if *number >= 0.0 { movers.iter().take(declared).nth(*number as usize) } else { None };
        let reason = if mover.is_some() { 0.0 } else { reason::tag(reason::NO_SUCH_ITEM) };
        let [x, y, z] = mover.map_or([0.0; 3], |(_, [x, y, z, ..])| [*x, *y, *z]);
        let at: &mut [f64; 3] = at.try_into().map_err(|_| FaultKind::Malformed)?;
        (*tag, *at) = (reason, [x, y, z]);
        Ok(())
    }

    /// The value of a block of one register.
    pub fn number(&mut self, block: &Block, frame: &mut [f64]) -> Result<f64, Fault> {
        let mission = self.mission;
        let mut memory = Memory { states: &mut [], arguments: &[], params: self.params };
        mission.program.run(block, frame, &mut memory, self)?;
        Ok(frame.get(block.result as usize).copied().unwrap_or(0.0))
    }

    fn ask(&mut self, condition: &Condition, frame: &mut [f64]) -> Result<Answer, Fault> {
        let holds = self.number(&condition.holds, frame)? != 0.0;
        // A margin evaluates what the condition may have left out: a fault there is no fault of the mission.
        // Nobody is left by minus nothing.
        let margin = condition.margin.and_then(|m| self.number(&m, frame).ok()).map(|m| m + 0.0);
        Ok(Answer { holds, margin })
    }
}

/// An expectation and how far it has come.
#[derive(Debug, Clone)]
pub(crate) struct Watch {
    /// One track, or one for each robot.
    pub tracks: Vec<Track>,
    /// The time the expectation gives.
    pub limit: Option<Time>,
    /// Whether it asks for world truth that nobody has.
    pub blind: bool,
    /// Decisions since they were asked for last: track and time.
    pub decided: Vec<(u32, Time)>,
}

/// The expectations.
#[derive(Debug, Clone, Default)]
pub(crate) struct Judge {
    pub watches: Vec<Watch>,
    /// One for each metric.
    pub gathered: Vec<Gathered>,
    pub frame: Vec<f64>,
}

/// At which instants an expectation is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Occasion {
    /// The end of an instant.
    Instant,
    /// A contact before it.
    Contact,
    /// The end of the run.
    End,
}

impl Judge {
    /// Judges all expectations. The court's robot is changed.
    pub fn judge(&mut self, court: &mut Court<'_>, occasion: Occasion) -> Result<(), Fault> {
        let mission = court.mission;
        let now = court.now;
        for (code, watch) in mission.judge.expects.iter().zip(&mut self.watches) {
            if watch.blind || (occasion == Occasion::Contact && !code.contacts) {
                continue;
            }
            for (r, track) in watch.tracks.iter_mut().enumerate() {
                if occasion != Occasion::End && track.is_over(&code.kind) {
                    continue;
                }
                court.robot = code.each_robot.then_some(r as u32);
                let before = track.held;
                let mut ask = |c: &Condition| court.ask(c, &mut self.frame);
                let result = match occasion {
                    Occasion::End => track.end(&code.kind, watch.limit, now, &mut ask),
                    _ => track.step(&code.kind, watch.limit, now, &mut ask),
                };
                if result.is_err() {
                    // What cannot be told has not been seen to hold.
                    track.violate(now);
                }
                if track.held != before {
                    watch.decided.push((r as u32, now));
                }
                result?;
            }
        }
        court.robot = None;
        if occasion != Occasion::Contact {
            for (code, gathered) in mission.judge.metrics.iter().zip(&mut self.gathered) {
                if let Some(samples) = &code.samples {
                    gathered.step(&code.value, samples, court, &mut self.frame);
                }
            }
        }
        Ok(())
    }
}
