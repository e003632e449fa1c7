//! What arguments of worlds, platforms and topics must be, by name, and what is said of one that is not.

use soifra_graph::Value;
use std::f64::consts::{PI, TAU};

/// What an argument must be.
#[derive(Debug, Clone, Copy)]
pub enum Must {
    BePositive,
    BeAPeriod,
    NotBeNegative,
    HaveNoNegativePart,
    BeAChance,
    AscendWithinATurn,
    AscendFromZero,
    BeAtMostHalfATurn,
    BeAColour,
    FlowAsWaterDoes,
    HaveTwoPoints,
}

/// Arguments by name; a name means the same thing in every model.
pub const RULES: &[(&str, Must)] = &[
    ("added_mass", Must::HaveNoNegativePart),
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
    ("hair", Must::BeAColour),
    ("inertia", Must::BePositive),
    ("keep_out", Must::NotBeNegative),
    ("lag", Must::NotBeNegative),
    ("latency", Must::NotBeNegative),
    ("lifetime", Must::BePositive),
    ("linear_drag", Must::HaveNoNegativePart),
    ("linear_turn_drag", Must::NotBeNegative),
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
    ("quadratic_drag", Must::HaveNoNegativePart),
    ("quadratic_turn_drag", Must::NotBeNegative),
    ("radius", Must::BePositive),
    ("range", Must::AscendFromZero),
    ("rate", Must::BePositive),
    ("reflectance", Must::BeAChance),
    ("repeat", Must::BePositive),
    ("shirt", Must::BeAColour),
    ("shoes", Must::BeAColour),
    ("size", Must::BePositive),
    ("skin", Must::BeAColour),
    ("speed", Must::NotBeNegative),
    ("strength", Must::NotBeNegative),
    ("thickness", Must::BePositive),
    ("thrust", Must::BePositive),
    ("thruster_lag", Must::NotBeNegative),
    ("torque", Must::BePositive),
    ("trousers", Must::BeAColour),
    ("turn_lag", Must::NotBeNegative),
    ("turn_period", Must::BeAPeriod),
    ("velocity", Must::FlowAsWaterDoes),
    ("velocity_lag", Must::BePositive),
    ("wheel_acceleration", Must::BePositive),
    ("wheel_base", Must::BePositive),
    ("wheel_radius", Must::BePositive),
    ("width", Must::BePositive),
];

/// The shortest period, in seconds.
const SHORTEST: f64 = 1e-6;
/// Water that is faster, in m/s, than any tidal stream is a mistake.
const SWIFTEST: f64 = 20.0;

impl Must {
    /// What is wrong with a value in SI unit `unit`: the end of a title, and a label.
    pub fn complaint(self, v: &Value, unit: &str) -> Option<(&'static str, String)> {
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
            (Must::HaveNoNegativePart, Value::Vector(v)) => {
                v.iter().find(|x| **x < 0.0).map(|x| ("cannot be below 0 in any part", shown(*x)))
            }
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
            (Must::FlowAsWaterDoes, Value::Vector([x, y, z])) => {
                let speed = libm::hypot(*x, *y);
                match *z != 0.0 {
                    true => Some(("must be level", format!("{} up", shown(*z)))),
                    false => (speed > SWIFTEST).then(|| ("must be at most 20 m/s", shown(speed))),
                }
            }
            (Must::HaveTwoPoints, Value::List(items)) if items.len() < 2 => {
                let n = if items.len() == 1 { "one point" } else { "no point" };
                Some(("leads nowhere", n.to_string()))
            }
            _ => None,
        }
    }

    /// What to write instead.
    pub fn hint(self) -> &'static str {
        match self {
            Must::BePositive => "write a value above 0",
            Must::BeAPeriod => "write a longer one: what happens more often never lets the time go on",
            Must::NotBeNegative | Must::HaveNoNegativePart => "write 0 or more",
            Must::BeAChance => "write a value from 0 to 1, or from 0 % to 100 %",
            Must::AscendWithinATurn => "write the smaller end first, and ends that lie at most 360 deg apart",
            Must::BeAtMostHalfATurn => "write an angle up to 180 deg",
            Must::AscendFromZero => "write the smaller end first; ranges begin at 0 or above",
            Must::BeAColour => "write it as `#rrggbb`, for example `#e8e4da`",
            Must::FlowAsWaterDoes => "write a velocity along the ground: `velocity: (10 cm/s, 0 m/s)`",
            Must::HaveTwoPoints => {
                "write where it turns round: `path: [(0 m, 0 m), (1 m, 0 m)]`; what stands still is an `obstacle`"
            }
        }
    }
}
