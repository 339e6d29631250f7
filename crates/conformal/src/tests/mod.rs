//! Laws of forms, zeros and atlases on surfaces whose structure is known.

mod atlases;
mod forms;
mod limbs;
mod shapes;
mod tori;
