//! Grids: keys, order, failures, repetition and resumption.
