//! Results directories: manifests, series, node files, checkpoints, VTK.
