//! Processor time of this project's factorisation beside CHOLMOD's, in one run.
//!
//! `cargo run --release -p msplines-reference --bin cholmod_ratio [MESH] [--rounds N]` compares L
//! and L A⁻¹ L of a mesh, or of a bumpy sphere of 100,000 vertices. Both sides run on one thread and
//! take turns; the table holds medians. CHOLMOD orders with METIS; its kernels are as fast as the
//! BLAS that is installed, so the table names it.

use std::env;
use std::path::Path;
use std::process::{Command, ExitCode};

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::{Policy, TriangleMesh, accept, shapes};
use msplines_common::operators::mesh_operators;
use msplines_reference::cholmod::{Cholmod, blas};
use msplines_reference::{Library, cpu_seconds};

type Failure = Box<dyn std::error::Error>;

/// What both sides do, in this order.
const STEPS: [&str; 7] = [
    "order and analyse",
    "factor",
    "refactor",
    "solve 1",
    "solve 3",
    "solve 16",
    "solve 64",
];
/// Right-hand sides of the last steps.
const SIDES: [usize; 4] = [1, 3, 16, 64];
/// Variables that keep the BLAS on one thread; it reads them before `main` starts.
const ONE_THREAD: [&str; 3] = [
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "RAYON_NUM_THREADS",
];

fn main() -> Result<ExitCode, Failure> {
    if ONE_THREAD
        .iter()
        .any(|name| env::var(name).as_deref() != Ok("1"))
    {
        let mut command = Command::new(env::current_exe()?);
        command
            .args(env::args_os().skip(1))
            .envs(ONE_THREAD.map(|name| (name, "1")));
        let status = command.status()?;
        return Ok(if status.success() {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        });
    }
    let (mut path, mut rounds) = (None, 5);
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--rounds" => rounds = arguments.next().ok_or("--rounds needs a number")?.parse()?,
            _ => path = Some(argument),
        }
    }
    let (name, mesh) = match path {
        Some(path) => {
            let soup = msplines_io::read_soup(Path::new(&path))?;
            (path, accept(&soup, Policy::Refuse)?.mesh)
        }
        None => ("bumpy sphere".to_owned(), shapes::bumpy_sphere(100_000)),
    };
    compare(&name, &mesh, rounds)?;
    Ok(ExitCode::SUCCESS)
}

fn compare(name: &str, mesh: &TriangleMesh, rounds: usize) -> Result<(), Failure> {
    println!("{name}, {} vertices, {rounds} rounds", mesh.vertex_count());
    println!("{}, {}\n", Library::Cholmod.version(), blas());
    println!("| matrix | step | ours, CPU s | CHOLMOD, CPU s | ratio |");
    println!("|---|---|---:|---:|---:|");
    let operators = mesh_operators(mesh);
    let bilaplacian = operators.bilaplacian();
    for (label, matrix) in [("L", &operators.laplacian), ("L A⁻¹ L", &bilaplacian)] {
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        let (mut entries, mut stored) = (0, 0);
        for _ in 0..rounds {
            let (times, count) = time_theirs(matrix);
            theirs.push(times);
            stored = count;
            let (times, count) = time_ours(matrix)?;
            ours.push(times);
            entries = count;
        }
        for (step, text) in STEPS.iter().enumerate() {
            let (ours, theirs) = (median(&ours, step), median(&theirs, step));
            println!(
                "| {label} | {text} | {ours:.3} | {theirs:.3} | {:.2} |",
                ours / theirs
            );
        }
        let ratio = entries as f64 / stored as f64;
        println!("| {label} | values stored | {entries} | {stored} | {ratio:.2} |");
    }
    Ok(())
}

/// Returns the processor time of each step, and the entries that the factor stores.
fn time_ours(matrix: &SymmetricMatrix) -> Result<([f64; STEPS.len()], usize), Failure> {
    let mut times = [0.0; STEPS.len()];
    let mut clock = Clock::start();
    let ordering = Ordering::nested_dissection(matrix)?;
    let symbolic = Symbolic::analyze_kept(matrix, &ordering, |row| row != 0);
    times[0] = clock.lap();
    let mut factor = Cholesky::factor(symbolic, matrix)?;
    times[1] = clock.lap();
    factor.refactor(matrix)?;
    times[2] = clock.lap();
    for (sides, time) in SIDES.iter().zip(&mut times[3..]) {
        let mut x = Mat::from_fn(matrix.size(), *sides, right_hand_side);
        clock = Clock::start();
        factor.solve_in_place(x.as_mut());
        *time = clock.lap();
    }
    Ok((times, factor.symbolic().value_count()))
}

fn time_theirs(matrix: &SymmetricMatrix) -> ([f64; STEPS.len()], usize) {
    let mut times = [0.0; STEPS.len()];
    let mut solver = Cholmod::of(matrix, |row| row != 0);
    let mut clock = Clock::start();
    solver.analyze();
    times[0] = clock.lap();
    solver.factor();
    times[1] = clock.lap();
    solver.factor();
    times[2] = clock.lap();
    for (sides, time) in SIDES.iter().zip(&mut times[3..]) {
        let rows = 1..matrix.size();
        let b: Vec<f64> = (0..*sides)
            .flat_map(|side| rows.clone().map(move |row| right_hand_side(row, side)))
            .collect();
        let mut x = vec![0.0; b.len()];
        clock = Clock::start();
        solver.solve(&b, &mut x);
        *time = clock.lap();
    }
    (times, solver.stored_values())
}

/// A right-hand side without structure.
fn right_hand_side(row: usize, side: usize) -> f64 {
    ((row * 7919 + side * 104_729) % 1_000) as f64 / 1_000.0 - 0.5
}

/// Processor time of this process.
struct Clock(f64);

impl Clock {
    fn start() -> Self {
        Self(cpu_seconds())
    }

    /// Returns the time since the last lap.
    fn lap(&mut self) -> f64 {
        let now = cpu_seconds();
        now - std::mem::replace(&mut self.0, now)
    }
}

fn median(rounds: &[[f64; STEPS.len()]], step: usize) -> f64 {
    let mut times: Vec<f64> = rounds.iter().map(|times| times[step]).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
