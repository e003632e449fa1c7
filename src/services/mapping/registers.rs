//! Values of a call as registers.

use soifra_graph::{eval::FaultKind, reason};
use soifra_mapping::{Beam, Place, Why};
use soifra_runtime::objects::{Object, Shelf};
use std::sync::Arc;

/// Registers of arguments, which are taken from the front or the end. A list stands last when all others are taken.
pub struct Registers<'a>(pub &'a [f64]);

impl Registers<'_> {
    /// The next ones.
    pub fn take<const N: usize>(&mut self) -> Result<[f64; N], FaultKind> {
        let (first, rest) = self.0.split_first_chunk::<N>().ok_or(FaultKind::Malformed)?;
        self.0 = rest;
        Ok(*first)
    }

    /// The last ones, in order.
    pub fn take_last<const N: usize>(&mut self) -> Result<[f64; N], FaultKind> {
        let (rest, last) = self.0.split_last_chunk::<N>().ok_or(FaultKind::Malformed)?;
        self.0 = rest;
        Ok(*last)
    }

    /// An object.
    pub fn object(&mut self, shelf: &dyn Shelf) -> Result<Arc<dyn Object>, FaultKind> {
        let [number] = self.take()?;
        shelf.get(number).ok_or(FaultKind::Unavailable("this object"))
    }

    /// An object, or none.
    pub fn optional_object(&mut self, shelf: &dyn Shelf) -> Result<Option<Arc<dyn Object>>, FaultKind> {
        let [tag] = self.take()?;
        if tag == 0.0 {
            return self.object(shelf).map(Some);
        }
        let [_] = self.take()?;
        Ok(None)
    }

    /// A pose, on the ground.
    pub fn place(&mut self) -> Result<Place, FaultKind> {
        let [x, y, _, qx, qy, qz, qw] = self.take()?;
        let yaw = libm::atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz));
        Ok(Place::new(x, y, yaw))
    }

    /// The beams of a scan: all that is left.
    pub fn scan(self) -> Result<Vec<Beam>, FaultKind> {
        let (count, items) = self.0.split_first().ok_or(FaultKind::Malformed)?;
        let beam = |[bearing, tag, range]: &[f64; 3]| Beam {
            bearing: *bearing,
            range: (*tag == 0.0).then_some(*range),
        };
        Ok(items.as_chunks::<3>().0.iter().take(count.max(0.0) as usize).map(beam).collect())
    }
}

/// Where the value goes.
pub struct Slots<'a>(pub &'a mut [f64]);

impl Slots<'_> {
    /// A value.
    pub fn value<const N: usize>(self, value: [f64; N]) -> Result<(), FaultKind> {
        let slots: &mut [f64; N] = self.0.try_into().map_err(|_| FaultKind::Malformed)?;
        *slots = value;
        Ok(())
    }

    /// An optional: tag and value.
    pub fn optional<const N: usize>(self, value: Result<[f64; N], Why>) -> Result<(), FaultKind> {
        let (tag, rest) = self.0.split_first_mut().ok_or(FaultKind::Malformed)?;
        if rest.len() != N {
            return Err(FaultKind::Malformed);
        }
        match value {
            Ok(value) => {
                *tag = 0.0;
                rest.copy_from_slice(&value);
            }
            Err(why) => {
                *tag = reason::tag(reason::index(why.text()));
                rest.fill(0.0);
            }
        }
        Ok(())
    }
}
