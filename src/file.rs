//! Reading our RON files.
