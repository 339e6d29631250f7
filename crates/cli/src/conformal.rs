//! `msplines conformal`.

use msplines_compare::case::{Case, ConformalMethod, Input, Method};
use msplines_compare::input::file_name;
use msplines_compare::run;

use crate::arguments::Conformal;
use crate::session::{Failure, Session};

/// Lays out a surface.
pub(crate) fn run(arguments: &Conformal, session: &Session) -> Result<u8, Failure> {
    let input = Input::File {
        path: arguments.input.clone(),
        repair: session.repair,
    };
    let method = ConformalMethod {
        form: arguments.form.clone(),
        puncture: arguments.puncture.clone(),
    };
    let case = Case {
        outputs: arguments.outputs.clone(),
        seed: session.seed,
        ..Case::new(input, Method::Conformal(method))
    };
    let label = format!("conformal {}", file_name(&arguments.input));
    session.observe(&label, |observer| {
        run::run(&case, session.process_start, observer)
    })
}
