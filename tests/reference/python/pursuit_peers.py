"""Times SPAMS and scikit-learn on the problems in a folder and writes what they find there.

`pursuit_peers.py FOLDER` answers lines of standard input: `versions`, or the name of a peer, whose
processor seconds for all problems it prints. The folder holds `dictionaries.npy` of shape
(problems, rows, atoms) with unit columns, and `signals.npy` of shape (problems, rows, signals). The
dense coefficients of a peer go to `NAME.npy`, of shape (problems, signals, atoms).
"""

import sys
import time
import warnings
from importlib import metadata
from pathlib import Path

import numpy as np

SPARSITY = 25


def spams_omp(dictionary, signals):
    """Order-recursive pursuit in double precision; takes unit columns for granted."""
    import spams

    return spams.omp(signals, dictionary, L=SPARSITY, eps=0.0, numThreads=1)


def orthogonal_mp(dictionary, signals):
    from sklearn.linear_model import orthogonal_mp as solve

    return solve(dictionary, signals, n_nonzero_coefs=SPARSITY, precompute=False)


def orthogonal_mp_gram(gram, products):
    from sklearn.linear_model import orthogonal_mp_gram as solve

    return solve(gram, products, n_nonzero_coefs=SPARSITY)


PEERS = {
    "spams.omp": (spams_omp, ["spams-bin", "spams"]),
    "orthogonal_mp": (orthogonal_mp, ["scikit-learn"]),
    "orthogonal_mp_gram": (orthogonal_mp_gram, ["scikit-learn"]),
}


def version(packages):
    for package in packages:
        try:
            return f"{package} {metadata.version(package)}"
        except metadata.PackageNotFoundError:
            pass
    return "absent"


def main():
    folder = Path(sys.argv[1])
    # Columns one after another, as all peers want them.
    dictionaries = [np.asfortranarray(a) for a in np.load(folder / "dictionaries.npy")]
    signals = [np.asfortranarray(a) for a in np.load(folder / "signals.npy")]
    warnings.simplefilter("ignore")
    for line in sys.stdin:
        name = line.strip()
        if name == "versions":
            for peer, (_, packages) in PEERS.items():
                print(peer, version(packages), sep="\t", flush=True)
            print(flush=True)
            continue
        solve = PEERS[name][0]
        problems = list(zip(dictionaries, signals))
        if solve is orthogonal_mp_gram:
            problems = [(d.T @ d, d.T @ x) for d, x in problems]
        # Imports and the first call of a library are not what is timed.
        solve(*problems[0])
        start = time.process_time()
        found = [solve(*problem) for problem in problems]
        print(time.process_time() - start, flush=True)
        dense = [x if isinstance(x, np.ndarray) else x.toarray() for x in found]
        np.save(folder / f"{name}.npy", np.ascontiguousarray(np.stack(dense).swapaxes(1, 2)))


if __name__ == "__main__":
    main()
