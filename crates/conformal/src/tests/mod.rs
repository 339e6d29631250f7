//! Laws of forms, zeros and atlases on surfaces whose structure is known.

mod atlases;
mod forms;
mod limbs;
mod shapes;
pub(crate) use shapes::{with_finger, with_spike};
mod stopping;
mod tori;
