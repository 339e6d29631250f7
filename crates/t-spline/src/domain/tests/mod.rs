//! Domains of surfaces whose structure is known.

mod surfaces;
