//! Prepares a run.

use super::{
    Clock, Engine, TalkChannel,
    activate::Desk,
    actuate::Actuators,
    batch::Workers,
    board::{Board, Channel},
    cast::Cast,
    contacts::Contacts,
    cores::{CoreState, Tally},
    devices::DeviceState,
    directory::Directory,
    goals::Goals,
    judge::{Judge, Watch},
    lives::Lives,
    minds::Minds,
    operator::Operator,
    planner::Planner,
    post::Mail,
    queue::Queue,
    recorder::Recorder,
    regions::Regions,
    sampled::Gathered,
    senses::Senses,
    store::Store,
    talks::Talks,
    troubles::Troubles,
    verdict::Track,
};
use crate::{
    Mission, Platform, Readings, Scene, Settings, Time, TraceSink,
    mission::{
        START_VALUE,
        code::{ExpectKindCode, StrategyCode, TriggerCode},
        start::Start,
        uses::Uses,
    },
};
use soifra_graph::{Diagnostic, eval::Block, planning::Pool};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::atomic::AtomicBool,
};

/// A message takes at least this long.
const LEAST_DELAY: Time = Time(1_000);

/// The most messages heard or waiting, whatever a topic declares.
const MOST_CAPACITY: f64 = 65_536.0;

impl<'m> Engine<'m> {
    /// Prepares a run. `stop` is the operator's stop: once it is true, the run ends after the current
    /// instant with every robot's safe action.
    ///
    /// # Errors
    /// When an initial value, an argument or a duration cannot be computed.
    pub fn new(
        mission: &'m Mission,
        settings: &Settings,
        scene: &'m Scene,
        platform: &'m mut dyn Platform,
        sink: &'m mut dyn TraceSink,
        stop: &'m AtomicBool,
    ) -> Result<Engine<'m>, Diagnostic> {
        let mut start = Start::new(mission, settings)?;
        let mut cast = Cast::new(mission, scene, &mut start)?;
        let queue = Queue::new(std::mem::take(&mut cast.timers));
        let truth = platform.truth().is_some();
        let boards = boards(mission, &cast, &mut start, truth)?;
        let actuators = Actuators::new(scene, &mission.groups, |robot, channel| {
            let Some((binding, arbiter)) = channel.arbiter else { return Ok(Vec::new()) };
            let instance = cast.of_robot(robot).start + binding as usize;
            let agent = &mission.agents[cast.instances[instance].agent as usize];
            let StrategyCode::Layers(layers) = &agent.arbiters[arbiter as usize].strategy else {
                return Ok(Vec::new());
            };
            layers.iter().map(|l| Ok(seconds(&mut start, l.hold.as_ref())?.unwrap_or_default())).collect()
        })?;
        let limit = match &mission.judge.within {
            Some(w) => Some(limit(&mut start, scene, w)?),
            None => None,
        };
        let judge = judge(mission, scene, &mut start, truth)?;
        let goals = Goals::new(mission, scene, &cast);
        let (subscribers, on_reading, on_param) = receivers(mission, scene, &cast);
        let channels = talk_channels(mission, &mut start)?;
        let minds = Minds::new(&cast);
        let groups: Vec<u32> = scene.robots.iter().map(|r| r.group).collect();
        let pool = Pool::new(&mission.graph, &groups);
        let troubles = Troubles::new(mission, scene)?;
        let restarts = restarts(mission, &cast, &mut start)?;
        let units = cast.units.len();
        let frame = mission.frame.max(1);
        let mut engine = Engine {
            mission,
            scene,
            platform,
            recorder: Recorder::new(sink),
            stop,
            operator: Operator::default(),
            seed: settings.seed,
            texts: start.texts,
            regions: Regions::new(&mission.graph, scene),
            subscribers,
            on_reading,
            limit,
            now: Time::ZERO,
            resumed: false,
            over: false,
            polled: Time::ZERO,
            params: start.params,
            new_params: Vec::new(),
            subgoals: minds.subgoals.clone(),
            minds,
            clocks: vec![Clock::default(); cast.units.len()],
            tallies: vec![Tally::default(); cast.units.len()],
            cores: vec![CoreState::default(); cast.cores.len()],
            touched: Vec::new(),
            devices: vec![DeviceState::default(); cast.devices.len()],
            senses: Senses::new(scene, &mission.graph.types),
            boards,
            mail: Mail::new(cast.units.len()),
            talks: Talks::default(),
            ended: Vec::new(),
            channels,
            directory: Directory::new(mission, &cast),
            store: Store::default(),
            pool,
            planner: Planner::new(mission),
            lives: Lives::default(),
            restarts,
            reset: BTreeSet::new(),
            troubles,
            on_param,
            queue,
            actuators,
            contacts: Contacts::new(scene.robots.len()),
            goals,
            judge,
            faults: Vec::new(),
            aborted: None,
            poses: vec![None; scene.bodies().len()],
            movers: BTreeMap::new(),
            places: vec![[0.0; 3]; scene.bodies().len()],
            arriving: Vec::new(),
            readings: Readings::default(),
            reports: Vec::new(),
            releases: Vec::new(),
            outcomes: Vec::new(),
            workers: Workers::new(settings.threads, frame),
            desk: Desk { frame: vec![0.0; frame], ..Desk::default() },
            events: 0,
            cast,
        };
        engine.lives =
            Lives::new(engine.cast.instances.len(), (0..units as u32).map(|u| engine.starts_on(u)).collect());
        engine.schedule_faults()?;
        Ok(engine)
    }
}

/// How often each agent may fail within how long.
fn restarts(
    mission: &Mission,
    cast: &Cast,
    start: &mut Start<'_>,
) -> Result<Vec<Option<(u32, Time)>>, Diagnostic> {
    let mut out = Vec::new();
    for who in &cast.instances {
        out.push(match &mission.agents[who.agent as usize].restart {
            Some((times, within)) => Some((*times, seconds(start, Some(within))?.unwrap_or_default())),
            None => None,
        });
    }
    Ok(out)
}

fn seconds(start: &mut Start<'_>, block: Option<&Block>) -> Result<Option<Time>, Diagnostic> {
    let Some(block) = block else { return Ok(None) };
    let s = start.run(block, &[])?.first().copied().unwrap_or(0.0);
    match Time::from_seconds(s) {
        Some(t) if t >= Time::ZERO => Ok(Some(t)),
        _ => Err(Diagnostic::error(START_VALUE, format!("a duration of {s} s is not possible"))),
    }
}

/// A time limit in seconds or steps.
fn limit(
    start: &mut Start<'_>,
    scene: &Scene,
    (block, in_steps): &(Block, bool),
) -> Result<Time, Diagnostic> {
    if !in_steps {
        return Ok(seconds(start, Some(block))?.unwrap_or_default());
    }
    let steps = start.run(block, &[])?.first().copied().unwrap_or(0.0);
    let step = scene.step.unwrap_or_default();
    Time::from_seconds(steps * step.seconds())
        .filter(|t| *t >= Time::ZERO)
        .map(|_| Time((step.0 as i128 * steps.round() as i128).clamp(0, i64::MAX as i128) as i64))
        .ok_or_else(|| Diagnostic::error(START_VALUE, format!("a limit of {steps} steps is not possible")))
}

fn boards(
    mission: &Mission,
    cast: &Cast,
    start: &mut Start<'_>,
    truth: bool,
) -> Result<Vec<Board>, Diagnostic> {
    let graph = &mission.graph;
    // Which units publish on which topic, by agent type.
    let publishes: Vec<Vec<Uses>> =
        graph.agents.iter().map(|a| a.units.iter().map(Uses::of_unit).collect()).collect();
    let mut boards = Vec::new();
    for (t, code) in mission.topics.iter().enumerate() {
        let number = |start: &mut Start<'_>, block: Option<&Block>| -> Result<Option<f64>, Diagnostic> {
            let Some(block) = block else { return Ok(None) };
            let r = start.run(block, &[])?;
            Ok(match *r {
                [x] => Some(x),
                [tag, x] => (tag == 0.0).then_some(x),
                _ => None,
            })
        };
        let bad = |what: &str, x: f64| {
            Diagnostic::error(START_VALUE, format!("topic `{}` cannot have a {what} of {x}", code.name))
        };
        let duration = |what: &str, s: Option<f64>| match s.map(|s| (s, Time::from_seconds(s))) {
            None => Ok(None),
            Some((_, Some(t))) if t >= Time::ZERO => Ok(Some(t)),
            Some((s, _)) => Err(bad(what, s)),
        };
        let delay = duration("delay", number(start, code.delay.as_ref())?)?;
        let lifetime = duration("lifetime", number(start, code.lifetime.as_ref())?)?;
        let loss = number(start, code.loss.as_ref())?.unwrap_or(0.0);
        let range = number(start, code.range.as_ref())?;
        let capacity = number(start, code.capacity.as_ref())?.unwrap_or(16.0);
        if !(0.0..=1.0).contains(&loss) {
            return Err(bad("loss", loss));
        }
        if !(1.0..=MOST_CAPACITY).contains(&capacity) {
            return Err(bad("capacity", capacity));
        }
        if let Some(r) = range.filter(|r| *r < 0.0) {
            return Err(bad("range", r));
        }
        let mut senders = Vec::new();
        let mut period: Option<Time> = None;
        for (i, instance) in cast.instances.iter().enumerate() {
            let mut sends = false;
            for (u, uses) in publishes[instance.agent as usize].iter().enumerate() {
                if uses.publishes.contains(&(t as u32)) {
                    sends = true;
                    let info = &cast.units[instance.units as usize + u];
                    period = info.period.map(|p| period.map_or(p, |q: Time| q.min(p))).or(period);
                }
            }
            if sends {
                senders.push(i as u32);
            }
        }
        let channel = Channel {
            width: code.width,
            delay: delay.unwrap_or_default().max(LEAST_DELAY),
            loss,
            range,
            lifetime,
            capacity: capacity as usize,
        };
        boards.push(Board::new(start.seed, t as u32, channel, senders, period, truth));
    }
    Ok(boards)
}

fn talk_channels(mission: &Mission, start: &mut Start<'_>) -> Result<Vec<TalkChannel>, Diagnostic> {
    let mut out = Vec::new();
    for (code, c) in mission.talks.iter().zip(&mission.graph.conversations) {
        let delay = seconds(start, code.delay.as_ref())?.unwrap_or_default().max(LEAST_DELAY);
        let mut number = |block: Option<&Block>, default: f64| -> Result<f64, Diagnostic> {
            match block {
                Some(b) => Ok(start.run(b, &[])?.first().copied().unwrap_or(default)),
                None => Ok(default),
            }
        };
        let (loss, capacity) = (number(code.loss.as_ref(), 0.0)?, number(code.capacity.as_ref(), 64.0)?);
        if !(0.0..=1.0).contains(&loss) || !(1.0..=MOST_CAPACITY).contains(&capacity) {
            let text = format!(
                "conversation `{}` cannot have a loss of {loss} and a capacity of {capacity}",
                c.name
            );
            return Err(Diagnostic::error(START_VALUE, text).at(c.at, "here"));
        }
        let mut timeouts = Vec::new();
        for t in &code.timeouts {
            timeouts.push(seconds(start, t.as_ref())?);
        }
        out.push(TalkChannel { delay, loss, capacity: capacity as usize, timeouts });
    }
    Ok(out)
}

fn judge(mission: &Mission, scene: &Scene, start: &mut Start<'_>, truth: bool) -> Result<Judge, Diagnostic> {
    let mut watches = Vec::new();
    for code in &mission.judge.expects {
        let given = match &code.kind {
            ExpectKindCode::Eventually(_, t) | ExpectKindCode::LeadsTo(_, _, t) => t.as_ref(),
            _ => None,
        };
        let limit = match given {
            Some(t) => Some(limit(start, scene, t)?),
            None => None,
        };
        let tracks = if code.each_robot { scene.bodies().len() } else { 1 };
        let blind = !truth && (code.truth || code.contacts);
        watches.push(Watch { tracks: vec![Track::default(); tracks], limit, blind, decided: Vec::new() });
    }
    let gathered = vec![Gathered::default(); mission.judge.metrics.len()];
    Ok(Judge { watches, gathered, frame: vec![0.0; mission.judge.frame.max(1)] })
}

type OnReading = BTreeMap<(u32, u32), Vec<u32>>;
type OnParam = BTreeMap<u32, Vec<u32>>;

/// Units that messages, readings and parameters set off.
fn receivers(mission: &Mission, scene: &Scene, cast: &Cast) -> (Vec<Vec<u32>>, OnReading, OnParam) {
    let mut subscribers = vec![Vec::new(); mission.topics.len()];
    let (mut on_reading, mut on_param) = (OnReading::new(), OnParam::new());
    for (u, info) in cast.units.iter().enumerate() {
        let who = &cast.instances[info.instance as usize];
        let group = &mission.groups[scene.robots[who.robot as usize].group as usize];
        match &mission.agents[who.agent as usize].units[info.unit as usize].trigger {
            TriggerCode::Message { topic } => subscribers[*topic as usize].push(u as u32),
            TriggerCode::Reading(port) => {
                let sensor = group.agents[who.binding as usize].sensors[*port as usize];
                on_reading.entry((who.robot, sensor)).or_default().push(u as u32);
            }
            TriggerCode::Param(p) => on_param.entry(*p).or_default().push(u as u32),
            _ => {}
        }
    }
    (subscribers, on_reading, on_param)
}
