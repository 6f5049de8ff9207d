"""Array shapes and types of all of hydrostat are checked while the tests run; one thread of BLAS."""

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

from jaxtyping import install_import_hook  # noqa: E402

install_import_hook("hydrostat", "typechecker.checked")
