//! Values at the start of a run: parameters, durations, arguments, initial states, the scene.

use super::{Mission, PARAMETER, START_VALUE, Settings};
use crate::{Scene, seed::Stream};
use soifra_graph::{
    Diagnostic, Distribution, Own, Type, Value, did_you_mean,
    eval::{Block, Env, FaultKind, Memory},
};

/// Evaluates blocks outside of any activation.
pub(crate) struct Start<'m> {
    mission: &'m Mission,
    pub(crate) seed: u64,
    /// Parameters of the run.
    pub(crate) params: Vec<f64>,
    /// Texts of the mission and of the parameters that were set.
    pub(crate) texts: soifra_graph::Texts,
    /// What draws come from.
    pub(crate) stream: Option<Stream>,
    /// The robot in question.
    pub(crate) robot: Option<(&'m Scene, u32)>,
    frame: Vec<f64>,
}

impl<'m> Start<'m> {
    /// With the parameters of a run.
    pub(crate) fn new(mission: &'m Mission, settings: &Settings) -> Result<Self, Diagnostic> {
        let graph = &mission.graph;
        let mut texts = mission.texts.clone();
        for name in settings.params.keys() {
            if !graph.params.iter().any(|p| *p.name == **name) {
                let d = Diagnostic::error(PARAMETER, format!("there is no parameter `{name}`"));
                let names = graph.params.iter().map(|p| &*p.name);
                return Err(match did_you_mean(name, names) {
                    Some(near) => d.hint(format!("did you mean `{near}`?")),
                    None => d,
                });
            }
        }
        let mut params = Vec::new();
        for p in &graph.params {
            let value = settings.params.get(&*p.name).unwrap_or(&p.default);
            let from = params.len();
            let fits = value.flatten(&p.ty, &graph.types, &mut texts, &mut params).is_some();
            if !fits || !params[from..].iter().all(|x| x.is_finite()) {
                let title = format!("parameter `{}` must be a {}", p.name, p.ty);
                return Err(Diagnostic::error(PARAMETER, title).at(p.at, "declared here"));
            }
        }
        Ok(Start {
            mission,
            seed: settings.seed,
            params,
            texts,
            stream: None,
            robot: None,
            frame: Vec::new(),
        })
    }

    /// Runs a block with some registers given, and returns its result.
    pub(crate) fn run(&mut self, block: &Block, given: &[(usize, f64)]) -> Result<&[f64], Diagnostic> {
        self.run_with(block, given, &[])
    }

    /// As [`Start::run`], for an agent with arguments.
    pub(crate) fn run_with(
        &mut self,
        block: &Block,
        given: &[(usize, f64)],
        arguments: &[f64],
    ) -> Result<&[f64], Diagnostic> {
        let size = (block.frame as usize).max(given.iter().map(|g| g.0 + 1).max().unwrap_or(0));
        self.frame.clear();
        self.frame.resize(size, 0.0);
        for &(register, x) in given {
            self.frame[register] = x;
        }
        let mut memory = Memory { states: &mut [], arguments, params: &self.params };
        let mut env = StartEnv { stream: self.stream.as_mut(), robot: self.robot };
        self.mission.program.run(block, &mut self.frame, &mut memory, &mut env).map_err(|fault| {
            Diagnostic::error(START_VALUE, format!("a value cannot be computed: {fault}"))
                .at(fault.at, "at the start of the run")
        })?;
        Ok(self.frame.get(block.result as usize..(block.result + block.width) as usize).unwrap_or_default())
    }

    /// A value from registers.
    pub(crate) fn value(&self, registers: &[f64], ty: &Type) -> Value {
        Value::from_registers(registers, ty, &self.mission.graph.types, &self.texts)
    }
}

struct StartEnv<'a> {
    stream: Option<&'a mut Stream>,
    robot: Option<(&'a Scene, u32)>,
}

impl Env for StartEnv<'_> {
    fn now(&self) -> Result<f64, FaultKind> {
        Ok(0.0)
    }
    fn steps(&self) -> Result<f64, FaultKind> {
        Ok(0.0)
    }
    fn own(&self, which: Own, out: &mut [f64]) -> Result<(), FaultKind> {
        match self.robot {
            Some((scene, robot)) => own(scene, robot, which, out),
            None => Err(FaultKind::Unavailable("the robot")),
        }
    }
    fn draw(&mut self, from: Distribution) -> Result<f64, FaultKind> {
        match &mut self.stream {
            Some(s) => Ok(s.draw(from)),
            None => Err(FaultKind::Unavailable("randomness")),
        }
    }
}

/// What a robot knows of itself.
pub(crate) fn own(scene: &Scene, robot: u32, which: Own, out: &mut [f64]) -> Result<(), FaultKind> {
    let missing = FaultKind::Unavailable("the robot");
    let r = scene.robots.get(robot as usize).ok_or(missing)?;
    let put = |from: &[f64], out: &mut [f64]| {
        if from.len() != out.len() {
            return Err(FaultKind::Malformed);
        }
        out.copy_from_slice(from);
        Ok(())
    };
    let body = |name: &str| {
        let body = scene.platforms.get(r.platform as usize).and_then(|p| p.of_role("body").next());
        body.map_or(0.0, |b| b.number(name))
    };
    match which {
        Own::Index => put(&[f64::from(robot)], out),
        Own::Start => put(&r.declared_start, out),
        Own::Target => put(&r.target.ok_or(FaultKind::Unavailable("a target"))?, out),
        Own::Radius => put(&[body("radius")], out),
        Own::Height => put(&[body("height")], out),
        Own::CruiseSpeed => {
            let platform = scene.platforms.get(r.platform as usize);
            let cruise = platform.and_then(|p| p.of_role("cruise").next());
            put(&[cruise.ok_or(FaultKind::Unavailable("a cruise speed"))?.number("of")], out)
        }
    }
}
