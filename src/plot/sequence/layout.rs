//! Where the lifelines stand: as near to each other as the texts between them allow.

use super::{
    Sequence, TimeUnit,
    rows::{Arrow, Row, Turn, What},
};
use crate::plot::{
    font,
    page::{BOLD, FINE, SMALL},
};
use soifra_runtime::Time;
use std::collections::BTreeMap;

/// Margin of the page.
pub(super) const MARGIN: f64 = 24.0;
/// Between the times and what is drawn.
const GAP: f64 = 22.0;
/// Space on both sides of a text between lifelines.
pub(super) const AIR: f64 = 12.0;
/// From a lifeline to the text beside it.
pub(super) const BESIDE: f64 = 14.0;
/// Width of the loop of a message to oneself.
pub(super) const LOOP: f64 = 26.0;
/// So far from its receiver a lost message ends.
pub(super) const LOST: f64 = 18.0;
/// A page is not narrower, nor wider if shorter texts can help.
const NARROW: f64 = 760.0;
const WIDE: f64 = 1560.0;
/// Lengths at which texts are cut, the first that gives a page that is not too wide.
const LENGTHS: [f64; 5] = [460.0, 340.0, 240.0, 160.0, 110.0];

/// Places across the page.
#[derive(Debug)]
pub(super) struct Layout {
    /// Of each lifeline.
    pub lifelines: Vec<f64>,
    /// Right end of the times.
    pub times: f64,
    /// Width of the page.
    pub width: f64,
    /// No text beside a lifeline is longer.
    pub longest: f64,
    /// Decimals of the times.
    pub decimals: usize,
}

impl Layout {
    pub(super) fn new(chart: &Sequence) -> Layout {
        let decimals = chart.unit.decimals(chart.rows.iter().map(|r| r.t));
        let times = chart.rows.iter().map(|r| font::width(&chart.unit.write(r.t, decimals), SMALL.size));
        let times = times.fold(font::width(&time_title(chart.unit), FINE.size), f64::max);
        let mut layout =
            Layout { lifelines: Vec::new(), times: MARGIN + times, width: 0.0, longest: 0.0, decimals };
        for longest in LENGTHS {
            layout.longest = longest;
            layout.place(chart);
            if layout.width <= WIDE {
                break;
            }
        }
        layout.widen();
        layout
    }

    /// Places the lifelines from left to right.
    fn place(&mut self, chart: &Sequence) {
        let n = chart.lifelines.len();
        let half = |i: usize| head_width(chart, i) / 2.0;
        // Room beside each lifeline, and between two of them.
        let mut left: Vec<f64> = (0..n).map(half).collect();
        let mut right = left.clone();
        let mut between: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        for row in &chart.rows {
            match &row.what {
                What::Arrow(a) if a.from == a.to => {
                    let wanted = LOOP + BESIDE + self.short(&chart.arrow_text(a));
                    right[a.to] = right[a.to].max(wanted);
                }
                What::Arrow(a) => {
                    let lost = if a.is_lost() { LOST } else { 0.0 };
                    let wanted = self.short(&chart.arrow_text(a)) + 2.0 * AIR + lost;
                    let room = between.entry((a.from.min(a.to), a.from.max(a.to))).or_default();
                    *room = room.max(wanted);
                }
                What::Life { of, turn: Turn::Other | Turn::Dead, text } => {
                    right[*of] = right[*of].max(BESIDE + self.short(text));
                }
                What::Over { of, text } => {
                    let wanted = BESIDE + font::width(text, FINE.size).min(self.longest);
                    right[*of] = right[*of].max(wanted);
                }
                What::Life { of, text, .. } => {
                    right[*of] = right[*of].max(half(*of) + BESIDE + self.short(text));
                }
                What::Service { of, text, .. } => {
                    let wanted = box_width(self.short(text)) / 2.0;
                    left[*of] = left[*of].max(wanted);
                    right[*of] = right[*of].max(wanted);
                }
            }
        }
        let mut at: Vec<f64> = Vec::with_capacity(n);
        for j in 0..n {
            let mut x = match at.last() {
                Some(before) => before + f64::max(right[j - 1] + half(j), half(j - 1) + left[j]) + AIR,
                None => self.times + GAP + left[j],
            };
            for ((i, _), room) in between.iter().filter(|((_, to), _)| *to == j) {
                x = x.max(at[*i] + room);
            }
            at.push(x);
        }
        self.width = at.iter().zip(&right).map(|(x, r)| x + r).fold(self.times + GAP, f64::max) + MARGIN;
        self.lifelines = at;
    }

    /// Width of a text that is cut when it is too long.
    fn short(&self, text: &str) -> f64 {
        font::width(text, SMALL.size).min(self.longest)
    }

    /// A narrow page is made wider, and the lifelines move apart.
    fn widen(&mut self) {
        let more = NARROW - self.width;
        if more > 0.0 {
            let n = self.lifelines.len().max(2) as f64;
            for (i, x) in self.lifelines.iter_mut().enumerate() {
                *x += more * (i as f64 + 0.5) / n;
            }
            self.width = NARROW;
        }
    }
}

/// What stands above the times.
pub(super) fn time_title(unit: TimeUnit) -> String {
    format!("time ({})", unit.name)
}

/// Width of a lifeline's head.
pub(super) fn head_width(chart: &Sequence, i: usize) -> f64 {
    let l = &chart.lifelines[i];
    let text = f64::max(font::width(&l.name, BOLD.size), font::width(&l.robot, FINE.size));
    f64::max(text + 20.0, 64.0)
}

/// Width of the box around a text.
pub(super) fn box_width(text: f64) -> f64 {
    text + 16.0
}

impl Sequence {
    /// What stands at an arrow.
    pub(super) fn arrow_text(&self, a: &Arrow) -> String {
        let mut text = label(a);
        if a.count > 1 {
            text += &format!(", until {}", self.unit.exact(a.last));
        }
        dropped(a).into_iter().for_each(|d| text += &format!(" ({d})"));
        text
    }

    /// The time of a row, unless it is that of the row before.
    pub(super) fn time_of(&self, row: usize, decimals: usize) -> Option<String> {
        let t = self.rows.get(row)?.t;
        let before: Option<Time> = row.checked_sub(1).and_then(|r| self.rows.get(r)).map(|r: &Row| r.t);
        (before != Some(t)).then(|| self.unit.write(t, decimals))
    }
}

/// What an arrow says, and how often.
pub(super) fn label(a: &Arrow) -> String {
    if a.count > 1 { format!("{} ×{}", a.label, a.count) } else { a.label.clone() }
}

/// What of it did not arrive, and why.
pub(super) fn dropped(a: &Arrow) -> Option<String> {
    match a.dropped {
        0 => None,
        _ if a.is_lost() => Some(format!("dropped: {}", a.why)),
        n => Some(format!("{n} dropped: {}", a.why)),
    }
}
