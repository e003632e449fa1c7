//! Copying registers.

/// Copies registers to a place of the same length, without the call that a copy of unknown length costs
/// where it is short.
///
/// # Panics
/// When the lengths differ.
#[inline]
pub fn copy_registers(from: &[f64], to: &mut [f64]) {
    assert_eq!(from.len(), to.len());
    macro_rules! short {
        ($($n:literal)*) => {
            match from.len() {
                $($n => {
                    if let (Some(from), Some(to)) = (from.first_chunk::<$n>(), to.first_chunk_mut::<$n>()) {
                        *to = *from;
                    }
                })*
                _ => to.copy_from_slice(from),
            }
        };
    }
    short!(0 1 2 3 4 5 6 7 8);
}
