//! Has every platform the sensors, actuators and parts that its robots' agents need?

use super::walk;
use crate::{code, decls::unknown};
use soifra_graph::{Agent, AgentBinding, Diagnostic, Graph, Op, Own, Platform, Port, RobotGroup};

/// Checks every robot against its platform, and every platform by itself.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for (i, p) in g.platforms.iter().enumerate() {
        if g.robots.iter().any(|r| r.host && r.platform as usize == i) {
            continue;
        }
        complete(p, &mut out);
        driven(p, &mut out);
        equipped(p, &mut out);
        airborne(p, &mut out);
    }
    for r in &g.robots {
        let Some(p) = g.platforms.get(r.platform as usize) else { continue };
        for b in &r.agents {
            let Some(a) = g.agents.get(b.agent as usize) else { continue };
            for port in &a.sensors {
                port_on(a, b, r, p, port, "sensor", code::LACKS_SENSOR, &mut out);
            }
            for port in &a.actuators {
                port_on(a, b, r, p, port, "actuator", code::LACKS_ACTUATOR, &mut out);
            }
            if !r.host && p.of_role("cruise").next().is_none() {
                cruises(a, r, p, &mut out);
            }
        }
    }
    // One port that many robots lack is one mistake.
    let mut seen = std::collections::BTreeSet::new();
    out.retain(|d| seen.insert((d.code, d.position())));
    out
}

fn complete(p: &Platform, out: &mut Vec<Diagnostic>) {
    if p.of_role("safe").next().is_none() {
        out.push(
            Diagnostic::error(code::NO_SAFE_ACTION, format!("`{}` has no safe action", p.name))
                .at(p.at, "what should it do when in doubt?")
                .hint("add `safe = stop()`"),
        );
    }
    for role in ["body", "drive"] {
        if p.of_role(role).next().is_none() {
            out.push(
                Diagnostic::error(code::INCOMPLETE_PLATFORM, format!("`{}` has no {role}", p.name))
                    .at(p.at, format!("no `{role} = …` here"))
                    .hint(format!("add one; the models are listed under `{role}` in docs/language.md")),
            );
        }
    }
}

/// The drive of a platform that is a recording.
const RECORDED: &str = "recorded";

/// What only one kind of drive has: an actuator or sensor, the drive that it needs, and why.
const NEEDS_DRIVE: &[(&str, &str, &str)] = &[
    ("strides", "holonomic", "a stride goes in any direction"),
    ("encoders", "differential", "pulses are counted at two wheels"),
    ("footage", "recorded", "its images come from a recording"),
];

/// Sensors, what they read, and why: a role of the platform and, unless any will do, its model.
const NEEDS_PART: &[(&str, &str, &str, &str)] = &[
    ("charge", "power", "battery", "a charge is that of a battery"),
    ("holding", "actuator", "gripper", "a gripper holds things, or does not"),
];

/// Sensors without what they read.
fn equipped(p: &Platform, out: &mut Vec<Diagnostic>) {
    for c in p.of_role("sensor") {
        let Some((model, role, part, why)) = NEEDS_PART.iter().find(|(m, ..)| *c.model == **m) else {
            continue;
        };
        if !p.of_role(role).any(|x| *x.model == **part) {
            let title = format!("`{model}` of `{}` needs a {part}", p.name);
            let d = Diagnostic::error(code::INCOMPLETE_PLATFORM, title).at(c.at, *why);
            out.push(d.hint(format!("add `{role} … = {part}(…)` to the profile, or leave the sensor out")));
        }
    }
}

/// An agent that asks for a cruise speed that the platform does not tell.
fn cruises(a: &Agent, r: &RobotGroup, p: &Platform, out: &mut Vec<Diagnostic>) {
    let mut asked = None;
    walk::agent(a, &mut |e| {
        if e.op == Op::Own(Own::CruiseSpeed) {
            asked = asked.or(Some(e.span));
        }
    });
    if let Some(at) = asked {
        out.push(
            Diagnostic::error(code::INCOMPLETE_PLATFORM, format!("`{}` has no cruise speed", p.name))
                .at(at, format!("`{}` needs it", a.name))
                .at(r.at, format!("`{}` is one", r.name))
                .hint("add `cruise = speed(50 cm/s)` to the profile, or choose another platform"),
        );
    }
}

/// Drives that leave the ground, and what they do.
const LEAVES_GROUND: &[(&str, &str)] = &[("quadrotor", "flies"), ("submersible", "swims")];

/// What is done off the ground: roles and models.
const OFF_THE_GROUND: &[(&str, &str)] =
    &[("prepare", "take_off"), ("safe", "hover"), ("safe", "land"), ("finish", "land")];

/// A drive that leaves the ground takes off; others do not. What was recorded may have left it.
fn airborne(p: &Platform, out: &mut Vec<Diagnostic>) {
    let Some(drive) = p.of_role("drive").next() else { return };
    if *drive.model == *RECORDED {
        return;
    }
    let leaves = LEAVES_GROUND.iter().find(|(model, _)| *drive.model == **model);
    if let Some((_, what)) = leaves
        && !p.of_role("prepare").any(|c| *c.model == *"take_off")
    {
        out.push(
            Diagnostic::error(code::INCOMPLETE_PLATFORM, format!("`{}` never takes off", p.name))
                .at(drive.at, *what)
                .hint("add `prepare = take_off(height: 1 m)`"),
        );
    }
    let grounded = leaves.is_none();
    for c in p.components.iter().filter(|c| grounded && OFF_THE_GROUND.contains(&(&*c.role, &*c.model))) {
        out.push(
            Diagnostic::error(
                code::INCOMPLETE_PLATFORM,
                format!("`{}` of `{}` needs wings or fins", c.model, p.name),
            )
            .at(c.at, "only what flies or swims can do this")
            .at(drive.at, format!("this drive is {}", drive.model))
            .hint("write `stop()`, or take a drive that flies or swims"),
        );
    }
}

/// Actuators and sensors that the drive cannot serve. A recording serves all.
fn driven(p: &Platform, out: &mut Vec<Diagnostic>) {
    let Some(drive) = p.of_role("drive").next() else { return };
    for c in p.components.iter().filter(|_| *drive.model != *RECORDED) {
        for (model, needed, why) in NEEDS_DRIVE {
            if *c.model == **model && *drive.model != **needed {
                out.push(
                    Diagnostic::error(
                        code::INCOMPLETE_PLATFORM,
                        format!("`{model}` of `{}` needs a {needed} drive", p.name),
                    )
                    .at(c.at, *why)
                    .at(drive.at, format!("this drive is {}", drive.model))
                    .hint(format!("take another `{}`, or another drive", c.role)),
                );
            }
        }
    }
}

#[allow(
    clippy::too_many_arguments,
    reason = "one call site a kind of port; a struct would only rename them, 2026-11"
)]
fn port_on(
    a: &Agent,
    b: &AgentBinding,
    r: &RobotGroup,
    p: &Platform,
    port: &Port,
    role: &str,
    lacks: &'static str,
    out: &mut Vec<Diagnostic>,
) {
    match p.of_role(role).find(|c| c.name == port.name) {
        None => {
            let same: Vec<&str> = p
                .of_role(role)
                .filter(|c| c.ty.as_ref().is_some_and(|t| t.serves(&port.ty)))
                .map(|c| &*c.name)
                .collect();
            let all: Vec<&str> = p.of_role(role).map(|c| &*c.name).collect();
            let mut d =
                unknown(lacks, &format!("{role} on {}:", p.name), &port.name, port.span, all.iter().copied());
            d.title = format!("`{}` on `{}` has no {role} `{}`", r.name, p.name, port.name);
            d.labels[0].text = format!("`{}` needs it", a.name);
            let d = d.at(b.at, format!("`{}` runs it", r.name));
            out.push(match same.as_slice() {
                _ if r.host => d.hint("a host has no body; let a robot run this agent"),
                [] => match all.as_slice() {
                    [] => d.hint(format!("the platform has none; choose another platform, or add `{role} {} = …` to its profile", port.name)),
                    _ => d,
                },
                list => d.hint(format!("of that type it has {}", list.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", "))),
            });
        }
        Some(c) => {
            let Some(have) = &c.ty else { return };
            if !have.serves(&port.ty) {
                out.push(
                    Diagnostic::error(
                        code::PORT_TYPE,
                        format!("{role} `{}` of `{}` has another type", port.name, p.name),
                    )
                    .at(port.span, format!("{} is wanted", port.ty))
                    .at(c.at, format!("{have} is what it gives"))
                    .hint(format!(
                        "declare `{role} {}: {have}{}` in the agent, or choose a platform that fits",
                        port.name,
                        if port.optional { "?" } else { "" }
                    )),
                );
            }
        }
    }
}
