//! Pictures of traces, drawn from the trace alone: the top view, the messages, the schedule.

mod axis;
mod drawing;
mod font;
mod frames;
mod gantt;
mod latest;
mod page;
mod png;
mod selection;
mod sequence;
mod svg;
mod top;

pub use drawing::Drawing;
pub use frames::Sheet;
pub use gantt::Gantt;
pub use png::PngError;
pub use selection::{Conversation, SelectError, Selection};
pub use sequence::Sequence;
pub use top::{top_view, top_view_of};
