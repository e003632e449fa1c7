//! Are the sizes, chances and durations of worlds, platforms, topics and robots possible at all?

use super::constants::Constants;
use crate::code;
use soifra_graph::{
    Component, Diagnostic, Distribution, ExpectKind, Expr, Graph, PlanKind, Span, Strategy, Trigger, Type,
    UnitKind, Value,
};
use std::f64::consts::{PI, TAU};

/// What an argument must be.
#[derive(Clone, Copy)]
enum Must {
    BePositive,
    BeAPeriod,
    NotBeNegative,
    BeAChance,
    AscendWithinATurn,
    AscendFromZero,
    BeAtMostHalfATurn,
    BeAColour,
    HaveTwoPoints,
}

/// Arguments by name; a name means the same thing in every model.
const RULES: &[(&str, Must)] = &[
    ("beams", Must::BePositive),
    ("attitude_lag", Must::BePositive),
    ("bearings", Must::BePositive),
    ("chance", Must::BeAChance),
    ("color", Must::BeAColour),
    ("cone", Must::BeAtMostHalfATurn),
    ("delay", Must::NotBeNegative),
    ("drag", Must::NotBeNegative),
    ("duration", Must::BeAPeriod),
    ("false_alarm", Must::BeAChance),
    ("ambient", Must::NotBeNegative),
    ("field", Must::AscendWithinATurn),
    ("field_of_view", Must::BeAtMostHalfATurn),
    ("gain", Must::NotBeNegative),
    ("height", Must::BePositive),
    ("from", Must::NotBeNegative),
    ("keep_out", Must::NotBeNegative),
    ("lag", Must::NotBeNegative),
    ("latency", Must::NotBeNegative),
    ("lifetime", Must::BePositive),
    ("loss", Must::BeAChance),
    ("mass", Must::BePositive),
    ("max_climb", Must::BePositive),
    ("max_speed", Must::BePositive),
    ("max_tilt", Must::BePositive),
    ("max_turn", Must::BePositive),
    ("path", Must::HaveTwoPoints),
    ("period", Must::BeAPeriod),
    ("phase", Must::BeAChance),
    ("pulse", Must::BePositive),
    ("radius", Must::BePositive),
    ("range", Must::AscendFromZero),
    ("rate", Must::BePositive),
    ("reflectance", Must::BeAChance),
    ("repeat", Must::BePositive),
    ("size", Must::BePositive),
    ("speed", Must::NotBeNegative),
    ("strength", Must::NotBeNegative),
    ("thickness", Must::BePositive),
    ("turn_lag", Must::NotBeNegative),
    ("turn_period", Must::BeAPeriod),
    ("velocity_lag", Must::BePositive),
    ("wheel_acceleration", Must::BePositive),
    ("wheel_base", Must::BePositive),
    ("wheel_radius", Must::BePositive),
    ("width", Must::BePositive),
];

/// The shortest period, in seconds.
const SHORTEST: f64 = 1e-6;
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

impl Must {
    /// What is wrong with a value in SI unit `unit`: the end of a title, and a label.
    fn complaint(self, v: &Value, unit: &str) -> Option<(&'static str, String)> {
        let shown = |x: f64| format!("{x} {unit}").trim_end().to_string();
        let number = |wrong: fn(f64) -> bool, why| v.number().filter(|x| wrong(*x)).map(|x| (why, shown(x)));
        match (self, v) {
            (Must::BePositive, Value::Vector(v)) => {
                v.iter().find(|x| **x <= 0.0).map(|x| ("must be above 0 in every part", shown(*x)))
            }
            (Must::BePositive, Value::List(items)) => {
                items.is_empty().then(|| ("cannot be empty", "no items".to_string()))
            }
            (Must::BePositive, _) => number(|x| x <= 0.0, "must be above 0"),
            (Must::BeAPeriod, _) => number(|x| x < SHORTEST, "must be at least 1 us"),
            (Must::NotBeNegative, _) => number(|x| x < 0.0, "cannot be below 0"),
            (Must::BeAChance, _) => number(|x| !(0.0..=1.0).contains(&x), "must be from 0 to 1"),
            (Must::AscendWithinATurn | Must::AscendFromZero, Value::Range(a, b)) if a >= b => {
                Some(("runs backwards", format!("from {} to {}", shown(*a), shown(*b))))
            }
            // A hair more: the ends are rounded.
            (Must::AscendWithinATurn, Value::Range(a, b)) if b - a > TAU * (1.0 + 1e-12) => Some((
                "is wider than a turn",
                format!("{} deg wide", ((b - a).to_degrees() * 1e6).round() / 1e6),
            )),
            (Must::BeAtMostHalfATurn, _) => {
                number(|x| x <= 0.0 || x > PI, "must be above 0 and at most 180 deg")
            }
            (Must::AscendFromZero, Value::Range(a, _)) if *a < 0.0 => {
                Some(("cannot begin below 0", format!("from {}", shown(*a))))
            }
            (Must::AscendFromZero, _) => number(|x| x <= 0.0, "must be above 0"),
            (Must::BeAColour, Value::Text(t)) => {
                let hex =
                    t.strip_prefix('#').filter(|h| h.len() == 6 && h.bytes().all(|b| b.is_ascii_hexdigit()));
                hex.is_none().then(|| ("is no colour", "not six digits after a `#`".to_string()))
            }
            (Must::HaveTwoPoints, Value::List(items)) if items.len() < 2 => {
                let n = if items.len() == 1 { "one point" } else { "no point" };
                Some(("leads nowhere", n.to_string()))
            }
            _ => None,
        }
    }

    fn hint(self) -> &'static str {
        match self {
            Must::BePositive => "write a value above 0",
            Must::BeAPeriod => "write a longer one: what happens more often never lets the time go on",
            Must::NotBeNegative => "write 0 or more",
            Must::BeAChance => "write a value from 0 to 1, or from 0 % to 100 %",
            Must::AscendWithinATurn => "write the smaller end first, and ends that lie at most 360 deg apart",
            Must::BeAtMostHalfATurn => "write an angle up to 180 deg",
            Must::AscendFromZero => "write the smaller end first; ranges begin at 0 or above",
            Must::BeAColour => "write it as `#rrggbb`, for example `#e8e4da`",
            Must::HaveTwoPoints => {
                "write where it turns round: `path: [(0 m, 0 m), (1 m, 0 m)]`; what stands still is an `obstacle`"
            }
        }
    }
}

/// The SI unit of a quantity, or of what it is made of.
fn unit_of(ty: &Type) -> String {
    match ty {
        Type::Quantity(d) | Type::Range(d) | Type::Vector(_, d) => d.si_unit(),
        Type::Option(t) | Type::List(t, _) => unit_of(t),
        _ => String::new(),
    }
}
