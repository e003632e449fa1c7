//! The message sequence chart: who told whom what, in the order in which it happened.

mod draw;
mod layout;
mod marks;
mod mermaid;
mod rows;

use super::{
    Drawing, Selection,
    axis::TimeUnit,
    drawing::Color,
    page::{self, Ending, MILD},
};
use crate::trace_file::{Header, Reader, Trace, TraceError, palette};
use rows::{Arrow, Participant, Row, Rows, What};
use std::io::Read;

/// A chart, ready to be drawn.
#[derive(Debug)]
pub struct Sequence {
    title: String,
    subtitle: String,
    /// From left to right.
    lifelines: Vec<Lifeline>,
    /// Participants of rows are indices of lifelines.
    rows: Vec<Row>,
    cut: u64,
    /// How the times of its rows are written.
    unit: TimeUnit,
}

/// A lifeline's head.
#[derive(Debug)]
struct Lifeline {
    name: String,
    /// `@robot`; empty when it is no agent.
    robot: String,
    color: Color,
}

impl Lifeline {
    fn new(who: &Participant, header: &Header) -> Lifeline {
        let Participant::Agent(agent) = who else {
            return Lifeline { name: "parameters".into(), robot: String::new(), color: MILD };
        };
        let Some((name, robot)) = agent.split_once('@') else {
            return Lifeline { name: agent.clone(), robot: String::new(), color: MILD };
        };
        let index = header.scene.robots.iter().position(|r| r.name == robot);
        let color = index.map_or(MILD, palette::robot);
        Lifeline { name: name.into(), robot: format!("@{robot}"), color }
    }

    fn full(&self) -> String {
        format!("{}{}", self.name, self.robot)
    }
}

impl Sequence {
    /// The chart of a trace in memory, of at most `limit` rows.
    pub fn of(trace: &Trace, selection: &Selection, limit: usize) -> Sequence {
        let (mut rows, mut ending) = (Rows::new(selection, limit), Ending::default());
        for record in &trace.records {
            ending.take(record);
            rows.take(record);
        }
        Sequence::new(&trace.header, selection, rows, &ending, trace.complete)
    }

    /// The chart of a trace of any length, which is read to its end with the memory of a chunk and of the
    /// rows.
    pub fn read<R: Read>(
        mut reader: Reader<R>,
        selection: &Selection,
        limit: usize,
    ) -> Result<Sequence, TraceError> {
        let (mut rows, mut ending) = (Rows::new(selection, limit), Ending::default());
        for record in reader.by_ref() {
            let record = record?;
            ending.take(&record);
            rows.take(&record);
        }
        Ok(Sequence::new(reader.header(), selection, rows, &ending, reader.complete()))
    }

    fn new(header: &Header, selection: &Selection, rows: Rows, ending: &Ending, complete: bool) -> Sequence {
        let Rows { participants, mut rows, cut, .. } = rows;
        let mut order: Vec<usize> = (0..participants.len()).collect();
        order.sort_by_key(|i| rank(&participants[*i]));
        let mut place = vec![0; order.len()];
        for (at, i) in order.iter().enumerate() {
            place[*i] = at;
        }
        for row in &mut rows {
            match &mut row.what {
                What::Arrow(Arrow { from, to, .. }) => (*from, *to) = (place[*from], place[*to]),
                What::Service { of, .. } | What::Life { of, .. } | What::Over { of, .. } => *of = place[*of],
            }
        }
        let told = selection.told();
        let what = if told.is_empty() { "messages".into() } else { format!("messages {told}") };
        Sequence {
            title: format!("{}: {what}", page::title(header)),
            subtitle: page::subtitle(header, ending, complete),
            lifelines: order.into_iter().map(|i| Lifeline::new(&participants[i], header)).collect(),
            unit: TimeUnit::of(rows.iter().map(last).max().unwrap_or_default()),
            rows,
            cut,
        }
    }

    /// The chart as a picture.
    pub fn drawing(&self) -> Drawing {
        draw::draw(self)
    }

    /// The chart in Mermaid's language.
    pub fn mermaid(&self) -> String {
        mermaid::write(self)
    }

    /// What is said of the rows that were left out because there are more than the limit.
    pub fn rest(&self) -> Option<String> {
        match self.cut {
            0 => None,
            1 => Some("1 more row is not drawn".into()),
            n => Some(format!("{n} more rows are not drawn")),
        }
    }
}

/// Those that serve everybody come first, the parameters last.
fn rank(who: &Participant) -> usize {
    match who {
        Participant::Agent(name) if name.starts_with("df@") => 0,
        Participant::Agent(name) if name.starts_with("planner@") => 1,
        Participant::Agent(_) => 2,
        Participant::Parameters => 3,
    }
}

/// The last instant of a row.
fn last(row: &Row) -> soifra_runtime::Time {
    match &row.what {
        What::Arrow(a) => a.last,
        _ => row.t,
    }
}
