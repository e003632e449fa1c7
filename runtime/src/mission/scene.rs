//! Sets the scene: evaluates the world, platforms and robots of a graph for one seed and one set of
//! parameters.
//!
//! Every component, start, target and scatter draws from a stream of its own, named after it.

use super::{
    Mission, Settings,
    code::*,
    compile::{Compiled, alone, alone_as, damaged, perhaps},
    start::Start,
};
use crate::{
    Scene, Time,
    scene::{Part, PlatformScene, RobotScene},
    seed::Stream,
};
use soifra_graph::{
    Component, Diagnostic, Dim, Distribution, Expr, Frame, Graph, Name, RobotGroup, Type, Value,
    eval::{Block, Compiler},
};
use std::collections::BTreeMap;

/// The most robots, and the most instances of one array of a world.
pub const MAX_INSTANCES: usize = 1 << 20;

pub(super) fn compile(c: &mut Compiler<'_>, graph: &Graph) -> Compiled<SceneCode> {
    let components = |c: &mut Compiler<'_>, list: &[Component]| -> Compiled<Vec<ComponentCode>> {
        list.iter().map(|x| component(c, x)).collect()
    };
    Ok(SceneCode {
        step: perhaps(c, graph.step.as_ref())?,
        world: components(c, &graph.world)?,
        platforms: graph.platforms.iter().map(|p| components(c, &p.components)).collect::<Compiled<_>>()?,
        robots: graph.robots.iter().map(|r| robot(c, r)).collect::<Compiled<_>>()?,
        faults: components(c, &graph.faults)?,
    })
}

fn component(c: &mut Compiler<'_>, x: &Component) -> Compiled<ComponentCode> {
    let mut args = Vec::new();
    for (name, e) in &x.args {
        args.push((name.clone(), alone(c, e, &[Type::Int])?, e.ty.clone()));
    }
    Ok(ComponentCode { count: count(c, x.count.as_ref())?, args })
}

fn count(c: &mut Compiler<'_>, e: Option<&Expr>) -> Compiled<Option<Block>> {
    match e {
        Some(e) if e.ty != Type::Int => damaged(e.span, "a whole number is wanted here"),
        Some(e) => Ok(Some(alone(c, e, &[])?)),
        None => Ok(None),
    }
}

fn robot(c: &mut Compiler<'_>, r: &RobotGroup) -> Compiled<RobotCode> {
    let mut one = |e: &Expr, ty: &Type| alone_as(c, e, &[Type::Int], ty);
    let start = one(&r.start, &Type::Pose(Frame::map()))?;
    let scatter = r.scatter.as_ref().map(|e| one(e, &Type::Distribution(Dim::LENGTH))).transpose()?;
    let target = r.target.as_ref().map(|e| one(e, &Type::Point(Frame::map()))).transpose()?;
    Ok(RobotCode { count: count(c, r.count.as_ref())?, start, scatter, target })
}

/// Evaluates everything.
pub(super) fn set(mission: &Mission, settings: &Settings) -> Result<Scene, Diagnostic> {
    let mut start = Start::new(mission, settings)?;
    let (graph, code) = (&mission.graph, &mission.scene);
    let step = match &code.step {
        Some(b) => Some(start.positive(b, "the step of the step clock")?),
        None => None,
    };
    let mut world = Vec::new();
    for (x, code) in graph.world.iter().zip(&code.world) {
        let Some(count) = &code.count else {
            world.push(part(&mut start, x, code, x.name.to_string(), "", 0)?);
            continue;
        };
        for i in 0..start.count(count)? {
            world.push(part(&mut start, x, code, format!("{}[{i}]", x.name), "", i)?);
        }
    }
    let mut platforms = Vec::new();
    for (p, code) in graph.platforms.iter().zip(&code.platforms) {
        let prefix = format!("platform/{}/", p.name);
        let mut parts = Vec::new();
        for (x, code) in p.components.iter().zip(code) {
            parts.push(part(&mut start, x, code, x.name.to_string(), &prefix, 0)?);
        }
        platforms.push(PlatformScene { name: p.name.clone(), parts });
    }
    let mut robots = Vec::new();
    for (g, (r, code)) in graph.robots.iter().zip(&code.robots).enumerate() {
        let consumed = &mission.groups[g].consumed;
        let instances = match &code.count {
            Some(count) => (0..start.count(count)?).map(|i| (i, format!("{}[{i}]", r.name))).collect(),
            None => vec![(0, r.name.to_string())],
        };
        if robots.len() + instances.len() > MAX_INSTANCES {
            return Err(Diagnostic::error(super::START_VALUE, "too many robots").at(r.at, "here"));
        }
        for (i, name) in instances {
            let robot = place(&mut start, code, g as u32, r.platform, name, i, consumed)?;
            robots.push(RobotScene { host: r.host, ..robot });
        }
    }
    let mut faults = Vec::new();
    for (number, (x, code)) in graph.faults.iter().zip(&code.faults).enumerate() {
        // They have no names: their place among them tells their random numbers apart.
        let part = part(&mut start, x, code, number.to_string(), "", 0)?;
        faults.push(Part { name: String::new(), ..part });
    }
    Ok(Scene { seed: settings.seed, step, world, platforms, robots, faults, images: mission.images.clone() })
}

fn part(
    start: &mut Start<'_>,
    x: &Component,
    code: &ComponentCode,
    name: String,
    prefix: &str,
    index: usize,
) -> Result<Part, Diagnostic> {
    start.stream = Some(Stream::new(start.seed, &format!("{prefix}{}/{name}", x.role)));
    let mut args: BTreeMap<Name, Value> = BTreeMap::new();
    for (arg, block, ty) in &code.args {
        let registers = start.run(block, &[(0, index as f64)])?.to_vec();
        args.insert(arg.clone(), start.value(&registers, ty));
    }
    Ok(Part { role: x.role.clone(), name, model: x.model.clone(), args, ty: x.ty.clone() })
}

fn place(
    start: &mut Start<'_>,
    code: &RobotCode,
    group: u32,
    platform: u32,
    name: String,
    index: usize,
    consumed: &[bool],
) -> Result<RobotScene, Diagnostic> {
    let index = [(0, index as f64)];
    start.stream = Some(Stream::new(start.seed, &format!("robot/{name}/start")));
    let mut pose = [0.0; 7];
    for (p, x) in pose.iter_mut().zip(start.run(&code.start, &index)?) {
        *p = *x;
    }
    let mut scattered = pose;
    if let Some(scatter) = &code.scatter {
        let from = Distribution::from_registers(start.run(scatter, &index)?);
        let mut stream = Stream::new(start.seed, &format!("robot/{name}/scatter"));
        scattered[0] += stream.draw(from);
        scattered[1] += stream.draw(from);
    }
    let target = match &code.target {
        Some(b) => {
            start.stream = Some(Stream::new(start.seed, &format!("robot/{name}/target")));
            let r = start.run(b, &index)?;
            Some([r[0], r[1], r[2]])
        }
        None => None,
    };
    Ok(RobotScene {
        name,
        group,
        platform,
        declared_start: pose,
        start: scattered,
        target,
        consumed: consumed.to_vec(),
        host: false,
    })
}

impl Start<'_> {
    /// How many instances an array has.
    fn count(&mut self, block: &Block) -> Result<usize, Diagnostic> {
        let n = self.run(block, &[])?[0];
        if (0.0..=MAX_INSTANCES as f64).contains(&n) {
            return Ok(n as usize);
        }
        Err(Diagnostic::error(super::START_VALUE, format!("an array of {n} instances is not possible")))
    }

    /// A duration of a microsecond at least.
    pub(crate) fn positive(&mut self, block: &Block, what: &str) -> Result<Time, Diagnostic> {
        let s = self.run(block, &[])?[0];
        Time::from_seconds(s).filter(|t| t.0 >= 1_000).ok_or_else(|| {
            Diagnostic::error(
                super::START_VALUE,
                format!("{what} is {s} s; it must be at least a microsecond"),
            )
        })
    }
}
