//! Processor time of this project's pursuits beside SPAMS and scikit-learn, in one run.
//!
//! `cargo run --release -p msplines-reference --bin pursuit_ratio [--rounds N]` solves 802 problems of
//! 300 rows, 175 atoms and 3 signals, each signal for itself with 25 atoms. Half of the dictionaries
//! are those of charts, monomials of degree 14 and the shape functions of all valences at random points
//! of a star; half are random. All columns have unit length, which SPAMS takes for granted: its `omp`
//! is the order-recursive pursuit, which takes the atom after which the residual is smallest. That of
//! scikit-learn takes the largest correlation. On charts some atoms tie up to rounding, so that not all
//! supports are equal.
//!
//! Every side starts from dictionary and signals, so that the products with them count; only
//! `orthogonal_mp_gram` is given them, and then so are we. All run on one thread and take turns; the
//! table holds medians. The Python packages come into `target/pursuit_peers`.

use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::{env, io};

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatMut, MatRef, Par};
use msplines_reference::cpu_seconds;
use msplines_sparse_manifold::pursuit::{Problem, Selection, Workspace, pursue};
use msplines_sparse_manifold::{Dictionary, DictionaryKind, Star};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

type Failure = Box<dyn Error>;

const PROBLEMS: usize = 802;
const ROWS: usize = 300;
const ATOMS: usize = 175;
const SIGNALS: usize = 3;
const SPARSITY: usize = 25;
/// Peers, and our selection that is the same as theirs.
const PEERS: [(&str, Selection); 3] = [
    ("spams.omp", Selection::Ormp),
    ("orthogonal_mp", Selection::Omp),
    (GIVEN_PRODUCTS, Selection::Omp),
];
/// The peer that is given the products.
const GIVEN_PRODUCTS: &str = "orthogonal_mp_gram";
/// Variables that keep a BLAS on one thread.
const ONE_THREAD: [&str; 3] = [
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "RAYON_NUM_THREADS",
];

fn main() -> Result<ExitCode, Failure> {
    let mut rounds = 5;
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--rounds" => rounds = arguments.next().ok_or("--rounds needs a number")?.parse()?,
            _ => return Err(format!("{argument} means nothing here").into()),
        }
    }
    let problems = problems();
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/pursuit_peers");
    let folder = env::temp_dir().join(format!("pursuit_ratio-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let result = compare(&problems, &target, &folder, rounds);
    fs::remove_dir_all(&folder)?;
    result.map(|()| ExitCode::SUCCESS)
}

fn compare(problems: &[Case], target: &Path, folder: &Path, rounds: usize) -> Result<(), Failure> {
    write_problems(problems, folder)?;
    println!("{PROBLEMS} problems of {ROWS} rows and {ATOMS} atoms, {SIGNALS} signals each,");
    println!(
        "{SPARSITY} atoms per signal; {rounds} rounds; load {}\n",
        load()
    );
    println!("| peer | version | ours, CPU s | its CPU s | ratio | charts | random | residual |");
    println!("|---|---|---:|---:|---:|---:|---:|---:|");
    let mut peers = Peers::start(target, folder)?;
    let versions = peers.versions()?;
    let mut times = vec![(Vec::new(), Vec::new()); PEERS.len()];
    let mut found = vec![Vec::new(); PEERS.len()];
    let mut shares = Vec::new();
    let present = |name: &str| {
        let own = versions.iter().find(|(peer, _)| peer == name);
        own.is_some_and(|(_, version)| version != "absent")
    };
    for _ in 0..rounds {
        for (index, (name, selection)) in PEERS.into_iter().enumerate() {
            if present(name) {
                times[index].1.push(peers.time(name)?);
            }
            let start = cpu_seconds();
            let (atoms, products) = solve(problems, selection);
            let whole = cpu_seconds() - start;
            let given = if name == GIVEN_PRODUCTS {
                products
            } else {
                0.0
            };
            times[index].0.push(whole - given);
            shares.push(products / whole);
            found[index] = atoms;
        }
    }
    for (index, (name, _)) in PEERS.into_iter().enumerate() {
        let ours = median(&mut times[index].0);
        if !present(name) {
            println!("| {name} | cannot be had | {ours:.3} | | | | | |");
            continue;
        }
        let version = versions.iter().find(|(peer, _)| peer == name);
        let version = version.map_or("", |(_, version)| version);
        let theirs = median(&mut times[index].1);
        let coefficients = read_numbers(&folder.join(format!("{name}.npy")))?;
        let [charts, random] = equal_supports(problems, &found[index], &coefficients);
        let residuals = residual_ratio(problems, &found[index], &coefficients);
        println!(
            "| {name} | {version} | {ours:.3} | {theirs:.3} | {:.3} | {charts:.4} | {random:.4} | {residuals:.6} |",
            ours / theirs
        );
    }
    println!(
        "\ncharts, random: signals for which both took the same atoms; residual: the root mean"
    );
    println!(
        "square of ours, as a multiple of theirs, where both did not take the same atoms (NaN: never)."
    );
    Ok(())
}

/// One dictionary and its signals.
struct Case {
    is_chart: bool,
    /// Unit columns.
    dictionary: Mat<f64>,
    signals: Mat<f64>,
}

fn problems() -> Vec<Case> {
    let mut random = Pcg64Mcg::seed_from_u64(802);
    (0..PROBLEMS)
        .map(|index| {
            let is_chart = index % 2 == 0;
            let mut dictionary = if is_chart {
                chart(3 + (index / 2 % 5) as u32, &mut random)
            } else {
                Mat::from_fn(ROWS, ATOMS, |_, _| random.random_range(-1.0..1.0))
            };
            for atom in 0..ATOMS {
                let column = dictionary.col_mut(atom);
                let length = column.norm_l2();
                column.iter_mut().for_each(|x| *x /= length);
            }
            // A sum of all atoms that no few of them give, and some noise.
            let weights = Mat::from_fn(ATOMS, SIGNALS, |_, _| {
                random.random_range(-1.0_f64..1.0).powi(3)
            });
            let mut signals = &dictionary * &weights;
            for signal in 0..SIGNALS {
                let noise = signals.col_mut(signal);
                noise
                    .iter_mut()
                    .for_each(|x| *x += random.random_range(-0.05..0.05));
            }
            Case {
                is_chart,
                dictionary,
                signals,
            }
        })
        .collect()
}

/// Returns the dictionary of a chart at random points.
fn chart(valence: u32, random: &mut Pcg64Mcg) -> Mat<f64> {
    let star = Star {
        sectors: valence,
        valence,
    };
    let dictionary = Dictionary::new(DictionaryKind::AllShapes, 14, star);
    let rows: Vec<Vec<f64>> = (0..ROWS)
        .map(|row| {
            let at = [random.random_range(0.0..1.0), random.random_range(0.0..1.0)];
            dictionary.values(row as u32 % valence, at)
        })
        .collect();
    assert_eq!(rows[0].len(), ATOMS, "monomials and shape functions");
    Mat::from_fn(ROWS, ATOMS, |row, atom| rows[row][atom])
}

/// Atoms and coefficients of a signal.
type Sparse = Vec<(usize, f64)>;

/// Returns what our pursuit takes for each signal of each problem, and the time of the products.
fn solve(problems: &[Case], selection: Selection) -> (Vec<Sparse>, f64) {
    let mut workspace = Workspace::default();
    let mut gram = vec![0.0; ATOMS * ATOMS];
    let mut alpha = Mat::zeros(ATOMS, SIGNALS);
    let allowed = [true; ATOMS];
    let mut all = Vec::with_capacity(problems.len() * SIGNALS);
    let mut products = 0.0;
    for case in problems {
        let start = cpu_seconds();
        multiply(case, &mut gram, &mut alpha);
        products += cpu_seconds() - start;
        for signal in 0..SIGNALS {
            let alpha: Vec<f64> = column(alpha.as_ref(), signal).collect();
            let problem = Problem {
                gram: &gram,
                components: 1,
                alpha: &alpha,
                allowed: &allowed,
            };
            let found = pursue(problem, selection, SPARSITY, &mut workspace);
            let support = found.support.iter().map(|&atom| usize::from(atom));
            all.push(support.zip(found.coefficients).collect());
        }
    }
    (all, products)
}

/// Writes the products of the atoms with each other and with the signals.
fn multiply(case: &Case, gram: &mut [f64], alpha: &mut Mat<f64>) {
    let (left, right) = (case.dictionary.transpose(), case.dictionary.as_ref());
    triangular::matmul(
        MatMut::from_column_major_slice_mut(gram, ATOMS, ATOMS),
        BlockStructure::TriangularLower,
        Accum::Replace,
        left,
        BlockStructure::Rectangular,
        right,
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    for j in 0..ATOMS {
        for i in j + 1..ATOMS {
            gram[i * ATOMS + j] = gram[j * ATOMS + i];
        }
    }
    let signals = case.signals.as_ref();
    matmul(alpha.as_mut(), Accum::Replace, left, signals, 1.0, Par::Seq);
}

fn column(matrix: MatRef<'_, f64>, index: usize) -> impl Iterator<Item = f64> {
    matrix.col(index).iter().copied()
}

/// Returns the signals of charts and of random dictionaries, as a fraction, for which both sides took
/// the same atoms.
fn equal_supports(problems: &[Case], ours: &[Sparse], theirs: &[f64]) -> [f64; 2] {
    let mut counts = [[0.0; 2]; 2];
    for (index, (ours, theirs)) in ours.iter().zip(theirs.chunks_exact(ATOMS)).enumerate() {
        let kind = usize::from(!problems[index / SIGNALS].is_chart);
        counts[kind][0] += f64::from(u8::from(are_equal(ours, theirs)));
        counts[kind][1] += 1.0;
    }
    counts.map(|[equal, all]| equal / all)
}

fn are_equal(ours: &Sparse, theirs: &[f64]) -> bool {
    let taken = theirs.iter().filter(|&&x| x != 0.0).count();
    taken == ours.len() && ours.iter().all(|&(atom, _)| theirs[atom] != 0.0)
}

/// Returns the root mean square residual of ours as a multiple of theirs, where atoms differ; NaN if
/// they never do.
fn residual_ratio(problems: &[Case], ours: &[Sparse], theirs: &[f64]) -> f64 {
    let mut sums = [0.0; 2];
    for (index, (ours, theirs)) in ours.iter().zip(theirs.chunks_exact(ATOMS)).enumerate() {
        if are_equal(ours, theirs) {
            continue;
        }
        let case = &problems[index / SIGNALS];
        let theirs: Sparse = theirs.iter().copied().enumerate().collect();
        for (sum, coefficients) in sums.iter_mut().zip([ours, &theirs]) {
            let mut rest: Vec<f64> = column(case.signals.as_ref(), index % SIGNALS).collect();
            for &(atom, weight) in coefficients {
                let values = column(case.dictionary.as_ref(), atom);
                rest.iter_mut()
                    .zip(values)
                    .for_each(|(x, a)| *x -= weight * a);
            }
            *sum += rest.iter().map(|x| x * x).sum::<f64>();
        }
    }
    (sums[0] / sums[1]).sqrt()
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn load() -> String {
    let text = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').take(3).collect::<Vec<_>>().join(" ")
}

/// The Python process that runs the peers.
struct Peers {
    child: Child,
    answers: BufReader<std::process::ChildStdout>,
}

impl Peers {
    /// Starts it, after making its environment where that is absent.
    fn start(target: &Path, folder: &Path) -> Result<Self, Failure> {
        let python = environment(target)?;
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/pursuit_peers.py");
        let mut child = Command::new(python)
            .args([script.as_path(), folder])
            .envs(ONE_THREAD.map(|name| (name, "1")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let answers = BufReader::new(child.stdout.take().ok_or("Python has no output")?);
        Ok(Self { child, answers })
    }

    fn ask(&mut self, question: &str) -> io::Result<()> {
        let mut input = self.child.stdin.as_ref().ok_or(io::ErrorKind::BrokenPipe)?;
        writeln!(input, "{question}")?;
        input.flush()
    }

    fn line(&mut self) -> Result<String, Failure> {
        let mut line = String::new();
        if self.answers.read_line(&mut line)? == 0 {
            return Err("the Python script has ended early".into());
        }
        Ok(line.trim().to_owned())
    }

    /// Returns peers and their versions.
    fn versions(&mut self) -> Result<Vec<(String, String)>, Failure> {
        self.ask("versions")?;
        let mut versions = Vec::new();
        loop {
            let line = self.line()?;
            match line.split_once('\t') {
                Some((peer, version)) => versions.push((peer.to_owned(), version.to_owned())),
                None => return Ok(versions),
            }
        }
    }

    /// Returns the processor time that a peer takes for all problems.
    fn time(&mut self, peer: &str) -> Result<f64, Failure> {
        self.ask(peer)?;
        Ok(self.line()?.parse()?)
    }
}

impl Drop for Peers {
    fn drop(&mut self) {
        // The script ends with its input.
        drop(self.child.stdin.take());
        let _ended = self.child.wait();
    }
}

/// Returns the Python of a virtual environment with the packages that could be had.
fn environment(target: &Path) -> Result<PathBuf, Failure> {
    let python = target.join("bin/python");
    if python.exists() {
        return Ok(python);
    }
    let made = Command::new("python3")
        .args(["-m", "venv"])
        .arg(target)
        .status()?;
    if !made.success() {
        return Err("python3 makes no virtual environment: install python3-venv".into());
    }
    let install = |package: &str| {
        let mut pip = Command::new(&python);
        pip.args(["-m", "pip", "install", "--quiet", package]);
        pip.stdout(Stdio::null())
            .status()
            .is_ok_and(|s| s.success())
    };
    for packages in [&["numpy"][..], &["scikit-learn"], &["spams-bin", "spams"]] {
        if !packages.iter().any(|package| install(package)) {
            println!("{} cannot be installed", packages[0]);
        }
    }
    Ok(python)
}

fn write_problems(problems: &[Case], folder: &Path) -> io::Result<()> {
    for (name, width) in [("dictionaries", ATOMS), ("signals", SIGNALS)] {
        let mut numbers = Vec::with_capacity(PROBLEMS * ROWS * width);
        for case in problems {
            let matrix = match name {
                "signals" => &case.signals,
                _ => &case.dictionary,
            };
            for row in 0..ROWS {
                numbers.extend(matrix.row(row).iter().flat_map(|x| x.to_le_bytes()));
            }
        }
        let shape = format!("({PROBLEMS}, {ROWS}, {width})");
        fs::write(folder.join(format!("{name}.npy")), npy(&shape, &numbers))?;
    }
    Ok(())
}

/// Returns a file of 64-bit numbers in row-major order, as `numpy.save` writes it.
fn npy(shape: &str, numbers: &[u8]) -> Vec<u8> {
    const PRELUDE: usize = 10;
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    while !(PRELUDE + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(numbers);
    file
}

/// Returns the 64-bit numbers of a file by `numpy.save`.
fn read_numbers(path: &Path) -> Result<Vec<f64>, Failure> {
    let file = fs::read(path)?;
    let size = file.get(8..10).ok_or("the file is too short")?;
    let start = 10 + usize::from(u16::from_le_bytes([size[0], size[1]]));
    let (numbers, _) = file[start..].as_chunks::<8>();
    Ok(numbers
        .iter()
        .map(|&bytes| f64::from_le_bytes(bytes))
        .collect())
}
