//! The compiled form of a graph: blocks of bytecode where the graph has expressions and statements.

use crate::nodes::Tree;
use soifra_graph::{
    Keep, Misses, Name, Span, Type,
    eval::{Block, Layout},
};

/// An agent type.
pub(crate) struct AgentCode {
    pub states: Layout,
    /// Registers of its states that are numbers of objects.
    pub opaque: Vec<usize>,
    /// Initial value of each state; they read arguments and parameters.
    pub initial: Vec<Block>,
    pub units: Vec<UnitCode>,
    /// Conditions of its offers, in their order.
    pub offers: Vec<OfferCode>,
    /// How often it may fail within how long.
    pub restart: Option<(u32, Block)>,
    pub arbiters: Vec<ArbiterCode>,
    /// Sub-goals it pursues, in the order of the goals.
    pub subgoals: Vec<SubgoalCode>,
    /// Plan nodes of all units together.
    pub nodes: usize,
    /// Registers of the largest frame of its units and arbiters.
    pub frame: usize,
}

/// Something an agent offers.
pub(crate) struct OfferCode {
    /// When it agrees to be engaged.
    pub when: Option<Block>,
}

/// A sub-goal from the side of the agent.
pub(crate) struct SubgoalCode {
    pub goal: u32,
    pub name: Name,
    /// When the agent believes it achieved.
    pub achieved: Option<BeliefCode>,
    /// Unit whose plan it is achieved by.
    pub plan: Option<u32>,
}

/// A condition on what an agent knows.
pub(crate) enum BeliefCode {
    /// A state that is a `Bool`, by register: most are, and to look at one needs no evaluation.
    State(usize),
    Condition(Block),
}

/// A unit.
pub(crate) struct UnitCode {
    pub trigger: TriggerCode,
    pub timing: TimingCode,
    /// Registers of its locals, cleared before each activation.
    pub locals: usize,
    /// Where the message that triggered it goes: register and width.
    pub letter: Option<(usize, usize)>,
    /// Where the other agent and the conversation go.
    pub envelope: Option<[usize; 2]>,
    /// Sensor ports it reads.
    pub reads: Vec<u32>,
    /// Those of them whose reading must be present.
    pub requires: Vec<u32>,
    /// Topics it hears.
    pub hears: Vec<u32>,
    pub kind: KindCode,
    pub span: Span,
}

pub(crate) enum TriggerCode {
    Every { period: Block, offset: Option<Block> },
    Step { offset: Option<Block> },
    Message { topic: u32 },
    Told { performative: Name, content: Name, from: Option<Name> },
    Talk { conversation: u32, what: TalkCode },
    Reading(u32),
    Event(u32),
    Param(u32),
}

/// What of a conversation sets a unit off.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum TalkCode {
    /// A message with this performative.
    Message(Name),
    Timeout,
    Settled,
}

/// How the messages of a conversation travel, and how long its sides wait; evaluated at the start of a run.
pub(crate) struct TalkChannelCode {
    pub delay: Option<Block>,
    pub loss: Option<Block>,
    pub capacity: Option<Block>,
    /// Of each state.
    pub timeouts: Vec<Option<Block>>,
}

/// Durations, evaluated at the start of a run.
#[derive(Default)]
pub(crate) struct TimingCode {
    pub deadline: Option<Block>,
    pub worst_case: Option<Block>,
    pub at_most_every: Option<Block>,
    pub priority: i64,
    pub misses: Misses,
    /// A distribution.
    pub takes: Option<Block>,
    pub jitter: Option<Block>,
    pub budget: Option<Block>,
    pub core: Option<i64>,
    /// Resources and how long each is held.
    pub shares: Vec<(Name, Block)>,
}

pub(crate) enum KindCode {
    /// Agent-level `let`s and statements in one block.
    Service(Option<Block>),
    Anytime(AnytimeCode),
    Machine {
        prelude: Option<Block>,
        states: Vec<StateCode>,
    },
    Plan(PlanCode),
}

/// A service that improves a value while its budget lasts.
pub(crate) struct AnytimeCode {
    /// Agent-level `let`s and the statements before.
    pub before: Option<Block>,
    /// First value, and next value.
    pub first: Block,
    pub step: Block,
    /// Whether it is good enough.
    pub until: Option<Block>,
    /// What a round costs, in seconds.
    pub cost: Block,
    /// First register of the value.
    pub local: usize,
    /// The statements that use it.
    pub after: Option<Block>,
}

pub(crate) struct StateCode {
    pub entry: Option<Block>,
    pub body: Option<Block>,
    pub exit: Option<Block>,
    pub transitions: Vec<TransitionCode>,
}

pub(crate) struct TransitionCode {
    pub guard: Block,
    pub target: u32,
    /// Value and state slot of each datum of the target.
    pub arguments: Vec<(Block, u32)>,
    pub body: Option<Block>,
}

pub(crate) struct PlanCode {
    pub prelude: Option<Block>,
    pub tree: Tree,
    /// What the tree's codes stand for.
    pub code: Vec<Block>,
    /// First node in the plan memory of the agent.
    pub nodes_at: usize,
    /// Index in [`AgentCode::subgoals`] of the sub-goal its success achieves.
    pub subgoal: Option<u32>,
}

pub(crate) struct ArbiterCode {
    pub prelude: Option<Block>,
    pub locals: usize,
    pub strategy: StrategyCode,
    /// Sensor ports its expressions need.
    pub requires: Vec<u32>,
    /// Topics its expressions hear.
    pub hears: Vec<u32>,
}

pub(crate) enum StrategyCode {
    Priority(Vec<Block>),
    Layers(Vec<LayerCode>),
    Switch,
    Blend(Vec<Block>),
}

pub(crate) struct LayerCode {
    pub suppresses: Vec<u32>,
    pub hold: Option<Block>,
    pub inhibited: Option<Block>,
}

/// A topic; its arguments are evaluated at the start of a run.
pub(crate) struct TopicCode {
    pub name: Name,
    pub width: usize,
    pub delay: Option<Block>,
    pub loss: Option<Block>,
    pub range: Option<Block>,
    pub lifetime: Option<Block>,
    pub capacity: Option<Block>,
}

/// Robots of one declaration, which run the same agents on the same platform.
pub(crate) struct GroupCode {
    pub agents: Vec<BindingCode>,
    pub channels: Vec<ChannelCode>,
    /// Platform sensors that somebody reads.
    pub consumed: Vec<bool>,
}

pub(crate) struct BindingCode {
    pub agent: u32,
    pub arguments: Vec<Block>,
    /// Platform sensor of each sensor port.
    pub sensors: Vec<u32>,
    /// Channel and source number for each (unit, actuator port): `unit * ports + port`.
    pub routes: Vec<Option<(u32, u32)>>,
    pub actuators: usize,
}

/// An actuator of a robot that somebody commands.
pub(crate) struct ChannelCode {
    /// Platform actuator.
    pub actuator: u32,
    pub name: Name,
    pub width: usize,
    /// Binding and arbiter of it that decide; absent when there is one writer only.
    pub arbiter: Option<(u32, u32)>,
    /// Binding and unit of each source; absent for agents that this group does not run.
    pub sources: Vec<Option<(u32, u32)>>,
    /// Names of the sources.
    pub names: Vec<String>,
}

/// Conditions of the mission: what is asked at every event or at the end.
pub(crate) struct JudgeCode {
    pub done: Block,
    /// Time limit, and whether it is in steps.
    pub within: Option<(Block, bool)>,
    pub expects: Vec<ExpectCode>,
    pub metrics: Vec<MetricCode>,
    pub frame: usize,
}

pub(crate) struct MetricCode {
    pub name: Name,
    pub value: Block,
    pub samples: Option<SamplesCode>,
}

/// When a metric is sampled.
pub(crate) struct SamplesCode {
    pub keep: Keep,
    pub upon: Block,
    pub when: Option<Block>,
}

pub(crate) struct ExpectCode {
    pub each_robot: bool,
    pub kind: ExpectKindCode,
    /// Whether a contact that ended before it was reported can change it.
    pub contacts: bool,
    /// Whether it asks for poses or path lengths.
    pub truth: bool,
}

/// A condition and its margin.
#[derive(Clone, Copy)]
pub(crate) struct Condition {
    pub holds: Block,
    pub margin: Option<Block>,
}

pub(crate) enum ExpectKindCode {
    Always(Condition),
    Never(Condition),
    Eventually(Condition, Option<(Block, bool)>),
    Until(Condition, Condition),
    LeadsTo(Condition, Condition, Option<(Block, bool)>),
    Finally(Condition),
}

/// An expression of the scene, evaluated with draws.
pub(crate) struct SceneCode {
    pub step: Option<Block>,
    /// Of each world component: count and arguments.
    pub world: Vec<ComponentCode>,
    /// Of each platform, its components.
    pub platforms: Vec<Vec<ComponentCode>>,
    /// Of each group.
    pub robots: Vec<RobotCode>,
    /// Of each declared fault.
    pub faults: Vec<ComponentCode>,
}

pub(crate) struct ComponentCode {
    pub count: Option<Block>,
    pub args: Vec<(Name, Block, Type)>,
}

pub(crate) struct RobotCode {
    pub count: Option<Block>,
    pub start: Block,
    pub scatter: Option<Block>,
    pub target: Option<Block>,
}

impl UnitCode {
    /// Its nodes in the plan memory of its agent.
    pub fn nodes(&self) -> std::ops::Range<usize> {
        match &self.kind {
            KindCode::Plan(p) => p.nodes_at..p.nodes_at + p.tree.len(),
            _ => 0..0,
        }
    }
}
