//! A mission that is ready to run: the graph with all its code compiled.

pub(crate) mod code;
mod compile;
mod group;
mod judge;
pub(crate) mod margin;
mod scene;
pub(crate) mod start;
pub(crate) mod uses;

use crate::scene::ImageFile;
use crate::{
    Scene,
    objects::{Cameras, Retake, Services},
};
use code::{AgentCode, GroupCode, JudgeCode, SceneCode, TalkChannelCode, TopicCode};
use compile::Compiled;
pub use scene::MAX_INSTANCES;
use soifra_graph::{
    Diagnostic, Graph, Span, Texts, Type, Value,
    eval::{Block, CompileError, Compiler, Layout, Program},
};
use std::{collections::BTreeMap, sync::Arc};

/// Code of diagnostics about a graph that does not fit together.
pub const DAMAGED: &str = "S0801";
/// Code of diagnostics about a value that cannot be computed at the start of a run.
pub const START_VALUE: &str = "S0901";
/// Code of diagnostics about a parameter that does not exist or is given a value of another type.
pub const PARAMETER: &str = "S0902";

/// What a run is a function of, besides the graph and recorded inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Seed of all randomness.
    pub seed: u64,
    /// Parameters that differ from their defaults, of their declared types.
    pub params: BTreeMap<String, Value>,
    /// Threads that evaluate large batches; changes nothing but the speed.
    pub threads: usize,
}

/// A loaded graph.
pub struct Mission {
    pub(crate) graph: Graph,
    /// Texts of the graph and of its code.
    pub(crate) texts: Texts,
    pub(crate) program: Program,
    pub(crate) params: Layout,
    /// Registers of the largest frame of any unit or arbiter.
    pub(crate) frame: usize,
    pub(crate) agents: Vec<AgentCode>,
    pub(crate) groups: Vec<GroupCode>,
    pub(crate) topics: Vec<TopicCode>,
    pub(crate) talks: Vec<TalkChannelCode>,
    /// When each plan of the library holds.
    pub(crate) plans: Vec<Option<Block>>,
    pub(crate) judge: JudgeCode,
    pub(crate) scene: SceneCode,
    services: Option<Arc<dyn Services>>,
    cameras: Option<Arc<dyn Cameras>>,
    /// Image files of the world.
    images: Vec<ImageFile>,
}

impl Mission {
    /// The same mission with services that compute what the machine itself cannot.
    pub fn with_services(self, services: Arc<dyn Services>) -> Mission {
        Mission { services: Some(services), ..self }
    }

    /// The same mission with cameras for replays.
    pub fn with_cameras(self, cameras: Arc<dyn Cameras>) -> Mission {
        Mission { cameras: Some(cameras), ..self }
    }

    /// The same mission with the image files that its materials name.
    pub fn with_images(self, images: Vec<ImageFile>) -> Mission {
        Mission { images, ..self }
    }

    /// What takes the images of a recorded run of a scene again.
    pub(crate) fn cameras(&self, scene: &Scene) -> Option<Box<dyn Retake>> {
        self.cameras.as_ref()?.of(scene)
    }

    /// The services, if there are any.
    pub(crate) fn services(&self) -> Option<&dyn Services> {
        self.services.as_deref()
    }

    /// Compiles all code of a graph.
    ///
    /// # Errors
    /// Everything that does not fit together in a graph that was not written by the checker.
    pub fn load(graph: Graph) -> Result<Mission, Vec<Diagnostic>> {
        let mut texts = graph.texts.clone();
        let mut errors = Vec::new();
        let mut compiler = Compiler::for_graph(&graph, &mut texts);
        let parts = compile(&mut compiler, &graph, &mut errors);
        let program = compiler.finish();
        match parts {
            Some(Parts { agents, groups, topics, talks, plans, judge, scene }) if errors.is_empty() => {
                let params = Layout::params(&graph);
                let frame = agents.iter().map(|a| a.frame).max().unwrap_or(0);
                Ok(Mission {
                    graph,
                    texts,
                    program,
                    params,
                    frame,
                    agents,
                    groups,
                    topics,
                    talks,
                    plans,
                    judge,
                    scene,
                    services: None,
                    cameras: None,
                    images: Vec::new(),
                })
            }
            _ => Err(errors.into_iter().map(diagnostic).collect()),
        }
    }

    /// The graph.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// World, platforms and robots for one seed and one set of parameters.
    ///
    /// # Errors
    /// A parameter that does not exist or has another type, or an expression that cannot be computed.
    pub fn scene(&self, settings: &Settings) -> Result<Scene, Diagnostic> {
        scene::set(self, settings)
    }

    /// `path:line:column` of a span, empty when it lies in no source.
    pub(crate) fn place(&self, at: Span) -> String {
        let Some(source) = self.graph.sources.get(at.file as usize) else { return String::new() };
        let Some(before) = source.text.get(..at.start as usize) else { return String::new() };
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        format!("{}:{line}:{column}", source.path)
    }

    /// What is written at a span.
    pub(crate) fn written(&self, at: Span) -> &str {
        let source = self.graph.sources.get(at.file as usize);
        source.and_then(|s| s.text.get(at.start as usize..at.end as usize)).unwrap_or_default()
    }
}

struct Parts {
    agents: Vec<AgentCode>,
    groups: Vec<GroupCode>,
    topics: Vec<TopicCode>,
    talks: Vec<TalkChannelCode>,
    plans: Vec<Option<Block>>,
    judge: JudgeCode,
    scene: SceneCode,
}

fn compile(c: &mut Compiler<'_>, graph: &Graph, errors: &mut Vec<CompileError>) -> Option<Parts> {
    fn keep<T>(result: Compiled<T>, errors: &mut Vec<CompileError>) -> Option<T> {
        result.map_err(|e| errors.push(e)).ok()
    }
    if graph.schema != soifra_graph::mission::SCHEMA {
        let text = format!("schema {} is not known, only {}", graph.schema, soifra_graph::mission::SCHEMA);
        errors.push(CompileError { text, at: Span::default() });
        return None;
    }
    let agents =
        (0..graph.agents.len() as u32).map(|a| compile::agent(c, graph, a, errors)).collect::<Vec<_>>();
    let groups = graph.robots.iter().map(|r| keep(group::group(c, graph, r), errors)).collect::<Vec<_>>();
    let topics = graph.topics.iter().map(|t| keep(topic(c, graph, t), errors)).collect::<Vec<_>>();
    let talks = graph.conversations.iter().map(|t| keep(talk(c, t), errors)).collect::<Vec<_>>();
    let plan = |c: &mut Compiler<'_>, p: &soifra_graph::LibraryPlan| {
        p.when.as_ref().map(|e| compile::alone_as(c, e, &[], &Type::Bool)).transpose()
    };
    let plans = graph.plans.iter().map(|p| keep(plan(c, p), errors)).collect::<Vec<_>>();
    let judge = keep(judge::judge(c, graph), errors);
    let scene = keep(scene::compile(c, graph), errors);
    for s in graph.goals.iter().flat_map(|g| &g.subgoals) {
        if s.agent.is_some_and(|a| a as usize >= graph.agents.len()) {
            errors.push(CompileError {
                text: "a sub-goal names an agent that does not exist".into(),
                at: s.at,
            });
        }
    }
    let (agents, groups): (Option<Vec<_>>, Option<Vec<_>>) =
        (agents.into_iter().collect(), groups.into_iter().collect());
    let topics: Option<Vec<_>> = topics.into_iter().collect();
    let talks: Option<Vec<_>> = talks.into_iter().collect();
    let plans: Option<Vec<_>> = plans.into_iter().collect();
    Some(Parts {
        agents: agents?,
        groups: groups?,
        topics: topics?,
        talks: talks?,
        plans: plans?,
        judge: judge?,
        scene: scene?,
    })
}

fn talk(c: &mut Compiler<'_>, t: &soifra_graph::Conversation) -> Compiled<TalkChannelCode> {
    let states = t.states.len();
    for s in &t.states {
        let targets = s.moves.iter().map(|m| m.target).chain(s.timeout.as_ref().map(|t| t.1));
        if targets.into_iter().any(|t| t as usize >= states) {
            return compile::damaged(s.at, "a protocol leads to a state that does not exist");
        }
    }
    let mut arg = |name: &str| {
        let e = t.channel.args.iter().find(|(n, _)| **n == *name).map(|(_, e)| e);
        e.map(|e| compile::alone(c, e, &[])).transpose()
    };
    let (delay, loss, capacity) = (arg("delay")?, arg("loss")?, arg("capacity")?);
    let timeout = |s: &soifra_graph::ProtocolState| compile::perhaps(c, s.timeout.as_ref().map(|t| &t.0));
    let timeouts = t.states.iter().map(timeout).collect::<Compiled<_>>()?;
    Ok(TalkChannelCode { delay, loss, capacity, timeouts })
}

fn topic(c: &mut Compiler<'_>, graph: &Graph, t: &soifra_graph::Topic) -> Compiled<TopicCode> {
    let mut arg = |name: &str| {
        let e = t.channel.args.iter().find(|(n, _)| **n == *name).map(|(_, e)| e);
        e.map(|e| compile::alone(c, e, &[])).transpose()
    };
    Ok(TopicCode {
        name: t.channel.name.clone(),
        width: graph.types.width(&t.ty),
        delay: arg("delay")?,
        loss: arg("loss")?,
        range: arg("range")?,
        lifetime: arg("lifetime")?,
        capacity: arg("capacity")?,
    })
}

fn diagnostic(e: CompileError) -> Diagnostic {
    Diagnostic::error(DAMAGED, format!("the graph is damaged: {}", e.text))
        .at(e.at, "here")
        .hint("compile the mission from its sources again")
}
