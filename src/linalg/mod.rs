//! Small linear algebra: banded and sparse factorisations behind one interface.
