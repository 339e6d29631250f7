"""Pursuits of SPAMS and scikit-learn on dictionaries of unit columns, for peers.py."""

import warnings

import numpy as np


def spams_omp(dictionary, signals, sparsity):
    """Order-recursive pursuit in double precision; takes unit columns for granted."""
    import spams

    return spams.omp(signals, dictionary, L=sparsity, eps=0.0, numThreads=1)


def orthogonal_mp(dictionary, signals, sparsity):
    from sklearn.linear_model import orthogonal_mp as solve

    return solve(dictionary, signals, n_nonzero_coefs=sparsity, precompute=False)


def orthogonal_mp_gram(dictionary, signals, sparsity):
    """The products count, as for the others."""
    from sklearn.linear_model import orthogonal_mp_gram as solve

    products = dictionary.T @ dictionary, dictionary.T @ signals
    return solve(*products, n_nonzero_coefs=sparsity)


def problems(folder, count):
    """Dictionaries and signals, their columns one after another, as all peers want them."""
    dictionaries = np.load(folder / "dictionaries.npy")
    signals = np.load(folder / "signals.npy")
    rows = len(signals) // count
    return [
        tuple(np.asfortranarray(a[at : at + rows]) for a in (dictionaries, signals))
        for at in range(0, rows * count, rows)
    ]


def solve_all(name, folder, count, sparsity, timed):
    """Dense coefficients, problem after problem, signal after signal."""
    warnings.simplefilter("ignore")
    solve = {f.__name__: f for f in (spams_omp, orthogonal_mp, orthogonal_mp_gram)}[name]
    all_problems = problems(folder, count)
    # Imports and the first call of a library are not what is timed.
    solve(*all_problems[0], sparsity)
    with timed():
        found = [solve(*problem, sparsity) for problem in all_problems]
    dense = [x if isinstance(x, np.ndarray) else x.toarray() for x in found]
    return np.concatenate([x.T for x in dense])
