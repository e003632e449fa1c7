//! Are the sizes, chances and durations of worlds, platforms, topics and robots possible at all?

use super::{
    constants::Constants,
    possible::{Must, RULES},
};
use crate::code;
use soifra_graph::{
    Component, Diagnostic, Distribution, ExpectKind, Expr, Graph, PlanKind, Span, Strategy, Trigger, Type,
    UnitKind, Value,
};

/// Most of one array that are looked at one by one.
const MOST: usize = 256;
/// Most robots, or things of one declaration.
const LARGEST: i64 = 1 << 20;

/// Checks every argument whose value is known before the run.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut c = Ranges { known: Constants::new(g), out: Vec::new() };
    let parts = g.world.iter().chain(g.platforms.iter().flat_map(|p| &p.components));
    let channels = g.topics.iter().map(|t| &t.channel).chain(g.conversations.iter().map(|x| &x.channel));
    for part in parts.chain(channels).chain(&g.faults) {
        c.component(part);
    }
    for r in g.bodies() {
        c.count(r.count.as_ref(), &r.name);
        if let Some(s) = &r.scatter {
            c.distribution(s, "scatter", &r.name, 0);
        }
    }
    if let Some(step) = &g.step {
        c.period(step, "the step of the clock");
    }
    c.limits(g);
    c.behaviours(g);
    c.out
}

struct Ranges<'a> {
    known: Constants<'a>,
    out: Vec<Diagnostic>,
}

impl Ranges<'_> {
    fn component(&mut self, part: &Component) {
        let name = if part.name.is_empty() { &part.role } else { &part.name };
        self.count(part.count.as_ref(), name);
        let count = self.known.count(part.count.as_ref()).unwrap_or(1).min(MOST);
        for (argument, e) in &part.args {
            let constant = e.as_const().is_some();
            for index in 0..if constant { count.min(1) } else { count } {
                if !self.argument(argument, e, name, index as i64) {
                    break;
                }
            }
        }
        self.corners(part, name);
        self.lags(part);
    }

    /// Whether an argument is possible; reports it when not.
    fn argument(&mut self, argument: &str, e: &Expr, name: &str, index: i64) -> bool {
        if matches!(e.ty, Type::Distribution(_)) {
            return self.distribution(e, argument, name, index);
        }
        if let Err(fault) = self.known.evaluate(e, index) {
            self.out.push(
                Diagnostic::error(
                    code::NOT_FINITE,
                    format!("`{argument}` of `{name}` has no value: {fault}"),
                )
                .at(fault.at, "here")
                .hint("change the operands so that the result is a finite number"),
            );
            return false;
        }
        let Some((_, must)) = RULES.iter().find(|(n, _)| *n == argument) else { return true };
        let Some(mut value) = self.known.value(e, index) else { return true };
        while let Value::Some(inner) = value {
            value = *inner;
        }
        if let Some((why, seen)) = must.complaint(&value, &unit_of(&e.ty)) {
            let title = format!("`{argument}` of `{name}` {why}");
            self.out.push(Diagnostic::error(code::RANGE, title).at(e.span, seen).hint(must.hint()));
            return false;
        }
        true
    }

    fn distribution(&mut self, e: &Expr, argument: &str, name: &str, index: i64) -> bool {
        let title = format!("`{argument}` of `{name}` is no distribution");
        let hint = "write `normal(sd: 1 cm)`, `uniform(low, high)` or `skewed(best, mean, worst)`";
        let d = match self.known.evaluate(e, index) {
            Ok(Some(Value::Distribution(d))) => d,
            Ok(_) => return true,
            Err(fault) => {
                self.out
                    .push(Diagnostic::error(code::RANGE, title).at(fault.at, fault.to_string()).hint(hint));
                return false;
            }
        };
        let why = match d {
            Distribution::Normal(_, sd) if sd < 0.0 => "a standard deviation below 0",
            Distribution::Uniform(a, b) if a > b => "its low end lies above its high end",
            Distribution::Skewed(a, b, c) if !(a <= b && b <= c) => "best, mean and worst are not in order",
            _ => return true,
        };
        self.out.push(Diagnostic::error(code::RANGE, title).at(e.span, why).hint(hint));
        false
    }

    /// An autopilot that would be quicker than the thrusters it has.
    fn lags(&mut self, part: &Component) {
        let lag = |n: &str| part.args.iter().find(|(a, _)| &**a == n).map(|(_, e)| e);
        let Some(thrusters) = lag("thruster_lag") else { return };
        let Some(least) = self.known.number(thrusters, 0) else { return };
        for name in ["velocity_lag", "turn_lag"] {
            let Some((e, seconds)) = lag(name).and_then(|e| Some((e, self.known.number(e, 0)?))) else {
                continue;
            };
            if seconds > 0.0 && seconds < least {
                self.out.push(
                    Diagnostic::error(code::RANGE, format!("`{name}` is shorter than `thruster_lag`"))
                        .at(e.span, format!("{seconds} s"))
                        .at(thrusters.span, format!("{least} s"))
                        .hint("an autopilot cannot be quicker than its thrusters: write a longer one"),
                );
            }
        }
    }

    /// Corners and ends that leave nothing between them.
    fn corners(&mut self, part: &Component, name: &str) {
        let mut point = |n: &str| {
            let (_, e) = part.args.iter().find(|(a, _)| &**a == n)?;
            match self.known.value(e, 0) {
                Some(Value::Vector(v)) => Some((v, e.span)),
                _ => None,
            }
        };
        match &*part.model {
            "rectangle" => {
                let (Some((low, _)), Some((high, at))) = (point("low"), point("high")) else { return };
                if low[0] >= high[0] || low[1] >= high[1] {
                    self.out.push(
                        Diagnostic::error(code::RANGE, format!("`{name}` has no ground"))
                            .at(at, "not beyond the low corner in x and y")
                            .hint("`low` is the corner with the smaller x and y, `high` the opposite one"),
                    );
                }
            }
            "segment" => {
                let (Some((from, _)), Some((to, at))) = (point("from"), point("to")) else { return };
                if from == to {
                    self.out.push(
                        Diagnostic::error(code::RANGE, format!("`{name}` has no length"))
                            .at(at, "where it begins")
                            .hint("a wall needs two different ends"),
                    );
                }
            }
            _ => {}
        }
    }

    fn count(&mut self, count: Option<&Expr>, name: &str) {
        let Some(e) = count else { return };
        let Some(Value::Int(n)) = self.known.value(e, 0) else { return };
        if !(1..=LARGEST).contains(&n) {
            self.out.push(
                Diagnostic::error(code::RANGE, format!("{n} of `{name}` are not possible"))
                    .at(e.span, format!("1 to {LARGEST} are"))
                    .hint("write how many there are, or take the declaration out"),
            );
        }
    }

    fn duration(&mut self, e: &Expr, what: &str, positive: bool) {
        let Some(v) = self.known.number(e, 0) else { return };
        if v < 0.0 || (positive && v == 0.0) {
            let bound = if positive { "must be above 0" } else { "cannot be below 0" };
            let unit = if e.ty == Type::Quantity(soifra_graph::Dim::STEP) { "steps" } else { "s" };
            self.out.push(
                Diagnostic::error(code::RANGE, format!("{what} {bound}"))
                    .at(e.span, format!("{v} {unit}"))
                    .hint("write a longer one"),
            );
        }
    }

    fn period(&mut self, e: &Expr, what: &str) {
        let seconds = self.known.value(e, 0);
        self.out.extend(seconds.and_then(|v| wrong_period(&v, e.span, what)));
    }

    fn limits(&mut self, g: &Graph) {
        if let Some(w) = &g.within {
            self.duration(w, "the time limit", true);
        }
        for e in &g.expects {
            if let ExpectKind::Eventually(_, Some(w)) | ExpectKind::LeadsTo(_, _, Some(w)) = &e.kind {
                self.duration(w, "a time limit", false);
            }
        }
    }

    fn behaviours(&mut self, g: &Graph) {
        for a in &g.agents {
            for u in &a.units {
                if let Trigger::Every { period, .. } = &u.trigger
                    && let Some(v) = period.as_const()
                {
                    self.out.extend(wrong_period(v, period.span, &format!("the period of `{}`", u.name)));
                }
                let UnitKind::Plan { nodes, .. } = &u.kind else { continue };
                for n in nodes {
                    match &n.kind {
                        PlanKind::Wait(e) => self.written(e, "a wait", false),
                        PlanKind::Timeout(e) => self.written(e, "a timeout", true),
                        _ => {}
                    }
                }
            }
            for x in &a.arbiters {
                let Strategy::Layers(layers) = &x.strategy else { continue };
                layers.iter().filter_map(|l| l.hold.as_ref()).for_each(|e| self.written(e, "a hold", false));
            }
        }
    }

    /// A duration of a behaviour: only what is written out is known.
    fn written(&mut self, e: &Expr, what: &str, positive: bool) {
        if e.as_const().is_some() {
            self.duration(e, what, positive);
        }
    }
}

/// What is wrong with a period of so many seconds. Asked when a unit is lowered, since an agent is checked
/// without a mission too, and of graphs, which may come from elsewhere.
pub fn wrong_period(seconds: &Value, at: Span, what: &str) -> Option<Diagnostic> {
    let (why, seen) = Must::BeAPeriod.complaint(seconds, "s")?;
    let d = Diagnostic::error(code::RANGE, format!("{what} {why}")).at(at, seen);
    Some(d.hint(Must::BeAPeriod.hint()))
}

/// The SI unit of a quantity, or of what it is made of.
fn unit_of(ty: &Type) -> String {
    match ty {
        Type::Quantity(d) | Type::Range(d) | Type::Vector(_, d) => d.si_unit(),
        Type::Option(t) | Type::List(t, _) => unit_of(t),
        _ => String::new(),
    }
}
