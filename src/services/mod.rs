//! What missions call services for: functions that the runtime's machine does not compute itself.

mod mapping;
#[cfg(feature = "vision")]
mod vision;

use soifra_graph::{Diagnostic, Expr, Function, Graph, Op, eval::FaultKind};
use soifra_lang::check::walk;
use soifra_runtime::objects::{Frame, Services, Shelf};

/// All services of this program.
#[derive(Debug, Clone, Copy, Default)]
pub struct Everything;

impl Services for Everything {
    fn call(
        &self,
        which: Function,
        args: &[f64],
        shelf: &mut dyn Shelf,
        out: &mut [f64],
    ) -> Result<(), FaultKind> {
        match (which, args, out) {
            (Function::Brightness, [image], [out]) => {
                let image = shelf.get(*image).ok_or(FaultKind::Unavailable("this image"))?;
                let frame = image.as_any().downcast_ref::<Frame>().ok_or(FaultKind::Malformed)?;
                *out = brightness(frame);
                Ok(())
            }
            (which, args, out) if mapping::computes(which) => mapping::call(which, args, shelf, out),
            #[cfg(feature = "vision")]
            (which, args, out) => vision::call(which, args, shelf, out),
            #[cfg(not(feature = "vision"))]
            _ => Err(FaultKind::Unavailable("vision: this program was built without it")),
        }
    }
}

/// What a graph calls that this program was built without.
pub fn missing(graph: &Graph) -> Vec<Diagnostic> {
    let mut out: Vec<Diagnostic> = Vec::new();
    if cfg!(feature = "vision") {
        return out;
    }
    let mut look = |e: &Expr| {
        if let Op::Builtin(f) = e.op
            && f.is_service()
            && !matches!(f, Function::Brightness | Function::TruePlace)
            && !mapping::computes(f)
        {
            let name = &f.signature().name;
            out.push(
                Diagnostic::error("S9029", format!("there is no `{name}` in this program"))
                    .at(e.span, "a vision service; the program was built without them")
                    .hint("build it with the feature `vision`, which needs OpenCV: `cargo build --release`"),
            );
        }
    };
    graph.agents.iter().for_each(|a| walk::agent(a, &mut look));
    graph.functions.iter().for_each(|f| f.body.walk(&mut look));
    out
}

/// The mean of all channels, 0 to 1.
fn brightness(frame: &Frame) -> f64 {
    let sum: u64 = frame.data.iter().map(|b| u64::from(*b)).sum();
    sum as f64 / (255.0 * frame.data.len().max(1) as f64)
}
