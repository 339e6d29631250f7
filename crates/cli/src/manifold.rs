//! `msplines fit sparse-manifold` and `msplines fit curve-network`.

use msplines_common::mesh::polygon::{BoundaryCorners, CreaseRule, Rules};
use msplines_compare::case::{
    Case, Creases, CurveNetworkMethod, DomainStorage, Input, Method, Polygons, SparseManifoldMethod,
};
use msplines_sparse_manifold::network::{C0Atoms, CycleOptions, NetworkOptions};
use msplines_sparse_manifold::pursuit::Selection;
use msplines_sparse_manifold::{Components, DictionaryKind, Gate, Local, Options};

use crate::arguments::{
    self, AtomSelection, CurveNetwork, Kinks, LocalFit, Points, SparseManifold,
};
use crate::session::Session;

/// Returns the run that the arguments ask for.
pub(crate) fn case(arguments: &SparseManifold, session: &Session) -> Case {
    let input = Input::File {
        path: arguments.input.clone(),
        repair: session.repair,
    };
    let method = SparseManifoldMethod {
        options: options(arguments),
        rules: Rules {
            creases: match arguments.crease_rule {
                arguments::CreaseRule::Uniform => CreaseRule::Uniform,
                arguments::CreaseRule::Chaikin => CreaseRule::Chaikin,
            },
            corners: if arguments.smooth_corners {
                BoundaryCorners::Smooth
            } else {
                BoundaryCorners::Sharp
            },
        },
        creases: match &arguments.creases {
            None => Creases::Beside,
            Some(word) if word.as_os_str() == "none" => Creases::None,
            Some(file) => Creases::File(file.clone()),
        },
        polygons: if arguments.refine_polygons {
            Polygons::Refine
        } else {
            Polygons::Refuse
        },
        cells: arguments.tessellate,
        scan: arguments.scan,
    };
    let domain = if arguments.domain_by_digest {
        DomainStorage::Digest
    } else {
        DomainStorage::Embedded
    };
    Case {
        outputs: arguments.outputs.clone(),
        seed: session.seed,
        domain,
        ..Case::new(input, Method::SparseManifold(Box::new(method)))
    }
}

fn options(arguments: &SparseManifold) -> Options {
    let smooth_charts = arguments.smooth_charts.clone();
    if arguments.paper {
        return Options {
            smooth_charts,
            ..Options::PAPER
        };
    }
    let local = match arguments.local {
        LocalFit::Sparse => Local::Sparse {
            dictionary: DictionaryKind::default(),
            sparsity: arguments.sparsity,
            selection: match arguments.selection {
                AtomSelection::Omp => Selection::Omp,
                AtomSelection::Ormp => Selection::Ormp,
                AtomSelection::Plain => Selection::Plain,
            },
            components: Components::default(),
        },
        LocalFit::Polynomial => Local::Polynomial { degree: None },
        LocalFit::Spline => Local::Spline,
    };
    Options {
        local,
        levels: arguments.levels,
        gate: if arguments.open_gate {
            Gate::Free
        } else {
            Gate::Sharp
        },
        smooth_charts,
        ..Options::default()
    }
}

/// Returns the run over a curve network that the arguments ask for.
pub(crate) fn network(arguments: &CurveNetwork, session: &Session) -> Case {
    let lists = |given: &[Points]| given.iter().map(|points| points.0.clone()).collect();
    let base = if arguments.paper {
        NetworkOptions::PAPER
    } else {
        let default = NetworkOptions::default();
        NetworkOptions {
            degree: arguments.degree.unwrap_or(default.degree),
            c0_atoms: match arguments.kinks {
                Kinks::Creases => C0Atoms::Gated,
                Kinks::Everywhere => C0Atoms::With,
                Kinks::Nowhere => C0Atoms::Without,
            },
            ..default
        }
    };
    let options = NetworkOptions {
        cycles: CycleOptions {
            seed: session.seed,
            expected_euler: arguments.expected_euler,
            cycles: lists(&arguments.cycle),
            fill: lists(&arguments.fill),
            hole: lists(&arguments.hole),
            ..CycleOptions::default()
        },
        ..base
    };
    let input = Input::File {
        path: arguments.input.clone(),
        repair: session.repair,
    };
    let method = CurveNetworkMethod {
        options,
        cells: arguments.tessellate,
    };
    Case {
        outputs: arguments.outputs.clone(),
        seed: session.seed,
        ..Case::new(input, Method::CurveNetwork(Box::new(method)))
    }
}
