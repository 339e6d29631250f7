//! The form of a surface with boundary loops and poles.

use msplines_common::mesh::{Facts, TriangleMesh};
use msplines_common::progress::Observer;
use msplines_conformal::Atlas;

use super::error::DomainError;
use super::form::{End, PeriodicForm};
use super::{Domain, DomainOptions};

impl Domain {
    /// Cuts a connected surface into cylinders: a closed one of genus >= 1, or one of any genus with two
    /// or more boundary loops and poles. Cost: the forms of the surface, and O(n) for each zero.
    /// `observer` sees the phase `domain`.
    ///
    /// # Errors
    /// A surface of another kind; what the forms refuse, a stop among it; and as [`Self::of_form`].
    pub fn of_surface(
        mesh: &TriangleMesh,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        let facts = Facts::measure(mesh);
        let genus = facts.genus.unwrap_or(0);
        let loops = facts.boundary_loops + options.poles.len();
        match (genus, loops) {
            (1.., 0) => Self::closed(mesh, options, observer),
            (_, 0 | 1) => Err(DomainError::Kind { genus, loops }),
            _ => Self::poled(mesh, facts.boundary_loops, options, observer),
        }
    }

    fn poled(
        mesh: &TriangleMesh,
        boundaries: usize,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        let found = Atlas::with_poles(mesh, &options.poles, &options.pole_form, observer)?;
        // The loops of the input come first, then those around the poles.
        let end = |loop_of_atlas: &Vec<u32>| {
            let place = found
                .loops
                .iter()
                .position(|hole| hole.contains(&loop_of_atlas[0]));
            let pole = place.and_then(|hole| options.poles.get(hole.checked_sub(boundaries)?));
            pole.map_or(End::Boundary, |&pole| End::Pole(pole))
        };
        let loops = found.atlas.mesh().topology().boundary_loops();
        let given = PeriodicForm {
            ends: loops.iter().map(end).collect(),
            ..PeriodicForm::of_atlas(&found.atlas)
        };
        let mut domain = Self::of_form(&given, &options.snap)?;
        domain.origins = found.origins;
        Ok(domain)
    }
}
