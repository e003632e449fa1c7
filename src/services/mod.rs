//! What missions call services for: functions that the runtime's machine does not compute itself.

#[cfg(not(feature = "vision"))]
mod blind;
mod mapping;
#[cfg(feature = "vision")]
mod vision;

#[cfg(not(feature = "vision"))]
pub use blind::Onlooker;
#[cfg(feature = "vision")]
pub use vision::Onlooker;

use soifra_graph::{Diagnostic, Expr, Function, Graph, Op, eval::FaultKind};
use soifra_lang::check::walk;
use soifra_runtime::objects::{Frame, Services, Shelf};

/// What of that which is seen is drawn into an image.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Overlay {
    /// Upright edges, the pairs that are obstacles, the optical centre.
    pub edges: bool,
    /// The flow of points on the first obstacle, and its focus of expansion.
    pub flow: bool,
}

impl Overlay {
    /// Whether anything is drawn.
    pub fn any(self) -> bool {
        self.edges || self.flow
    }
}

/// What is known beside an image, as registers of the latest readings.
#[derive(Debug, Clone, Copy, Default)]
pub struct Readings {
    /// Of an inertial unit.
    pub imu: Option<[f64; 6]>,
    /// Of odometry.
    pub odometry: Option<[f64; 14]>,
    /// Half the width of the body, m.
    #[cfg_attr(
        not(feature = "vision"),
        allow(dead_code, reason = "nobody looks without vision; 2026-11-24")
    )]
    pub half_width: f64,
}

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
