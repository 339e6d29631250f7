//! The commands that meet the battery, with sound inputs so small that hundreds of runs take a minute.

/// A command that works.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subject {
    /// What the tables call it.
    pub(super) name: &'static str,
    /// Its arguments, `{}` for the input.
    pub(super) command: &'static str,
    /// Its sound input.
    pub(super) input: &'static str,
    /// Whether defects are put into its input.
    pub(super) takes_defects: bool,
    /// Whether broken files are given to it, and how large they may be in bytes once they are sound.
    pub(super) files_up_to: u64,
    /// The option that something is named twice in, and what to give instead.
    pub(super) twice: Option<(&'static str, &'static str)>,
    /// What it writes.
    pub(super) outputs: &'static str,
}

impl Subject {
    /// Returns the whole command on a file.
    pub(super) fn arguments(&self, command: &str, file: &str, more: &str) -> Vec<String> {
        let line = format!("{command} {}{more}", self.outputs);
        let words = line.split(' ').filter(|word| !word.is_empty());
        words.map(|word| word.replace("{}", file)).collect()
    }
}

/// A surface, its spline and its record.
const ALL: &str = "--output=o.ply --output=o.json --report=r.json";
/// Files of so many bytes are fitted by every method once they are sound.
const SMALL: u64 = 150_000;
/// Files of so many bytes are fitted by the quick methods once they are sound.
const LARGE: u64 = 3_100_000;

const NONE: Subject = Subject {
    name: "",
    command: "",
    input: "mesh.obj",
    takes_defects: true,
    files_up_to: SMALL,
    twice: None,
    outputs: ALL,
};

/// All commands that take a mesh, a network or a solid.
pub(super) const SUBJECTS: [Subject; 14] = [
    Subject {
        name: "info",
        command: "info {}",
        files_up_to: u64::MAX,
        outputs: "",
        ..NONE
    },
    Subject {
        name: "fit biharmonic",
        command: "fit biharmonic {} --knots=10% --effort=fast",
        files_up_to: LARGE,
        twice: Some(("--knots", "--knots-from=twice.obj")),
        ..NONE
    },
    Subject {
        name: "decompose",
        command: "decompose {} --layers=5%,15% --effort=fast",
        twice: Some(("--layers", "--layers=20,20")),
        ..NONE
    },
    Subject {
        name: "fit ls-mesh",
        command: "fit ls-mesh {} --controls=10%",
        files_up_to: u64::MAX,
        ..NONE
    },
    Subject {
        name: "fit powell-sabin",
        command: "fit powell-sabin {}",
        twice: Some(("", "--puncture=5,5")),
        ..NONE
    },
    Subject {
        name: "fit powell-sabin, torus",
        command: "fit powell-sabin {}",
        input: "torus.obj",
        twice: Some(("", "--puncture=5,5")),
        files_up_to: 0,
        ..NONE
    },
    Subject {
        name: "fit t-spline",
        command: "fit t-spline {} --control-points=150",
        twice: Some(("", "--puncture=5,5")),
        ..NONE
    },
    Subject {
        name: "fit t-spline, torus",
        command: "fit t-spline {} --control-points=100",
        input: "torus.obj",
        twice: Some(("", "--puncture=5,5")),
        files_up_to: 0,
        ..NONE
    },
    Subject {
        name: "conformal",
        command: "conformal {}",
        twice: Some(("", "--puncture=5,5")),
        ..NONE
    },
    Subject {
        name: "fit trivariate",
        command: "fit trivariate {} --spans=2 --spacing=8 --samples=2000,1000 --validate-at=4 --tessellate=2",
        twice: Some(("", "--corners=3,3,40,50,60,70,80,90")),
        ..NONE
    },
    Subject {
        name: "fit trivariate, tetrahedra",
        command: "fit trivariate {} --spans=2 --samples=2000,1000 --validate-at=4 --tessellate=2",
        input: "solid.mesh",
        twice: Some(("", "--corners=0,0,12,15,48,51,60,63")),
        files_up_to: 0,
        ..NONE
    },
    Subject {
        name: "fit sparse-manifold",
        command: "fit sparse-manifold {} --levels=1 --tessellate=2",
        input: "box.obj",
        twice: Some(("", "--creases=twice.creases")),
        ..NONE
    },
    Subject {
        name: "fit sparse-manifold --scan",
        command: "fit sparse-manifold {} --scan=60 --levels=1 --tessellate=2",
        ..NONE
    },
    Subject {
        name: "fit curve-network",
        command: "fit curve-network {} --tessellate=2",
        input: "net.obj",
        ..NONE
    },
];

/// Fits whose spline files are evaluated, changed and spoiled, with the names of the files.
pub(super) const SPLINES: [(&str, &str); 8] = [
    (
        "biharmonic",
        "fit biharmonic ball.obj --knots=20 --effort=fast",
    ),
    ("ls-mesh", "fit ls-mesh ball.obj --controls=20"),
    ("powell-sabin", "fit powell-sabin ring.obj"),
    ("filled", "fit powell-sabin ball.obj"),
    ("t-spline", "fit t-spline ring.obj --control-points=90"),
    (
        "trivariate",
        "fit trivariate solid.mesh --spans=2 --samples=2000,1000 --validate-at=4 --tessellate=2",
    ),
    (
        "sparse-manifold",
        "fit sparse-manifold box.obj --levels=1 --tessellate=2",
    ),
    ("curve-network", "fit curve-network net.obj --tessellate=2"),
];
