//! Can the faults that a mission or test declares happen? They name agents, channels, sensors and goals.

use crate::{code, decls::unknown};
use soifra_graph::{Component, Diagnostic, Dim, Expr, Graph, RobotGroup, Type, TypeTable, Value};

/// Checks every fault.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    g.faults.iter().filter_map(|f| fault(g, f)).collect()
}

fn fault(g: &Graph, f: &Component) -> Option<Diagnostic> {
    match &*f.model {
        "kill" => {
            let (text, e) = text(f, "agent")?;
            let (agent, robot) = text.split_once('@').map_or((text, None), |(a, r)| (a, Some(r)));
            let used = super::used_agents(g);
            let agents: Vec<&str> =
                g.agents.iter().zip(used).filter(|(_, used)| *used).map(|(a, _)| &*a.name).collect();
            if !agents.contains(&agent) {
                return Some(unknown(code::FAULT, "agent of the mission:", agent, e.span, agents));
            }
            let robot = robot?;
            let runs = |r: &&RobotGroup| {
                r.agents.iter().any(|b| g.agents.get(b.agent as usize).is_some_and(|a| *a.name == *agent))
            };
            let groups: Vec<&RobotGroup> = g.robots.iter().filter(runs).collect();
            (!groups.iter().any(|r| is_of(r, robot))).then(|| {
                let what = format!("robot or host that runs `{agent}`:");
                unknown(code::FAULT, &what, robot, e.span, groups.iter().map(|r| &*r.name))
            })
        }
        "dropout" | "bias" => {
            let (text, e) = text(f, "sensor")?;
            let (robot, sensor) = text.split_once('.').unwrap_or((text, ""));
            let Some(group) = g.bodies().find(|r| is_of(r, robot)) else {
                return Some(
                    unknown(code::FAULT, "robot", robot, e.span, g.bodies().map(|r| &*r.name))
                        .hint("write `ROBOT.SENSOR`"),
                );
            };
            let platform = g.platforms.get(group.platform as usize)?;
            let Some(part) = platform.of_role("sensor").find(|c| &*c.name == sensor) else {
                let known = platform.of_role("sensor").map(|c| &*c.name);
                let what = format!("sensor of `{}`:", platform.name);
                return Some(unknown(code::FAULT, &what, sensor, e.span, known));
            };
            let lengths = part.ty.as_ref().is_none_or(|t| has_lengths(t, &g.types));
            (&*f.model == "bias" && !lengths).then(|| {
                Diagnostic::error(code::FAULT, format!("`{sensor}` measures no lengths"))
                    .at(e.span, "has no ranges or positions that could be off")
                    .at(part.at, "this sensor")
                    .hint("a bias is for sensors of ranges, distances and poses")
            })
        }
        "drop" | "delay" | "duplicate" | "corrupt" => {
            let (text, e) = text(f, "of")?;
            let topics = g.topics.iter().map(|t| &*t.channel.name);
            let known: Vec<&str> = topics.chain(g.conversations.iter().map(|c| &*c.name)).collect();
            (!known.contains(&text))
                .then(|| unknown(code::FAULT, "topic or conversation", text, e.span, known))
        }
        // Whoever asks for a goal that is not there is refused; that is what it is for.
        _ => None,
    }
}

/// Whether there are distances or positions in a value.
fn has_lengths(ty: &Type, types: &TypeTable) -> bool {
    match ty {
        Type::Quantity(Dim::LENGTH) | Type::Point(_) | Type::Pose(_) => true,
        Type::Option(inner) | Type::List(inner, _) => has_lengths(inner, types),
        Type::Record(name) => {
            types.records.get(name).is_some_and(|r| r.fields.iter().any(|(_, t)| has_lengths(t, types)))
        }
        _ => false,
    }
}

/// A text written out; another expression has been refused before.
fn text<'f>(f: &'f Component, name: &str) -> Option<(&'f str, &'f Expr)> {
    let (_, e) = f.args.iter().find(|(n, _)| &**n == name)?;
    match e.as_const() {
        Some(Value::Text(t)) => Some((t, e)),
        _ => None,
    }
}

/// Whether a name is that of a robot of the group: `NAME`, or `NAME[2]` for one of an array.
fn is_of(r: &RobotGroup, name: &str) -> bool {
    match name.split_once('[') {
        Some((array, index)) => r.count.is_some() && *r.name == *array && index.ends_with(']'),
        None => r.count.is_none() && *r.name == *name,
    }
}
