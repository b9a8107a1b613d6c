//! The Python module `rodlab._rodlab`.
