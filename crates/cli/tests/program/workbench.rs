//! A temporary folder with meshes, and the program run in it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use msplines_common::mesh::{PolygonSoup, TriangleMesh, shapes};
use msplines_io::{Surface, read_soup, write_surface};

/// Vertices of the ordinary test mesh: small enough for hundreds of runs.
pub(crate) const VERTICES: usize = 642;

/// A folder of its own for one test.
pub(crate) struct Workbench {
    folder: tempfile::TempDir,
}

/// What a run of the program gave.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Workbench {
    /// Returns a folder that holds the ordinary mesh as `mesh.ply`.
    pub(crate) fn new() -> Self {
        let workbench = Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
        };
        workbench.put("mesh.ply", &mesh());
        workbench
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn put(&self, name: &str, mesh: &TriangleMesh) {
        let surface = Surface {
            positions: mesh.positions(),
            faces: mesh.faces(),
            ..Surface::default()
        };
        write_surface(&self.path(name), &surface).expect("written");
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("written");
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect("the file is there")
    }

    pub(crate) fn soup(&self, name: &str) -> PolygonSoup {
        read_soup(&self.path(name)).expect("the file can be read")
    }

    pub(crate) fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.bytes(name)).expect("the file is JSON")
    }

    /// Runs the program in the folder; the arguments are separated by spaces.
    pub(crate) fn run(&self, arguments: &str) -> Ran {
        self.run_on(arguments.split_whitespace())
    }

    pub(crate) fn run_on<'a>(&self, arguments: impl IntoIterator<Item = &'a str>) -> Ran {
        let Output {
            status,
            stdout,
            stderr,
        } = Command::new(env!("CARGO_BIN_EXE_msplines"))
            .args(arguments)
            .current_dir(self.folder.path())
            .output()
            .expect("the program starts");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
        Ran {
            code: status.code().unwrap_or(-1),
            out: text(stdout),
            err: text(stderr),
        }
    }

    /// Runs the program and checks how it ends.
    pub(crate) fn expect(&self, code: i32, arguments: &str) -> Ran {
        let ran = self.run(arguments);
        assert_eq!(ran.code, code, "msplines {arguments}: {ran:?}");
        ran
    }
}

/// Returns the ordinary mesh: a sphere with bumps.
pub(crate) fn mesh() -> TriangleMesh {
    shapes::bumpy_sphere(VERTICES)
}

/// Returns the folder of the model library, if there is one.
pub(crate) fn models() -> Option<PathBuf> {
    let given = std::env::var_os("MSPLINES_MODELS").filter(|folder| !folder.is_empty());
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    // A relative folder is meant from the project's root, where the tests are started.
    let folder = root.join(given.map_or(PathBuf::from("data/models"), PathBuf::from));
    folder.is_dir().then_some(folder)
}
